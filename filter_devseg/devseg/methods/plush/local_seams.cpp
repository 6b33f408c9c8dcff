#include "devseg/methods/plush/local_seams.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "devseg/atlas/disks.h"
#include "devseg/base/parallel.h"
#include "devseg/methods/plush/patch_trial.h"

namespace devseg::plush {

namespace {

constexpr double least_part =
    0.12;                          // of the patch's area: smaller parts are not cut off by isolines
constexpr int patient_rounds = 15; // after them, what is left is cut in halves
constexpr int most_rounds = 60;
constexpr int smoothing_rounds = 4; // of isolines

struct Split {
    bool is_needed = false;
    std::vector<Index> cuts; // half-edges
};

class Splitter {
public:
    Splitter(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& weight,
             const PatchLimits& limits, const SeamMarks& seam)
        : mesh_(mesh), graph_(graph), weight_(weight), limits_(limits), seam_(seam) {}

    Split split(const std::vector<Index>& faces, bool in_halves, const Progress& progress) const {
        const PatchTrial trial = try_patch(mesh_, faces, seam_, limits_, true, progress);
        Split split;
        if (trial.accepted)
            return split;
        split.is_needed = true;
        if (!trial.is_disk) {
            SeamMarks marks = seam_;
            atlas::cut_to_disk(mesh_, atlas::extract_surface(mesh_, faces, marks), marks, progress);
            for (const Face f : faces)
                for (const HalfEdge h : half_edges_of(f))
                    if (marks[h] != seam_[h])
                        split.cuts.push_back(h);
            return split;
        }
        const bool has_map = !trial.face.empty();
        if (!in_halves && has_map)
            split.cuts = isoline(trial);
        if (!in_halves && has_map && split.cuts.empty())
            split.cuts = path_through(trial, progress);
        if (split.cuts.empty())
            split.cuts = halves(faces);
        return split;
    }

private:
    double median(std::vector<double> values) const {
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    }

    // The half-edges around the faces that are nearer to the worst change than to the usual one and
    // hang together with the worst face.
    std::vector<Index> isoline(const PatchTrial& trial) const {
        if (trial.face.size() < 8)
            return {};
        const double usual = median(trial.change);
        std::size_t worst = 0;
        for (std::size_t i = 0; i < trial.change.size(); ++i)
            if (std::abs(trial.change[i] - usual) > std::abs(trial.change[worst] - usual))
                worst = i;
        std::vector<double> change(mesh_.faces.size(), 0.0);
        std::vector<std::uint8_t> state(mesh_.faces.size(), 0); // 1: of the patch, 2: cut off
        double area = 0.0;
        for (std::size_t i = 0; i < trial.face.size(); ++i) {
            state[trial.face[i]] = 1;
            change[trial.face[i]] = (trial.change[i] - usual) / (trial.change[worst] - usual);
            area += mesh_.face_areas[trial.face[i]];
        }
        std::vector<Index> part{trial.face[worst]};
        state[part.front()] = 2;
        double part_area = 0.0;
        for (std::size_t k = 0; k < part.size(); ++k) {
            part_area += mesh_.face_areas[part[k]];
            for (const HalfEdge h : half_edges_of(part[k])) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin >= 0 && seam_[h] == 0 && state[twin / 3] == 1 && change[twin / 3] > 0.5) {
                    state[twin / 3] = 2;
                    part.push_back(twin / 3);
                }
            }
        }
        if (part_area < least_part * area || part_area > (1.0 - least_part) * area)
            return {};
        smooth(trial.face, state);
        std::vector<Index> cuts;
        for (const Face f : trial.face)
            for (HalfEdge h = 3 * f; h < 3 * f + 3 && state[f] == 2; ++h)
                if (mesh_.twin[h] >= 0 && seam_[h] == 0 && state[mesh_.twin[h] / 3] == 1)
                    cuts.push_back(h);
        return cuts;
    }

    // Faces take the side (1 or 2) of most of their neighbours, a few times.
    void smooth(const std::vector<Index>& faces, std::vector<std::uint8_t>& state) const {
        for (int round = 0; round < smoothing_rounds; ++round)
            for (const Face f : faces) {
                int same = 0;
                int other = 0;
                for (const HalfEdge h : half_edges_of(f))
                    if (mesh_.twin[h] >= 0 && seam_[h] == 0)
                        ++(state[mesh_.twin[h] / 3] == state[f] ? same : other);
                if (other > same)
                    state[f] = state[f] == 1 ? 2 : 1;
            }
    }

    // From the worst spot to the nearest place on the border, and to the nearest on its far side.
    std::vector<Index> path_through(const PatchTrial& trial, const Progress& progress) const {
        const atlas::ChartSurface surface = atlas::extract_surface(mesh_, trial.face, seam_);
        std::vector<std::uint8_t> may_enter(mesh_.points.size(), 0);
        for (const Vertex v : surface.vertex)
            may_enter[v] = 1;
        std::vector<std::uint8_t> on_border(mesh_.points.size(), 0);
        for (const HalfEdge h : surface.loops.front())
            on_border[surface.vertex[surface.origin(h)]] = 1;
        const Index tip = worst_inner_vertex(trial, on_border);
        if (tip < 0)
            return {};
        const PathTree tree =
            shortest_paths(graph_, weight_, {tip}, progress, may_enter, on_border);
        const std::vector<Index>& loop = surface.loops.front();
        const auto vertex = [&](std::size_t i) { return surface.vertex[surface.origin(loop[i])]; };
        const auto usable = [&](std::size_t i) {
            return inside(tree.half_edge[vertex(i)], trial) &&
                   std::isfinite(tree.distance[vertex(i)]);
        };
        std::size_t near = loop.size();
        for (std::size_t i = 0; i < loop.size(); ++i)
            if (usable(i) &&
                (near == loop.size() || tree.distance[vertex(i)] < tree.distance[vertex(near)]))
                near = i;
        if (near == loop.size())
            return {};
        std::size_t far = loop.size();
        for (std::size_t k = loop.size() / 4; k <= loop.size() - loop.size() / 4; ++k) {
            const std::size_t i = (near + k) % loop.size();
            if (usable(i) && vertex(i) != vertex(near) &&
                (far == loop.size() || tree.distance[vertex(i)] < tree.distance[vertex(far)]))
                far = i;
        }
        std::vector<Index> cuts = trace_path(mesh_, tree, vertex(near));
        if (far < loop.size())
            for (const HalfEdge h : trace_path(mesh_, tree, vertex(far)))
                cuts.push_back(h);
        cuts.erase(
            std::remove_if(cuts.begin(), cuts.end(), [&](HalfEdge h) { return seam_[h] != 0; }),
            cuts.end());
        return cuts;
    }

