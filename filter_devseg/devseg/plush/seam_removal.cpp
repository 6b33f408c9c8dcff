#include "devseg/plush/seam_removal.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "devseg/parallel.h"
#include "devseg/plush/patch_trial.h"

namespace devseg {

namespace {

constexpr std::size_t batch =
    6;                         // trials that run side by side; fixed, for the same result anywhere
constexpr int most_passes = 2; // over all segments
constexpr double unpaired = 0.05; // of the root of the area
constexpr double lone = 0.008;    // of the area: patches that may be joined without a mirror image

using Key = std::pair<Index, Index>; // lowest half-edge and number of edges of a segment

Key key_of(const Mesh& mesh, const SeamSegment& segment) {
    Index lowest = segment.half_edges.front();
    for (const Index h : segment.half_edges)
        lowest = std::min({lowest, h, mesh.twin[at(h)]});
    return {lowest, static_cast<Index>(segment.half_edges.size())};
}

enum class Mode { whole_segments, joins, darts };

// The part of a segment from one share of its length to another.
struct Window {
    double from = 0.0;
    double to = 1.0;
};

// What stays of a seam is an end, or two; the middle goes first. The widest windows come first.
constexpr Window join_windows[] = {{0.0, 1.0},  {0.15, 1.0},  {0.0, 0.85},  {0.15, 0.85},
                                   {0.35, 1.0}, {0.0, 0.65},  {0.25, 0.75}, {0.55, 1.0},
                                   {0.0, 0.45}, {0.35, 0.65}, {0.7, 1.0},   {0.0, 0.3},
                                   {0.4, 0.6},  {0.2, 0.45},  {0.55, 0.8}};
// A dart keeps its outer end, which comes first.
constexpr Window dart_windows[] = {{0.0, 1.0}, {0.3, 1.0}, {0.55, 1.0}, {0.8, 1.0}};

// Segments that go together, or parts of them, and what becomes of the patches beside them.
struct Removal {
    std::vector<std::size_t> segments;
    std::vector<std::uint8_t> reversed; // the mirror image runs the other way
    std::vector<Window> windows;        // to be tried, in this order
    std::vector<Index> patches;         // that are joined or lose a dart
    std::vector<Index> half_edges;      // that go; empty = no window was accepted
};

class Remover {
public:
    Remover(const SeamSetting& setting, Mode mode, const RemovalOptions& options, SeamMarks& seam,
            Progress& progress)
        : s_(setting), mode_(mode), options_(options), seam_(seam), progress_(progress) {}

    Index run() {
        unpaired_ = unpaired * std::sqrt(s_.mesh.total_area);
        refresh();
        const double start = static_cast<double>(segments_.size());
        for (int pass = 0; pass < most_passes; ++pass) {
            failed_.clear();
            is_first_pass_ = pass == 0;
            bool changed = false;
            for (; rounds_ < s_.max_rounds; ++rounds_) {
                std::vector<Removal> round = next_round();
                if (round.empty())
                    break;
                test(round);
                bool removed = false;
                for (const Removal& removal : round)
                    removed = apply(removal) || removed;
                if (removed)
                    refresh();
                changed = changed || removed;
                progress_.update(std::min(0.95, 1.0 - static_cast<double>(segments_.size()) /
                                                          std::max(1.0, start)));
            }
            if (!changed && (!is_first_pass_ || s_.mirror.empty()))
                break;
        }
        return trials_;
    }

private:
    void refresh() {
        segments_ = find_segments(s_.mesh, seam_, s_.hard, s_.weight);
        patches_ = find_patches(s_.mesh, seam_);
        degree_ = seam_degrees(s_.mesh, seam_);
        faces_.assign(at(patches_.count), {});
        area_.assign(at(patches_.count), 0.0);
        for (Index f = 0; f < s_.mesh.face_count(); ++f) {
            faces_[at(patches_.label[at(f)])].push_back(f);
            area_[at(patches_.label[at(f)])] += s_.mesh.face_areas[at(f)];
        }
        if (!s_.mirror.empty())
            find_nearby();
    }

