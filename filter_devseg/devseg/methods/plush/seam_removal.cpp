#include "devseg/methods/plush/seam_removal.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <mutex>
#include <random>
#include <set>
#include <utility>

#include "devseg/base/parallel.h"

namespace devseg::plush {

namespace {

constexpr std::size_t batch =
    6;                         // trials that run side by side; fixed, for the same result anywhere
constexpr int most_passes = 2; // over all segments

using Key = std::pair<Index, Index>; // lowest half-edge and number of edges of a segment

Key key_of(const Mesh& mesh, const SeamSegment& segment) {
    Index lowest = segment.half_edges.front();
    for (const HalfEdge h : segment.half_edges)
        lowest = std::min<Index>({lowest, h, mesh.twin[h]});
    return {lowest, static_cast<Index>(segment.half_edges.size())};
}

enum class Mode { whole_segments, joins, darts };

// The part of a segment from one share of its length to another.
struct Window {
    double from = 0.0;
    double to = 1.0;
};

// What stays of a seam is an end, or two; the middle goes first. The widest windows come first.
constexpr Window join_windows[] = {
    {0.15, 1.0}, {0.0, 0.85},  {0.15, 0.85}, {0.35, 1.0}, {0.0, 0.65}, {0.25, 0.75}, {0.55, 1.0},
    {0.0, 0.45}, {0.35, 0.65}, {0.7, 1.0},   {0.0, 0.3},  {0.4, 0.6},  {0.2, 0.45},  {0.55, 0.8}};
// A dart keeps its outer end, which comes first.
constexpr Window dart_windows[] = {{0.0, 1.0}, {0.3, 1.0}, {0.55, 1.0}, {0.8, 1.0}};

// A segment that goes with its mirror image, or parts of both, and the patches beside them.
struct Removal {
    std::size_t segment = 0;
    std::size_t image = 0;                   // the same where a segment is its own mirror image
    std::vector<Index> patches;              // that are joined or lose a dart
    std::vector<std::vector<Index>> choices; // half-edges that could go, the best ones first
    std::size_t taken = none;                // the first choice that is accepted

    static constexpr std::size_t none = static_cast<std::size_t>(-1);
};

// One choice of one removal of a round.
struct Choice {
    std::size_t removal = 0;
    std::size_t index = 0;
};

// The first choices of all removals, then the second ones, and so on.
std::vector<Choice> in_turn(const std::vector<Removal>& round) {
    std::vector<Choice> turns;
    bool is_done = false;
    for (std::size_t index = 0; !is_done; ++index) {
        is_done = true;
        for (std::size_t i = 0; i < round.size(); ++i)
            if (index < round[i].choices.size()) {
                turns.push_back({i, index});
                is_done = false;
            }
    }
    return turns;
}

class Remover {
public:
    Remover(const SeamSetting& setting, Mode mode, const RemovalOptions& options, SeamMarks& seam,
            Progress& progress)
        : s_(setting), mesh_(setting.mesh()), mode_(mode), options_(options), seam_(seam),
          progress_(progress) {}

    Index run() {
        refresh();
        const double start = static_cast<double>(segments_.size());
        int rounds = 0;
        for (int pass = 0; pass < most_passes; ++pass) {
            failed_.clear();
            bool changed = false;
            for (; rounds < s_.max_rounds; ++rounds) {
                std::vector<Removal> round = next_round();
                if (round.empty())
                    break;
                try_choices(round);
                bool removed = false;
                for (const Removal& removal : round)
                    removed = apply(removal) || removed;
                if (removed)
                    refresh();
                changed = changed || removed;
                progress_.update(std::min(0.95, 1.0 - static_cast<double>(segments_.size()) /
                                                          std::max(1.0, start)));
            }
            if (!changed)
                break;
        }
        return trials_;
    }

private:
    void refresh() {
        segments_ = find_segments(mesh_, seam_, s_.hard, s_.weight);
        patches_ = find_patches(mesh_, seam_);
        degree_ = seam_degrees(mesh_, seam_);
        faces_.assign(at(patches_.count), {});
        area_.assign(at(patches_.count), 0.0);
        for (const Face f : mesh_.all_faces()) {
            faces_[patches_.label[f]].push_back(f);
            area_[patches_.label[f]] += mesh_.face_areas[f];
        }
        segment_of_.assign(mesh_.twin.size(), 0);
        for (std::size_t i = 0; i < segments_.size(); ++i)
            for (const HalfEdge h : segments_[i].half_edges)
                segment_of_[h] = segment_of_[mesh_.twin[h]] = i;
    }

