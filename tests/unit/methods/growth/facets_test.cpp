// Flat regions are one face to every method that grows charts.
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/growth/seeds.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::growth {
namespace {

using checks::run;
using checks::value;

// Labels of each flat region.
std::map<Index, std::set<int>> labels_of_regions(const Mesh& mesh, const std::vector<int>& label) {
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    std::map<Index, std::set<int>> labels;
    for (const Face f : mesh.all_faces())
        labels[regions.label[f]].insert(label[f]);
    return labels;
}

class Methods : public testing::TestWithParam<const char*> {};

TEST_P(Methods, NoBorderRunsThroughAFlatRegion) {
    const mesh::RawMesh raw = shapes::cube(6);
    const Mesh mesh = checks::gated(raw);
    for (const int number : {2, 4, 6}) {
        const declare::HostResult r =
            run(GetParam(), checks::host_of(raw), {{"charts_number", number}});
        EXPECT_EQ(value(r, "charts_number"), number);
        for (const auto& [region, labels] : labels_of_regions(mesh, r.chart_id))
            EXPECT_EQ(labels.size(), 1U) << number;
    }
}

TEST_P(Methods, MoreChartsThanFacesCutFlatRegions) {
    const mesh::RawMesh raw = shapes::cube(6);
    const declare::HostResult r = run(GetParam(), checks::host_of(raw), {{"charts_number", 20}});
    EXPECT_EQ(value(r, "charts_number"), 20);
}

INSTANTIATE_TEST_SUITE_P(Facets, Methods,
                         testing::Values("Segmentation: t-flooding",
                                         "Segmentation: Variational Shape Approximation",
                                         "Segmentation: Multi-Chart Geometry Images"));

TEST(Facets, SeedsAreInDifferentOnes) {
    const Mesh mesh = checks::gated(shapes::cube(6));
    const mesh::Facets facets(mesh, 6);
    Progress progress;
    const std::vector<Index> seeds = farthest_point_seeds(mesh, 6, 0, progress, facets);
    for (std::size_t i = 0; i < seeds.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_FALSE(facets.are_one(seeds[i], seeds[k]));
}

TEST(Facets, AreNoneWhereMoreAreWanted) {
    const Mesh mesh = checks::gated(shapes::cube(6));
    EXPECT_EQ(mesh::Facets(mesh, 6).around(0).size(), 72U);
    EXPECT_EQ(mesh::Facets(mesh, 7).around(0).size(), 0U);
    EXPECT_FALSE(mesh::Facets(mesh, 7).are_one(0, 1));
}

} // namespace
} // namespace devseg::growth
