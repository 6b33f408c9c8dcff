#include "devseg/methods/plush/thin_tips.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "devseg/methods/plush/mend_patches.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

using Line = std::vector<Index>; // half-edges

// A seam as it leaves one of its ends, up to the next end, and its direction over the reach.
struct Arm {
    Line half_edges;
    Vec3 direction = Vec3::Zero();
};

Arm make_arm(const Mesh& mesh, Line half_edges, double reach) {
    // To the point at which the arm is as long as the reach.
    Vec3 end = mesh.points[mesh.target(half_edges.back())];
    for (const HalfEdge h : half_edges) {
        const double length = mesh.edge_length(h);
        if (length >= reach) {
            const Vec3& start = mesh.points[mesh.origin(h)];
            end = start + reach / length * (mesh.points[mesh.target(h)] - start);
            break;
        }
        reach -= length;
    }
    const Vec3& start = mesh.points[mesh.origin(half_edges.front())];
    return {std::move(half_edges), (end - start).normalized()};
}

struct Arms {
    std::vector<Arm> all;
    std::vector<Index> starting; // 3 #F: the arm that begins with a half-edge; −1 = none

    /// The next arm around the same vertex, on the left; −1 where the mesh's boundary comes first.
    Index next_on_left(const Mesh& mesh, const Arm& arm) const {
        const HalfEdge start = arm.half_edges.front();
        for (HalfEdge h = mesh.twin[Mesh::previous(start)]; h >= 0 && h != start;
             h = mesh.twin[Mesh::previous(h)])
            if (starting[h] >= 0)
                return starting[h];
        return -1;
    }
};

Arms find_arms(const Mesh& mesh, const SeamMarks& seam, const SeamMarks& hard, double reach) {
    Arms arms;
    for (const SeamSegment& segment : find_segments(mesh, seam, hard)) {
        if (segment.is_loop)
            continue;
        Line back;
        for (auto h = segment.half_edges.rbegin(); h != segment.half_edges.rend(); ++h)
            back.push_back(mesh.twin[*h]);
        arms.all.push_back(make_arm(mesh, segment.half_edges, reach));
        arms.all.push_back(make_arm(mesh, std::move(back), reach));
    }
    arms.starting.assign(mesh.twin.size(), -1);
    for (std::size_t i = 0; i < arms.all.size(); ++i)
        arms.starting[arms.all[i].half_edges.front()] = static_cast<Index>(i);
    return arms;
}

std::vector<AcuteCorner> corners_between(const Mesh& mesh, const Arms& arms, double max_angle) {
    std::vector<AcuteCorner> corners;
    for (const Arm& first : arms.all) {
        const Index left = arms.next_on_left(mesh, first);
        if (left < 0)
            continue;
        const Arm& second = arms.all[left];
        const double cosine = first.direction.dot(second.direction);
        if (cosine > std::cos(max_angle))
            corners.push_back({first.half_edges.front(), second.half_edges.front(), cosine});
    }
    std::stable_sort(
        corners.begin(), corners.end(),
        [](const AcuteCorner& a, const AcuteCorner& b) { return a.cosine > b.cosine; });
    return corners;
}

Line start_of(const Mesh& mesh, const Line& line, double length) {
    Line start;
    for (const HalfEdge h : line)
        if (start.empty() || length > 0.0) {
            start.push_back(h);
            length -= mesh.edge_length(h);
        }
    return start;
}

class CornerBlunter {
public:
    CornerBlunter(const SeamSetting& setting, SeamMarks& seam, Progress& progress)
        : s_(setting), mesh_(setting.mesh()),
          reach_(tuning.corner_reach * std::sqrt(mesh_.total_area)), seam_(seam),
          progress_(progress) {}

    Index run() {
        std::set<std::pair<Index, Index>> left_alone;
        for (bool found = true; found;) {
            found = false;
            const Arms arms = find_arms(mesh_, seam_, s_.hard, reach_);
            for (const AcuteCorner& corner : corners_between(mesh_, arms, tuning.acute)) {
                if (!left_alone.insert({corner.first, corner.second}).second)
                    continue;
                found = true;
                if (blunt(arms, corner))
                    break; // others have changed, too
            }
        }
        return tried_;
    }

private:
    bool blunt(const Arms& arms, const AcuteCorner& corner) {
        const Line& first = arms.all[arms.starting[corner.first]].half_edges;
        const Line& second = arms.all[arms.starting[corner.second]].half_edges;
        const std::vector<Index> degree = seam_degrees(mesh_, seam_);
        std::vector<std::pair<Line, Line>> exchanges; // what opens, and what closes
        for (const Line* line : {&first, &second})
            if (length_of(mesh_, *line) < tuning.slides.back() * reach_ &&
                degree[mesh_.target(line->back())] == 1)
                exchanges.emplace_back(*line, Line{});
        for (const double slide : tuning.slides) {
            const Line a = start_of(mesh_, first, slide * reach_);
            const Line b = start_of(mesh_, second, slide * reach_);
            const Line root = path_between(corner, a, b);
            if (!root.empty())
                exchanges.insert(exchanges.end(), {{a, root}, {b, root}});
        }
        // Rather far and without darts than near and with some.
        for (const bool may_mend : {false, s_.tester.limits().by_strain()})
            for (const auto& [opened, closed] : exchanges)
                if (replace(opened, closed, may_mend))
                    return true;
        return false;
    }

