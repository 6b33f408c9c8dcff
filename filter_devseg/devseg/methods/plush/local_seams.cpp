#include "devseg/methods/plush/local_seams.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/base/parallel.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

using Line = std::vector<Index>; // half-edges

struct Split {
    bool is_needed = false;
    Line cuts;
};

// How far each face of a trial is from what is good: its strain, or how far its change is from the
// usual one.
std::vector<double> deviations(const judge::ClothTrial& trial) {
    if (!trial.strains.empty())
        return trial.strains;
    std::vector<double> sorted = trial.change;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    std::vector<double> result;
    for (const double change : trial.change)
        result.push_back(change - *middle);
    return result;
}

// One patch of a surface that is split.
class Splitter {
public:
    Splitter(const Mesh& mesh, const SeamMarks& seam, const std::vector<Index>& faces)
        : mesh_(mesh), seam_(seam), faces_(faces) {}

    // Edges that make it sound: holes that lie flat are opened where nothing else is.
    Line disk_cuts(const Progress& progress) const {
        Line cuts;
        for (const atlas::HoleRule& holes : {atlas::HoleRule::exact(), atlas::HoleRule::none()}) {
            SeamMarks marks = seam_;
            atlas::cut_to_disk(mesh_, atlas::extract_surface(mesh_, faces_, marks), marks, progress,
                               nullptr, holes);
            for (const Face f : faces_)
                for (const HalfEdge h : half_edges_of(f))
                    if (marks[h] != seam_[h])
                        cuts.push_back(h);
            if (!cuts.empty())
                break;
        }
        return cuts;
    }

    // The half-edges around the faces that are nearer to the worst change than to the usual one and
    // hang together with the worst face.
    Line isoline(const judge::ClothTrial& trial) const {
        if (trial.face.size() < 8)
            return {};
        const std::vector<double> deviation = deviations(trial);
        const auto worst = static_cast<std::size_t>(
            std::max_element(deviation.begin(), deviation.end(),
                             [](double a, double b) { return std::abs(a) < std::abs(b); }) -
            deviation.begin());
        std::vector<double> change(mesh_.faces.size(), 0.0);
        std::vector<std::uint8_t> state(mesh_.faces.size(), 0); // 1: of the patch, 2: cut off
        double area = 0.0;
        for (std::size_t i = 0; i < trial.face.size(); ++i) {
            state[trial.face[i]] = 1;
            change[trial.face[i]] = deviation[i] / deviation[worst];
            area += mesh_.face_areas[trial.face[i]];
        }
        std::vector<Index> part{trial.face[worst]};
        state[part.front()] = 2;
        double part_area = 0.0;
        for (std::size_t k = 0; k < part.size(); ++k) {
            part_area += mesh_.face_areas[part[k]];
            for (const Face g : neighbours(part[k]))
                if (state[g] == 1 && change[g] > 0.5) {
                    state[g] = 2;
                    part.push_back(g);
                }
        }
        if (part_area < tuning.least_split * area || part_area > (1.0 - tuning.least_split) * area)
            return {};
        smooth(trial.face, state);
        return border_of(trial.face, state);
    }

    // From the worst spot to the nearest place on the border, and to the nearest on its far side.
    Line path_through(const judge::ClothTrial& trial, const SeamSetting& setting,
                      const Progress& progress) const {
        const atlas::ChartSurface surface = atlas::extract_surface(mesh_, trial.face, seam_);
        const std::vector<Index>& loop = surface.loops.front();
        const auto vertex = [&](std::size_t i) { return surface.vertex[surface.origin(loop[i])]; };
        std::vector<std::uint8_t> may_enter(mesh_.points.size(), 0);
        for (const Vertex v : surface.vertex)
            may_enter[v] = 1;
        std::vector<std::uint8_t> on_border(mesh_.points.size(), 0);
        for (std::size_t i = 0; i < loop.size(); ++i)
            on_border[vertex(i)] = 1;
        const Vertex tip = worst_inner_vertex(trial, on_border);
        if (tip < 0)
            return {};
        const PathTree tree =
            shortest_paths(setting.graph, setting.cut_cost, {tip}, progress, may_enter, on_border);
        const auto usable = [&](Vertex v) {
            return is_inside(tree.half_edge[v], trial) && std::isfinite(tree.distance[v]);
        };
        std::size_t near = loop.size();
        for (std::size_t i = 0; i < loop.size(); ++i)
            if (usable(vertex(i)) &&
                (near == loop.size() || tree.distance[vertex(i)] < tree.distance[vertex(near)]))
                near = i;
        if (near == loop.size())
            return {};
        Line cuts = trace_path(mesh_, tree, vertex(near));
        Vertex far;
        for (std::size_t k = loop.size() / 4; k <= loop.size() - loop.size() / 4; ++k) {
            const Vertex v = vertex((near + k) % loop.size());
            if (usable(v) && v != vertex(near) &&
                (far < 0 || tree.distance[v] < tree.distance[far]))
                far = v;
        }
        if (far >= 0)
            for (const HalfEdge h : trace_path(mesh_, tree, far))
                cuts.push_back(h);
        const auto is_seam = [&](HalfEdge h) { return seam_[h] != 0; };
        cuts.erase(std::remove_if(cuts.begin(), cuts.end(), is_seam), cuts.end());
        return cuts;
    }

