#include "devseg/mesh/flat_regions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace devseg::mesh {

namespace {

struct Tuning {
    // Normals of the faces of one plane differ by less (1e-3 rad): files with six digits.
    double parallel_cosine = 1.0 - 0.5e-6;
    // Of the root of the surface's area: needles have no normal, but they lie in the plane.
    double flat = 1e-6;
    double least_facet = 0.002; // of the surface
};
constexpr Tuning tuning;

// Whether the face lies in the plane of another one.
bool is_in_plane(const Mesh& mesh, Face f, Face of) {
    const Vec3& normal = mesh.face_normals[of];
    const double cosine = normal.dot(mesh.face_normals[f]);
    if (cosine >= tuning.parallel_cosine)
        return true;
    if (!(cosine > 0.0))
        return false;
    const double bound = tuning.flat * std::sqrt(mesh.total_area);
    return std::all_of(mesh.faces[f].begin(), mesh.faces[f].end(), [&](Index v) {
        return std::abs(normal.dot(mesh.points[v] - mesh.face_centers[of])) <= bound;
    });
}

} // namespace

FaceComponents flat_regions(const Mesh& mesh) {
    // Large faces first: their normals are the most exact.
    std::vector<Index> order(mesh.faces.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return mesh.face_areas[a] > mesh.face_areas[b]; });
    std::vector<Index> first_face(mesh.faces.size(), -1); // where the region began
    std::vector<Face> stack;
    for (const Face start : order) {
        if (first_face[start] >= 0)
            continue;
        first_face[start] = start;
        stack.push_back(start);
        while (!stack.empty()) {
            const Face f = stack.back();
            stack.pop_back();
            for (const HalfEdge h : half_edges_of(f)) {
                const Face g = mesh.across(h);
                if (g < 0 || first_face[g] >= 0 || !is_in_plane(mesh, g, start))
                    continue;
                first_face[g] = start;
                stack.push_back(g);
            }
        }
    }
    FaceComponents regions;
    std::vector<Index> number(mesh.faces.size(), -1);
    for (const Face f : mesh.all_faces()) {
        Index& n = number[first_face[f]];
        if (n < 0)
            n = regions.count++;
        regions.label.push_back(n);
    }
    return regions;
}

namespace {

std::vector<double> areas_of(const Mesh& mesh, const FaceComponents& regions) {
    std::vector<double> area(at(regions.count), 0.0);
    for (const Face f : mesh.all_faces())
        area[regions.label[f]] += mesh.face_areas[f];
    return area;
}

} // namespace

std::vector<std::uint8_t> within_flat_regions(const Mesh& mesh, double share) {
    const FaceComponents regions = flat_regions(mesh);
    const std::vector<double> area = areas_of(mesh, regions);
    std::vector<std::uint8_t> within(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index region = regions.label[face_of(h)];
        within[h] = mesh.twin[h] >= 0 && regions.label[mesh.across(h)] == region &&
                            area[region] >= share * mesh.total_area
                        ? 1
                        : 0;
    }
    return within;
}

std::vector<std::vector<Index>> flat_regions_with_holes(const Mesh& mesh, double share) {
    const FaceComponents regions = flat_regions(mesh);
    const std::vector<double> area = areas_of(mesh, regions);
    std::vector<std::vector<Index>> faces(at(regions.count));
    for (const Face f : mesh.all_faces())
        faces[at(regions.label[f])].push_back(f);
    std::vector<std::vector<Index>> found;
    for (std::vector<Index>& region : faces) {
        if (region.size() < 2 ||
            area[at(regions.label[at(region.front())])] < share * mesh.total_area)
            continue;
        std::set<Index> vertices;
        Index twice_edges = 0; // inner ones are met from both sides
        for (const Index f : region) {
            vertices.insert(mesh.faces[at(f)].begin(), mesh.faces[at(f)].end());
            for (const HalfEdge h : half_edges_of(Face(f))) {
                const Face g = mesh.across(h);
                twice_edges += g >= 0 && regions.label[g] == regions.label[at(f)] ? 1 : 2;
            }
        }
        const Index euler = static_cast<Index>(vertices.size()) - twice_edges / 2 +
                            static_cast<Index>(region.size());
        if (euler < 1)
            found.push_back(std::move(region));
    }
    return found;
}

void keep_regions_whole(const Mesh& mesh, double share, std::vector<Index>& label) {
    const FaceComponents regions = flat_regions(mesh);
    const std::vector<double> area = areas_of(mesh, regions);
    std::vector<std::map<Index, double>> shares(at(regions.count)); // by label
    for (const Face f : mesh.all_faces())
        if (area[regions.label[f]] >= share * mesh.total_area)
            shares[regions.label[f]][label[f]] += mesh.face_areas[f];
    for (const Face f : mesh.all_faces()) {
        const std::map<Index, double>& labels = shares[regions.label[f]];
        const auto largest =
            std::max_element(labels.begin(), labels.end(),
                             [](const auto& a, const auto& b) { return a.second < b.second; });
        if (largest != labels.end())
            label[f] = largest->first;
    }
}

Facets::Facets(const Mesh& mesh, Index count) {
    const FaceComponents regions = flat_regions(mesh);
    const std::vector<double> area = areas_of(mesh, regions);
    std::vector<Index> size(at(regions.count), 0);
    for (const Index r : regions.label)
        ++size[r];
    std::vector<Index> number(at(regions.count), -1);
    Index facets = 0;
    Index places = mesh.face_count();
    for (Index r = 0; r < regions.count; ++r)
        if (size[r] > 1 && area[r] >= tuning.least_facet * mesh.total_area) {
            number[r] = facets++;
            places -= size[r] - 1;
        }
    if (facets == 0 || places < count)
        return;
    for (const Index r : regions.label)
        number_.push_back(number[r]);
    faces_ = make_buckets<Index>(facets, [&](auto put) {
        for (const Face f : mesh.all_faces())
            if (number_[f] >= 0)
                put(number_[f], Index{f});
    });
}

} // namespace devseg::mesh
