// Properties of all filters on random meshes with random parameters. Filters are taken from the
// table: those that are added later are tested as well.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "devseg/base/parallel.h"
#include "property/cases.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"
#include "unit/temporary_folder.h"

namespace devseg {
namespace {

using checks::any_of;
using checks::attempt;
using checks::filters_named;
using checks::for_random_cases;
using checks::host_of;
using checks::random_values;
using shapes::Defects;
using shapes::Random;
using shapes::RandomMesh;

const declare::FilterDeclaration& filter_named(const std::string& name) {
    return *filters_named(name).at(0);
}

declare::ParameterValues flattening(Random& random) {
    // Packing several charts takes a fixed effort, most of the time of a case: few cases only.
    return {{"method", random.below(5)}, {"pack", random.below(12) == 0}};
}

Index proper_faces(const mesh::RawMesh& raw) {
    return mesh::gate_mesh(raw).mesh.face_count();
}

// Segments, checks the charts, flattens them, checks the layout, and takes both into `host`.
void expect_good_atlas(declare::HostMesh& host, Random& random, bool may_refuse) {
    const mesh::RawMesh& raw = host.geometry;
    const declare::FilterDeclaration& method = any_of(filters_named("Segmentation:"), random);
    const declare::ParameterValues values = random_values(method, proper_faces(raw), "", random);
    SCOPED_TRACE(checks::described(method, values));
    const auto charts = attempt(method, host, values, true);
    if (!charts)
        return;
    checks::expect_complete(raw, *charts);
    const auto weld = values.find("weld");
    checks::expect_disks(raw, *charts, weld == values.end() ? 0.0 : std::get<double>(weld->second));
    if (testing::Test::HasFatalFailure())
        return;
    checks::take_charts(host, *charts);
    const declare::ParameterValues choice = flattening(random);
    const auto flat = attempt(filter_named("Charts: Flatten"), host, choice, may_refuse);
    if (!flat)
        return;
    SCOPED_TRACE("method " + std::to_string(std::get<int>(choice.at("method"))));
    checks::expect_complete(raw, *flat);
    checks::expect_disks(raw, *flat);
    if (!testing::Test::HasFatalFailure())
        checks::expect_valid_layout(raw, *flat, std::get<bool>(choice.at("pack")));
    checks::take_charts(host, *flat);
    host.wedge_uv = flat->wedge_uv;
}

bool has_area(const mesh::RawMesh& raw) {
    try {
        mesh::gate_mesh(raw);
        return true;
    } catch (const InvalidMesh&) {
        return false;
    }
}

TEST(Property, AtlasesOfProperMeshesAreValid) {
    for_random_cases(30, [](Random& random) {
        const RandomMesh mesh = shapes::random_mesh(random, Defects::none);
        SCOPED_TRACE(mesh.recipe);
        declare::HostMesh host = host_of(mesh.raw);
        expect_good_atlas(host, random, false);
    });
}

TEST(Property, AtlasesOfBrokenMeshesAreValid) {
    for_random_cases(30, [](Random& random) {
        const RandomMesh mesh = shapes::random_mesh(random, Defects::any);
        SCOPED_TRACE(mesh.recipe);
        declare::HostMesh host = host_of(mesh.raw);
        if (has_area(mesh.raw))
            expect_good_atlas(host, random, false);
    });
}

// Charts that nobody would make: random labels, which change at one of `run` faces, and cuts.
declare::HostMesh with_random_charts(declare::HostMesh host, Index run, Random& random) {
    const Index labels = 1 + random.below(4);
    const Index cuts = random.below(3) == 0 ? 0 : 1 + random.below(30);
    for (std::size_t f = 0; f < host.geometry.faces.size(); ++f) {
        const bool same = f > 0 && random.below(run) > 0;
        host.chart_id.push_back(same ? host.chart_id.back() : random.below(labels));
        host.seam_edges.push_back(cuts > 0 && random.below(cuts) == 0 ? random.below(8) : 0);
    }
    return host;
}

TEST(Property, AtlasesOfRandomChartsAreValid) {
    for_random_cases(30, [](Random& random) {
        const RandomMesh mesh =
            shapes::random_mesh(random, random.below(2) == 0 ? Defects::none : Defects::any);
        if (!has_area(mesh.raw))
            return;
        SCOPED_TRACE(mesh.recipe);
        declare::HostMesh host = with_random_charts(host_of(mesh.raw), 4, random);
        const declare::ParameterValues choice = flattening(random);
        const auto flat = attempt(filter_named("Charts: Flatten"), host, choice, false);
        if (!flat)
            return;
        SCOPED_TRACE("method " + std::to_string(std::get<int>(choice.at("method"))));
        checks::expect_complete(mesh.raw, *flat);
        checks::expect_disks(mesh.raw, *flat);
        if (!testing::Test::HasFatalFailure())
            checks::expect_valid_layout(mesh.raw, *flat, std::get<bool>(choice.at("pack")));
    });
}

TEST(Property, SmoothSeamsOfRandomChartsAreSound) {
    for_random_cases(60, [](Random& random) {
        const bool proper = random.below(2) == 0;
        const RandomMesh mesh = shapes::random_mesh(random, proper ? Defects::none : Defects::any);
        if (!has_area(mesh.raw))
            return;
        SCOPED_TRACE(mesh.recipe);
        declare::HostMesh host = with_random_charts(host_of(mesh.raw), 8, random);
        const declare::FilterDeclaration& filter = filter_named("Charts: Smooth Seams");
        const auto made = attempt(
            filter, host,
            random_values(filter, static_cast<Index>(mesh.raw.faces.size()), "", random), true);
        if (!made)
            return;
        checks::expect_complete(mesh.raw, *made);
        declare::HostMesh fine = host_of(checks::refined(mesh.raw, *made));
        checks::take_charts(fine, *made);
        const declare::HostResult measured = checks::run("Charts: Measure Segmentation", fine);
        // Where the gate has to cut, it cuts elsewhere once there are other faces.
        if (proper && mesh.recipe.find("moebius") == std::string::npos) {
            EXPECT_EQ(checks::value(measured, "charts_number"),
                      checks::value(*made, "charts_number"));
        }
    });
}

// What hosts may have on a mesh: anything.
void add_random_attributes(declare::HostMesh& host, Random& random) {
    const double odd[] = {std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity(),
                          -1.0,
                          0.5,
                          1e300,
                          3e38};
    const auto number = [&](double low, double high) {
        return random.below(400) == 0
                   ? odd[random.below(6)]
                   : static_cast<double>(static_cast<float>(random.uniform(low, high)));
    };
    const bool has_charts = random.below(2) == 0;
    const bool has_uv = random.below(3) > 0;
    const bool projected = random.below(2) == 0;
    for (const Triangle& t : host.geometry.faces) {
        if (has_charts) {
            host.chart_id.push_back(std::floor(number(0.0, 3.0)));
            host.seam_edges.push_back(random.below(10) == 0 ? number(0.0, 8.0) : 0.0);
        }
        if (!has_uv)
            continue;
        std::array<Vec2, 3> corners{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = projected ? Vec2(host.geometry.points[t[k]].head<2>())
                                   : Vec2(number(-1.0, 1.0), number(-1.0, 1.0));
        host.wedge_uv.push_back(corners);
    }
}

TEST(Property, EveryFilterAnswersOrRefuses) {
    const TemporaryFolder folder;
    for_random_cases(150, [&](Random& random) {
        const RandomMesh mesh = shapes::random_mesh(random, Defects::any);
        SCOPED_TRACE(mesh.recipe);
        declare::HostMesh host = host_of(mesh.raw);
        if (random.below(20) == 0)
            host.geometry.points[mesh.raw.faces[0][0]].x() =
                std::numeric_limits<double>::quiet_NaN();
        add_random_attributes(host, random);
        const declare::FilterDeclaration& filter = any_of(filters_named(""), random);
        const declare::ParameterValues values = random_values(
            filter, static_cast<Index>(mesh.raw.faces.size()), folder.file("pattern"), random);
        const std::ptrdiff_t before = folder.count();
        const auto result = attempt(filter, host, values, true);
        if (result)
            checks::expect_complete(mesh.raw, *result);
        else
            EXPECT_EQ(folder.count(), before) << "a refusal left a file";
    });
}

TEST(Property, PatternsOfGoodAtlasesAreMade) {
    const TemporaryFolder folder;
    for_random_cases(20, [&](Random& random) {
        const RandomMesh mesh = shapes::random_mesh(random, Defects::none);
        SCOPED_TRACE(mesh.recipe);
        declare::HostMesh host = host_of(mesh.raw);
        expect_good_atlas(host, random, false);
        if (host.wedge_uv.empty())
            return;
        for (const declare::FilterDeclaration* filter : filters_named("Pattern:")) {
            const declare::ParameterValues values =
                random_values(*filter, proper_faces(mesh.raw), folder.file("pattern"), random);
            SCOPED_TRACE(checks::described(*filter, values));
            const auto result = attempt(*filter, host, values, true);
            if (result)
                checks::expect_complete(mesh.raw, *result);
        }
    });
}

void expect_same(const declare::HostResult& a, const declare::HostResult& b) {
    EXPECT_EQ(a.chart_id, b.chart_id);
    EXPECT_EQ(a.seam_edges, b.seam_edges);
    EXPECT_EQ(a.face_quality, b.face_quality);
    EXPECT_EQ(a.wedge_uv, b.wedge_uv);
    EXPECT_EQ(a.values, b.values);
    EXPECT_EQ(a.notes, b.notes);
}

TEST(Property, TheNumberOfThreadsChangesNothing) {
    for_random_cases(10, [](Random& random) {
        const RandomMesh mesh = shapes::random_mesh(random, Defects::any);
        if (!has_area(mesh.raw))
            return;
        SCOPED_TRACE(mesh.recipe);
        const declare::FilterDeclaration& method = any_of(filters_named("Segmentation:"), random);
        const declare::ParameterValues values =
            random_values(method, proper_faces(mesh.raw), "", random);
        const declare::ParameterValues choice = flattening(random);
        std::optional<declare::HostResult> first_charts;
        std::optional<declare::HostResult> first_flat;
        for (const int threads : {1, 2, 5}) {
            set_thread_limit(threads);
            declare::HostMesh host = host_of(mesh.raw);
            const auto charts = attempt(method, host, values, true);
            if (!charts)
                break;
            checks::take_charts(host, *charts);
            const auto flat = attempt(filter_named("Charts: Flatten"), host, choice, false);
            if (!flat)
                break;
            if (first_flat) {
                expect_same(*first_charts, *charts);
                expect_same(*first_flat, *flat);
            }
            first_charts = charts;
            first_flat = flat;
        }
        set_thread_limit(0);
    });
}

// Share of the area (by number of faces) that lies in other charts once each chart of `a` has
// been given the chart of `b` that it shares most faces with.
double difference(const std::vector<int>& a, const std::vector<int>& b) {
    std::map<int, std::map<int, int>> shared;
    for (std::size_t f = 0; f < a.size(); ++f)
        ++shared[a[f]][b[f]];
    int same = 0;
    for (const auto& [chart, counts] : shared)
        same += std::max_element(counts.begin(), counts.end(), [](const auto& x, const auto& y) {
                    return x.second < y.second;
                })->second;
    return 1.0 - static_cast<double>(same) / static_cast<double>(a.size());
}

// Cases whose charts a change of the mesh changes, although it means nothing: rounding may decide
// otherwise between two candidates that are equally good, and growth carries that on.
struct Changes {
    int cases = 0;
    int changed = 0;
    int count_changed = 0;
};

using Edit = mesh::RawMesh (*)(const mesh::RawMesh&, const std::vector<Index>& order, Random&);

void count_changes(Random& random, Edit edit, Changes& changes,
                   std::vector<const declare::FilterDeclaration*> methods) {
    RandomMesh mesh = shapes::random_mesh(random, Defects::none);
    // Noise breaks the ties of symmetric shapes.
    mesh.raw = shapes::with_noise(mesh.raw, 0.01, static_cast<std::uint32_t>(random.below(1000)));
    SCOPED_TRACE(mesh.recipe);
    const std::vector<Index> order = shapes::random_order(
        mesh.raw.faces.size(), static_cast<std::uint32_t>(random.below(1 << 30)));
    const declare::FilterDeclaration& method = any_of(methods, random);
    declare::ParameterValues values = random_values(method, proper_faces(mesh.raw), "", random);
    values.erase("random_seed"); // it chooses faces by their number
    const auto charts = attempt(method, host_of(mesh.raw), values, true);
    const mesh::RawMesh edited = edit(mesh.raw, order, random);
    const auto other = attempt(method, host_of(edited), values, true);
    ASSERT_EQ(charts.has_value(), other.has_value());
    if (!charts)
        return;
    std::vector<int> in_order;
    const bool reordered = edited.faces != mesh.raw.faces;
    for (const Index f : order)
        in_order.push_back(charts->chart_id[f]);
    const std::vector<int>& expected = reordered ? in_order : charts->chart_id;
    const double share =
        std::max(difference(expected, other->chart_id), difference(other->chart_id, expected));
    if (share > 0.02)
        std::cout << checks::described(method, values) << ", " << mesh.recipe << ": " << share
                  << '\n';
    ++changes.cases;
    changes.changed += share > 0.02 ? 1 : 0;
    changes.count_changed +=
        checks::value(*charts, "charts_number") != checks::value(*other, "charts_number") ? 1 : 0;
}

void expect_few(const Changes& changes, double largest_share) {
    testing::Test::RecordProperty("cases", changes.cases);
    testing::Test::RecordProperty("changed", changes.changed);
    std::cout << changes.changed << " of " << changes.cases << " segmentations changed, "
              << changes.count_changed << " in the number of charts\n";
    EXPECT_LE(changes.changed, 2 + largest_share * changes.cases);
}

void count_changes_by_motion(const std::vector<const declare::FilterDeclaration*>& methods,
                             double largest_share) {
    Changes changes;
    for_random_cases(30, [&](Random& random) {
        count_changes(
            random,
            [](const mesh::RawMesh& mesh, const std::vector<Index>&, Random& motion) {
                return shapes::moved_rigidly(mesh, motion.uniform(0.3, 3.0), motion);
            },
            changes, methods);
    });
    expect_few(changes, largest_share);
}

TEST(Property, RigidMotionKeepsTheCharts) {
    std::vector<const declare::FilterDeclaration*> methods = filters_named("Segmentation:");
    const declare::FilterDeclaration* plush = &filter_named("Segmentation: Plush Toy Seams");
    methods.erase(std::remove(methods.begin(), methods.end(), plush), methods.end());
    count_changes_by_motion(methods, 0.1);
}

// Decided in the model's own frame, they do not even depend on rounding.
TEST(Property, RigidMotionKeepsPlushSeams) {
    count_changes_by_motion({&filter_named("Segmentation: Plush Toy Seams")}, 0.02);
}

void count_changes_by_order(const std::vector<const declare::FilterDeclaration*>& methods,
                            double largest_share) {
    Changes changes;
    for_random_cases(30, [&](Random& random) {
        count_changes(
            random,
            [](const mesh::RawMesh& mesh, const std::vector<Index>& order, Random&) {
                return shapes::with_face_order(mesh, order);
            },
            changes, methods);
    });
    expect_few(changes, largest_share);
}

// Of the other methods it decides more than ties between costs: among faces at equal distance in
// t-flooding, about seeds in Multi-Chart Geometry Images, and which seam is tried next in Plush Toy
// Seams.
TEST(Property, TheOrderOfFacesKeepsTheCharts) {
    count_changes_by_order({&filter_named("Segmentation: D-Charts"),
                            &filter_named("Segmentation: Papercraft with Creases and Slits")},
                           0.03); // 1.8 %, measured on 494 small meshes
}

// A fitting error that rounding raises or lowers decides here which face is the next seed.
TEST(Property, TheOrderOfFacesKeepsMostProxies) {
    count_changes_by_order({&filter_named("Segmentation: Variational Shape Approximation")}, 0.2);
}

// Multiplying by a power of two changes no digit: nothing may differ but the lengths.
TEST(Property, SizeChangesNothing) {
    for_random_cases(20, [](Random& random) {
        const RandomMesh mesh = shapes::random_mesh(random, Defects::none);
        SCOPED_TRACE(mesh.recipe);
        const declare::FilterDeclaration& method = any_of(filters_named("Segmentation:"), random);
        const declare::ParameterValues values =
            random_values(method, proper_faces(mesh.raw), "", random);
        const auto charts = attempt(method, host_of(mesh.raw), values, true);
        const double size = std::ldexp(1.0, random.below(80) - 40);
        const auto other =
            attempt(method, host_of(shapes::moved(mesh.raw, size, Vec3::Zero())), values, true);
        ASSERT_EQ(charts.has_value(), other.has_value());
        if (!charts)
            return;
        EXPECT_EQ(charts->chart_id, other->chart_id) << size;
        EXPECT_EQ(charts->seam_edges, other->seam_edges) << size;
    });
}

} // namespace
} // namespace devseg
