// References
//   H. Sakoe, S. Chiba: Dynamic Programming Algorithm Optimization for Spoken Word Recognition.
//   IEEE Transactions on Acoustics, Speech, and Signal Processing 26(1), 1978.
#include "devseg/pattern/alike.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/pattern/corners.h"
#include "devseg/pattern/same_pieces.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

struct Tuning {
    double size_share = 0.03;  // of a piece's size: cloth takes a change of its outline by so much
    std::size_t samples = 512; // along an outline
    int rounds = 2;            // the second one takes out what spacing the samples left
};
constexpr Tuning tuning;

using Ring = std::vector<Vec2>;
using Match = std::vector<std::pair<std::size_t, std::size_t>>;

// Pairs of points of two closed rings, in their order and all of them, whose squared distances are
// least in sum. It begins where a's outermost point finds its nearest one.
Match match_in_order(const Ring& a, const Ring& b) {
    const std::size_t n = a.size();
    Vec2 middle = Vec2::Zero();
    for (const Vec2& p : a)
        middle += p / static_cast<double>(n);
    const auto nearer = [](const Vec2& to) {
        return [to](const Vec2& p, const Vec2& q) {
            return (p - to).squaredNorm() < (q - to).squaredNorm();
        };
    };
    const auto first =
        static_cast<std::size_t>(std::max_element(a.begin(), a.end(), nearer(middle)) - a.begin());
    const auto second = static_cast<std::size_t>(
        std::min_element(b.begin(), b.end(), nearer(a[first])) - b.begin());
    const auto cost = [&](std::size_t i, std::size_t j) {
        return (a[(first + i) % n] - b[(second + j) % n]).squaredNorm();
    };
    const std::size_t size = n + 1; // the first point comes once more
    std::vector<double> least(size * size, infinite);
    for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < size; ++j) {
            double before = i == 0 && j == 0 ? 0.0 : infinite;
            if (i > 0)
                before = std::min(before, least[(i - 1) * size + j]);
            if (j > 0)
                before = std::min(before, least[i * size + j - 1]);
            if (i > 0 && j > 0)
                before = std::min(before, least[(i - 1) * size + j - 1]);
            least[i * size + j] = before + cost(i, j);
        }
    Match match;
    std::size_t i = n;
    std::size_t j = n;
    while (i > 0 || j > 0) {
        match.emplace_back((first + i) % n, (second + j) % n);
        const double both = i > 0 && j > 0 ? least[(i - 1) * size + j - 1] : infinite;
        const double in_a = i > 0 ? least[(i - 1) * size + j] : infinite;
        const double in_b = j > 0 ? least[i * size + j - 1] : infinite;
        if (both <= in_a && both <= in_b) {
            --i;
            --j;
        } else if (in_a <= in_b)
            --i;
        else
            --j;
    }
    return match;
}

// Means of what is put to each sample.
class Means {
public:
    explicit Means(std::size_t size) : sum_(size, Vec2::Zero()), count_(size, 0) {}
    void add(std::size_t k, const Vec2& p) {
        sum_[k] += p;
        ++count_[k];
    }
    Ring values() const {
        Ring result = sum_;
        for (std::size_t k = 0; k < result.size(); ++k)
            if (count_[k] > 0)
                result[k] /= count_[k];
        return result;
    }

private:
    Ring sum_;
    std::vector<int> count_;
};

// One outline of one of the pieces that are alike.
struct Member {
    PiecePath* path = nullptr;
    Vec2 center = Vec2::Zero(); // of its piece
    bool mirrored = false;
    Motion motion;         // to the model
    bool is_image = false; // the mirror image of another member: it is read, not written

    Vec2 to_model(Vec2 p) const {
        p -= center;
        if (mirrored)
            p.x() = -p.x();
        return motion(p);
    }
    // Of a direction in the model's frame.
    Vec2 from_model(const Vec2& way) const {
        const Motion back = motion.inverse();
        Vec2 p = back(way) - back(Vec2::Zero());
        if (mirrored)
            p.x() = -p.x();
        return p;
    }
    Ring samples() const {
        Ring ring = even_points(path->points, tuning.samples);
        for (Vec2& p : ring)
            p = to_model(p);
        return ring;
    }
};

// Samples that belong together: of the model, and of each member in the order of its own outline.
// Mirrored outlines run the other way round.
Match match_member(const Ring& model, Ring samples, bool mirrored) {
    if (mirrored)
        std::reverse(samples.begin(), samples.end());
    Match match = match_in_order(model, samples);
    if (mirrored)
        for (auto& pair : match)
            pair.second = samples.size() - 1 - pair.second;
    return match;
}

// Moves the points of the outline as the samples around them are to move.
void move_points(const Member& member, const Ring& moves) {
    Ring& points = member.path->points;
    const double step =
        plane::perimeter(points) / static_cast<double>(moves.size()); // between samples
    const Ring old = points;
    double arc = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double place = step > 0.0 ? arc / step : 0.0;
        const double below = std::floor(place);
        const auto k = static_cast<std::size_t>(below) % moves.size();
        const double s = place - below;
        points[i] += member.from_model((1.0 - s) * moves[k] + s * moves[(k + 1) % moves.size()]);
        arc += (old[(i + 1) % old.size()] - old[i]).norm();
    }
}

