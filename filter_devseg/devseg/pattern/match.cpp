#include "devseg/pattern/match.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/flatten/maps/lpfb.h"
#include "devseg/pattern/corners.h"
#include "devseg/pattern/outlines.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Crossings that are less deep do not count: mm, and a share of the size on pieces below 100 mm.
constexpr double rounding_depth = 0.01;
constexpr double rounding_share = 1e-4;

// What nobody notices in sewing.
constexpr double largest_share = 0.002; // of the length
constexpr double largest_mm = 0.5;
// Seams that are better than this share of it are left alone.
constexpr double good_enough = 0.5;
// Every round takes freedom from one more piece; what is still mismatched then is reported.
constexpr int match_rounds = 8;
// Newton steps for positions, the share of the outline's length that edges may be off, and what
// keeps the equations solvable on straight outlines.
constexpr int match_steps = 60;
constexpr double softness = 1e-9;
// Rounds of pushing crossing edges apart, to this share of the outline's length.
constexpr double push_share = 2e-5;

double edge_length(const std::vector<PatternPiece>& pieces, const SeamSide& side, Index k) {
    return (side_point(pieces, side, k + 1) - side_point(pieces, side, k)).norm();
}

double side_length(const std::vector<PatternPiece>& pieces, const SeamSide& side) {
    double length = 0.0;
    for (Index k = 0; k < side.count; ++k)
        length += edge_length(pieces, side, k);
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
    const PiecePath& path = pieces[side.piece].path(side.path);
    std::vector<double>& own = targets[side.piece][side.path];
    if (own.empty())
        for (std::size_t i = 0; i < path.points.size(); ++i)
            own.push_back((path.points[(i + 1) % path.points.size()] - path.points[i]).norm());
    const Index edge = side.reversed ? side.first + side.count - 1 - k : side.first + k;
    own[at(edge) % own.size()] = length;
}

// How far a piece may be changed: to the lengths on the model, only along its seams with itself,
// to their mean, or not at all.
enum class Freedom : std::uint8_t { free, own_seams, fixed };

// The length for edge k of a chain, with sides of the given freedom: that of the side that must
// keep it, that on the model where a side has it along the whole seam, or the mean of both.
double target_length(const std::vector<PatternPiece>& pieces, const Chain& chain, Index k,
                     const std::vector<Freedom>& freedom, bool is_true) {
    double sum = 0.0;
    int held = 0; // sides that keep their lengths
    double both = 0.0;
    for (const SeamSide& side : chain.sides) {
        const double length = edge_length(pieces, side, k);
        both += length;
        if (freedom[side.piece] != Freedom::free) {
            sum += length;
            ++held;
        }
    }
    if (held > 0)
        return sum / held;
    return is_true ? chain.true_length[k] : 0.5 * both;
}

