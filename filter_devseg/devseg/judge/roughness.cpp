#include "devseg/judge/roughness.h"

#include <algorithm>
#include <cmath>

#include "devseg/base/parallel.h"
#include "devseg/judge/trial.h"

namespace devseg::judge {

namespace {

struct Tuning {
    Index samples = 64;        // the mean of so many differs by a few percent from that of all
    Index rings = 3;           // of faces over common edges
    double radius = 0.005;     // of the root of the model's area
    double most_share = 0.005; // of the surface: more is no neighbourhood
};
constexpr Tuning tuning;

// Faces around one, nearest first: whole rings.
std::vector<Index> neighbourhood(const Mesh& mesh, Face centre) {
    const double radius = tuning.radius * std::sqrt(mesh.model_area());
    const double most_area = tuning.most_share * mesh.total_area;
    std::vector<Index> faces{centre};
    std::vector<Index> ring{centre};
    double area = mesh.face_areas[centre];
    double reach = 0.0;
    for (Index rings = 0; rings < tuning.rings || reach < radius; ++rings) {
        std::vector<Index> next;
        double added = 0.0;
        for (const Face f : ring)
            for (const HalfEdge h : half_edges_of(f)) {
                const Face g = mesh.across(h);
                if (g >= 0)
                    next.push_back(g);
            }
        std::sort(next.begin(), next.end());
        next.erase(std::unique(next.begin(), next.end()), next.end());
        std::vector<Index> fresh;
        std::vector<Index> known = faces;
        std::sort(known.begin(), known.end());
        std::set_difference(next.begin(), next.end(), known.begin(), known.end(),
                            std::back_inserter(fresh));
        for (const Face f : fresh) {
            added += mesh.face_areas[f];
            reach = std::max(reach, (mesh.face_centers[f] - mesh.face_centers[centre]).norm());
        }
        if (fresh.empty() || area + added > most_area)
            break;
        area += added;
        faces.insert(faces.end(), fresh.begin(), fresh.end());
        ring = std::move(fresh);
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

} // namespace

Roughness roughness(const Mesh& mesh, Progress& progress) {
    const Index count = mesh.face_count();
    if (tuning.most_share * count < 2.0)
        return {}; // every face is large
    const std::vector<std::uint8_t> no_cuts(mesh.twin.size(), 0);
    std::vector<TrialMap> maps(at(std::min(tuning.samples, count)));
    parallel_for(
        static_cast<int>(maps.size()),
        [&](int i) {
            const auto centre = static_cast<Index>(static_cast<std::int64_t>(i) * count /
                                                   static_cast<std::int64_t>(maps.size()));
            const std::vector<Index> around = neighbourhood(mesh, centre);
            if (around.size() > 1)
                maps[at(i)] = try_chart(mesh, around, no_cuts, TrialEffort(), progress);
        },
        progress);
    // The median: neighbourhoods of corners and tips are no roughness.
    std::vector<double> excess;
    Roughness result;
    for (const TrialMap& map : maps)
        if (map.flat) {
            excess.push_back(map.l2_squared - 1.0);
            result.linf = std::max(result.linf, map.linf);
        }
    if (excess.empty())
        return {};
    const auto middle = excess.begin() + static_cast<std::ptrdiff_t>(excess.size() / 2);
    std::nth_element(excess.begin(), middle, excess.end());
    result.excess = std::max(0.0, *middle);
    return result;
}

} // namespace devseg::judge