// All outlines of one place in pieces that are alike get their mean.
void take_mean(const std::vector<Member>& members) {
    std::vector<Ring> samples;
    for (const Member& member : members)
        samples.push_back(member.samples());
    std::vector<Match> matches;
    Ring mean = samples.front();
    for (std::size_t m = 1; m < members.size(); ++m) {
        const bool reversed = members[m].mirrored != members.front().mirrored;
        matches.push_back(match_member(samples.front(), samples[m], reversed));
        Means there(tuning.samples);
        for (const auto& [i, j] : matches.back())
            there.add(i, samples[m][j]);
        const Ring values = there.values();
        for (std::size_t i = 0; i < mean.size(); ++i)
            mean[i] += values[i];
    }
    for (Vec2& p : mean)
        p /= static_cast<double>(members.size());
    for (std::size_t m = 0; m < members.size(); ++m) {
        if (members[m].is_image)
            continue;
        Means moves(tuning.samples);
        if (m == 0)
            for (std::size_t i = 0; i < mean.size(); ++i)
                moves.add(i, mean[i] - samples[0][i]);
        else
            for (const auto& [i, j] : matches[m - 1])
                moves.add(j, mean[i] - samples[m][j]);
        move_points(members[m], moves.values());
    }
}

// The outline of the model that outline l of a piece lies on.
Index outline_of_model(const PatternPiece& piece, const Likeness& likeness, Index l,
                       const PatternPiece& model) {
    if (l == 0)
        return 0;
    Member member{nullptr, piece.box.center(), likeness.mirrored, likeness.motion, false};
    const Vec2 p = member.to_model(piece.path(l).points.front()) + model.box.center();
    Index best = 1;
    double least = infinite;
    for (Index k = 1; k < model.path_count(); ++k)
        for (const Vec2& q : model.path(k).points)
            if ((p - q).squaredNorm() < least) {
                least = (p - q).squaredNorm();
                best = k;
            }
    return best;
}

// Pieces that have one shape, the model first.
struct Group {
    std::vector<std::size_t> pieces;
    std::vector<Likeness> likeness;
};

std::vector<Group> find_groups(const std::vector<PatternPiece>& pieces, double tolerance_mm,
                               const Progress& progress) {
    const std::vector<Likeness> found =
        find_likenesses(pieces, tolerance_mm, tuning.size_share, progress);
    std::vector<Group> groups(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        Group& group = groups[found[i].model];
        group.pieces.push_back(i);
        group.likeness.push_back(found[i]);
    }
    return groups;
}

// The group's outlines become alike; the model's own mirror image counts as one of them where it
// is alone.
void make_group_alike(std::vector<PatternPiece>& pieces, const Group& group, double tolerance_mm) {
    PatternPiece& model = pieces[group.pieces.front()];
    const auto image = group.pieces.size() == 1
                           ? mirror_motion(model, tolerance_mm, tuning.size_share)
                           : std::nullopt;
    for (Index l = 0; l < model.path_count(); ++l) {
        std::vector<Member> members;
        for (std::size_t m = 0; m < group.pieces.size(); ++m) {
            PatternPiece& piece = pieces[group.pieces[m]];
            const Likeness& likeness = group.likeness[m];
            for (Index k = 0; k < piece.path_count(); ++k)
                if (outline_of_model(piece, likeness, k, model) == l) {
                    members.push_back({&piece.path(k), piece.box.center(), likeness.mirrored,
                                       likeness.motion, false});
                    break;
                }
        }
        if (image && l == 0)
            members.push_back({&model.path(0), model.box.center(), true, *image, true});
        if (members.size() > 1)
            take_mean(members);
    }
}

} // namespace

Index make_alike(std::vector<PatternPiece>& pieces, double tolerance_mm, const Progress& progress) {
    Index changed = 0;
    for (const Group& group : find_groups(pieces, tolerance_mm, progress)) {
        if (group.pieces.empty())
            continue;
        progress.check();
        std::vector<PatternPiece> before;
        for (const std::size_t i : group.pieces)
            before.push_back(pieces[i]);
        for (int round = 0; round < tuning.rounds; ++round)
            make_group_alike(pieces, group, tolerance_mm);
        bool crosses = false;
        for (std::size_t k = 0; k < before.size(); ++k)
            crosses =
                crosses || (crosses_itself(pieces[group.pieces[k]]) && !crosses_itself(before[k]));
        for (std::size_t k = 0; k < before.size(); ++k)
            if (crosses)
                pieces[group.pieces[k]] = before[k];
            else if (pieces[group.pieces[k]].outer.points != before[k].outer.points)
                ++changed;
    }
    return changed;
}

} // namespace devseg::pattern
