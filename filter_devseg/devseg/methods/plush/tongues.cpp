#include "devseg/methods/plush/tongues.h"

#include <algorithm>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/graph/shortest_paths.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

struct Tongue {
    std::vector<Index> faces;
    double reach = 0.0; // of its tip from its root
};

// A seam beside a tongue that would go, and the one across its root that would come.
struct Change {
    std::vector<Index> tongue; // faces
    std::vector<Index> opened;
    std::vector<Index> closed;
};

class TongueGiver {
public:
    TongueGiver(const SeamSetting& setting, double width, SeamMarks& seam, Progress& progress)
        : s_(setting), mesh_(setting.mesh()), radius_(0.5 * width), seam_(seam),
          progress_(progress) {}

    Index run() {
        std::vector<Change> changes = find_changes();
        auto tried = static_cast<Index>(changes.size());
        progress_.update(0.1);
        if (apply_together(changes)) {
            changes = find_changes();
            tried += static_cast<Index>(changes.size());
        }
        progress_.update(0.6);
        apply_each(changes);
        return tried;
    }

private:
    // Distances (#F) over faces from the sources, inside patches.
    template <class IsSource>
    std::vector<double> distances_from(IsSource is_source) const {
        graph::ShortestPaths<> paths(mesh_.faces.size());
        for (const Face f : mesh_.all_faces())
            if (is_source(f))
                paths.add_source(f);
        paths.run(
            [&](Face f, double distance) {
                for (const HalfEdge h : half_edges_of(f))
                    if (mesh_.twin[h] >= 0 && seam_[h] == 0) {
                        const Face g = face_of(mesh_.twin[h]);
                        paths.reach(g, distance +
                                           (mesh_.face_centers[f] - mesh_.face_centers[g]).norm());
                    }
            },
            progress_);
        return std::move(paths.distance);
    }

    // What is left of the patches when disks of the radius have rolled over them, in components.
    std::vector<Tongue> find_tongues() const {
        const std::vector<std::uint8_t> on_seam = border_vertices(mesh_, seam_);
        const std::vector<double> to_seam = distances_from([&](Face f) {
            const Triangle& t = mesh_.faces[f];
            return std::any_of(t.begin(), t.end(), [&](Vertex v) { return on_seam[v] != 0; });
        });
        const std::vector<double> to_body =
            distances_from([&](Face f) { return to_seam[f] > radius_; });
        const auto is_thin = [&](Face f) { return to_body[f] > tuning.tongue_slack * radius_; };
        const mesh::FaceComponents parts = mesh::face_components(mesh_, [&](HalfEdge h) {
            return seam_[h] == 0 && is_thin(h / 3) && is_thin(mesh_.twin[h] / 3);
        });
        std::vector<Tongue> tongues(at(parts.count));
        for (const Face f : mesh_.all_faces()) {
            Tongue& tongue = tongues[parts.label[f]];
            tongue.faces.push_back(f);
            tongue.reach = std::max(tongue.reach, to_body[f] - tuning.tongue_slack * radius_);
        }
        // Patches that are thin everywhere have no body.
        tongues.erase(std::remove_if(tongues.begin(), tongues.end(),
                                     [&](const Tongue& tongue) {
                                         return tongue.reach < tuning.tongue_reach * radius_ ||
                                                tongue.reach == infinite;
                                     }),
                      tongues.end());
        std::stable_sort(tongues.begin(), tongues.end(),
                         [](const Tongue& a, const Tongue& b) { return a.reach > b.reach; });
        return tongues;
    }

    std::vector<Change> find_changes() const {
        const mesh::FaceComponents patches = find_patches(mesh_, seam_);
        std::vector<Change> changes;
        for (const Tongue& tongue : find_tongues())
            find_changes(tongue, patches, changes);
        return changes;
    }

    void find_changes(const Tongue& tongue, const mesh::FaceComponents& patches,
                      std::vector<Change>& changes) const {
        const atlas::ChartSurface surface =
            atlas::extract_surface(mesh_, tongue.faces, atlas::enclose(mesh_, tongue.faces, seam_));
        if (!surface.is_disk())
            return;
        // Who lies on the other side: −1 the tongue's own body, −2 nobody.
        const auto beyond = [&](HalfEdge h) -> Index {
            if (mesh_.twin[h] < 0 || is_marked(s_.hard, h))
                return -2;
            return seam_[h] == 0 ? -1 : patches.label[mesh_.twin[h] / 3];
        };
        struct Side {
            Index beyond = 0;
            std::vector<Index> edges;
            double length = 0.0;
        };
        std::vector<Index> loop;
        for (const HalfEdge h : surface.loops.front())
            loop.push_back(surface.mesh_half_edge(h));
        auto first = loop.begin(); // a place where a side begins
        while (first != loop.end() &&
               beyond(*first) == beyond(first == loop.begin() ? loop.back() : *std::prev(first)))
            ++first;
        if (first == loop.end())
            return;
        std::rotate(loop.begin(), first, loop.end());
        std::vector<Side> sides;
        for (const HalfEdge h : loop) {
            if (sides.empty() || sides.back().beyond != beyond(h))
                sides.push_back({beyond(h), {}, 0.0});
            sides.back().edges.push_back(h);
            sides.back().length += mesh_.edge_length(h);
        }
        std::stable_sort(sides.begin(), sides.end(),
                         [](const Side& a, const Side& b) { return a.length > b.length; });
        const auto is_root = [](const Side& side) { return side.beyond == -1; };
        if (std::count_if(sides.begin(), sides.end(), is_root) != 1)
            return;
        const Side& root = *std::find_if(sides.begin(), sides.end(), is_root);
        const auto longest = std::find_if(sides.begin(), sides.end(),
                                          [](const Side& side) { return side.beyond >= 0; });
        if (longest != sides.end() && longest->length > root.length)
            changes.push_back({tongue.faces, longest->edges, root.edges});
    }