    // The segments within two rings of each vertex.
    void find_nearby() {
        nearby_.assign(s_.mesh.points.size(), {});
        for (std::size_t i = 0; i < segments_.size(); ++i)
            for (const Index h : segments_[i].half_edges)
                for (const Index v : {s_.mesh.origin(h), s_.mesh.target(h)})
                    nearby_[at(v)].push_back(static_cast<Index>(i));
        for (int ring = 0; ring < 2; ++ring) {
            const std::vector<std::vector<Index>> before = nearby_;
            for (Index h = 0; h < s_.mesh.half_edge_count(); ++h) {
                const std::vector<Index>& from = before[at(s_.mesh.origin(h))];
                const std::vector<Index>& back = before[at(s_.mesh.target(h))];
                std::vector<Index>& to = nearby_[at(s_.mesh.target(h))];
                std::vector<Index>& start = nearby_[at(s_.mesh.origin(h))];
                to.insert(to.end(), from.begin(), from.end());
                start.insert(start.end(), back.begin(), back.end());
            }
            for (std::vector<Index>& near : nearby_) {
                std::sort(near.begin(), near.end());
                near.erase(std::unique(near.begin(), near.end()), near.end());
            }
        }
    }

    Index left(std::size_t i) const {
        return patches_.label[at(segments_[i].half_edges.front() / 3)];
    }
    Index right(std::size_t i) const {
        return patches_.label[at(s_.mesh.twin[at(segments_[i].half_edges.front())] / 3)];
    }

    // A factor near 1 that depends on the seed and on where the segment is; 1 for the seed 0.
    double jitter(const SeamSegment& segment) const {
        if (options_.random_seed == 0)
            return 1.0;
        const auto [lowest, count] = key_of(s_.mesh, segment);
        std::minstd_rand random(static_cast<std::uint32_t>(options_.random_seed) * 2654435761U +
                                static_cast<std::uint32_t>(lowest));
        random.discard(2);
        return 0.8 + 0.4 * static_cast<double>(random()) / std::minstd_rand::max();
    }

    double order(std::size_t i) const {
        const SeamSegment& segment = segments_[i];
        const double size = std::min(area_[at(left(i))], area_[at(right(i))]) / s_.mesh.total_area;
        if (mode_ == Mode::joins)
            return segment.length / std::max(size, 1e-9);
        return jitter(segment) * segment.weight * std::pow(segment.length, options_.length_power) *
               std::pow(size, -options_.size_power);
    }

    // The mirror image of a segment: the one near which most of its mirrored vertices lie; −1 where
    // there is none. Without symmetry the segment itself.
    Index partner(std::size_t i) const {
        if (s_.mirror.empty())
            return static_cast<Index>(i);
        std::map<Index, int> votes;
        int total = 0;
        for (const Index h : segments_[i].half_edges) {
            const Index v = s_.mirror[at(s_.mesh.target(h))];
            ++total;
            if (v >= 0)
                for (const Index k : nearby_[at(v)])
                    ++votes[k];
        }
        Index best = -1;
        double most = 0.0;
        for (const auto& [k, count] : votes) {
            const double ratio = std::min(segments_[at(k)].length, segments_[i].length) /
                                 std::max(segments_[at(k)].length, segments_[i].length);
            if (2 * count > total && ratio > 0.5 && count * ratio > most) {
                most = count * ratio;
                best = k;
            }
        }
        return best;
    }

    std::pair<Index, Index> patches_beside(std::size_t i) const {
        return {std::min(left(i), right(i)), std::max(left(i), right(i))};
    }

    // Of the segments between the same two patches.
    bool is_longest_between(std::size_t i) const {
        const std::pair<Index, Index> sides = patches_beside(i);
        if (sides.first == sides.second)
            return false;
        for (std::size_t k = 0; k < segments_.size(); ++k)
            if (patches_beside(k) == sides && !segments_[k].is_hard &&
                (segments_[k].length > segments_[i].length ||
                 (segments_[k].length == segments_[i].length && k < i)))
                return false;
        return true;
    }

