#include "devseg/pattern/match.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "devseg/errors.h"
#include "devseg/flatten/lpfb.h"
#include "devseg/pattern/outlines.h"
#include "devseg/pattern/simplify.h"

namespace devseg {

namespace {

constexpr double pi = 3.14159265358979323846;

// What nobody notices in sewing.
constexpr double largest_share = 0.002; // of the length
constexpr double largest_mm = 0.5;
// Seams that are better than this share of it are left alone.
constexpr double good_enough = 0.5;
// Sides that differ by more do not belong to charts at one scale: there is no mean to sew by.
constexpr double largest_ratio = 1.25;
// An outline that would have to move by more, as a share of its size, keeps its lengths.
constexpr double largest_move = 0.05;
// Every round pins further pieces; what is still mismatched after some is left to be reported.
constexpr int most_rounds = 4;

double side_length(const std::vector<PatternPiece>& pieces, const SeamSide& side) {
    double length = 0.0;
    for (Index k = 0; k < side.count; ++k)
        length += (side_point(pieces, side, k + 1) - side_point(pieces, side, k)).norm();
    return length;
}

bool differ(double a, double b, double share) {
    const double mean = 0.5 * (a + b);
    return std::abs(a - b) > share * std::min(largest_share * mean, largest_mm);
}

// Lengths that each outline's edges should have; empty for outlines that may stay as they are.
using Targets = std::vector<std::vector<std::vector<double>>>; // piece, path, edge

void set_target(const std::vector<PatternPiece>& pieces, const SeamSide& side, Index k,
                double length, Targets& targets) {
    const PiecePath& path = pieces[at(side.piece)].path(side.path);
    std::vector<double>& own = targets[at(side.piece)][at(side.path)];
    if (own.empty())
        for (std::size_t i = 0; i < path.points.size(); ++i)
            own.push_back((path.points[(i + 1) % path.points.size()] - path.points[i]).norm());
    const Index edge = side.reversed ? side.first + side.count - 1 - k : side.first + k;
    own[at(edge) % own.size()] = length;
}

Targets find_targets(const std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                     const std::vector<std::uint8_t>& pinned) {
    Targets targets(pieces.size());
    for (std::size_t p = 0; p < pieces.size(); ++p)
        targets[p].resize(at(pieces[p].path_count()));
    for (const Chain& chain : chains) {
        if (chain.side_count < 2)
            continue;
        const SeamSide& a = chain.sides[0];
        const SeamSide& b = chain.sides[1];
        const double length_a = side_length(pieces, a);
        const double length_b = side_length(pieces, b);
        const bool may_move = pinned[at(a.piece)] == 0 || pinned[at(b.piece)] == 0;
        if (!may_move || !differ(length_a, length_b, good_enough) ||
            std::max(length_a, length_b) > largest_ratio * std::min(length_a, length_b))
            continue;
        for (Index k = 0; k < chain.count(); ++k) {
            const double own = (side_point(pieces, a, k + 1) - side_point(pieces, a, k)).norm();
            const double other = (side_point(pieces, b, k + 1) - side_point(pieces, b, k)).norm();
            double length = 0.5 * (own + other);
            if (pinned[at(a.piece)] != 0)
                length = own;
            if (pinned[at(b.piece)] != 0)
                length = other;
            if (pinned[at(a.piece)] == 0)
                set_target(pieces, a, k, length, targets);
            if (pinned[at(b.piece)] == 0)
                set_target(pieces, b, k, length, targets);
        }
    }
    return targets;
}

// Inner angles of a polygon whose inside is on its left.
std::vector<double> inner_angles(const std::vector<Vec2>& points) {
    std::vector<double> angles;
    const std::size_t size = points.size();
    for (std::size_t i = 0; i < size; ++i) {
        const Vec2 p = points[i] - points[(i + size - 1) % size];
        const Vec2 q = points[(i + 1) % size] - points[i];
        angles.push_back(pi - std::atan2(p.x() * q.y() - p.y() * q.x(), p.dot(q)));
    }
    return angles;
}

// Turns and moves the points onto the others, as near as possible in the mean square.
void lay_onto(const std::vector<Vec2>& others, std::vector<Vec2>& points) {
    Vec2 from = Vec2::Zero();
    Vec2 to = Vec2::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
        from += points[i] / static_cast<double>(points.size());
        to += others[i] / static_cast<double>(points.size());
    }
    std::complex<double> turn(0.0, 0.0);
    const auto number = [](const Vec2& v) { return std::complex<double>(v.x(), v.y()); };
    for (std::size_t i = 0; i < points.size(); ++i)
        turn += std::conj(number(points[i] - from)) * number(others[i] - to);
    if (std::abs(turn) > 0.0)
        turn /= std::abs(turn);
    for (Vec2& p : points) {
        const std::complex<double> q = turn * number(p - from);
        p = to + Vec2(q.real(), q.imag());
    }
}

// The outline with edges of the given lengths; nothing where there is none near to it.
bool close_path(PiecePath& path, std::vector<double> lengths, double size,
                const Progress& progress) {
    if (*std::min_element(lengths.begin(), lengths.end()) <= 0.0)
        return false;
    std::vector<Vec2> points = path.points;
    // Holes run clockwise: the other way round they are polygons as well.
    const bool is_hole = path.area < 0.0;
    if (is_hole) {
        std::reverse(points.begin(), points.end());
        std::reverse(lengths.begin(), lengths.end() - 1);
    }
    std::vector<Vec2> closed;
    try {
        closed = close_boundary(lengths, inner_angles(points), LpfbOptions{}, progress).points;
    } catch (const NumericalFailure&) {
        return false;
    }
    lay_onto(points, closed);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!((closed[i] - points[i]).norm() <= largest_move * size))
            return false;
    if (is_hole)
        std::reverse(closed.begin(), closed.end());
    path.points = std::move(closed);
    path.area = signed_area(path.points);
    return true;
}

bool close_piece(PatternPiece& piece, const std::vector<std::vector<double>>& targets,
                 const Progress& progress) {
    PatternPiece changed = piece;
    const double size = std::sqrt(piece.area);
    for (Index l = 0; l < piece.path_count(); ++l)
        if (!targets[at(l)].empty() && !close_path(changed.path(l), targets[at(l)], size, progress))
            return false;
    if (crosses_itself(changed) && !crosses_itself(piece))
        return false;
    piece = std::move(changed);
    return true;
}

} // namespace

bool sides_agree(double length_a, double length_b) {
    return !differ(length_a, length_b, 1.0);
}

Index match_sides(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                  const Progress& progress) {
    std::vector<std::uint8_t> pinned(pieces.size(), 0);
    for (int round = 0; round < most_rounds; ++round) {
        const Targets targets = find_targets(pieces, chains, pinned);
        std::vector<PatternPiece> changed = pieces;
        Index count = 0;
        bool again = false;
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            const bool wanted = std::any_of(targets[p].begin(), targets[p].end(),
                                            [](const auto& t) { return !t.empty(); });
            if (!wanted)
                continue;
            progress.check();
            if (close_piece(changed[p], targets[p], progress)) {
                ++count;
            } else {
                pinned[p] = 1;
                again = true;
            }
        }
        if (!again || round + 1 == most_rounds) {
            pieces = std::move(changed);
            return count;
        }
    }
    return 0;
}

} // namespace devseg
