#include "devseg/mesh/inside_out.h"

#include <algorithm>
#include <cmath>

namespace devseg::mesh {

namespace {

// A closed surface with less volume than this share of a cube of its area has no inside.
constexpr double no_volume = 1e-9;

struct ClosedSurface {
    double volume = 0.0; // below 0: inside out
    double area = 0.0;
    bool is_closed = true;
    Eigen::AlignedBox3d box;
};

} // namespace

Index find_inside_out(const Mesh& mesh, std::vector<std::uint8_t>& marked) {
    const FaceComponents components = face_components(mesh, [](HalfEdge) { return true; });
    std::vector<ClosedSurface> surfaces(at(components.count));
    for (const Face f : mesh.all_faces()) {
        ClosedSurface& own = surfaces[components.label[f]];
        const auto [v, w, u] = mesh.faces[f];
        const Vec3& a = mesh.points[v];
        own.volume += a.cross(mesh.points[w]).dot(mesh.points[u]) / 6.0;
        own.area += 0.5 * (mesh.points[w] - a).cross(mesh.points[u] - a).norm();
        for (const HalfEdge h : half_edges_of(f)) {
            own.is_closed = own.is_closed && mesh.twin[h] >= 0;
            own.box.extend(mesh.points[mesh.origin(h)]);
        }
    }
    const auto turned = [](const ClosedSurface& s, double sign) {
        return s.is_closed && sign * s.volume > no_volume * std::pow(s.area, 1.5);
    };
    std::vector<std::uint8_t> inside_out(surfaces.size(), 0);
    for (std::size_t c = 0; c < surfaces.size(); ++c)
        inside_out[c] = turned(surfaces[c], -1.0) &&
                        std::none_of(surfaces.begin(), surfaces.end(), [&](const ClosedSurface& s) {
                            return turned(s, 1.0) && s.box.contains(surfaces[c].box);
                        });
    marked.assign(mesh.faces.size(), 0);
    for (const Face f : mesh.all_faces())
        marked[f] = inside_out[components.label[f]];
    return static_cast<Index>(std::count(inside_out.begin(), inside_out.end(), 1));
}

} // namespace devseg::mesh