    std::vector<Removal> next_round() {
        std::vector<std::pair<double, std::size_t>> queue;
        for (std::size_t i = 0; i < segments_.size(); ++i)
            if (!segments_[i].is_hard && failed_.count(key_of(s_.mesh, segments_[i])) == 0 &&
                may_go(i))
                queue.emplace_back(-order(i), i);
        std::sort(queue.begin(), queue.end());
        std::vector<std::uint8_t> taken(faces_.size(), 0);
        std::vector<Removal> round;
        std::vector<std::uint8_t> used(segments_.size(), 0);
        for (const auto& [price, i] : queue) {
            if (round.size() >= batch)
                break;
            if (used[i] != 0 || (partner(i) < 0 && !may_go_alone(i)))
                continue;
            Removal removal = removal_of(i);
            bool is_free = true;
            for (const std::size_t k : removal.segments) {
                used[k] = 1;
                for (const Index p : {left(k), right(k)})
                    if (std::find(removal.patches.begin(), removal.patches.end(), p) ==
                        removal.patches.end()) {
                        removal.patches.push_back(p);
                        is_free = is_free && taken[at(p)] == 0;
                    }
            }
            for (const Index p : removal.patches)
                taken[at(p)] = 1;
            if (is_free)
                round.push_back(std::move(removal));
        }
        return round;
    }

    // Seams of small patches do not show.
    bool may_go_alone(std::size_t i) const {
        return segments_[i].length <= unpaired_ || smaller_area(i) <= lone * s_.mesh.total_area;
    }
    double smaller_area(std::size_t i) const {
        return std::min(area_[at(left(i))], area_[at(right(i))]);
    }

    bool may_go(std::size_t i) const {
        switch (mode_) {
        case Mode::whole_segments:
            return is_first_pass_ || s_.mirror.empty() || may_go_alone(i);
        case Mode::joins:
            return smaller_area(i) <= options_.most_area * s_.mesh.total_area &&
                   is_longest_between(i);
        case Mode::darts:
            return !segments_[i].is_loop && left(i) == right(i) && free_end(i) != 0;
        }
        return false;
    }

    // 1 where a segment ends inside a patch, −1 where it starts there, 0 for neither.
    int free_end(std::size_t i) const {
        const std::vector<Index>& line = segments_[i].half_edges;
        if (degree_[at(s_.mesh.target(line.back()))] == 1)
            return 1;
        return degree_[at(s_.mesh.origin(line.front()))] == 1 ? -1 : 0;
    }

    Removal removal_of(std::size_t i) const {
        Removal removal;
        removal.segments = {i};
        removal.reversed = {
            static_cast<std::uint8_t>(mode_ == Mode::darts && free_end(i) < 0 ? 1 : 0)};
        const Index image = partner(i);
        const std::size_t other = image >= 0 ? at(image) : i;
        if (other != i && !segments_[other].is_hard && may_go(other) &&
            (is_first_pass_ || !may_go_alone(i))) {
            removal.segments.push_back(other);
            removal.reversed.push_back(
                static_cast<std::uint8_t>(mode_ == Mode::darts ? (free_end(other) < 0 ? 1 : 0)
                                                               : (is_reversed(i, other) ? 1 : 0)));
        }
        if (mode_ == Mode::whole_segments) {
            removal.windows = {{0.0, 1.0}};
        } else if (mode_ == Mode::darts) {
            removal.windows.assign(std::begin(dart_windows), std::end(dart_windows));
        } else {
            const double size = std::min(area_[at(left(i))], area_[at(right(i))]);
            const double least = options_.least_neck * std::sqrt(size) / segments_[i].length;
            const bool is_own_image =
                image == static_cast<Index>(i) && !s_.mirror.empty() && is_reversed(i, i);
            for (const Window& w : join_windows)
                if ((w.from == 0.0 && w.to == 1.0) ||
                    (w.to - w.from >= least && (!is_own_image || w.from == 1.0 - w.to)))
                    removal.windows.push_back(w);
        }
        return removal;
    }

