#include "devseg/methods/plush/thin_tips.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

using Line = std::vector<Index>; // half-edges

struct Tongue {
    std::vector<Index> faces;
    double reach = 0.0; // of its tip from its root
};

// The border of a tongue with one patch.
struct Side {
    Index beyond = 0; // the patch; −1 the tongue's own body, −2 nobody
    Line edges;
};

// A seam beside a tongue that would go, and the one across its root that would come.
struct Change {
    Line opened;
    Line closed;

    // Of its mirror image, too.
    void apply(const WorkingSurface& surface, SeamMarks& marks) const {
        mark_both(surface, closed, 1, marks);
        mark_both(surface, opened, 0, marks);
    }
};

// Distances (#F) over faces from the sources, inside patches.
template <class IsSource>
std::vector<double> distances_from(const Mesh& mesh, const SeamMarks& seam, IsSource is_source,
                                   const Progress& progress) {
    graph::ShortestPaths<> paths(mesh.faces.size());
    for (const Face f : mesh.all_faces())
        if (is_source(f))
            paths.add_source(f);
    paths.run(
        [&](Face f, double distance) {
            for (const HalfEdge h : half_edges_of(f))
                if (!is_border(mesh, seam, h)) {
                    const Face g = face_of(mesh.twin[h]);
                    paths.reach(g, distance + (mesh.face_centers[f] - mesh.face_centers[g]).norm());
                }
        },
        progress);
    return std::move(paths.distance);
}

// What is left of the patches when disks of the radius have rolled over them, in components.
std::vector<Tongue> find_tongues(const Mesh& mesh, const SeamMarks& seam, double radius,
                                 const Progress& progress) {
    const std::vector<std::uint8_t> on_seam = border_vertices(mesh, seam);
    const std::vector<double> to_seam = distances_from(
        mesh, seam,
        [&](Face f) {
            const Triangle& t = mesh.faces[f];
            return std::any_of(t.begin(), t.end(), [&](Vertex v) { return on_seam[v] != 0; });
        },
        progress);
    const std::vector<double> to_body = distances_from(
        mesh, seam, [&](Face f) { return to_seam[f] > radius; }, progress);
    const double body = tuning.tongue_slack * radius;
    const mesh::FaceComponents parts = mesh::face_components(mesh, [&](HalfEdge h) {
        return seam[h] == 0 && to_body[face_of(h)] > body && to_body[face_of(mesh.twin[h])] > body;
    });
    std::vector<Tongue> tongues(at(parts.count));
    for (const Face f : mesh.all_faces()) {
        Tongue& tongue = tongues[parts.label[f]];
        tongue.faces.push_back(f);
        tongue.reach = std::max(tongue.reach, to_body[f] - body);
    }
    // Patches that are thin everywhere have no body.
    const auto is_none = [&](const Tongue& tongue) {
        return tongue.reach < tuning.tongue_reach * radius || tongue.reach == infinite;
    };
    tongues.erase(std::remove_if(tongues.begin(), tongues.end(), is_none), tongues.end());
    std::stable_sort(tongues.begin(), tongues.end(),
                     [](const Tongue& a, const Tongue& b) { return a.reach > b.reach; });
    return tongues;
}

// The sides of a tongue, the longest first; none where it is no disk, or an island.
std::vector<Side> sides_of(const SeamSetting& setting, const SeamMarks& seam,
                           const std::vector<Index>& label, const Tongue& tongue) {
    const Mesh& mesh = setting.mesh();
    const atlas::ChartSurface surface =
        atlas::extract_surface(mesh, tongue.faces, atlas::enclose(mesh, tongue.faces, seam));
    if (!surface.is_disk())
        return {};
    const auto beyond = [&](HalfEdge h) -> Index {
        if (mesh.twin[h] < 0 || is_marked(setting.hard, h))
            return -2;
        return seam[h] == 0 ? -1 : label[face_of(mesh.twin[h])];
    };
    Line loop;
    for (const HalfEdge h : surface.loops.front())
        loop.push_back(surface.mesh_half_edge(h));
    std::size_t first = 0; // a place where a side begins
    const std::size_t count = loop.size();
    while (first < count && beyond(loop[first]) == beyond(loop[(first + count - 1) % count]))
        ++first;
    std::vector<Side> sides;
    for (std::size_t k = 0; k < count && first < count; ++k) {
        const HalfEdge h = loop[(first + k) % count];
        if (sides.empty() || sides.back().beyond != beyond(h))
            sides.push_back({beyond(h), {}});
        sides.back().edges.push_back(h);
    }
    std::stable_sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
        return length_of(mesh, a.edges) > length_of(mesh, b.edges);
    });
    return sides;
}

