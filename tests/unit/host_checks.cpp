#include "unit/host_checks.h"

#include <array>
#include <stdexcept>

#include <gtest/gtest.h>

#include "devseg/filters/table.h"

namespace devseg::checks {

declare::HostResult run(const std::string& menu_name, const declare::HostMesh& host,
                        const declare::ParameterValues& values) {
    Progress progress;
    for (const declare::FilterDeclaration& filter : filters::filter_table())
        if (filter.menu_name == menu_name)
            return declare::run_filter(filter, host, values, progress);
    throw std::logic_error("no such filter");
}

double number(const declare::ParameterValue& value) {
    if (const auto* b = std::get_if<bool>(&value))
        return *b ? 1.0 : 0.0;
    if (const auto* i = std::get_if<int>(&value))
        return *i;
    if (const auto* d = std::get_if<double>(&value))
        return *d;
    return 0.0; // texts
}

double value(const declare::HostResult& result, const std::string& name) {
    for (const auto& [key, v] : result.values)
        if (key == name)
            return std::holds_alternative<int>(v) ? std::get<int>(v) : std::get<double>(v);
    ADD_FAILURE() << "no value " << name;
    return 0.0;
}

double sound_charts(const declare::HostResult& measures) {
    return value(measures, "disk_charts_number") + value(measures, "holed_charts_number");
}

declare::HostMesh host_of(const mesh::RawMesh& raw) {
    declare::HostMesh host;
    host.geometry = raw;
    return host;
}

void take_charts(declare::HostMesh& host, const declare::HostResult& result) {
    host.chart_id.assign(result.chart_id.begin(), result.chart_id.end());
    host.seam_edges.assign(result.seam_edges.begin(), result.seam_edges.end());
}

mesh::RawMesh refined(mesh::RawMesh raw, const declare::HostResult& result) {
    if (!result.refinement)
        return raw;
    const mesh::RawMesh old = raw;
    const auto place = [&](Index face, const Vec3& weights) {
        Vec3 sum = Vec3::Zero();
        for (Index k = 0; k < 3; ++k)
            sum += weights[k] * old.points.at(at(old.faces.at(at(face))[at(k)]));
        return sum;
    };
    for (const declare::HostRefinement::Point& p : result.refinement->points)
        raw.points.push_back(place(p.face, p.weights));
    for (const declare::HostRefinement::Part& part : result.refinement->parts) {
        if (at(part.face) >= raw.faces.size())
            raw.faces.resize(at(part.face) + 1);
        raw.faces[part.face] = part.corners;
        for (Index k = 0; k < 3; ++k)
            EXPECT_LT(
                (place(part.source, part.weights[at(k)]) - raw.points.at(at(part.corners[at(k)])))
                    .norm(),
                1e-9);
    }
    return raw;
}

Edges edges_of(const mesh::RawMesh& raw) {
    Edges edges;
    for (std::size_t f = 0; f < raw.faces.size(); ++f)
        for (std::size_t e = 0; e < 3; ++e)
            edges[{raw.faces[f][e], raw.faces[f][(e + 1) % 3]}].emplace_back(f,
                                                                             static_cast<int>(e));
    return edges;
}

namespace {

// The same faces with the first of the vertices at each place.
mesh::RawMesh joined(mesh::RawMesh raw) {
    std::map<std::array<double, 3>, Index> first;
    for (Triangle& t : raw.faces)
        for (Index& v : t) {
            const Vec3& p = raw.points[v];
            v = first.emplace(std::array<double, 3>{p.x(), p.y(), p.z()}, v).first->second;
        }
    return raw;
}

} // namespace

void expect_agreement(const mesh::RawMesh& raw, const declare::HostResult& result) {
    ASSERT_EQ(result.chart_id.size(), raw.faces.size());
    ASSERT_EQ(result.seam_edges.size(), raw.faces.size());
    const Edges places = edges_of(joined(raw));
    std::set<std::pair<std::size_t, int>> alone; // edges on which no other one lies
    for (const auto& [ends, faces] : places)
        if (faces.size() == 1)
            alone.insert(faces[0]);
    for (const auto& [ends, faces] : edges_of(raw)) {
        if (ends.size() < 2)
            continue; // of faces that repeat a vertex
        const auto bit = [&](std::size_t i) {
            return result.seam_edges[faces[i].first] >> faces[i].second & 1;
        };
        if (faces.size() == 1 && alone.count(faces[0]) != 0) {
            ASSERT_EQ(bit(0), 0) << "the mesh's own border is no seam";
        } else if (faces.size() == 2) {
            ASSERT_EQ(bit(0), bit(1));
            if (result.chart_id[faces[0].first] != result.chart_id[faces[1].first]) {
                ASSERT_EQ(bit(0), 1) << "faces " << faces[0].first << " and " << faces[1].first;
            }
        }
    }
}

void expect_kept_seams(const declare::HostMesh& host, const declare::HostResult& result) {
    const Edges edges = edges_of(refined(host.geometry, result));
    for (const auto& [ends, faces] : edges_of(host.geometry))
        for (const auto& [f, edge] : faces) {
            if ((static_cast<int>(host.seam_edges[f]) >> edge & 1) == 0)
                continue;
            const auto now = edges.find(ends);
            ASSERT_NE(now, edges.end()) << "a seam of face " << f << " was split";
            for (const auto& [g, side] : now->second)
                ASSERT_EQ(result.seam_edges[g] >> side & 1, 1) << f;
        }
}

double signed_area(const std::array<Vec2, 3>& triangle) {
    const Vec2 p = triangle[1] - triangle[0];
    const Vec2 q = triangle[2] - triangle[0];
    return 0.5 * (p.x() * q.y() - p.y() * q.x());
}

double area_on_surface(const mesh::RawMesh& raw, std::size_t face) {
    const Triangle& t = raw.faces[face];
    return 0.5 *
           (raw.points[t[1]] - raw.points[t[0]]).cross(raw.points[t[2]] - raw.points[t[0]]).norm();
}

} // namespace devseg::checks
