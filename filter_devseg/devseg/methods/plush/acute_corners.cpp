#include "devseg/methods/plush/acute_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "devseg/methods/plush/seam_paths.h"

namespace devseg::plush {

namespace {

constexpr double reach_share = 0.033;      // of the root of the surface
constexpr double acute = 40.0 / 57.295780; // radians
// Over the reach: how far along both seams a junction may slide.
constexpr std::array<double, 9> slides{0.4, 0.7, 1.0, 1.5, 2.2, 3.2, 4.5, 6.5, 9.0};

// A seam as it leaves one of its ends.
struct Arm {
    std::vector<Index> half_edges; // outwards, up to the next end
    Vec3 direction = Vec3::Zero();
};

class Arms {
public:
    Arms(const Mesh& mesh, const SeamMarks& seam, const SeamMarks& hard, double reach)
        : mesh_(mesh), starting_(mesh.twin.size(), -1) {
        const std::vector<double> no_weight(mesh.twin.size(), 0.0);
        for (const SeamSegment& segment : find_segments(mesh, seam, hard, no_weight)) {
            if (segment.is_loop)
                continue;
            std::vector<Index> back;
            for (auto h = segment.half_edges.rbegin(); h != segment.half_edges.rend(); ++h)
                back.push_back(mesh.twin[*h]);
            add(segment.half_edges, reach);
            add(std::move(back), reach);
        }
    }

    const std::vector<Arm>& all() const { return arms_; }
    /// The arm that begins with a half-edge; −1 = none.
    Index starting_with(HalfEdge h) const { return starting_[h]; }

    /// The next arm around the same vertex, on the left; −1 where the mesh's boundary comes first.
    Index next_on_left(Index arm) const {
        const Index start = arms_[arm].half_edges.front();
        for (HalfEdge h = mesh_.twin[Mesh::previous(start)]; h >= 0 && h != start;
             h = mesh_.twin[Mesh::previous(h)])
            if (starting_[h] >= 0)
                return starting_[h];
        return -1;
    }

private:
    void add(std::vector<Index> half_edges, double reach) {
        // To the point at which the arm is as long as the reach.
        Vec3 end = mesh_.points[mesh_.target(half_edges.back())];
        double left = reach;
        for (const HalfEdge h : half_edges) {
            const double length = mesh_.edge_length(h);
            if (length >= left) {
                end =
                    mesh_.points[mesh_.origin(h)] +
                    left / length * (mesh_.points[mesh_.target(h)] - mesh_.points[mesh_.origin(h)]);
                break;
            }
            left -= length;
        }
        Arm arm;
        arm.direction = (end - mesh_.points[mesh_.origin(half_edges.front())]).normalized();
        starting_[half_edges.front()] = static_cast<Index>(arms_.size());
        arm.half_edges = std::move(half_edges);
        arms_.push_back(std::move(arm));
    }

    const Mesh& mesh_;
    std::vector<Arm> arms_;
    std::vector<Index> starting_; // 3 #F
};

std::vector<AcuteCorner> corners_between(const Arms& arms, double max_angle) {
    std::vector<AcuteCorner> corners;
    for (std::size_t i = 0; i < arms.all().size(); ++i) {
        const Index left = arms.next_on_left(static_cast<Index>(i));
        if (left < 0)
            continue;
        const Arm& first = arms.all()[i];
        const Arm& second = arms.all()[left];
        const double cosine = first.direction.dot(second.direction);
        if (cosine > std::cos(max_angle))
            corners.push_back({first.half_edges.front(), second.half_edges.front(), cosine});
    }
    std::stable_sort(
        corners.begin(), corners.end(),
        [](const AcuteCorner& a, const AcuteCorner& b) { return a.cosine > b.cosine; });
    return corners;
}

class CornerBlunter {
public:
    CornerBlunter(const SeamSetting& setting, SeamMarks& seam, Progress& progress)
        : s_(setting), mesh_(setting.mesh()), graph_(build_vertex_graph(mesh_)),
          reach_(reach_share * std::sqrt(mesh_.total_area)), seam_(seam), progress_(progress) {
        for (const HalfEdge h : mesh_.all_half_edges())
            length_.push_back(mesh_.edge_length(h));
    }