    // The border of the half of the faces that is nearest to the first one, counted in faces.
    Line halves() const {
        std::vector<std::uint8_t> state(mesh_.faces.size(), 1);
        std::vector<Index> reached{faces_.front()};
        state[faces_.front()] = 2;
        for (std::size_t k = 0; k < reached.size(); ++k)
            for (const Face g : neighbours(reached[k]))
                if (state[g] == 1 && 2 * reached.size() < faces_.size()) {
                    state[g] = 2;
                    reached.push_back(g);
                }
        return border_of(reached, state);
    }

private:
    // Faces of the patch beside a face.
    std::vector<Index> neighbours(Face f) const {
        std::vector<Index> faces;
        for (const HalfEdge h : half_edges_of(f))
            if (!is_border(mesh_, seam_, h))
                faces.push_back(face_of(mesh_.twin[h]));
        return faces;
    }

    // Between faces with state 2, among the given ones, and those with state 1.
    Line border_of(const std::vector<Index>& faces, const std::vector<std::uint8_t>& state) const {
        Line border;
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f))
                if (state[f] == 2 && !is_border(mesh_, seam_, h) &&
                    state[face_of(mesh_.twin[h])] == 1)
                    border.push_back(h);
        return border;
    }

    // Faces take the side (1 or 2) of most of their neighbours, a few times.
    void smooth(const std::vector<Index>& faces, std::vector<std::uint8_t>& state) const {
        for (int round = 0; round < tuning.isoline_rounds; ++round)
            for (const Face f : faces) {
                int same = 0;
                int other = 0;
                for (const Face g : neighbours(f))
                    ++(state[g] == state[f] ? same : other);
                if (other > same)
                    state[f] = state[f] == 1 ? 2 : 1;
            }
    }

    bool is_inside(HalfEdge h, const judge::ClothTrial& trial) const {
        const auto has = [&](HalfEdge side) {
            return side >= 0 &&
                   std::binary_search(trial.face.begin(), trial.face.end(), face_of(side));
        };
        return h >= 0 && (has(h) || has(mesh_.twin[h]));
    }

    Vertex worst_inner_vertex(const judge::ClothTrial& trial,
                              const std::vector<std::uint8_t>& on_border) const {
        const std::vector<double> deviation = deviations(trial);
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t i = 0; i < deviation.size(); ++i)
            order.emplace_back(-std::abs(deviation[i]), i);
        std::sort(order.begin(), order.end());
        for (const auto& [change, i] : order)
            for (const Vertex v : mesh_.faces[trial.face[i]])
                if (on_border[v] == 0)
                    return v;
        return {};
    }

    const Mesh& mesh_;
    const SeamMarks& seam_;
    const std::vector<Index>& faces_;
};

// The open patches, one of each two mirror images.
std::vector<std::vector<Index>> open_patches(const WorkingSurface& surface, const SeamMarks& seam,
                                             const std::vector<std::uint8_t>& open) {
    const std::vector<Index> label = find_patches(surface.mesh, seam).label;
    std::vector<std::vector<Index>> patches = patches_of(surface.mesh, seam);
    const auto is_left_out = [&](Face f) {
        return open[f] == 0 || (surface.is_symmetric() && label[f] > label[surface.face_image(f)]);
    };
    for (std::vector<Index>& patch : patches)
        patch.erase(std::remove_if(patch.begin(), patch.end(), is_left_out), patch.end());
    patches.erase(std::remove_if(patches.begin(), patches.end(),
                                 [](const std::vector<Index>& patch) { return patch.empty(); }),
                  patches.end());
    return patches;
}

} // namespace

bool add_local_seams(const SeamSetting& setting, std::vector<std::uint8_t> open, SeamMarks& seam,
                     Progress& progress) {
    const WorkingSurface& surface = setting.surface;
    const Mesh& mesh = surface.mesh;
    open.resize(mesh.faces.size(), 1);
    bool all_developable = true;
    for (int round = 0;; ++round) {
        const std::vector<std::vector<Index>> faces = open_patches(surface, seam, open);
        if (faces.empty())
            return all_developable;
        auto splitting = progress.part(0.5 * progress.left());
        std::vector<Split> splits(faces.size());
        const auto split = [&](int i) {
            Split& result = splits[static_cast<std::size_t>(i)];
            const std::vector<Index>& patch = faces[static_cast<std::size_t>(i)];
            const judge::ClothTrial trial =
                judge::try_cloth(mesh, patch, seam, setting.tester.limits(), true, splitting);
            result.is_needed = !trial.accepted;
            const Splitter splitter(mesh, seam, patch);
            if (!trial.is_sound) {
                result.cuts = splitter.disk_cuts(splitting);
                return;
            }
            const bool has_map = !trial.face.empty() && round < tuning.patient_rounds;
            if (result.is_needed && has_map && !setting.tester.limits().by_strain())
                result.cuts = splitter.isoline(trial);
            if (result.is_needed && has_map && result.cuts.empty())
                result.cuts = splitter.path_through(trial, setting, splitting);
            if (result.is_needed && result.cuts.empty())
                result.cuts = splitter.halves();
        };
        parallel_for(static_cast<int>(faces.size()), split, splitting);
        for (std::size_t i = 0; i < splits.size(); ++i) {
            if (splits[i].cuts.empty())
                for (const Face f : faces[i]) {
                    open[f] = 0;
                    if (surface.is_symmetric())
                        open[surface.face_image(f)] = 0;
                }
            all_developable = all_developable && !(splits[i].is_needed && splits[i].cuts.empty());
            mark_both(surface, splits[i].cuts, 1, seam);
        }
    }
}

} // namespace devseg::plush