    std::size_t image_of(std::size_t i) const {
        return s_.surface.is_symmetric()
                   ? segment_of_[s_.surface.image[segments_[i].half_edges.front()]]
                   : i;
    }

    // Whether the segment runs across the plane: its mirror image is itself, the other way round.
    bool is_crossing(std::size_t i) const {
        return s_.surface.is_symmetric() && image_of(i) == i &&
               !s_.surface.is_on_plane(segments_[i].half_edges.front());
    }

    Index left(std::size_t i) const { return patches_.label[segments_[i].half_edges.front() / 3]; }
    Index right(std::size_t i) const {
        return patches_.label[mesh_.twin[segments_[i].half_edges.front()] / 3];
    }

    // A factor near 1 that depends on the seed and on where the segment is; 1 for the seed 0.
    double jitter(const SeamSegment& segment) const {
        if (options_.random_seed == 0)
            return 1.0;
        const auto [lowest, count] = key_of(mesh_, segment);
        std::minstd_rand random(static_cast<std::uint32_t>(options_.random_seed) * 2654435761U +
                                static_cast<std::uint32_t>(lowest));
        random.discard(2);
        return 0.8 + 0.4 * static_cast<double>(random()) / std::minstd_rand::max();
    }

    double order(std::size_t i) const {
        const SeamSegment& segment = segments_[i];
        const double size = std::min(area_[left(i)], area_[right(i)]) / mesh_.total_area;
        if (mode_ == Mode::joins)
            return segment.length * segment.weight / std::max(size, 1e-9);
        return jitter(segment) * std::pow(segment.weight, options_.weight_power) *
               std::pow(size, -options_.size_power);
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
            if (!segments_[i].is_hard && failed_.count(key_of(mesh_, segments_[i])) == 0 &&
                may_go(i))
                queue.emplace_back(-order(i), i);
        std::sort(queue.begin(), queue.end());
        std::vector<std::uint8_t> taken(faces_.size(), 0);
        std::vector<Removal> round;
        std::vector<std::uint8_t> used(segments_.size(), 0);
        for (const auto& [price, i] : queue) {
            if (round.size() >= batch)
                break;
            if (used[i] != 0)
                continue;
            Removal removal = removal_of(i);
            bool is_free = true;
            for (const std::size_t k : {i, removal.image}) {
                used[k] = 1;
                for (const Index p : {left(k), right(k)})
                    if (std::find(removal.patches.begin(), removal.patches.end(), p) ==
                        removal.patches.end()) {
                        removal.patches.push_back(p);
                        is_free = is_free && taken[p] == 0;
                    }
            }
            for (const Index p : removal.patches)
                taken[p] = 1;
            if (is_free) {
                find_choices(removal);
                round.push_back(std::move(removal));
            }
        }
        return round;
    }

    double smaller_area(std::size_t i) const { return std::min(area_[left(i)], area_[right(i)]); }

    // Large patches with many slits would be hard to sew, and seams easily fail on another surface.
    bool is_large_together(std::size_t i) const {
        return left(i) != right(i) &&
               area_[left(i)] + area_[right(i)] > options_.most_together * mesh_.total_area;
    }

    bool may_go(std::size_t i) const {
        switch (mode_) {
        case Mode::whole_segments:
            return true;
        case Mode::joins:
            return smaller_area(i) <= options_.most_area * mesh_.total_area &&
                   is_longest_between(i);
        case Mode::darts:
            return !segments_[i].is_loop && left(i) == right(i) && free_end(i) != 0;
        }
        return false;
    }

    // 1 where a segment ends inside a patch, −1 where it starts there, 0 for neither.
    int free_end(std::size_t i) const {
        const std::vector<Index>& line = segments_[i].half_edges;
        if (degree_[mesh_.target(line.back())] == 1)
            return 1;
        return degree_[mesh_.origin(line.front())] == 1 ? -1 : 0;
    }

    Removal removal_of(std::size_t i) const {
        Removal removal;
        removal.segment = i;
        removal.image = image_of(i);
        return removal;
    }

