#include "devseg/methods/growth/borders.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/atlas/border_path.h"
#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::growth {
namespace {

// The sum that expansion moves lower, recomputed; smooth surfaces only (no crease factor).
double sum_of(const Mesh& mesh, const std::vector<metrics::ConicProxy>& proxies,
              const ExpansionOptions& options, const std::vector<Index>& chart) {
    double sum = 0.0;
    for (const Face f : mesh.all_faces()) {
        const double error = proxies[chart[f]].fitting_error(mesh.face_normals[f]);
        sum +=
            mesh.face_areas[f] * (error + 20.0 * std::max(0.0, error - options.max_fitting_error));
    }
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index twin = mesh.twin[h];
        if (twin > h && chart[h / 3] != chart[twin / 3])
            sum += options.length_weight * std::sqrt(mesh.total_area) *
                   atlas::crease_factor(mesh, h) * mesh.edge_length(h);
    }
    return sum;
}

std::vector<Index> stripes(const Mesh& mesh, Index count) {
    std::vector<Index> chart;
    for (const Vec3& centre : mesh.face_centers)
        chart.push_back(std::min(count - 1, static_cast<Index>((centre.z() + 2.0) * count / 4.0)));
    return chart;
}

TEST(Expansion, NeverRaisesTheSumAndLowersABadStart) {
    const Mesh mesh = checks::gated(shapes::sphere(4));
    std::vector<Index> chart = stripes(mesh, 5);
    for (std::size_t f = 0; f < chart.size(); f += 7)
        chart[f] = static_cast<Index>(f % 5);
    ExpansionOptions options;
    options.max_rounds = 1; // proxies stay those of the start
    const std::vector<metrics::ConicProxy> proxies = metrics::fit_conics(mesh, chart, 5);
    const double before = sum_of(mesh, proxies, options, chart);
    Progress progress;
    relabel_by_expansion(mesh, proxies, options, chart, progress);
    const double after = sum_of(mesh, proxies, options, chart);
    EXPECT_LT(after, 0.5 * before);
    // A second run finds nothing more to gain but rounding.
    relabel_by_expansion(mesh, proxies, options, chart, progress);
    EXPECT_LE(sum_of(mesh, proxies, options, chart), after * (1.0 + 1e-12));
}

TEST(Expansion, TwoLabelsEndAtTheLeastCut) {
    // Two planes that meet at a right angle, the border started half-way up one of them: with two
    // labels one move is exact, and the crease is both where faces fit and where borders are cheap.
    const Mesh mesh = checks::gated(shapes::cube(6));
    std::vector<Index> chart(mesh.faces.size());
    std::vector<metrics::ConicProxy> proxies(6);
    std::vector<Index> wanted(chart.size());
    for (const Face f : mesh.all_faces()) {
        Index axis = 0;
        mesh.face_normals[f].cwiseAbs().maxCoeff(&axis);
        wanted[f] = 2 * axis + (mesh.face_normals[f][axis] > 0.0 ? 1 : 0);
        proxies[wanted[f]].axis = mesh.face_normals[f];
        chart[f] = f % 5 == 0 ? (wanted[f] + 1) % 6 : wanted[f];
    }
    Progress progress;
    relabel_by_expansion(mesh, proxies, ExpansionOptions{}, chart, progress);
    EXPECT_EQ(chart, wanted);
}

TEST(CreaseFactor, IsOneOnPlanesAndATenthOnRightAngles) {
    const Mesh mesh = checks::gated(shapes::cube(2));
    for (const HalfEdge h : mesh.all_half_edges()) {
        const bool crease = mesh.face_normals[h / 3].dot(mesh.face_normals[mesh.twin[h] / 3]) < 0.5;
        EXPECT_NEAR(atlas::crease_factor(mesh, h), crease ? 0.1 : 1.0, 1e-12);
    }
}

} // namespace
} // namespace devseg::growth
