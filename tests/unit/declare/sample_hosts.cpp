#include "unit/declare/sample_hosts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::declare::hosts {

namespace {

// The faces on one side of the origin.
void select_half(HostMesh& host) {
    for (const Triangle& t : host.geometry.faces)
        host.face_selected.push_back(host.geometry.points[t[0]].x() > 0.0 ? 1 : 0);
}

} // namespace

HostMesh chosen_by_hand(double bulge) {
    HostMesh host = checks::host_of(shapes::cylinder_tube(24, 12));
    for (Vec3& p : host.geometry.points) {
        const double up = std::abs(p.z() - host.geometry.points.front().z()) - 1.0;
        p.head<2>() *= 1.0 + bulge * (1.0 - up * up);
    }
    const std::vector<Vec3>& points = host.geometry.points;
    const auto angle = [](const Vec3& p) { return std::atan2(p.y(), p.x()); };
    const double low = points.front().z();
    for (const Triangle& t : host.geometry.faces) {
        const Vec3 middle = (points[t[0]] + points[t[1]] + points[t[2]]) / 3.0;
        const double height = std::abs(middle.z() - low);
        const double wave = 0.2 * std::sin(9.0 * height); // borders are not as short as can be
        host.chart_id.push_back(
            std::floor((std::clamp(angle(middle) + wave, -pi, 3.1) + pi) / (0.5 * pi)));
        host.seam_edges.push_back(0.0);
        host.face_color.push_back(height < 1.0 ? Color{255, 0, 0} : Color{0, 0, 255});
        host.face_selected.push_back(std::abs(angle(middle)) < 0.5 && height < 1.0 ? 1 : 0);
        int bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 edge = 0.5 * (points[t[k]] + points[t[(k + 1) % 3]]);
            if (std::abs(angle(edge) - 0.25 * pi) < 1e-6 && std::abs(edge.z() - low) > 1.1)
                bits |= 1 << k;
        }
        host.edge_selected.push_back(static_cast<std::uint8_t>(bits));
    }
    for (const Vec3& p : points)
        host.vertex_selected.push_back(std::abs(angle(p) - 0.25 * pi) < 1e-6 &&
                                               std::abs(std::abs(p.z() - low) - 1.0) < 0.1
                                           ? 1
                                           : 0);
    return host;
}

HostMesh halves_of_a_ball() {
    HostMesh host = checks::host_of(shapes::sphere(3));
    std::array<int, 2> seen{};
    for (const Triangle& t : host.geometry.faces) {
        const double x = (host.geometry.points[t[0]] + host.geometry.points[t[1]]).x() +
                         host.geometry.points[t[2]].x();
        const std::size_t side = x > 0.0 ? 1 : 0;
        host.chart_id.push_back(static_cast<double>(side));
        host.face_selected.push_back(seen[side]++ == 30 ? 1 : 0);
        host.edge_selected.push_back(7);
        std::array<Vec2, 3>& corners = host.wedge_uv.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = host.geometry.points[t[k]].head<2>();
    }
    return host;
}

HostMesh prepared() {
    HostMesh host = checks::host_of(shapes::with_noise(shapes::torus(24, 14, 2.0, 0.9), 0.03, 4));
    const HostResult flat = checks::run("Charts: Flatten", host);
    checks::take_charts(host, flat);
    host.wedge_uv = flat.wedge_uv;
    for (std::array<Vec2, 3>& corners : host.wedge_uv)
        for (Vec2& p : corners)
            p = Eigen::Rotation2Dd(0.5) * p; // no box stands upright
    select_half(host);
    return host;
}

HostMesh textured() {
    HostMesh host = prepared();
    host.wedge_uv = checks::run("Charts: Pack", host).wedge_uv;
    plane::Image image{8, 8, {}};
    for (int i = 0; i < 3 * 64; ++i)
        image.rgb.push_back(static_cast<std::uint8_t>(i));
    host.textures = {std::move(image)};
    host.uv_before.assign(host.wedge_uv.size(), {Vec2(0.1, 0.1), Vec2(0.9, 0.2), Vec2(0.3, 0.8)});
    host.page_before.assign(host.wedge_uv.size(), 0);
    return host;
}

HostMesh cubes_and_a_finger() {
    mesh::RawMesh all = shapes::finger(12, 20, 1.0, 9.0);
    for (int i = 1; i <= 20; ++i)
        all = shapes::join(all, shapes::moved(shapes::cube(2), 1.0, Vec3(3.0 * i, 0.0, 0.0)));
    return checks::host_of(all);
}

HostMesh bumpy_body() {
    mesh::RawMesh raw = shapes::sphere(3);
    for (Vec3& p : raw.points) {
        p *= 1.0 + 0.25 * std::sin(4.0 * p.z() + 1.0) + 0.1 * std::cos(3.0 * p.x() + p.z());
        p.z() *= 2.2;
    }
    return checks::host_of(raw);
}

HostMesh wedge_of_a_cone() {
    HostMesh host = checks::host_of(shapes::cone(24, 8, 1.0, 2.0));
    for (const Triangle& t : host.geometry.faces) {
        Vec3 centre = Vec3::Zero();
        for (const Index v : t)
            centre += host.geometry.points[v] / 3.0;
        host.chart_id.push_back(std::abs(std::atan2(centre.y(), centre.x())) < 0.5 ? 1 : 0);
    }
    return host;
}

HostMesh tube_laid_out() {
    HostMesh host = checks::host_of(shapes::cylinder_tube(12, 3));
    for (const Triangle& t : host.geometry.faces) {
        std::array<Vec2, 3> uv;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& p = host.geometry.points[at(t[k])];
            uv[k] = Vec2(0.5, 0.5) + 0.1 * (2.0 + p.z()) * p.head<2>();
        }
        host.wedge_uv.push_back(uv);
    }
    return host;
}

} // namespace devseg::declare::hosts