    // Whether the mirror image of segment i runs against segment k.
    bool is_reversed(std::size_t i, std::size_t k) const {
        const auto image = [&](Index v) {
            const Index m = s_.mirror[at(v)];
            return s_.mesh.points[at(m >= 0 ? m : v)];
        };
        const Vec3 start = image(s_.mesh.origin(segments_[i].half_edges.front()));
        const Vec3 end = image(s_.mesh.target(segments_[i].half_edges.back()));
        const Vec3& first = s_.mesh.points[at(s_.mesh.origin(segments_[k].half_edges.front()))];
        const Vec3& last = s_.mesh.points[at(s_.mesh.target(segments_[k].half_edges.back()))];
        return (start - last).norm() + (end - first).norm() <
               (start - first).norm() + (end - last).norm();
    }

    std::vector<Index> edges_within(const Removal& removal, const Window& window) const {
        std::vector<Index> edges;
        for (std::size_t j = 0; j < removal.segments.size(); ++j) {
            const SeamSegment& segment = segments_[removal.segments[j]];
            const Window w =
                removal.reversed[j] != 0 ? Window{1.0 - window.to, 1.0 - window.from} : window;
            double before = 0.0;
            for (const Index h : segment.half_edges) {
                const double middle = (before + 0.5 * s_.mesh.edge_length(h)) / segment.length;
                if (middle >= w.from && middle <= w.to)
                    edges.push_back(h);
                before += s_.mesh.edge_length(h);
            }
        }
        return edges;
    }

    // The patches that there are with other marks, in place of the removal's.
    std::vector<std::vector<Index>> flood(const Removal& removal, const SeamMarks& marks) const {
        std::vector<Index> open;
        for (const Index p : removal.patches)
            open.insert(open.end(), faces_[at(p)].begin(), faces_[at(p)].end());
        std::sort(open.begin(), open.end());
        return patches_of(s_.mesh, marks, open);
    }

    void try_windows(Removal& removal) const {
        std::vector<Index> tried;
        for (const Window& window : removal.windows) {
            std::vector<Index> edges = edges_within(removal, window);
            if (edges.empty() || edges == tried)
                continue;
            SeamMarks marks = seam_;
            for (const Index h : edges)
                mark(s_.mesh, h, 0, marks);
            const auto parts = flood(removal, marks);
            const bool fits = std::all_of(parts.begin(), parts.end(), [&](const auto& faces) {
                return try_patch(s_.mesh, faces, marks, s_.max_area_change, false, progress_)
                    .accepted;
            });
            if (fits) {
                removal.half_edges = std::move(edges);
                return;
            }
            tried = std::move(edges);
        }
    }

    void test(std::vector<Removal>& round) {
        parallel_for(
            static_cast<int>(round.size()),
            [&](int i) { try_windows(round[static_cast<std::size_t>(i)]); }, progress_);
        trials_ += static_cast<Index>(round.size());
    }

    bool apply(const Removal& removal) {
        for (const Index h : removal.half_edges)
            mark(s_.mesh, h, 0, seam_);
        if (removal.half_edges.empty())
            for (const std::size_t k : removal.segments)
                failed_.insert(key_of(s_.mesh, segments_[k]));
        return !removal.half_edges.empty();
    }

    const SeamSetting& s_;
    const Mode mode_;
    const RemovalOptions& options_;
    SeamMarks& seam_;
    Progress& progress_;
    std::vector<SeamSegment> segments_;
    FaceComponents patches_;
    std::vector<std::vector<Index>> faces_; // of each patch
    std::vector<double> area_;
    std::vector<std::vector<Index>> nearby_; // #V: segments
    std::vector<Index> degree_;              // #V
    std::set<Key> failed_;
    bool is_first_pass_ = true; // later, small patches may be joined without their mirror images
    double unpaired_ = 0.0;     // length of segments that may go without a mirror image
    Index trials_ = 0;
    int rounds_ = 0;
};

} // namespace

Index remove_seams(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress) {
    return Remover(setting, Mode::whole_segments, options, seam, progress).run();
}

Index join_patches(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress) {
    return Remover(setting, Mode::joins, options, seam, progress).run();
}

Index shorten_darts(const SeamSetting& setting, SeamMarks& seam, Progress& progress) {
    const RemovalOptions options;
    return Remover(setting, Mode::darts, options, seam, progress).run();
}

} // namespace devseg