// `always_true`: as on the model even where neither side is.
Targets find_targets(const std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                     const std::vector<Freedom>& freedom, bool always_true) {
    Targets targets(pieces.size());
    for (std::size_t p = 0; p < pieces.size(); ++p)
        targets[p].resize(at(pieces[p].path_count()));
    for (const Chain& chain : chains) {
        if (chain.side_count < 2)
            continue;
        const SeamSide& a = chain.sides[0];
        const SeamSide& b = chain.sides[1];
        if (!differ(side_length(pieces, a), side_length(pieces, b), good_enough))
            continue;
        const auto may_move = [&](const SeamSide& side) {
            return freedom[side.piece] == Freedom::free ||
                   (freedom[side.piece] == Freedom::own_seams && a.piece == b.piece);
        };
        const double on_model =
            std::accumulate(chain.true_length.begin(), chain.true_length.end(), 0.0);
        const bool is_true = always_true || sides_agree(side_length(pieces, a), on_model) ||
                             sides_agree(side_length(pieces, b), on_model);
        for (Index k = 0; k < chain.count(); ++k)
            for (const SeamSide& side : chain.sides)
                if (may_move(side))
                    set_target(pieces, side, k, target_length(pieces, chain, k, freedom, is_true),
                               targets);
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
        angles.push_back(pi - plane::signed_angle(p, q));
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

// The polygon with edges of the given lengths and angles as near as possible to those it has.
bool close_by_angles(std::vector<Vec2>& points, const std::vector<double>& lengths,
                     const Progress& progress) {
    try {
        std::vector<Vec2> closed =
            flatten::close_boundary(lengths, inner_angles(points), flatten::LpfbOptions{}, progress)
                .points;
        lay_onto(points, closed);
        points = std::move(closed);
    } catch (const NumericalFailure&) {
        return false;
    }
    return true;
}

// The polygon with edges of the given lengths whose points move as little as possible: steps of
// least norm that fulfil the linearised conditions |x[i + 1] − x[i]| = lengths[i].
bool close_by_positions(std::vector<Vec2>& points, const std::vector<double>& lengths) {
    const std::size_t n = points.size();
    const double enough = no_extent * std::accumulate(lengths.begin(), lengths.end(), 0.0);
    for (int step = 0; step < match_steps; ++step) {
        std::vector<Vec2> along(n);
        Eigen::VectorXd missing(static_cast<Eigen::Index>(n));
        for (std::size_t i = 0; i < n; ++i) {
            along[i] = points[(i + 1) % n] - points[i];
            const double length = along[i].norm();
            if (!(length > 0.0))
                return false;
            along[i] /= length;
            missing[static_cast<Eigen::Index>(i)] = lengths[i] - length;
        }
        if (missing.lpNorm<Eigen::Infinity>() <= enough)
            return true;
        std::vector<Eigen::Triplet<double>> entries;
        for (std::size_t i = 0; i < n; ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            const auto next = static_cast<Eigen::Index>((i + 1) % n);
            const double common = -along[i].dot(along[(i + 1) % n]);
            entries.emplace_back(row, row, 2.0 + softness);
            entries.emplace_back(row, next, common);
            entries.emplace_back(next, row, common);
        }
        Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(n),
                                           static_cast<Eigen::Index>(n));
        matrix.setFromTriplets(entries.begin(), entries.end());
        const Eigen::VectorXd pull =
            Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(missing);
        if (!pull.allFinite())
            return false;
        for (std::size_t i = 0; i < n; ++i) {
            points[i] -= pull[static_cast<Eigen::Index>(i)] * along[i];
            points[(i + 1) % n] += pull[static_cast<Eigen::Index>(i)] * along[i];
        }
    }
    return false;
}

// Moves the ends of two edges that cross until they do not: the end that is nearest to the other
// edge goes to its other side, and that edge comes towards it.
void push_apart(std::vector<Vec2>& points, std::size_t i, std::size_t j, double gap) {
    const std::size_t n = points.size();
    const std::array<std::array<std::size_t, 3>, 4> ends = {{{i, j, (j + 1) % n},
                                                             {(i + 1) % n, j, (j + 1) % n},
                                                             {j, i, (i + 1) % n},
                                                             {(j + 1) % n, i, (i + 1) % n}}};
    double least = infinite;
    Vec2 push = Vec2::Zero();
    std::array<std::size_t, 3> best{};
    for (const auto& end : ends) {
        const Vec2 along = (points[end[2]] - points[end[1]]).normalized();
        const Vec2 across = plane::left_of(along);
        const double distance = across.dot(points[end[0]] - points[end[1]]);
        if (std::abs(distance) >= least)
            continue;
        least = std::abs(distance);
        push = -0.5 * (distance + std::copysign(gap, distance)) * across;
        best = end;
    }
    points[best[0]] += push;
    points[best[1]] -= push;
    points[best[2]] -= push;
}

// The same, with edges that cross pushed apart in turn with the lengths.
bool close_without_crossing(std::vector<Vec2>& points, const std::vector<double>& lengths,
                            const Progress& progress) {
    const std::size_t n = points.size();
    const double gap = push_share * std::accumulate(lengths.begin(), lengths.end(), 0.0);
    for (int round = 0; round < match_steps; ++round) {
        progress.check();
        if (!close_by_positions(points, lengths))
            return false;
        bool crosses = false;
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 2; j < n; ++j)
                if (plane::segments_cross(points[i], points[i + 1], points[j],
                                          points[(j + 1) % n])) {
                    push_apart(points, i, j, gap);
                    crosses = true;
                }
        if (!crosses)
            return true;
    }
    return false;
}

