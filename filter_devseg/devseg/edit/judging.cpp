#include "devseg/edit/judging.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "devseg/mesh/coarsen.h"

namespace devseg::edit {

using judge::TrialMap;

namespace {

struct Tuning {
    // Of a chart that is judged: with so many its map, pushed apart, takes up to 0.15 s, and as
    // much for any chart. With half as many, more joins look flat that are not.
    Index most_faces = 8000;
};
constexpr Tuning tuning;

bool is_large(const std::vector<Index>& faces) {
    return faces.size() > at(tuning.most_faces);
}

TrialMap coarse_map(const Mesh& mesh, const std::vector<Index>& faces,
                    const std::vector<std::uint8_t>& seam, const judge::WholeEffort& effort,
                    Progress& progress) {
    const atlas::ChartSurface surface =
        atlas::extract_surface(mesh, faces, atlas::enclose(mesh, faces, seam));
    auto decimating = progress.part("decimating what has changed", 0.3);
    const mesh::CoarseMesh coarse =
        mesh::coarsen_in_parallel(atlas::mesh_of(mesh, surface), tuning.most_faces, decimating);
    std::vector<Index> all(coarse.mesh.faces.size());
    std::iota(all.begin(), all.end(), 0);
    auto flattening = progress.part("flattening what has changed", progress.left());
    TrialMap map = std::move(
        judge::whole_maps(coarse.mesh, {std::move(all)},
                          std::vector<std::uint8_t>(coarse.mesh.twin.size(), 0), effort, flattening)
            .front());
    map.area = atlas::area_of(mesh, surface);
    map.turns.clear();
    map.part.clear();
    return map;
}

} // namespace

std::vector<TrialMap> quick_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                                 const std::vector<std::uint8_t>& seam,
                                 const judge::WholeEffort& effort, Progress& progress) {
    std::vector<std::vector<Index>> small;
    std::copy_if(charts.begin(), charts.end(), std::back_inserter(small),
                 [&](const auto& faces) { return !is_large(faces); });
    auto judging = progress.part("flattening what has changed", 0.3);
    std::vector<TrialMap> of_small = judge::whole_maps(mesh, small, seam, effort, judging);
    std::vector<TrialMap> maps;
    auto next = of_small.begin();
    for (std::size_t c = 0; c < charts.size(); ++c) {
        auto one = progress.part("flattening what has changed",
                                 progress.left() / static_cast<double>(charts.size() - c));
        maps.push_back(is_large(charts[c]) ? coarse_map(mesh, charts[c], seam, effort, one)
                                           : std::move(*next++));
    }
    return maps;
}

void confirm_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                  const std::vector<std::uint8_t>& seam, const judge::WholeEffort& effort,
                  std::vector<TrialMap>& maps, Progress& progress) {
    std::vector<std::vector<Index>> large;
    std::copy_if(charts.begin(), charts.end(), std::back_inserter(large), is_large);
    std::vector<TrialMap> of_large = judge::whole_maps(mesh, large, seam, effort, progress);
    auto next = of_large.begin();
    for (std::size_t c = 0; c < charts.size(); ++c)
        if (is_large(charts[c]))
            maps[c] = std::move(*next++);
}

} // namespace devseg::edit
