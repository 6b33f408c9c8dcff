#include "devseg/assembly/opening.h"

#include <algorithm>
#include <cmath>

#include "devseg/assembly/visibility.h"

namespace devseg::assembly {

namespace {

struct Tuning {
    double size_share = 0.25; // of the cube root of the solid's box: small toys have small openings
    double end = 5.0;         // mm to the seam's ends, where there is room: knots hold there
    double step = 5.0;        // mm between stretches that are looked at
    double most_steps = 500;  // of a seam: that of a house is as long in steps as that of a toy
    int samples = 5;          // places on a stretch
};
constexpr Tuning tuning;

// A side of a seam on the model.
class SeamOnModel {
public:
    SeamOnModel(const pattern::Pattern& pattern, const pattern::SeamSide& side)
        : mesh_(pattern.mesh) {
        const pattern::PiecePath& path = pattern.pieces[at(side.piece)].path(side.path);
        const std::size_t count = path.points.size();
        std::vector<std::size_t> edges;
        for (Index i = 0; i < side.count; ++i)
            edges.push_back(at(side.first + i) % count);
        if (side.reversed)
            std::reverse(edges.begin(), edges.end());
        double mm = 0.0;
        for (const std::size_t e : edges) {
            starts_.push_back(mm);
            half_edges_.push_back(path.half_edge[e]);
            mm += (path.points[(e + 1) % count] - path.points[e]).norm();
        }
    }

    // How well the stretch is seen, in the mean.
    double seen(const Visibility& visibility, double from, double to) const {
        double sum = 0.0;
        for (int i = 0; i < tuning.samples; ++i) {
            const double mm = from + (to - from) * (i + 0.5) / tuning.samples;
            const auto next = std::upper_bound(starts_.begin(), starts_.end(), mm);
            const HalfEdge h(half_edges_[static_cast<std::size_t>(
                std::max<std::ptrdiff_t>(0, next - starts_.begin() - 1))]);
            Vec3 normal = mesh_.face_normals[face_of(h)];
            if (mesh_.twin[h] >= 0)
                normal += mesh_.face_normals[face_of(mesh_.twin[h])];
            const Vec3 place =
                0.5 * (mesh_.points[mesh_.origin(h)] + mesh_.points[mesh_.target(h)]);
            sum += visibility.at(place, normal.stableNormalized());
        }
        return sum / tuning.samples;
    }

private:
    const Mesh& mesh_;
    std::vector<double> starts_; // mm from the seam's start
    std::vector<Index> half_edges_;
};

double size_of(const pattern::Pattern& pattern) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : pattern.mesh.points)
        box.extend(p);
    return std::cbrt(box.volume()) * pattern.mesh.unit_length * pattern.mm_per_unit;
}

} // namespace

std::vector<Opening> find_openings(const pattern::Pattern& pattern, const PieceGraph& graph,
                                   const Progress& progress) {
    if (std::count(graph.is_closed.begin(), graph.is_closed.end(), 1) == 0)
        return {};
    const Visibility visibility(pattern.mesh, progress);
    const double wanted =
        std::clamp(tuning.size_share * size_of(pattern), least_opening, most_opening);
    std::vector<Opening> best(at(graph.component_count));
    std::vector<double> least(best.size(), infinite);
    std::vector<double> longest(best.size(), 0.0);
    for (std::size_t s = 0; s < pattern.seams.size(); ++s) {
        const pattern::Seam& seam = pattern.seams[s];
        const std::size_t c = at(graph.component[at(seam.sides[0].piece)]);
        const double length = seam.sides[0].length;
        if (graph.is_closed[c] == 0 || length <= 0.0)
            continue;
        progress.check();
        if (length < least_opening) {
            if (least[c] == infinite && length > longest[c]) {
                longest[c] = length;
                best[c] = {static_cast<Index>(s), 0.0, length, true};
            }
            continue;
        }
        const double margin = std::min(tuning.end, 0.5 * (length - least_opening));
        const double width = std::min(wanted, length - 2.0 * margin);
        const SeamOnModel on_model(pattern, seam.sides[0]);
        const double step = std::max(tuning.step, length / tuning.most_steps);
        for (double from = margin; from + width <= length - margin + 1e-9; from += step) {
            const double seen = on_model.seen(visibility, from, from + width);
            // Darts end at a tip, where a hand has no room.
            const double score = seam.is_dart ? seen + 1.0 : seen;
            if (score < least[c] - 1e-9) {
                least[c] = score;
                best[c] = {static_cast<Index>(s), from, from + width, false};
            }
        }
    }
    best.erase(std::remove_if(best.begin(), best.end(),
                              [](const Opening& opening) { return opening.seam < 0; }),
               best.end());
    return best;
}

} // namespace devseg::assembly
