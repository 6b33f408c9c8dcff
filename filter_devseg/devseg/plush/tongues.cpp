#include "devseg/plush/tongues.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "devseg/parallel.h"

namespace devseg {

namespace {

constexpr int most_rounds = 4;
constexpr double slack = 1.3;         // paths over faces are longer than straight lines
constexpr double least_reach = 0.8;   // of half the width: how far a tongue sticks out at least
constexpr std::size_t most_sides = 3; // of a tongue: seams that are tried

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Tongue {
    std::vector<Index> faces;
    double reach = 0.0; // of its tip from its root
};

// A seam beside a tongue that would go, and the one across its root that would come.
struct Change {
    std::vector<Index> opened;
    std::vector<Index> closed;
    std::vector<std::vector<Index>> patches; // afterwards
    SeamMarks marks;                         // afterwards
    bool is_accepted = false;
};

class TongueGiver {
public:
    TongueGiver(const SeamSetting& setting, double width, SeamMarks& seam, Progress& progress)
        : s_(setting), mesh_(setting.mesh()), radius_(0.5 * width), seam_(seam),
          progress_(progress) {}

    Index run() {
        Index tried = 0;
        for (int round = 0; round < most_rounds; ++round) {
            std::vector<Change> changes;
            for (const Tongue& tongue : find_tongues())
                find_changes(tongue, changes);
            tried += static_cast<Index>(changes.size());
            parallel_for(
                static_cast<int>(changes.size()),
                [&](int i) {
                    Change& change = changes[static_cast<std::size_t>(i)];
                    change.is_accepted =
                        s_.tester.accepts_all(change.patches, change.marks, progress_);
                },
                progress_);
            if (!apply(changes))
                break;
            progress_.update(static_cast<double>(round + 1) / most_rounds);
        }
        return tried;
    }

private:
    // Distances over faces from those where the distance is 0, inside patches.
    void spread(std::vector<double>& distance) const {
        using Entry = std::pair<double, Index>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        for (Index f = 0; f < mesh_.face_count(); ++f)
            if (distance[at(f)] == 0.0)
                queue.emplace(0.0, f);
        while (!queue.empty()) {
            const auto [d, f] = queue.top();
            queue.pop();
            if (d > distance[at(f)])
                continue;
            for (Index h = 3 * f; h < 3 * f + 3; ++h) {
                const Index twin = mesh_.twin[at(h)];
                if (twin < 0 || seam_[at(h)] != 0)
                    continue;
                const Index g = twin / 3;
                const double next =
                    d + (mesh_.face_centers[at(f)] - mesh_.face_centers[at(g)]).norm();
                if (next < distance[at(g)]) {
                    distance[at(g)] = next;
                    queue.emplace(next, g);
                }
            }
        }
    }

    // What is left of the patches when disks of the radius have rolled over them, in components.
    std::vector<Tongue> find_tongues() const {
        std::vector<std::uint8_t> on_seam(mesh_.points.size(), 0);
        for (Index h = 0; h < mesh_.half_edge_count(); ++h)
            if (seam_[at(h)] != 0 || mesh_.twin[at(h)] < 0)
                on_seam[at(mesh_.origin(h))] = on_seam[at(mesh_.target(h))] = 1;
        std::vector<double> to_seam(mesh_.faces.size(), infinite);
        for (Index f = 0; f < mesh_.face_count(); ++f)
            for (const Index v : mesh_.faces[at(f)])
                if (on_seam[at(v)] != 0)
                    to_seam[at(f)] = 0.0;
        spread(to_seam);
        std::vector<double> to_body(mesh_.faces.size(), infinite);
        for (std::size_t f = 0; f < to_body.size(); ++f)
            if (to_seam[f] > radius_)
                to_body[f] = 0.0;
        spread(to_body);
        const auto is_thin = [&](Index f) { return to_body[at(f)] > slack * radius_; };
        const FaceComponents parts = face_components(mesh_, [&](Index h) {
            return seam_[at(h)] == 0 && is_thin(h / 3) && is_thin(mesh_.twin[at(h)] / 3);
        });
        std::vector<Tongue> tongues(at(parts.count));
        for (Index f = 0; f < mesh_.face_count(); ++f) {
            Tongue& tongue = tongues[at(parts.label[at(f)])];
            tongue.faces.push_back(f);
            tongue.reach = std::max(tongue.reach, to_body[at(f)] - slack * radius_);
        }
        // Patches that are thin everywhere have no body.
        tongues.erase(std::remove_if(tongues.begin(), tongues.end(),
                                     [&](const Tongue& tongue) {
                                         return tongue.reach < least_reach * radius_ ||
                                                tongue.reach == infinite;
                                     }),
                      tongues.end());
        std::stable_sort(tongues.begin(), tongues.end(),
                         [](const Tongue& a, const Tongue& b) { return a.reach > b.reach; });
        return tongues;
    }