    // Inside the patch, from the end of one seam's start to that of the other, so that it closes
    // off the tip; empty if there is none.
    Line path_between(const AcuteCorner& corner, const Line& a, const Line& b) const {
        const Vertex start = mesh_.target(a.back());
        const Vertex end = mesh_.target(b.back());
        const Vertex tip = mesh_.origin(a.front());
        if (start == end || start == tip || end == tip)
            return {};
        Line both = a;
        both.insert(both.end(), b.begin(), b.end());
        const double radius = length_of(mesh_, both);
        std::vector<std::uint8_t> may_enter(mesh_.points.size(), 0);
        const std::vector<Index> patch = tip_patch(corner, seam_);
        for (const Face f : patch)
            for (const Vertex v : mesh_.faces[f])
                may_enter[v] = (mesh_.points[v] - mesh_.points[tip]).norm() < radius ? 1 : 0;
        for (const Face f : patch)
            for (const HalfEdge h : half_edges_of(f))
                if (is_border(mesh_, seam_, h))
                    may_enter[mesh_.origin(h)] = may_enter[mesh_.target(h)] = 0;
        may_enter[start] = may_enter[end] = 1;
        const PathTree tree =
            shortest_paths(s_.graph, edge_lengths(mesh_), {start}, progress_, may_enter);
        if (!std::isfinite(tree.distance[end]))
            return {};
        Line path = trace_path(mesh_, tree, end);
        return closes_off(corner, a, b, path) ? path : Line{};
    }

    std::vector<Index> tip_patch(const AcuteCorner& corner, const SeamMarks& marks) const {
        return patches_of(mesh_, marks, {face_of(corner.first)}).front();
    }

    bool closes_off(const AcuteCorner& corner, const Line& a, const Line& b,
                    const Line& path) const {
        if (any_marked(seam_, path))
            return false;
        SeamMarks marks = seam_;
        mark(mesh_, path, 1, marks);
        std::size_t border = 0;
        for (const Face f : tip_patch(corner, marks))
            for (const HalfEdge h : half_edges_of(f))
                border += is_border(mesh_, marks, h) ? 1 : 0;
        return border == a.size() + b.size() + path.size();
    }

    std::size_t count_corners(const SeamMarks& seam) const {
        return find_acute_corners(mesh_, seam, s_.hard, reach_, tuning.acute).size();
    }

    // Opens one line and closes another where that helps and patches keep their limits, with a few
    // darts if it may.
    bool replace(const Line& opened, const Line& closed, bool may_mend) {
        if (any_marked(s_.hard, opened))
            return false;
        SeamMarks marks = seam_;
        mark_both(s_.surface, opened, 0, marks);
        mark_both(s_.surface, closed, 1, marks);
        const std::size_t before = count_corners(seam_);
        if (count_corners(marks) >= before)
            return false;
        // With its mirror image, a tip may be cut off.
        if (s_.surface.is_symmetric() &&
            find_patches(mesh_, marks).count > find_patches(mesh_, seam_).count)
            return false;
        ++tried_;
        progress_.check();
        const std::vector<Line> lines = with_image(s_.surface, {opened, closed});
        auto patches = patches_beside(mesh_, marks, lines);
        if (may_mend && (!mend(patches, marks) || count_corners(marks) >= before))
            return false;
        if (may_mend)
            patches = patches_beside(mesh_, marks, lines);
        if (!s_.tester.accepts_all(patches, marks, progress_))
            return false;
        seam_ = std::move(marks);
        return true;
    }

    // By darts: no patch may be cut in two.
    bool mend(const std::vector<Line>& patches, SeamMarks& marks) const {
        for (const Line& patch : patches) {
            const auto cuts = mend_patch(mesh_, s_.graph, s_.cut_cost, patch, marks,
                                         s_.tester.limits(), progress_);
            if (!cuts)
                return false;
            mark_both(s_.surface, *cuts, 1, marks);
            if (patches_of(mesh_, marks, patch).size() > 1)
                return false;
        }
        return true;
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    const double reach_;
    SeamMarks& seam_;
    Progress& progress_;
    Index tried_ = 0;
};

} // namespace

std::vector<AcuteCorner> find_acute_corners(const Mesh& mesh, const SeamMarks& seam,
                                            const SeamMarks& hard, double reach, double max_angle) {
    return corners_between(mesh, find_arms(mesh, seam, hard, reach), max_angle);
}

Index blunt_acute_corners(const SeamSetting& setting, SeamMarks& seam, Progress& progress) {
    return CornerBlunter(setting, seam, progress).run();
}

} // namespace devseg::plush