    Index run() {
        std::set<std::pair<Index, Index>> left_alone;
        for (bool found = true; found;) {
            found = false;
            const Arms arms(mesh_, seam_, s_.hard, reach_);
            for (const AcuteCorner& corner : corners_between(arms, acute)) {
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
    using Line = std::vector<Index>; // half-edges

    bool blunt(const Arms& arms, const AcuteCorner& corner) {
        const Line& first = arms.all()[arms.starting_with(corner.first)].half_edges;
        const Line& second = arms.all()[arms.starting_with(corner.second)].half_edges;
        for (const Line* line : {&first, &second})
            if (is_dart(*line) && replace(*line, {}))
                return true;
        for (const double slide : slides) {
            const Line a = start_of(first, slide * reach_);
            const Line b = start_of(second, slide * reach_);
            const Line root = path_between(corner, a, b);
            if (root.empty())
                continue;
            if (replace(a, root) || replace(b, root))
                return true;
        }
        return false;
    }

    bool is_dart(const Line& line) const {
        double length = 0.0;
        for (const HalfEdge h : line)
            length += length_[h];
        return length < slides.back() * reach_ && degree_at(mesh_.target(line.back())) == 1;
    }

    Index degree_at(Vertex v) const {
        Index degree = 0;
        for (Index i = graph_.begin[v]; i < graph_.begin[at(v) + 1]; ++i) {
            const HalfEdge h = graph_.half_edge[i];
            degree += seam_[h] != 0 || mesh_.twin[h] < 0 ? 1 : 0;
        }
        return degree;
    }

    Line start_of(const Line& line, double length) const {
        Line start;
        for (const HalfEdge h : line) {
            start.push_back(h);
            length -= length_[h];
            if (length <= 0.0)
                break;
        }
        return start;
    }

    // Inside the patch, from the end of one seam's start to that of the other, so that it closes
    // off the tip; empty if there is none.
    Line path_between(const AcuteCorner& corner, const Line& a, const Line& b) const {
        const Index start = mesh_.target(a.back());
        const Index end = mesh_.target(b.back());
        const Index tip = mesh_.origin(a.front());
        if (start == end || start == tip || end == tip)
            return {};
        double radius = 0.0;
        for (const Line* line : {&a, &b})
            for (const HalfEdge h : *line)
                radius += length_[h];
        std::vector<std::uint8_t> may_enter(mesh_.points.size(), 0);
        const std::vector<Index> patch = patches_of(mesh_, seam_, {corner.first / 3}).front();
        for (const Face f : patch)
            for (const Vertex v : mesh_.faces[f])
                may_enter[v] = (mesh_.points[v] - mesh_.points[tip]).norm() < radius ? 1 : 0;
        for (const Face f : patch)
            for (const HalfEdge h : half_edges_of(f))
                if (seam_[h] != 0 || mesh_.twin[h] < 0)
                    may_enter[mesh_.origin(h)] = may_enter[mesh_.target(h)] = 0;
        may_enter[start] = may_enter[end] = 1;
        const PathTree tree = shortest_paths(graph_, length_, {start}, progress_, may_enter);
        if (!std::isfinite(tree.distance[end]))
            return {};
        Line path = trace_path(mesh_, tree, end);
        return closes_off(corner, a, b, path) ? path : Line{};
    }

    bool closes_off(const AcuteCorner& corner, const Line& a, const Line& b,
                    const Line& path) const {
        SeamMarks marks = seam_;
        for (const HalfEdge h : path) {
            if (seam_[h] != 0)
                return false;
            mark(mesh_, h, 1, marks);
        }
        Index border = 0;
        const std::vector<Index> closed_off = patches_of(mesh_, marks, {corner.first / 3}).front();
        for (const Face f : closed_off)
            for (const HalfEdge h : half_edges_of(f))
                border += marks[h] != 0 || mesh_.twin[h] < 0 ? 1 : 0;
        return border == static_cast<Index>(a.size() + b.size() + path.size());
    }

    // Opens one line and closes another where that helps and patches stay developable.
    bool replace(const Line& opened, const Line& closed) {
        for (const HalfEdge h : opened)
            if (!s_.hard.empty() && s_.hard[h] != 0)
                return false;
        SeamMarks marks = seam_;
        for (const HalfEdge h : opened)
            mark(mesh_, h, 0, marks);
        for (const HalfEdge h : closed)
            mark(mesh_, h, 1, marks);
        const auto count = [&](const SeamMarks& seam) {
            return corners_between(Arms(mesh_, seam, s_.hard, reach_), acute).size();
        };
        if (count(marks) >= count(seam_))
            return false;
        std::vector<Index> start;
        for (const Line* line : {&opened, &closed})
            for (const HalfEdge h : *line)
                for (const HalfEdge side : {h, mesh_.twin[h]})
                    start.push_back(side / 3);
        ++tried_;
        progress_.check();
        if (!s_.tester.accepts_all(patches_of(mesh_, marks, start), marks, progress_))
            return false;
        seam_ = std::move(marks);
        return true;
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    const VertexGraph graph_;
    const double reach_;
    SeamMarks& seam_;
    Progress& progress_;
    std::vector<double> length_; // 3 #F
    Index tried_ = 0;
};

} // namespace

std::vector<AcuteCorner> find_acute_corners(const Mesh& mesh, const SeamMarks& seam,
                                            const SeamMarks& hard, double reach, double max_angle) {
    return corners_between(Arms(mesh, seam, hard, reach), max_angle);
}

Index blunt_acute_corners(const SeamSetting& setting, SeamMarks& seam, Progress& progress) {
    return CornerBlunter(setting, seam, progress).run();
}

} // namespace devseg::plush