    void find_changes(const Tongue& tongue, std::vector<Change>& changes) const {
        const ChartSurface surface =
            extract_surface(mesh_, tongue.faces, enclose(mesh_, tongue.faces, seam_));
        if (!surface.is_disk())
            return;
        const FaceComponents patches = find_patches(mesh_, seam_);
        // Who lies on the other side: −1 the tongue's own body, −2 nobody.
        const auto beyond = [&](Index h) -> Index {
            if (mesh_.twin[at(h)] < 0 || (!s_.hard.empty() && s_.hard[at(h)] != 0))
                return -2;
            return seam_[at(h)] == 0 ? -1 : patches.label[at(mesh_.twin[at(h)] / 3)];
        };
        struct Side {
            Index beyond = 0;
            std::vector<Index> edges;
            double length = 0.0;
        };
        std::vector<Index> loop;
        for (const Index h : surface.loops.front())
            loop.push_back(surface.mesh_half_edge(h));
        auto first = loop.begin(); // a place where a side begins
        while (first != loop.end() &&
               beyond(*first) == beyond(first == loop.begin() ? loop.back() : *std::prev(first)))
            ++first;
        if (first == loop.end())
            return;
        std::rotate(loop.begin(), first, loop.end());
        std::vector<Side> sides;
        for (const Index h : loop) {
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
        std::size_t tried = 0;
        for (const Side& side : sides) {
            if (side.beyond < 0 || side.length <= root.length || ++tried > most_sides)
                continue;
            add_change(tongue, root.edges, side.edges, changes);
        }
    }

    void add_change(const Tongue& tongue, const std::vector<Index>& closed,
                    const std::vector<Index>& opened, std::vector<Change>& changes) const {
        Change change;
        change.closed = closed;
        change.opened = opened;
        change.marks = seam_;
        apply_to(change, change.marks);
        std::vector<Index> start = tongue.faces;
        for (const Index h : closed)
            start.push_back(mesh_.twin[at(h)] / 3);
        change.patches = patches_of(mesh_, change.marks, start);
        changes.push_back(std::move(change));
    }

    void apply_to(const Change& change, SeamMarks& marks) const {
        for (const Index h : change.closed)
            mark(mesh_, h, 1, marks);
        for (const Index h : change.opened)
            mark(mesh_, h, 0, marks);
    }

    // Those that are accepted, of each patch one.
    bool apply(const std::vector<Change>& changes) {
        std::vector<std::uint8_t> is_changed(mesh_.faces.size(), 0);
        bool any = false;
        for (const Change& change : changes) {
            bool is_free = change.is_accepted;
            for (const auto& patch : change.patches)
                for (const Index f : patch)
                    is_free = is_free && is_changed[at(f)] == 0;
            if (!is_free)
                continue;
            apply_to(change, seam_);
            any = true;
            for (const auto& patch : change.patches)
                for (const Index f : patch)
                    is_changed[at(f)] = 1;
        }
        return any;
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

} // namespace devseg
