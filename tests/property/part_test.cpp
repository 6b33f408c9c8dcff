// Filters on a part of random meshes, with seams that stay, and meshes cut open.
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/filters/table.h"
#include "property/cases.h"
#include "unit/checks.h"
#include "unit/host_checks.h"

namespace devseg {
namespace {

using checks::attempt;
using declare::FilterDeclaration;
using declare::HostMesh;
using declare::HostResult;
using shapes::Random;

// Random labels and cuts, made whole and flattened; nothing where the mesh is refused.
std::optional<HostMesh> random_atlas(const mesh::RawMesh& raw, Random& random) {
    HostMesh host = checks::host_of(raw);
    const Index labels = 1 + random.below(4);
    for (std::size_t f = 0; f < raw.faces.size(); ++f) {
        const bool same = f > 0 && random.below(8) > 0;
        host.chart_id.push_back(same ? host.chart_id.back() : random.below(labels));
        host.seam_edges.push_back(random.below(20) == 0 ? random.below(8) : 0);
    }
    const auto flat =
        attempt(*checks::filters_named("Charts: Flatten").at(0), host, {{"pack", false}}, true);
    if (!flat)
        return std::nullopt;
    checks::take_charts(host, *flat);
    host.wedge_uv = flat->wedge_uv;
    return host;
}

void select_some(HostMesh& host, Random& random) {
    for (std::size_t f = 0; f < host.geometry.faces.size(); ++f)
        host.face_selected.push_back(f > 0 && random.below(6) > 0 ? host.face_selected.back()
                                                                  : random.below(2) == 0);
    host.face_selected.front() = 1;
}

// Bits of the edges of each face on which a selected face lies.
std::vector<int> bits_to_selected(const HostMesh& host) {
    std::vector<int> bits(host.geometry.faces.size(), 0);
    for (const auto& [ends, faces] : checks::edges_of(host.geometry)) {
        bool selected = false;
        for (const auto& [f, edge] : faces)
            selected = selected || host.face_selected[f] != 0;
        for (const auto& [f, edge] : faces)
            bits[f] |= selected ? 1 << edge : 0;
    }
    return bits;
}

TEST(PropertyOfParts, NothingOutsideOfTheSelectionChanges) {
    std::set<std::string> ran;
    checks::for_random_cases(12, [&](Random& random) {
        const shapes::RandomMesh mesh = shapes::random_mesh(
            random, random.below(2) == 0 ? shapes::Defects::none : shapes::Defects::any);
        SCOPED_TRACE(mesh.recipe);
        auto host = random_atlas(mesh.raw, random);
        if (!host)
            return;
        select_some(*host, random);
        const std::vector<int> free_bits = bits_to_selected(*host);
        for (const FilterDeclaration& filter : filters::filter_table()) {
            if (!filter.on_part)
                continue;
            declare::ParameterValues values = checks::random_values(filter, 50, "", random);
            values["selected_only"] = true;
            SCOPED_TRACE(checks::described(filter, values));
            const auto r = attempt(filter, *host, values, true);
            if (!r)
                continue;
            ran.insert(filter.menu_name);
            for (std::size_t f = 0; f < host->geometry.faces.size(); ++f) {
                if (host->face_selected[f] != 0)
                    continue;
                ASSERT_TRUE(!r->untouched.empty() && r->untouched[f] != 0) << f;
                if (r->chart_id.empty())
                    continue;
                ASSERT_EQ(r->chart_id[f], static_cast<int>(host->chart_id[f])) << f;
                const int before = static_cast<int>(host->seam_edges[f]);
                ASSERT_EQ((r->seam_edges[f] ^ before) & ~free_bits[f], 0) << f;
            }
            if (r->refinement) {
                for (const declare::HostRefinement::Part& part : r->refinement->parts) {
                    ASSERT_NE(host->face_selected[part.source], 0);
                }
            }
        }
    });
    for (const FilterDeclaration& filter : filters::filter_table())
        EXPECT_EQ(ran.count(filter.menu_name) != 0, filter.on_part) << filter.menu_name;
}

TEST(PropertyOfParts, SeamsThatAreKeptStayInEveryFilter) {
    std::set<std::string> ran;
    checks::for_random_cases(12, [&](Random& random) {
        const shapes::RandomMesh mesh = shapes::random_mesh(random, shapes::Defects::none);
        SCOPED_TRACE(mesh.recipe);
        auto host = random_atlas(mesh.raw, random);
        if (!host)
            return;
        select_some(*host, random);
        for (const FilterDeclaration& filter : filters::filter_table()) {
            if (!filter.keeps)
                continue;
            declare::ParameterValues values = checks::random_values(filter, 50, "", random);
            values["keep"] = 1;
            values["selected_only"] = false;
            SCOPED_TRACE(checks::described(filter, values));
            const auto r = attempt(filter, *host, values, true);
            if (!r)
                continue;
            ran.insert(filter.menu_name);
            checks::expect_kept_seams(*host, *r);
        }
    });
    for (const FilterDeclaration& filter : filters::filter_table())
        EXPECT_EQ(ran.count(filter.menu_name) != 0, filter.keeps) << filter.menu_name;
}

// Two faces share an edge of the opened mesh if they did, and no seam lies on it. A slit of a
// single edge inside the surface opens nothing.
void expect_opened(const HostMesh& host, const HostResult& cut) {
    const mesh::RawMesh open = checks::refined(host.geometry, cut);
    const checks::Edges edges = checks::edges_of(host.geometry);
    const auto is_cut = [&](const auto& faces) {
        return faces.size() != 2 || (cut.seam_edges[faces[0].first] >> faces[0].second & 1) != 0;
    };
    std::vector<int> cuts(host.geometry.points.size(), 0); // at each vertex
    for (const auto& [ends, faces] : edges)
        for (const Index v : ends)
            cuts[at(v)] += is_cut(faces) ? 1 : 0;
    const auto ends_of = [&](const std::pair<std::size_t, int>& side) {
        const Triangle& t = open.faces[side.first];
        return std::set<Index>{t[at(side.second)], t[at((side.second + 1) % 3)]};
    };
    for (const auto& [ends, faces] : edges) {
        if (faces.size() != 2)
            continue;
        const bool is_slit = cuts[at(*ends.begin())] == 1 && cuts[at(*ends.rbegin())] == 1;
        ASSERT_EQ(ends_of(faces[0]) == ends_of(faces[1]), !is_cut(faces) || is_slit)
            << faces[0].first << ' ' << faces[1].first;
    }
    EXPECT_EQ(checks::value(cut, declare::new_vertices_number),
              static_cast<double>(open.points.size() - host.geometry.points.size()));
}

TEST(PropertyOfParts, AMeshIsCutOpenAtItsSeamsAndNowhereElse) {
    int runs = 0;
    checks::for_random_cases(30, [&](Random& random) {
        const shapes::RandomMesh mesh = shapes::random_mesh(random, shapes::Defects::none);
        SCOPED_TRACE(mesh.recipe);
        const auto host = random_atlas(mesh.raw, random);
        if (!host)
            return;
        const auto cut =
            attempt(*checks::filters_named("Charts: Cut Mesh").at(0), *host, {}, false);
        ASSERT_TRUE(cut);
        expect_opened(*host, *cut);
        ++runs;
    });
    EXPECT_GT(runs, 0);
}

} // namespace
} // namespace devseg