std::vector<Change> find_changes(const SeamSetting& setting, double radius, const SeamMarks& seam,
                                 const Progress& progress) {
    const Mesh& mesh = setting.mesh();
    const std::vector<Index> label = find_patches(mesh, seam).label;
    const auto is_root = [](const Side& side) { return side.beyond == -1; };
    const auto is_seam = [](const Side& side) { return side.beyond >= 0; };
    std::vector<Change> changes;
    for (const Tongue& tongue : find_tongues(mesh, seam, radius, progress)) {
        const std::vector<Side> sides = sides_of(setting, seam, label, tongue);
        const auto root = std::find_if(sides.begin(), sides.end(), is_root);
        const auto longest = std::find_if(sides.begin(), sides.end(), is_seam);
        if (std::count_if(sides.begin(), sides.end(), is_root) == 1 && longest != sides.end() &&
            length_of(mesh, longest->edges) > length_of(mesh, root->edges))
            changes.push_back({longest->edges, root->edges});
    }
    return changes;
}

// The changes that share no edge with one before.
std::vector<Change> without_shared_edges(const WorkingSurface& surface,
                                         const std::vector<Change>& changes) {
    const Mesh& mesh = surface.mesh;
    std::vector<Change> group;
    SeamMarks is_used(mesh.twin.size(), 0);
    for (const Change& change : changes) {
        Line edges = change.opened;
        edges.insert(edges.end(), change.closed.begin(), change.closed.end());
        if (any_marked(is_used, edges))
            continue;
        mark_both(surface, edges, 1, is_used);
        group.push_back(change);
    }
    return group;
}

// All at once; those beside patches that are not accepted are left out.
bool apply_together(const SeamSetting& setting, const std::vector<Change>& changes, SeamMarks& seam,
                    Progress& progress) {
    const Mesh& mesh = setting.mesh();
    std::vector<Change> group = without_shared_edges(setting.surface, changes);
    while (!group.empty()) {
        SeamMarks marks = seam;
        std::vector<Line> closed;
        for (const Change& change : group) {
            change.apply(setting.surface, marks);
            closed.push_back(change.closed);
        }
        const std::vector<std::vector<Index>> patches =
            patches_beside(mesh, marks, with_image(setting.surface, closed));
        std::vector<std::uint8_t> fails(mesh.faces.size(), 0);
        parallel_for(
            static_cast<int>(patches.size()),
            [&](int i) {
                const auto& patch = patches[static_cast<std::size_t>(i)];
                if (!setting.tester.accepts(patch, marks, progress))
                    for (const Face f : patch) {
                        fails[f] = 1;
                        if (setting.surface.is_symmetric())
                            fails[setting.surface.face_image(f)] = 1;
                    }
            },
            progress);
        const auto kept = std::remove_if(group.begin(), group.end(), [&](const Change& change) {
            const HalfEdge h = change.closed.front();
            return fails[face_of(h)] != 0 || fails[face_of(mesh.twin[h])] != 0;
        });
        if (kept == group.end()) {
            seam = std::move(marks);
            return true;
        }
        group.erase(kept, group.end());
    }
    return false;
}

// Each by itself, of each patch one.
void apply_each(const SeamSetting& setting, const std::vector<Change>& changes, SeamMarks& seam,
                Progress& progress) {
    const Mesh& mesh = setting.mesh();
    std::vector<std::uint8_t> is_accepted(changes.size(), 0);
    std::vector<std::vector<std::vector<Index>>> patches(changes.size());
    parallel_for(
        static_cast<int>(changes.size()),
        [&](int i) {
            const auto k = static_cast<std::size_t>(i);
            SeamMarks marks = seam;
            changes[k].apply(setting.surface, marks);
            patches[k] =
                patches_beside(mesh, marks, with_image(setting.surface, {changes[k].closed}));
            is_accepted[k] = setting.tester.accepts_all(patches[k], marks, progress) ? 1 : 0;
        },
        progress);
    std::vector<std::uint8_t> is_changed(mesh.faces.size(), 0);
    for (std::size_t k = 0; k < changes.size(); ++k) {
        bool is_free = is_accepted[k] != 0;
        for (const auto& patch : patches[k])
            for (const Face f : patch)
                is_free = is_free && is_changed[f] == 0;
        if (!is_free)
            continue;
        changes[k].apply(setting.surface, seam);
        for (const auto& patch : patches[k])
            for (const Face f : patch)
                is_changed[f] = 1;
    }
}

} // namespace

Index give_tongues_away(const SeamSetting& setting, double width, SeamMarks& seam,
                        Progress& progress) {
    const double radius = 0.5 * width;
    std::vector<Change> changes = find_changes(setting, radius, seam, progress);
    auto tried = static_cast<Index>(changes.size());
    progress.update(0.1);
    if (apply_together(setting, changes, seam, progress)) {
        changes = find_changes(setting, radius, seam, progress);
        tried += static_cast<Index>(changes.size());
    }
    progress.update(0.6);
    apply_each(setting, changes, seam, progress);
    return tried;
}

} // namespace devseg::plush
