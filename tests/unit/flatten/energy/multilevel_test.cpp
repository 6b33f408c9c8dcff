#include "devseg/flatten/energy/multilevel.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/maps/lscm.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::flatten {
namespace {

using checks::Disk;

std::vector<Vec2> minimised_lscm(const FlatteningProblem& problem, double tolerance) {
    SymmetricDirichletOptions options;
    options.max_iterations = 1000;
    options.relative_tolerance = tolerance;
    return minimise_symmetric_dirichlet(problem, flatten_lscm(problem), options, Progress{}).uv;
}

std::vector<Vec2> flatten(const Disk& disk, const Progress& progress = Progress{}) {
    const auto solve = [](const FlatteningProblem& coarse, const atlas::ChartSurface&) {
        return minimised_lscm(coarse, SymmetricDirichletOptions{}.relative_tolerance);
    };
    return flatten_multilevel(disk.mesh, disk.surface, disk.problem, solve, progress);
}

bool on_ruling(const Vec3& p) {
    return std::abs(p.y()) < 1e-12 && p.x() > 0.0;
}

// A cone with waves around it.
mesh::RawMesh wavy_cone() {
    mesh::RawMesh mesh = shapes::cone(80, 42);
    for (Vec3& p : mesh.points)
        p.z() += 0.05 * std::sin(6.0 * p.x()) * std::sin(5.0 * p.y() + 1.0);
    return mesh;
}

// Bent along its length, so that it is not developable.
mesh::RawMesh long_strip() {
    mesh::RawMesh mesh = shapes::grid(800, 4, 200.0, 1.0);
    for (Vec3& p : mesh.points)
        p.z() = 0.2 * std::sin(0.7 * p.x()) * std::sin(2.0 * p.y());
    return mesh;
}

std::vector<Disk> large_charts() {
    std::vector<Disk> disks;
    disks.emplace_back(shapes::hemisphere(80, 42));
    disks.emplace_back(long_strip());
    disks.emplace_back(shapes::cone(80, 42), on_ruling);
    disks.emplace_back(wavy_cone(), on_ruling);
    return disks;
}

TEST(Multilevel, MapsAreAsGoodAsThoseOfTheWholeChart) {
    for (const Disk& disk : large_charts()) {
        ASSERT_GE(disk.surface.face_count(), multilevel_threshold);
        const double converged =
            symmetric_dirichlet_energy(disk.problem, minimised_lscm(disk.problem, 1e-10));
        const std::vector<Vec2> start = flatten(disk);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, start), 0);
        EXPECT_LT(symmetric_dirichlet_energy(disk.problem, start), converged + 1e-4);
        const SymmetricDirichletResult r = minimise_symmetric_dirichlet(
            disk.problem, start, SymmetricDirichletOptions{}, Progress{});
        EXPECT_TRUE(r.converged);
        EXPECT_EQ(checks::count_flips(disk.problem.faces, r.uv), 0);
        EXPECT_NEAR(r.energy, converged, 1e-5);
    }
}

TEST(Multilevel, TheNumberOfThreadsDoesNotMatter) {
    const Mesh mesh = checks::gated(
        shapes::join(shapes::hemisphere(80, 42), shapes::moved(long_strip(), 1.0, {0, 3, 0})));
    const atlas::ChartMap charts = checks::components_cut_to_disks(mesh);
    const auto flat = [&](int threads) {
        set_thread_limit(threads);
        Progress progress;
        const FlattenResult r =
            flatten_charts(mesh, charts, FlattenMethod::symmetric_dirichlet, progress);
        set_thread_limit(0);
        std::vector<Vec2> all;
        for (const FlatChart& chart : r.flat) {
            EXPECT_GE(chart.surface.face_count(), multilevel_threshold);
            all.insert(all.end(), chart.uv.begin(), chart.uv.end());
        }
        return all;
    };
    const std::vector<Vec2> first = flat(1);
    for (const int threads : {2, 4})
        EXPECT_EQ(flat(threads), first); // the same bytes
}

// Vertices that lie on each other leave no room for a shape; then the whole chart is solved.
TEST(Multilevel, FacesWithoutAreaAndNeedlesAreFlattened) {
    for (const double stretch : {1.0, 1e-5}) {
        mesh::RawMesh raw = shapes::hemisphere(80, 42);
        for (std::size_t i = 100; i < raw.points.size(); i += 311)
            raw.points[i] = raw.points[i - 1] + stretch * (raw.points[i] - raw.points[i - 1]);
        const Disk disk(raw);
        ASSERT_GE(disk.surface.face_count(), multilevel_threshold);
        Progress progress;
        const FlattenResult r =
            flatten_charts(disk.mesh, disk.charts, FlattenMethod::symmetric_dirichlet, progress);
        for (const FlatChart& chart : r.flat)
            EXPECT_EQ(checks::count_flips(chart.surface.faces, chart.uv), 0);
    }
}

TEST(Multilevel, ErrorsOfTheSolverComeThrough) {
    const Disk disk(shapes::hemisphere(80, 42));
    const auto fails = [](const FlatteningProblem&,
                          const atlas::ChartSurface&) -> std::vector<Vec2> {
        throw NumericalFailure("no solution");
    };
    EXPECT_THROW(flatten_multilevel(disk.mesh, disk.surface, disk.problem, fails, Progress{}),
                 NumericalFailure);
}

TEST(Multilevel, Cancels) {
    const Disk disk(shapes::hemisphere(80, 42));
    Progress stopped([](double, const char*) { return false; });
    // Once the coarse map is there: what follows must stop as well.
    const auto solve = [&](const FlatteningProblem& coarse, const atlas::ChartSurface&) {
        std::vector<Vec2> uv = minimised_lscm(coarse, 1e-3);
        EXPECT_THROW(stopped.update(0.5), Cancelled);
        return uv;
    };
    EXPECT_THROW(flatten_multilevel(disk.mesh, disk.surface, disk.problem, solve, stopped),
                 Cancelled);
    EXPECT_THROW(flatten(disk, stopped), Cancelled);
}

} // namespace
} // namespace devseg::flatten