enum class Closing { by_angles, by_positions, without_crossing };

// The outline with edges of the given lengths; false where there is none.
bool close_path(PiecePath& path, std::vector<double> lengths, Closing how,
                const Progress& progress) {
    if (*std::min_element(lengths.begin(), lengths.end()) <= 0.0)
        return false;
    // Holes run clockwise: the other way round they are polygons as well.
    const auto turn_over = [&] {
        if (path.area < 0.0)
            std::reverse(path.points.begin(), path.points.end());
    };
    turn_over();
    if (path.area < 0.0)
        std::reverse(lengths.begin(), lengths.end() - 1);
    bool closed = false;
    switch (how) {
    case Closing::by_angles:
        closed = close_by_angles(path.points, lengths, progress);
        break;
    case Closing::by_positions:
        closed = close_by_positions(path.points, lengths);
        break;
    case Closing::without_crossing:
        closed = close_without_crossing(path.points, lengths, progress);
        break;
    }
    turn_over();
    return closed;
}

// All ways in turn; the first outline that does not cross itself is taken.
bool close_piece(PatternPiece& piece, const std::vector<std::vector<double>>& targets,
                 const Progress& progress) {
    // Parts that lie side by side may cross by rounding: that is no licence to cross more.
    const double size = plane::box_of(piece.outer.points).sizes().maxCoeff();
    const double depth =
        crosses_itself(piece) ? std::min(rounding_depth, rounding_share * size) : 0.0;
    const bool crossed = crosses_itself(piece, depth);
    for (const Closing how :
         {Closing::by_angles, Closing::by_positions, Closing::without_crossing}) {
        PatternPiece changed = piece;
        bool closed = true;
        for (Index l = 0; l < piece.path_count() && closed; ++l)
            closed = targets[l].empty() || close_path(changed.path(l), targets[l], how, progress);
        if (!closed || (crosses_itself(changed, depth) && !crossed))
            continue;
        piece = std::move(changed);
        return true;
    }
    return false;
}

// Matches as many seams as can be, and returns the number of pieces that were changed.
Index match_with(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                 bool always_true, const Progress& progress) {
    std::vector<Freedom> freedom(pieces.size(), Freedom::free);
    for (int round = 0;; ++round) {
        const Targets targets = find_targets(pieces, chains, freedom, always_true);
        std::vector<PatternPiece> changed = pieces;
        Index count = 0;
        std::size_t failed = pieces.size(); // the largest piece that must stay as it is
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            const bool wanted = std::any_of(targets[p].begin(), targets[p].end(),
                                            [](const auto& t) { return !t.empty(); });
            if (!wanted)
                continue;
            progress.check();
            if (close_piece(changed[p], targets[p], progress))
                ++count;
            else if (failed == pieces.size() || pieces[p].area > pieces[failed].area)
                failed = p;
        }
        if (failed == pieces.size() || round == match_rounds) {
            pieces = std::move(changed);
            return count;
        }
        freedom[failed] = freedom[failed] == Freedom::free ? Freedom::own_seams : Freedom::fixed;
    }
}

std::size_t count_mismatches(const std::vector<PatternPiece>& pieces,
                             const std::vector<Chain>& chains) {
    return static_cast<std::size_t>(
        std::count_if(chains.begin(), chains.end(), [&](const Chain& chain) {
            return chain.side_count == 2 && !sides_agree(side_length(pieces, chain.sides[0]),
                                                         side_length(pieces, chain.sides[1]));
        }));
}

} // namespace

bool sides_agree(double length_a, double length_b) {
    return !differ(length_a, length_b, 1.0);
}

Index match_sides(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                  const Progress& progress) {
    std::vector<PatternPiece> matched = pieces;
    const Index changed = match_with(matched, chains, false, progress);
    const std::size_t left = count_mismatches(matched, chains);
    if (left > 0) {
        std::vector<PatternPiece> other = pieces;
        const Index other_changed = match_with(other, chains, true, progress);
        if (count_mismatches(other, chains) < left) {
            pieces = std::move(other);
            return other_changed;
        }
    }
    pieces = std::move(matched);
    return changed;
}

} // namespace devseg::pattern
