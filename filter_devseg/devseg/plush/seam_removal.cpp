#include "devseg/plush/seam_removal.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "devseg/parallel.h"
#include "devseg/plush/patch_trial.h"

namespace devseg {

namespace {

constexpr std::size_t batch = 6; // trials that run side by side; fixed, for the same result anywhere
constexpr int most_passes = 4;

using Key = std::pair<Index, Index>; // lowest half-edge and number of edges of a segment

Key key_of(const Mesh& mesh, const SeamSegment& segment) {
    Index lowest = segment.half_edges.front();
    for (const Index h : segment.half_edges)
        lowest = std::min({lowest, h, mesh.twin[at(h)]});
    return {lowest, static_cast<Index>(segment.half_edges.size())};
}

// Segments that go together, and what would become of the patches beside them.
struct Removal {
    std::vector<std::size_t> segments;
    std::vector<Index> patches;            // that are joined or lose a dart
    std::vector<std::vector<Index>> faces; // of the patches that there would be
    double order = 0.0;                    // the largest goes first
    bool accepted = false;
};

class Remover {
public:
    Remover(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
            Progress& progress)
        : s_(setting), options_(options), seam_(seam), progress_(progress) {}

    Index run() {
        refresh();
        const double start = static_cast<double>(segments_.size());
        for (int pass = 0; pass < most_passes; ++pass) {
            failed_.clear();
            bool changed = false;
            while (true) {
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
                progress_.update(std::min(
                    0.95, 1.0 - static_cast<double>(segments_.size()) / std::max(1.0, start)));
            }
            if (!changed)
                break;
        }
        return trials_;
    }

private:
    void refresh() {
        segments_ = find_segments(s_.mesh, seam_, s_.hard, s_.weight);
        patches_ = find_patches(s_.mesh, seam_);
        faces_.assign(at(patches_.count), {});
        area_.assign(at(patches_.count), 0.0);
        for (Index f = 0; f < s_.mesh.face_count(); ++f) {
            faces_[at(patches_.label[at(f)])].push_back(f);
            area_[at(patches_.label[at(f)])] += s_.mesh.face_areas[at(f)];
        }
        segment_of_.assign(s_.mesh.points.size(), -1);
        for (std::size_t i = 0; i < segments_.size(); ++i)
            for (const Index h : segments_[i].half_edges)
                for (const Index v : {s_.mesh.origin(h), s_.mesh.target(h)})
                    if (segment_of_[at(v)] < 0)
                        segment_of_[at(v)] = static_cast<Index>(i);
    }

    Index left(std::size_t i) const {
        return patches_.label[at(segments_[i].half_edges.front() / 3)];
    }
    Index right(std::size_t i) const {
        return patches_.label[at(s_.mesh.twin[at(segments_[i].half_edges.front())] / 3)];
    }

    double order(std::size_t i) const {
        const SeamSegment& segment = segments_[i];
        double defect = 0.0;
        for (const Index h : segment.half_edges)
            defect += s_.defect[at(s_.mesh.target(h))];
        const double size = std::min(area_[at(left(i))], area_[at(right(i))]) / s_.mesh.total_area;
        return segment.weight * std::pow(segment.length, options_.length_power) *
               std::pow(size, -options_.size_power) *
               std::pow(0.05 + defect, -options_.defect_power);
    }

    // The mirror image of a segment: the one on which most of its mirrored vertices lie.
    std::size_t partner(std::size_t i) const {
        if (s_.mirror.empty())
            return i;
        std::vector<std::pair<Index, int>> votes;
        for (const Index h : segments_[i].half_edges) {
            const Index v = s_.mirror[at(s_.mesh.target(h))];
            const Index hit = v >= 0 ? segment_of_[at(v)] : -1;
            if (hit < 0)
                continue;
            const auto vote = std::find_if(votes.begin(), votes.end(),
                                           [&](const auto& entry) { return entry.first == hit; });
            if (vote == votes.end())
                votes.emplace_back(hit, 1);
            else
                ++vote->second;
        }
        const auto best = std::max_element(
            votes.begin(), votes.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
        if (best == votes.end() ||
            2 * best->second < static_cast<int>(segments_[i].half_edges.size()))
            return i;
        const double ratio = segments_[at(best->first)].length / segments_[i].length;
        return ratio > 0.5 && ratio < 2.0 ? at(best->first) : i;
    }

    std::vector<Removal> next_round() {
        std::vector<std::pair<double, std::size_t>> queue;
        for (std::size_t i = 0; i < segments_.size(); ++i)
            if (!segments_[i].is_hard && failed_.count(key_of(s_.mesh, segments_[i])) == 0)
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
            Removal removal;
            removal.segments = {i};
            const std::size_t other = partner(i);
            if (other != i && !segments_[other].is_hard)
                removal.segments.push_back(other);
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

    // The patches that there are without the removal's segments.
    void flood(Removal& removal, const SeamMarks& marks) const {
        std::vector<Index> open;
        for (const Index p : removal.patches)
            open.insert(open.end(), faces_[at(p)].begin(), faces_[at(p)].end());
        std::sort(open.begin(), open.end());
        std::vector<std::uint8_t> seen(s_.mesh.faces.size(), 0);
        for (const Index start : open) {
            if (seen[at(start)] != 0)
                continue;
            std::vector<Index> part{start};
            seen[at(start)] = 1;
            for (std::size_t k = 0; k < part.size(); ++k)
                for (Index h = 3 * part[k]; h < 3 * part[k] + 3; ++h) {
                    const Index twin = s_.mesh.twin[at(h)];
                    if (twin >= 0 && marks[at(h)] == 0 && seen[at(twin / 3)] == 0) {
                        seen[at(twin / 3)] = 1;
                        part.push_back(twin / 3);
                    }
                }
            std::sort(part.begin(), part.end());
            removal.faces.push_back(std::move(part));
        }
    }

    void test(std::vector<Removal>& round) {
        parallel_for(
            static_cast<int>(round.size()),
            [&](int i) {
                Removal& removal = round[static_cast<std::size_t>(i)];
                SeamMarks marks = seam_;
                for (const std::size_t k : removal.segments)
                    for (const Index h : segments_[k].half_edges)
                        mark(s_.mesh, h, 0, marks);
                flood(removal, marks);
                removal.accepted = true;
                for (const auto& faces : removal.faces)
                    removal.accepted =
                        removal.accepted &&
                        try_patch(s_.mesh, faces, marks, options_.max_area_change, false, progress_)
                            .accepted;
            },
            progress_);
        trials_ += static_cast<Index>(round.size());
    }

    bool apply(const Removal& removal) {
        for (const std::size_t k : removal.segments) {
            if (!removal.accepted)
                failed_.insert(key_of(s_.mesh, segments_[k]));
            else
                for (const Index h : segments_[k].half_edges)
                    mark(s_.mesh, h, 0, seam_);
        }
        return removal.accepted;
    }

    const SeamSetting& s_;
    const RemovalOptions& options_;
    SeamMarks& seam_;
    Progress& progress_;
    std::vector<SeamSegment> segments_;
    FaceComponents patches_;
    std::vector<std::vector<Index>> faces_; // of each patch
    std::vector<double> area_;
    std::vector<Index> segment_of_; // #V
    std::set<Key> failed_;
    Index trials_ = 0;
};

} // namespace

Index remove_seams(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress) {
    return Remover(setting, options, seam, progress).run();
}

} // namespace devseg
