#include "devseg/edit/given_charts.h"

#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/mesh/angle_defects.h"

namespace devseg::edit {

namespace {

class CutCompletion {
public:
    CutCompletion(const Mesh& mesh, std::vector<std::uint8_t> seam)
        : mesh_(mesh), boundary_(mesh::boundary_vertices(mesh)), paths_(mesh.points.size()) {
        result_.seam = std::move(seam);
        degree_ = atlas::cut_edges_at_vertices(mesh, result_.seam);
        ways_ = make_buckets<HalfEdge>(mesh.vertex_count(), [&](auto put) {
            for (const HalfEdge h : mesh.all_half_edges())
                if (mesh.twin[h] >= 0)
                    put(mesh.origin(h), h);
        });
    }

    CompletedCuts run(const Progress& progress) {
        std::vector<Vertex> ends;
        for (const Vertex v : mesh_.all_vertices())
            if (is_loose(v))
                ends.push_back(v);
        if (ends.empty())
            return std::move(result_);
        name_branches(ends);
        find_sides(progress);
        for (const Vertex v : ends)
            if (is_loose(v))
                lead_on(v, progress);
        return std::move(result_);
    }

private:
    bool is_loose(Vertex v) const { return degree_[v] == 1 && boundary_[v] == 0; }

    // From each loose end to where the cut meets others: all edges of a branch belong to one cut.
    void name_branches(const std::vector<Vertex>& ends) {
        branch_.assign(mesh_.points.size(), -1);
        for (const Vertex end : ends) {
            const Index name = branch_[end] >= 0 ? branch_[end] : Index{end};
            HalfEdge last;
            Vertex v = end;
            while (true) {
                branch_[v] = name;
                HalfEdge step;
                for (const HalfEdge h : ways_[v])
                    if (result_.seam[h] != 0 && (last < 0 || h != mesh_.twin[last]))
                        step = h;
                if (step < 0)
                    break;
                last = step;
                v = mesh_.target(step);
                if (degree_[v] != 2 || boundary_[v] != 0) {
                    if (is_loose(v))
                        branch_[v] = name;
                    break;
                }
            }
        }
    }

    // For each vertex, the branch that it lies beside: the one whose inner vertices, or the middles
    // of whose edges, are nearer than all else that is cut. −1 for others.
    void find_sides(const Progress& progress) {
        beside_.assign(mesh_.points.size(), -1);
        for (const Vertex v : mesh_.all_vertices())
            if (degree_[v] > 0) {
                paths_.add_source(v);
                beside_[v] = is_loose(v) ? -1 : branch_[v];
            }
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const Vertex apex = mesh_.apex(h);
            if (result_.seam[h] == 0 || degree_[apex] > 0)
                continue;
            const Vec3 middle =
                0.5 * (mesh_.points[mesh_.origin(h)] + mesh_.points[mesh_.target(h)]);
            if (paths_.reach(apex, (mesh_.points[apex] - middle).norm()))
                beside_[apex] = branch_of_edge(h);
        }
        paths_.run(
            [&](Vertex v, double distance) {
                for (const HalfEdge h : ways_[v])
                    if (paths_.reach(mesh_.target(h), distance + mesh_.edge_length(h)))
                        beside_[mesh_.target(h)] = beside_[v];
            },
            progress);
        paths_.clear();
    }

    Index branch_of_edge(HalfEdge h) const {
        const Index a = branch_[mesh_.origin(h)];
        return a >= 0 ? a : branch_[mesh_.target(h)];
    }

    bool is_goal(Vertex v, Index branch) const {
        if (degree_[v] > 0 && branch_[v] == branch)
            return is_loose(v);
        return degree_[v] > 0 || boundary_[v] != 0;
    }

    void lead_on(Vertex end, const Progress& progress) {
        const Index branch = branch_[end];
        Vertex goal;
        paths_.clear();
        paths_.add_source(end);
        paths_.run(
            [&](Vertex v, double distance) {
                if (v != end && is_goal(v, branch)) {
                    goal = v;
                    return false;
                }
                for (const HalfEdge h : ways_[v]) {
                    const Vertex to = mesh_.target(h);
                    const bool is_own = degree_[to] > 0 && branch_[to] == branch && !is_loose(to);
                    if (result_.seam[h] == 0 && !is_own && beside_[to] != branch)
                        paths_.reach(
                            to, distance + atlas::crease_factor(mesh_, h) * mesh_.edge_length(h),
                            h);
                }
                return true;
            },
            progress);
        if (goal < 0) {
            ++result_.loose;
            return;
        }
        ++result_.completed;
        for (Vertex v = goal; v != end; v = mesh_.origin(paths_.step[v])) {
            const HalfEdge h = paths_.step[v];
            result_.seam[h] = result_.seam[mesh_.twin[h]] = 1;
            ++degree_[mesh_.origin(h)];
            ++degree_[v];
        }
    }

    const Mesh& mesh_;
    CompletedCuts result_;
    std::vector<std::uint8_t> boundary_; // #V
    std::vector<Index> degree_;          // #V: cut edges
    Buckets<HalfEdge> ways_;             // inner edges that leave each vertex
    std::vector<Index> branch_;          // #V: its loose cut, by a loose end of it; −1 = none
    std::vector<Index> beside_;          // #V: the branch beside which it lies
    graph::ShortestPaths<> paths_;
};

} // namespace

std::vector<std::uint8_t> borders_of(const Mesh& mesh, const std::vector<std::uint8_t>& flags) {
    std::vector<std::uint8_t> marks(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (const Face g = mesh.across(h); g >= 0)
            marks[h] = flags[face_of(h)] != flags[g] ? 1 : 0;
    return marks;
}

CompletedCuts complete_cuts(const Mesh& mesh, std::vector<std::uint8_t> seam,
                            const Progress& progress) {
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] < 0)
            seam[h] = 0;
    return CutCompletion(mesh, std::move(seam)).run(progress);
}

} // namespace devseg::edit