    // The parts of a segment that could go, in the order in which they are tried.
    std::vector<Window> windows_of(std::size_t i) const {
        std::vector<Window> windows;
        if (mode_ == Mode::darts) {
            for (const Window& w : dart_windows)
                windows.push_back(free_end(i) < 0 ? Window{1.0 - w.to, 1.0 - w.from} : w);
            return windows;
        }
        windows = {{0.0, 1.0}};
        if (mode_ == Mode::whole_segments || is_large_together(i))
            return windows; // nearly flat patches need no darts
        const double least = options_.least_neck * std::sqrt(smaller_area(i)) / segments_[i].length;
        for (const Window& w : join_windows)
            if (w.to - w.from >= least && (!is_crossing(i) || w.from == 1.0 - w.to))
                windows.push_back(w);
        return windows;
    }

    void find_choices(Removal& removal) const {
        for (const Window& window : windows_of(removal.segment)) {
            std::vector<Index> edges = edges_within(removal, window);
            if (!edges.empty() && (removal.choices.empty() || edges != removal.choices.back()))
                removal.choices.push_back(std::move(edges));
        }
    }

    // Of the segment, and their mirror images.
    std::vector<Index> edges_within(const Removal& removal, const Window& window) const {
        std::vector<Index> edges;
        const SeamSegment& segment = segments_[removal.segment];
        double before = 0.0;
        for (const HalfEdge h : segment.half_edges) {
            const double middle = (before + 0.5 * mesh_.edge_length(h)) / segment.length;
            before += mesh_.edge_length(h);
            if (middle < window.from || middle > window.to)
                continue;
            edges.push_back(h);
            if (s_.surface.is_symmetric())
                edges.push_back(s_.surface.image[h]);
        }
        return edges;
    }

    // The patches that there are with other marks, in place of the removal's.
    std::vector<std::vector<Index>> flood(const Removal& removal, const SeamMarks& marks) const {
        std::vector<Index> open;
        for (const Index p : removal.patches)
            open.insert(open.end(), faces_[p].begin(), faces_[p].end());
        std::sort(open.begin(), open.end());
        return patches_of(mesh_, marks, open);
    }

    // Later choices are tried before it is known that they are needed, which changes nothing but
    // the time.
    void try_choices(std::vector<Removal>& round) {
        const std::vector<Choice> turns = in_turn(round);
        std::mutex mutex;
        parallel_for(
            static_cast<int>(turns.size()),
            [&](int i) {
                const Choice& choice = turns[static_cast<std::size_t>(i)];
                Removal& removal = round[choice.removal];
                {
                    const std::lock_guard<std::mutex> lock(mutex);
                    if (removal.taken < choice.index)
                        return;
                }
                if (!works(removal, removal.choices[choice.index]))
                    return;
                const std::lock_guard<std::mutex> lock(mutex);
                removal.taken = std::min(removal.taken, choice.index);
            },
            progress_);
        for (const Removal& removal : round)
            trials_ += static_cast<Index>(removal.taken == Removal::none ? removal.choices.size()
                                                                         : removal.taken + 1);
    }

    bool works(const Removal& removal, const std::vector<Index>& edges) const {
        PatchTester& tester = is_large_together(removal.segment) ? s_.strict_tester : s_.tester;
        SeamMarks marks = seam_;
        for (const HalfEdge h : edges)
            mark(mesh_, h, 0, marks);
        return tester.accepts_all(flood(removal, marks), marks, progress_);
    }

    bool apply(const Removal& removal) {
        if (removal.taken != Removal::none)
            for (const HalfEdge h : removal.choices[removal.taken])
                mark(mesh_, h, 0, seam_);
        else
            for (const std::size_t k : {removal.segment, removal.image})
                failed_.insert(key_of(mesh_, segments_[k]));
        return removal.taken != Removal::none;
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    const Mode mode_;
    const RemovalOptions& options_;
    SeamMarks& seam_;
    Progress& progress_;
    std::vector<SeamSegment> segments_;
    mesh::FaceComponents patches_;
    std::vector<std::vector<Index>> faces_; // of each patch
    std::vector<double> area_;
    std::vector<std::size_t> segment_of_; // 3 #F, of seam edges
    std::vector<Index> degree_;           // #V
    std::set<Key> failed_;
    Index trials_ = 0;
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

} // namespace devseg::plush
