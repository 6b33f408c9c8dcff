// Filters on the selected faces alone, with seams and charts that stay.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/filters/table.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::declare {
namespace {

using checks::run;
using checks::value;

// A bumpy ball in four charts, flattened, with the faces of one side selected: whole charts and
// parts of others.
HostMesh flattened_ball() {
    mesh::RawMesh raw = shapes::sphere(3);
    for (Vec3& p : raw.points)
        p *= 1.0 + 0.1 * std::sin(3.0 * p.x()) * std::cos(2.0 * p.y());
    HostMesh host = checks::host_of(raw);
    checks::take_charts(
        host, run("Segmentation: Variational Shape Approximation", host, {{"charts_number", 4}}));
    const HostResult flat = run("Charts: Flatten", host, {{"pack", false}});
    checks::take_charts(host, flat);
    host.wedge_uv = flat.wedge_uv;
    for (std::array<Vec2, 3>& corners : host.wedge_uv)
        for (Vec2& p : corners)
            p = checks::single(p);
    host.face_color = run("Charts: Colorize", host).face_color;
    for (const Triangle& t : raw.faces)
        host.face_selected.push_back(raw.points[t[0]].x() + 0.3 * raw.points[t[1]].y() > 0.1);
    return host;
}

// Bits of the edges of a face to selected ones.
int edges_to_selected(const HostMesh& host, std::size_t face) {
    int bits = 0;
    for (const auto& [ends, faces] : checks::edges_of(host.geometry))
        if (faces.size() == 2)
            for (int i = 0; i < 2; ++i)
                if (faces[at(i)].first == face && host.face_selected[faces[at(1 - i)].first] != 0)
                    bits |= 1 << faces[at(i)].second;
    return bits;
}

TEST(SelectedOnly, NothingElseChangesInAnyFilterThatTakesIt) {
    const HostMesh host = flattened_ball();
    std::vector<int> free_bits;
    for (std::size_t f = 0; f < host.geometry.faces.size(); ++f)
        free_bits.push_back(host.face_selected[f] != 0 ? 7 : edges_to_selected(host, f));
    int filters = 0;
    for (const FilterDeclaration& filter : filters::filter_table()) {
        if (!filter.on_part)
            continue;
        SCOPED_TRACE(filter.menu_name);
        ++filters;
        const HostResult r = run(filter.menu_name, host, {{"selected_only", true}});
        ASSERT_EQ(r.untouched.size(), checks::refined(host.geometry, r).faces.size());
        for (std::size_t f = 0; f < host.geometry.faces.size(); ++f) {
            ASSERT_EQ(r.untouched[f] != 0, host.face_selected[f] == 0);
            if (host.face_selected[f] != 0)
                continue;
            if (!r.chart_id.empty()) {
                ASSERT_EQ(r.chart_id[f], static_cast<int>(host.chart_id[f]));
                const int changed =
                    r.seam_edges[f] ^ static_cast<int>(std::lround(host.seam_edges[f]));
                ASSERT_EQ(changed & ~free_bits[f], 0);
            }
            if (!r.wedge_uv.empty()) {
                ASSERT_EQ(r.wedge_uv[f], host.wedge_uv[f]);
            }
        }
        if (r.refinement) {
            for (const HostRefinement::Part& part : r.refinement->parts)
                ASSERT_NE(host.face_selected[part.source], 0);
        } else if (!r.chart_id.empty()) {
            checks::expect_agreement(host.geometry, r);
        }
        EXPECT_TRUE(r.points.empty());
        EXPECT_FALSE(r.layer.has_value());
    }
    EXPECT_GE(filters, 9); // six segmentations, flattening, packing, smoothing
}

TEST(SelectedOnly, NewChartsTakeNumbersThatNoOtherFaceHas) {
    const HostMesh host = flattened_ball();
    const HostResult r = run("Segmentation: Variational Shape Approximation", host,
                             {{"charts_number", 6}, {"selected_only", true}});
    std::set<int> inside;
    std::set<int> outside;
    for (std::size_t f = 0; f < r.chart_id.size(); ++f)
        (host.face_selected[f] != 0 ? inside : outside).insert(r.chart_id[f]);
    EXPECT_EQ(static_cast<double>(inside.size()), value(r, "charts_number"));
    for (const int c : inside)
        EXPECT_EQ(outside.count(c), 0U) << c;
    for (std::size_t f = 0; f < r.chart_id.size(); ++f) // and neighbours other colours
        for (std::size_t g = 0; g < f; ++g)
            if (r.chart_id[f] == r.chart_id[g] && inside.count(r.chart_id[f]) != 0) {
                ASSERT_EQ(r.face_color[f], r.face_color[g]);
            }
}

TEST(SelectedOnly, NewCoordinatesLieBesideTheOthersAtTheirScale) {
    const HostMesh host = flattened_ball();
    for (const char* name : {"Charts: Flatten", "Charts: Pack"}) {
        const HostResult r = run(name, host, {{"selected_only", true}});
        double right = -1e300;
        double left = 1e300;
        double plane = 0.0;
        double surface = 0.0;
        for (std::size_t f = 0; f < r.wedge_uv.size(); ++f) {
            if (host.face_selected[f] != 0) {
                plane += checks::signed_area(r.wedge_uv[f]);
                surface += checks::area_on_surface(host.geometry, f);
            }
            for (const Vec2& p : r.wedge_uv[f])
                if (host.face_selected[f] != 0)
                    left = std::min(left, p.x());
                else
                    right = std::max(right, p.x());
        }
        EXPECT_GT(left, right) << name;
        EXPECT_NEAR(plane / surface, 1.0, 0.03) << name; // as the others, in model units
    }
}

TEST(SelectedOnly, AsksForASelection) {
    HostMesh host = flattened_ball();
    host.face_selected.clear();
    const std::string text = checks::error_of<InvalidMesh>([&] {
        run("Charts: Flatten", host, {{"selected_only", true}});
    });
    EXPECT_TRUE(checks::contains(text, "expected selected faces, found none"));
}

TEST(SelectedOnly, ASmoothSeamGoesOnOutside) {
    const HostMesh host = flattened_ball();
    const HostResult r = run("Charts: Smooth Seams", host, {{"selected_only", true}});
    ASSERT_TRUE(r.refinement.has_value());
    const mesh::RawMesh fine = checks::refined(host.geometry, r);
    checks::expect_agreement(fine, r);
    EXPECT_EQ(std::set<int>(r.chart_id.begin(), r.chart_id.end()),
              std::set<int>(host.chart_id.begin(), host.chart_id.end()));
    EXPECT_TRUE(checks::is_valid(checks::gated(fine)));
}

TEST(Keep, ExistingSeamsStayInEverySegmentation) {
    HostMesh host = flattened_ball();
    for (const FilterDeclaration& filter : filters::filter_table()) {
        if (!filter.keeps || filter.needs_selection)
            continue;
        SCOPED_TRACE(filter.menu_name);
        const HostResult r = run(filter.menu_name, host, {{"keep", 1}});
        EXPECT_TRUE(r.untouched.empty());
        checks::expect_agreement(host.geometry, r);
        for (std::size_t f = 0; f < r.seam_edges.size(); ++f) {
            const int before = static_cast<int>(host.seam_edges[f]);
            ASSERT_EQ(r.seam_edges[f] & before, before);
        }
        const auto most = *std::max_element(r.chart_id.begin(), r.chart_id.end());
        EXPECT_EQ(value(r, "charts_number"), most + 1);
        EXPECT_GE(value(r, "charts_number"), 4);
        if (filter.menu_name == "Charts: Flatten")
            continue; // has no measure of seams
        double length = 0.0;
        for (const auto& [ends, faces] : checks::edges_of(host.geometry))
            if (r.seam_edges[faces[0].first] >> faces[0].second & 1)
                length +=
                    (host.geometry.points[*ends.begin()] - host.geometry.points[*ends.rbegin()])
                        .norm();
        EXPECT_NEAR(value(r, "seam_length"), length, 1e-9 * length);
    }
}

// A fan of triangles about one vertex, together more than a full turn, with a flap on each of them.
HostMesh overfull_fan() {
    HostMesh host;
    host.geometry.points.emplace_back(0.0, 0.0, 0.0);
    const auto on_circle = [](int i, double radius) {
        const double turn = pi / 6.0 * i;
        const double side = i % 2 == 0 ? 0.6 : -0.6;
        return Vec3(radius * std::cos(turn), radius * std::sin(turn), radius * side);
    };
    constexpr int triangles = 7;
    for (int i = 0; i <= triangles; ++i)
        host.geometry.points.push_back(on_circle(i, 1.0));
    for (int i = 1; i <= triangles; ++i) {
        host.geometry.faces.push_back({0, i, i + 1});
        host.chart_id.push_back(0.0);
    }
    for (int i = 1; i <= triangles; ++i) {
        const Index tip = static_cast<Index>(host.geometry.points.size());
        host.geometry.points.push_back(host.geometry.points[at(i)] +
                                       host.geometry.points[at(i + 1)]);
        host.geometry.faces.push_back({i + 1, i, tip});
        host.chart_id.push_back(i);
    }
    return host;
}

TEST(Keep, APartThatIsCutOffIsNotHandedOverAcrossASeam) {
    HostMesh host = overfull_fan();
    checks::take_charts(host, run("Charts: Cut to Disks", host, {{"cut_tips", false}}));
    const HostResult handed = run("Charts: Flatten", host, {{"pack", false}});
    EXPECT_EQ(value(handed, "overlap_cuts_number"), 1);
    EXPECT_GE(value(handed, "reattached_parts_number"), 1);
    const HostResult kept = run("Charts: Flatten", host, {{"pack", false}, {"keep", 1}});
    EXPECT_EQ(value(kept, "overlap_cuts_number"), 1);
    EXPECT_EQ(value(kept, "reattached_parts_number"), 0);
    EXPECT_EQ(value(kept, "charts_number"), 9);
    bool all_stay = true;
    for (std::size_t f = 0; f < host.seam_edges.size(); ++f) {
        const int before = static_cast<int>(host.seam_edges[f]);
        EXPECT_EQ(kept.seam_edges[f] & before, before);
        all_stay = all_stay && (handed.seam_edges[f] & before) == before;
    }
    EXPECT_FALSE(all_stay);
}

TEST(Keep, FacesWithoutAChartAreSegmentedBesideTheOthers) {
    HostMesh host = flattened_ball();
    const std::vector<double> before = host.chart_id;
    for (double& id : host.chart_id)
        id = id == 1.0 || id == 2.0 ? -1.0 : id;
    const HostResult r = run("Segmentation: Variational Shape Approximation", host,
                             {{"charts_number", 5}, {"keep", 2}});
    EXPECT_EQ(value(r, "charts_number"), 5);
    for (std::size_t f = 0; f < before.size(); ++f) {
        EXPECT_GE(r.chart_id[f], 0);
        if (host.chart_id[f] >= 0.0) {
            EXPECT_EQ(r.chart_id[f], static_cast<int>(before[f]));
        } else {
            EXPECT_TRUE(r.chart_id[f] != 0 && r.chart_id[f] != 3);
        }
    }
    EXPECT_THROW(
        run("Segmentation: Variational Shape Approximation", flattened_ball(), {{"keep", 2}}),
        InvalidMesh);
}

} // namespace
} // namespace devseg::declare