    bool inside(HalfEdge h, const PatchTrial& trial) const {
        if (h < 0)
            return false;
        return std::binary_search(trial.face.begin(), trial.face.end(), h / 3) ||
               (mesh_.twin[h] >= 0 &&
                std::binary_search(trial.face.begin(), trial.face.end(), mesh_.twin[h] / 3));
    }

    Index worst_inner_vertex(const PatchTrial& trial,
                             const std::vector<std::uint8_t>& on_border) const {
        const double usual = median(trial.change);
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t i = 0; i < trial.face.size(); ++i)
            order.emplace_back(-std::abs(trial.change[i] - usual), i);
        std::sort(order.begin(), order.end());
        for (const auto& [change, i] : order)
            for (const Vertex v : mesh_.faces[trial.face[i]])
                if (on_border[v] == 0)
                    return v;
        return -1;
    }

    // The border of the half of the faces that is nearest to the first one, counted in faces.
    std::vector<Index> halves(const std::vector<Index>& faces) const {
        std::vector<std::uint8_t> state(mesh_.faces.size(), 0);
        std::vector<Index> reached{faces.front()};
        state[faces.front()] = 1;
        for (std::size_t k = 0; k < reached.size() && 2 * reached.size() < faces.size(); ++k)
            for (const HalfEdge h : half_edges_of(reached[k])) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin >= 0 && seam_[h] == 0 && state[twin / 3] == 0 &&
                    2 * reached.size() < faces.size()) {
                    state[twin / 3] = 1;
                    reached.push_back(twin / 3);
                }
            }
        std::vector<Index> cuts;
        for (const Face f : reached)
            for (const HalfEdge h : half_edges_of(f))
                if (mesh_.twin[h] >= 0 && seam_[h] == 0 && state[mesh_.twin[h] / 3] == 0)
                    cuts.push_back(h);
        return cuts;
    }

    const Mesh& mesh_;
    const VertexGraph& graph_;
    const std::vector<double>& weight_;
    const PatchLimits limits_;
    const SeamMarks& seam_;
};

// The patches that are not settled yet, one of each two mirror images.
std::vector<std::vector<Index>> open_patches(const WorkingSurface& surface, const SeamMarks& seam,
                                             const std::vector<std::uint8_t>& settled) {
    const mesh::FaceComponents patches = find_patches(surface.mesh, seam);
    std::vector<std::vector<Index>> faces(at(patches.count));
    for (const Face f : surface.mesh.all_faces()) {
        const Index own = patches.label[f];
        if (settled[f] == 0 &&
            (!surface.is_symmetric() || own <= patches.label[surface.face_image(f)]))
            faces[own].push_back(f);
    }
    faces.erase(std::remove_if(faces.begin(), faces.end(),
                               [](const std::vector<Index>& f) { return f.empty(); }),
                faces.end());
    return faces;
}

} // namespace

LocalSeams add_local_seams(const WorkingSurface& surface, const VertexGraph& graph,
                           const std::vector<double>& weight, const PatchLimits& limits,
                           std::vector<std::uint8_t> settled, SeamMarks& seam, Progress& progress) {
    const Mesh& mesh = surface.mesh;
    LocalSeams result;
    settled.resize(mesh.faces.size(), 0);
    for (int round = 0; round < most_rounds; ++round) {
        const std::vector<std::vector<Index>> faces = open_patches(surface, seam, settled);
        if (faces.empty())
            return result;
        const Splitter splitter(mesh, graph, weight, limits, seam);
        std::vector<Split> splits(faces.size());
        parallel_for(
            static_cast<int>(faces.size()),
            [&](int i) {
                const auto k = static_cast<std::size_t>(i);
                splits[k] = splitter.split(faces[k], round >= patient_rounds, progress);
            },
            progress);
        for (std::size_t i = 0; i < splits.size(); ++i) {
            result.splits += splits[i].is_needed ? 1 : 0;
            if (!splits[i].is_needed || splits[i].cuts.empty())
                for (const Face f : faces[i]) {
                    settled[f] = 1;
                    if (surface.is_symmetric())
                        settled[surface.face_image(f)] = 1;
                }
            result.all_developable =
                result.all_developable && !(splits[i].is_needed && splits[i].cuts.empty());
            for (const HalfEdge h : splits[i].cuts) {
                mark(mesh, h, 1, seam);
                if (surface.is_symmetric())
                    mark(mesh, surface.image[h], 1, seam);
            }
        }
    }
    result.all_developable = false;
    return result;
}

} // namespace devseg::plush
