#include "devseg/methods/plush/remnants.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "devseg/methods/plush/mend_patches.h"

namespace devseg::plush {

namespace {

constexpr double longest_darts = 1.5; // over the border that goes: an island is worse than a dart

class RemnantJoiner {
public:
    RemnantJoiner(const SeamSetting& setting, const VertexGraph& graph,
                  const std::vector<double>& cost, const PatchLimits& limits, SeamMarks& seam,
                  Progress& progress)
        : s_(setting), mesh_(setting.mesh()), graph_(graph), cost_(cost), limits_(limits),
          seam_(seam), progress_(progress) {}

    Index run(double most_area) {
        for (const std::vector<Index>& patch : remnants(most_area * mesh_.total_area)) {
            // Earlier joins may have made it larger.
            if (patches_of(mesh_, seam_, {patch.front()}).front() == patch)
                join(patch);
        }
        return tried_;
    }

private:
    // The smallest first.
    std::vector<std::vector<Index>> remnants(double most_area) const {
        std::vector<Index> all;
        for (const Face f : mesh_.all_faces())
            all.push_back(f);
        std::vector<std::pair<double, std::vector<Index>>> found;
        for (std::vector<Index>& patch : patches_of(mesh_, seam_, all)) {
            double area = 0.0;
            for (const Face f : patch)
                area += mesh_.face_areas[f];
            if (area <= most_area)
                found.emplace_back(area, std::move(patch));
        }
        std::sort(found.begin(), found.end());
        std::vector<std::vector<Index>> patches;
        for (auto& entry : found)
            patches.push_back(std::move(entry.second));
        return patches;
    }

    void join(const std::vector<Index>& patch) {
        const std::vector<Index> label = find_patches(mesh_, seam_).label;
        const atlas::ChartSurface surface = atlas::extract_surface(mesh_, patch, seam_);
        for (const Index neighbour : atlas::neighbour_labels(mesh_, label, surface)) {
            std::vector<Index> border;
            for (const Face f : patch)
                for (const HalfEdge h : half_edges_of(f))
                    if (mesh_.twin[h] >= 0 && label[mesh_.twin[h] / 3] == neighbour &&
                        (s_.hard.empty() || s_.hard[h] == 0))
                        border.push_back(h);
            if (!border.empty() && join_along(border))
                return;
        }
    }

    bool join_along(const std::vector<Index>& border) {
        SeamMarks marks = seam_;
        for (const HalfEdge h : border)
            mark(mesh_, h, 0, marks);
        ++tried_;
        progress_.check();
        const std::vector<Index> joined = patches_of(mesh_, marks, {border.front() / 3}).front();
        open_what_floats(joined, marks);
        const auto cuts = mend_patch(mesh_, graph_, cost_, joined, marks, limits_, progress_);
        if (!cuts || length(*cuts) > longest_darts * length(border))
            return false;
        for (const HalfEdge h : *cuts)
            mark(mesh_, h, 1, marks);
        if (patches_of(mesh_, marks, joined).size() > 1)
            return false;
        seam_ = std::move(marks);
        return true;
    }

    // Darts that ended on the common border, from one side or the other.
    void open_what_floats(const std::vector<Index>& faces, SeamMarks& marks) const {
        std::vector<std::uint8_t> inside(mesh_.faces.size(), 0);
        for (const Face f : faces)
            inside[f] = 1;
        std::vector<Index> inner; // half-edges of cuts
        std::vector<std::uint8_t> is_tied(mesh_.points.size(), 0);
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin < 0 || inside[twin / 3] == 0)
                    is_tied[mesh_.origin(h)] = is_tied[mesh_.target(h)] = 1;
                else if (marks[h] != 0)
                    inner.push_back(h);
            }
        for (bool grows = true; grows;) {
            grows = false;
            for (const HalfEdge h : inner)
                if (is_tied[mesh_.origin(h)] != 0 && is_tied[mesh_.target(h)] == 0)
                    is_tied[mesh_.target(h)] = grows = true;
        }
        for (const HalfEdge h : inner)
            if (is_tied[mesh_.origin(h)] == 0 && (s_.hard.empty() || s_.hard[h] == 0))
                mark(mesh_, h, 0, marks);
    }

    double length(const std::vector<Index>& half_edges) const {
        double sum = 0.0;
        for (const HalfEdge h : half_edges)
            sum += mesh_.edge_length(h);
        return sum;
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    const VertexGraph& graph_;
    const std::vector<double>& cost_;
    const PatchLimits limits_;
    SeamMarks& seam_;
    Progress& progress_;
    Index tried_ = 0;
};

} // namespace

Index absorb_remnants(const SeamSetting& setting, const VertexGraph& graph,
                      const std::vector<double>& cost, const PatchLimits& limits, double most_area,
                      SeamMarks& seam, Progress& progress) {
    return RemnantJoiner(setting, graph, cost, limits, seam, progress).run(most_area);
}

} // namespace devseg::plush
