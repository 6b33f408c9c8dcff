// Every filter of the table, run on one mesh: it does what its declaration says.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/declare/filter.h"
#include "devseg/filters/table.h"
#include "unit/checks.h"
#include "unit/declare/sample_hosts.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/pattern_samples.h"
#include "unit/shapes.h"

namespace devseg::declare {
namespace {

using checks::contains;
using checks::number;
using namespace hosts;

// With what is chosen, for filters that work on that.
HostMesh prepared_for(const FilterDeclaration& filter) {
    if (filter.needs_texture)
        return textured();
    return filter.needs_selection ? chosen_by_hand(0.1) : prepared();
}

HostResult run(const FilterDeclaration& filter, const HostMesh& host,
               const ParameterValues& values) {
    Progress progress;
    return run_filter(filter, host, values, progress);
}

TEST(DeclaredFilters, FiltersReturnAndWriteWhatTheyDeclare) {
    for (const FilterDeclaration& filter : filters::filter_table()) {
        HostMesh host = prepared_for(filter);
        SCOPED_TRACE(filter.menu_name);
        host.face_color =
            checks::run("Charts: Colorize", host).face_color; // smooth seams keep them
        HostResult r = run(filter, host, {});
        if ((filter.writes & writes_mesh) != 0 && !r.refinement)
            r = run(filter, host, {{"smooth", true}}); // only where it is asked for
        EXPECT_EQ(r.refinement.has_value(), (filter.writes & writes_mesh) != 0);
        const std::size_t faces = checks::refined(host.geometry, r).faces.size();
        std::vector<std::string> declared;
        std::vector<std::string> returned;
        for (const ResultField& field : filter.results)
            declared.push_back(field.name);
        for (const auto& [name, value] : r.values) {
            returned.push_back(name);
            const bool is_count = name.size() > 7 && name.substr(name.size() - 7) == "_number";
            EXPECT_EQ(is_count, std::holds_alternative<int>(value)) << name;
        }
        EXPECT_EQ(returned, declared);
        const auto expect_written = [&](unsigned what, std::size_t size) {
            EXPECT_EQ(size, (filter.writes & what) != 0 ? faces : 0U) << what;
        };
        expect_written(writes_charts, r.chart_id.size());
        expect_written(writes_charts, r.seam_edges.size());
        expect_written(writes_quality, r.face_quality.size());
        expect_written(writes_color, r.face_color.size());
        expect_written(writes_uv, r.wedge_uv.size());
        EXPECT_EQ(r.points.size(),
                  (filter.writes & writes_points) != 0 ? host.geometry.points.size() : 0U);
        EXPECT_EQ(r.texture.has_value(), (filter.writes & writes_texture) != 0);
        EXPECT_EQ(r.layer.has_value(), (filter.writes & writes_layer) != 0);
    }
}

bool same_layer(const HostResult& a, const HostResult& b) {
    if (!a.layer || !b.layer)
        return a.layer.has_value() == b.layer.has_value();
    return a.layer->geometry.points == b.layer->geometry.points &&
           a.layer->geometry.faces == b.layer->geometry.faces &&
           a.layer->face_color == b.layer->face_color &&
           a.layer->face_quality == b.layer->face_quality &&
           a.layer->face_attributes == b.layer->face_attributes;
}

bool same_refinement(const HostResult& a, const HostResult& b) {
    return a.refinement.has_value() == b.refinement.has_value() &&
           (!a.refinement ||
            (a.refinement->points.size() == b.refinement->points.size() &&
             a.refinement->parts.size() == b.refinement->parts.size() &&
             std::equal(a.refinement->points.begin(), a.refinement->points.end(),
                        b.refinement->points.begin(), [](const auto& p, const auto& q) {
                            return p.face == q.face && p.weights == q.weights;
                        })));
}

bool same(const HostResult& a, const HostResult& b) {
    return same_refinement(a, b) && a.chart_id == b.chart_id && a.seam_edges == b.seam_edges &&
           a.face_quality == b.face_quality && a.face_color == b.face_color &&
           a.wedge_uv == b.wedge_uv && a.texture.has_value() == b.texture.has_value() &&
           (!a.texture || a.texture->rgb == b.texture->rgb) && a.points == b.points &&
           same_layer(a, b);
}

TEST(DeclaredFilters, TheSameInputGivesTheSameResult) {
    for (const FilterDeclaration& filter : filters::filter_table()) {
        const HostMesh host = prepared_for(filter);
        const HostResult a = run(filter, host, {});
        const HostResult b = run(filter, host, {});
        EXPECT_TRUE(same(a, b)) << filter.menu_name;
        EXPECT_EQ(a.values, b.values) << filter.menu_name;
    }
}

TEST(DeclaredFilters, DefaultsAreTheDeclaredOnes) {
    for (const FilterDeclaration& filter : filters::filter_table()) {
        const HostMesh host = prepared_for(filter);
        ParameterValues all;
        for (const Parameter& p : filter.parameters)
            all[p.name] = p.default_value;
        EXPECT_TRUE(same(run(filter, host, {}), run(filter, host, all))) << filter.menu_name;
    }
}

// Other values in the range, as different as can be.
std::vector<ParameterValue> other_values(const Parameter& p) {
    const double now = number(p.default_value);
    switch (p.kind) {
    case ParameterKind::boolean:
        return {now == 0.0};
    case ParameterKind::choice:
        return {now == 0.0 ? 1 : 0};
    case ParameterKind::integer:
        return {static_cast<int>(now == p.minimum ? now + 3.0 : p.minimum)};
    case ParameterKind::text:
    case ParameterKind::output_file:
        return {std::get<std::string>(p.default_value) + " 2"};
    case ParameterKind::real:
        break;
    }
    if (p.name == "max_linf_stretch")
        return {1.01}; // 0 means no bound, and between 0 and 1 there is nothing to ask for
    if (p.name == "max_chart_l2_stretch") { // one between a chart's stretch before and afterwards
        std::vector<ParameterValue> bounds;
        for (double excess = 1e-3; excess < 1.0; excess *= 1.03)
            bounds.emplace_back(1.0 + excess);
        return bounds;
    }
    return {p.maximum, p.minimum + 0.1, p.minimum + 1e-3 * (now - p.minimum)};
}

HostResult refused(const std::exception& error) {
    HostResult result;
    result.notes = {error.what()};
    return result;
}

// A filter that refuses because it cannot reach a bound has another result than one that does.
HostResult run_or_refuse(const FilterDeclaration& filter, const HostMesh& host,
                         const ParameterValues& values) {
    try {
        return run(filter, host, values);
    } catch (const NumericalFailure& error) {
        return refused(error);
    } catch (const InvalidParameter& error) {
        return refused(error);
    } catch (const InvalidMesh& error) { // nothing is selected
        return refused(error);
    }
}

// They need a file, and faces that are selected: plush_test and test_plush.py have them. `weld`
// needs borders that lie on each other, and has a test of its own.
bool needs_more_than_a_mesh(const std::string& name) {
    return name == "skeleton_file" || name == "material_borders" || name == "weld";
}

// Bounds of smooth seams work between what charts have before and afterwards:
// run_filter_refinement_test and test_smooth_seams.py look for that.
bool needs_a_close_bound(const FilterDeclaration& filter, const std::string& name) {
    return filter.python_name == "meshing_smooth_chart_seams" && name.rfind("max_", 0) == 0;
}

// Flattening keeps seams where parts of charts that lie on themselves would go to others: part_test
// has such charts.
bool needs_overlaps(const FilterDeclaration& filter, const std::string& name) {
    return filter.menu_name == "Charts: Flatten" && name == "keep";
}

// Parameters that work only together with another value.
ParameterValues needed_for(const std::string& name) {
    if (name == "keep_unfinished")
        return {{"max_iterations", 1}, {"adjust_slits", false}};
    if (name == "max_net_faces") // nets, of whatever has faces
        return {{"deform", 2}};
    if (name == "grain")
        return {{"material", std::string("fleece")}};
    if (name == "grain_angle")
        return {{"grain", 3}};
    if (name == "k_factor")
        return {{"thickness_mm", 0.02}, {"bend_radius_mm", 0.02}};
    if (name == "max_area_change")
        return {{"max_strain", 0.0}};
    if (name == "max_l2_stretch" || name == "max_linf_stretch")
        return {{"charts_number", 0}};
    return {};
}

// Whether some other value of the parameter gives another result than `plain`.
bool changes_the_result(const FilterDeclaration& filter, const HostMesh& host, const Parameter& p,
                        const HostResult& plain) {
    for (const ParameterValue& value : other_values(p)) {
        ParameterValues changed = needed_for(p.name);
        changed[p.name] = value;
        const HostResult other = run_or_refuse(filter, host, changed);
        if (!same(plain, other) ||
            (filter.writes == writes_nothing && plain.values != other.values))
            return true;
    }
    return false;
}

TEST(DeclaredFilters, EveryParameterChangesTheResult) {
    // What one mesh does not have, such as two pieces of one shape, another one has.
    const std::vector<HostMesh> hosts{prepared(),
                                      samples::unfinished().host(),
                                      samples::nearly_equal().host(),
                                      cubes_and_a_finger(),
                                      bumpy_body(),
                                      chosen_by_hand(0.1),
                                      chosen_by_hand(0.0),
                                      halves_of_a_ball(),
                                      textured(),
                                      wedge_of_a_cone(),
                                      tube_laid_out()};
    for (const FilterDeclaration& filter : filters::filter_table()) {
        std::map<std::pair<std::size_t, ParameterValues>, HostResult> unchanged;
        const auto plain = [&](std::size_t host, const ParameterValues& values) -> HostResult& {
            const auto [place, fresh] = unchanged.try_emplace({host, values});
            if (fresh)
                place->second = run_or_refuse(filter, hosts[host], values);
            return place->second;
        };
        for (const Parameter& p : filter.parameters) {
            if (needs_more_than_a_mesh(p.name) || needs_a_close_bound(filter, p.name) ||
                needs_overlaps(filter, p.name))
                continue;
            bool changes = false;
            for (std::size_t i = 0; i < hosts.size() && !changes; ++i)
                if (!filter.needs_uv || !hosts[i].wedge_uv.empty())
                    changes = changes_the_result(filter, hosts[i], p, plain(i, needed_for(p.name)));
            EXPECT_TRUE(changes) << filter.menu_name << ", " << p.name;
        }
    }
}

// A tube of two halves that share no vertex, with texture coordinates: one island.
HostMesh split_tube() {
    const mesh::RawMesh tube = shapes::cylinder_tube(16, 4, 1.0, 2.0);
    HostMesh host;
    for (const Triangle& t : tube.faces) {
        double middle = 0.0;
        for (const Index v : t)
            middle += tube.points[v].z() / 3.0;
        const Index half = middle < 1.0 ? 0 : static_cast<Index>(tube.points.size());
        host.geometry.faces.push_back({t[0] + half, t[1] + half, t[2] + half});
        std::array<Vec2, 3> corners;
        const Vec3& first = tube.points[t[0]];
        const double start = std::atan2(first.y(), first.x());
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& p = tube.points[t[k]];
            const double turn = std::remainder(std::atan2(p.y(), p.x()) - start, 2.0 * pi);
            corners[k] = {start + turn, p.z()};
        }
        host.wedge_uv.push_back(corners);
    }
    host.geometry.points = tube.points;
    host.geometry.points.insert(host.geometry.points.end(), tube.points.begin(), tube.points.end());
    return host;
}

TEST(DeclaredFilters, AllJoinBordersThatLieOnEachOtherUnlessToldNotTo) {
    const HostMesh host = split_tube();
    for (const FilterDeclaration& filter : filters::filter_table()) {
        SCOPED_TRACE(filter.menu_name);
        ASSERT_EQ(filter.parameters.back().name, "weld");
        if (filter.needs_selection || filter.needs_texture)
            continue; // there is none
        const auto joined = [&](const ParameterValues& values) {
            const HostResult r = run_or_refuse(filter, host, values);
            return std::any_of(r.notes.begin(), r.notes.end(), [](const std::string& note) {
                return contains(note, "16 vertices were joined with others at the same place");
            });
        };
        EXPECT_TRUE(joined({}));
        EXPECT_FALSE(joined({{"weld", -1.0}}));
    }
}

TEST(DeclaredFilters, WhatIsNotJoinedStaysASeamForTheNextFilter) {
    HostMesh host = split_tube();
    EXPECT_EQ(checks::value(checks::run("Charts: Cut to Disks", host), "charts_number"), 1);
    host.wedge_uv.clear();
    const HostResult apart = checks::run("Charts: Cut to Disks", host, {{"weld", -1.0}});
    EXPECT_EQ(checks::value(apart, "charts_number"), 2);
    checks::take_charts(host, apart);
    EXPECT_EQ(checks::value(checks::run("Charts: Flatten", host), "charts_number"), 2);
}

TEST(DeclaredFilters, NumbersOutOfRangeAreRefusedByName) {
    const HostMesh usual = prepared();
    const HostMesh chosen = chosen_by_hand(0.1);
    for (const FilterDeclaration& filter : filters::filter_table())
        for (const Parameter& p : filter.parameters) {
            if (p.kind != ParameterKind::integer && p.kind != ParameterKind::real)
                continue;
            const HostMesh& host = filter.needs_selection ? chosen : usual;
            SCOPED_TRACE(filter.menu_name + ", " + p.name);
            const auto refused = [&](const ParameterValue& value) {
                const std::string text = checks::error_of<InvalidParameter>([&] {
                    run(filter, host, {{p.name, value}});
                });
                EXPECT_EQ(text.rfind(p.name + ": expected ", 0), 0U) << text;
                EXPECT_TRUE(contains(text, "found "));
            };
            if (p.kind == ParameterKind::integer) {
                refused(static_cast<int>(p.minimum) - 1);
                if (p.maximum < 1e6) {
                    refused(static_cast<int>(p.maximum) + 1);
                }
            } else {
                refused(p.minimum - 1.0);
                refused(p.maximum + 1.0);
                refused(std::numeric_limits<double>::quiet_NaN());
            }
        }
}

TEST(DeclaredFilters, ChoicesOutOfRangeAreRefused) {
    const HostMesh host = prepared();
    for (const FilterDeclaration& filter : filters::filter_table())
        for (const Parameter& p : filter.parameters) {
            if (p.kind != ParameterKind::choice)
                continue;
            for (const int value : {-1, static_cast<int>(p.choices.size())})
                EXPECT_THROW(run(filter, host, {{p.name, value}}), InvalidParameter)
                    << filter.menu_name << ", " << p.name << ' ' << value;
        }
}

TEST(DeclaredFilters, FiltersOnTextureCoordinatesAskForThem) {
    HostMesh host;
    host.geometry = shapes::sphere(1);
    for (const FilterDeclaration& filter : filters::filter_table()) {
        if (filter.needs_selection)
            continue;
        if (!filter.needs_uv) {
            EXPECT_NO_THROW(run(filter, host, {})) << filter.menu_name;
            continue;
        }
        const std::string text = checks::error_of<InvalidMesh>([&] { run(filter, host, {}); });
        EXPECT_TRUE(contains(text, "expected wedge texture coordinates, found none"));
        EXPECT_TRUE(contains(text, "Charts: Flatten"));
    }
}

TEST(DeclaredFilters, FiltersOnSelectionsAskForThem) {
    HostMesh host;
    host.geometry = shapes::sphere(1);
    for (const FilterDeclaration& filter : filters::filter_table()) {
        if (!filter.needs_selection)
            continue;
        const std::string text = checks::error_of<InvalidMesh>([&] { run(filter, host, {}); });
        EXPECT_TRUE(contains(text, "expected selected")) << filter.menu_name;
        EXPECT_TRUE(contains(text, "found none"));
    }
}

TEST(DeclaredFilters, EveryFilterCanBeCancelled) {
    for (const FilterDeclaration& filter : filters::filter_table()) {
        const HostMesh host = prepared_for(filter);
        int calls = 0;
        Progress progress([&](double, const char*) { return ++calls < 1; });
        try {
            run_filter(filter, host, {}, progress);
            EXPECT_EQ(calls, 0) << filter.menu_name; // over before the host could be asked
        } catch (const Cancelled&) {
            EXPECT_EQ(calls, 1);
        }
    }
}

TEST(DeclaredFilters, ProgressNeverGoesBackAndPhasesHaveNames) {
    for (const FilterDeclaration& filter : filters::filter_table()) {
        const HostMesh host = prepared_for(filter);
        double last = 0.0;
        Progress progress([&](double fraction, const char* phase) {
            EXPECT_GE(fraction, last);
            EXPECT_LE(fraction, 1.0);
            last = fraction;
            EXPECT_NE(std::string(phase), "") << filter.menu_name;
            return true;
        });
        run_filter(filter, host, {}, progress);
    }
}

} // namespace
} // namespace devseg::declare