    void apply_to(const Change& change, SeamMarks& marks) const {
        mark(mesh_, change.closed, 1, marks);
        mark(mesh_, change.opened, 0, marks);
    }

    // The patches of both sides, with other marks.
    std::vector<std::vector<Index>> patches_beside(const Change& change,
                                                   const SeamMarks& marks) const {
        std::vector<Index> start = change.tongue;
        for (const HalfEdge h : change.closed)
            start.push_back(mesh_.twin[h] / 3);
        return patches_of(mesh_, marks, start);
    }

    // All at once; those beside patches that are not accepted are left out.
    bool apply_together(const std::vector<Change>& changes) {
        std::vector<const Change*> group;
        std::vector<std::uint8_t> is_used(mesh_.twin.size(), 0);
        for (const Change& change : changes) {
            bool is_free = true;
            for (const auto* edges : {&change.opened, &change.closed})
                for (const HalfEdge h : *edges)
                    is_free = is_free && is_used[h] == 0;
            if (!is_free)
                continue;
            for (const auto* edges : {&change.opened, &change.closed})
                mark(mesh_, *edges, 1, is_used);
            group.push_back(&change);
        }
        while (!group.empty()) {
            SeamMarks marks = seam_;
            std::vector<Index> start;
            for (const Change* change : group)
                apply_to(*change, marks);
            for (const Change* change : group)
                for (const HalfEdge h : change->closed) {
                    start.push_back(h / 3);
                    start.push_back(mesh_.twin[h] / 3);
                }
            const std::vector<std::vector<Index>> patches = patches_of(mesh_, marks, start);
            std::vector<std::uint8_t> fails(mesh_.faces.size(), 0);
            parallel_for(
                static_cast<int>(patches.size()),
                [&](int i) {
                    const auto& patch = patches[static_cast<std::size_t>(i)];
                    if (!s_.tester.accepts(patch, marks, progress_))
                        for (const Face f : patch)
                            fails[f] = 1;
                },
                progress_);
            const auto kept = std::remove_if(group.begin(), group.end(), [&](const Change* change) {
                const HalfEdge h = change->closed.front();
                return fails[h / 3] != 0 || fails[mesh_.twin[h] / 3] != 0;
            });
            if (kept == group.end()) {
                seam_ = std::move(marks);
                return true;
            }
            group.erase(kept, group.end());
        }
        return false;
    }

    // Each by itself, of each patch one.
    void apply_each(const std::vector<Change>& changes) {
        std::vector<std::uint8_t> is_accepted(changes.size(), 0);
        std::vector<std::vector<std::vector<Index>>> patches(changes.size());
        parallel_for(
            static_cast<int>(changes.size()),
            [&](int i) {
                const auto k = static_cast<std::size_t>(i);
                SeamMarks marks = seam_;
                apply_to(changes[k], marks);
                patches[k] = patches_beside(changes[k], marks);
                is_accepted[k] = s_.tester.accepts_all(patches[k], marks, progress_) ? 1 : 0;
            },
            progress_);
        std::vector<std::uint8_t> is_changed(mesh_.faces.size(), 0);
        for (std::size_t k = 0; k < changes.size(); ++k) {
            bool is_free = is_accepted[k] != 0;
            for (const auto& patch : patches[k])
                for (const Face f : patch)
                    is_free = is_free && is_changed[f] == 0;
            if (!is_free)
                continue;
            apply_to(changes[k], seam_);
            for (const auto& patch : patches[k])
                for (const Face f : patch)
                    is_changed[f] = 1;
        }
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    const double radius_;
    SeamMarks& seam_;
    Progress& progress_;
};

} // namespace

Index give_tongues_away(const SeamSetting& setting, double width, SeamMarks& seam,
                        Progress& progress) {
    return TongueGiver(setting, width, seam, progress).run();
}

} // namespace devseg::plush
