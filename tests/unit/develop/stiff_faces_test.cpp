// Flat faces with holes in deformations.
#include <algorithm>

#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/flat_cuts.h"
#include "devseg/develop/attempts.h"
#include "devseg/develop/deform.h"
#include "devseg/develop/stiff_faces.h"
#include "devseg/methods/papercraft/papercraft.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::develop {
namespace {

std::vector<Index> every_point(const Mesh& mesh) {
    std::vector<Index> point_of;
    for (const Vertex v : mesh.all_vertices())
        point_of.push_back(v);
    return point_of;
}

Index stiff_count(const Mesh& mesh) {
    const StiffFaces stiff = find_stiff_faces(mesh, every_point(mesh));
    return static_cast<Index>(std::count(stiff.fixed.begin(), stiff.fixed.end(), 1));
}

// A slab of coordinates with five digits, so that its faces with holes are flat only nearly.
Mesh rough_slab(const shapes::Mask& mask) {
    return checks::gated(shapes::with_noise(shapes::slab(mask), 1e-5, 3));
}

// Of the faces with holes whose points are all fixed: how far their normals are apart.
double largest_turn(const Mesh& mesh, const std::vector<std::uint8_t>& fixed) {
    double largest = 0.0;
    for (const atlas::HoledFace& face : atlas::flat_faces_with_holes(mesh)) {
        Face first;
        for (const Index i : face.faces) {
            const Face f(i);
            const Triangle& t = mesh.faces[f];
            if ((fixed[at(t[0])] & fixed[at(t[1])] & fixed[at(t[2])]) == 0)
                continue;
            first = first < 0 ? f : first;
            largest = std::max(largest, (mesh.face_normals[f] - mesh.face_normals[first]).norm());
        }
    }
    return largest;
}

TEST(StiffFaces, LieInTheirPlanesAroundHoles) {
    EXPECT_EQ(stiff_count(rough_slab({"###", "###", "###"})), 0);
    const Mesh mesh = rough_slab({"###########", "#.#########", "###########"});
    const StiffFaces stiff = find_stiff_faces(mesh, every_point(mesh));
    EXPECT_GT(stiff_count(mesh), 16); // the hole's own, above and below
    EXPECT_LT(stiff_count(mesh), 40); // and not the far end
    const Mesh flat = with_points(mesh, stiff.points);
    EXPECT_GT(largest_turn(mesh, stiff.fixed), 1e-6);
    EXPECT_LT(largest_turn(flat, stiff.fixed), 1e-9);
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        EXPECT_LT((flat.points[v] - mesh.points[v]).norm(),
                  stiff.fixed[v] != 0 ? 1e-4 * diagonal_of(mesh.points) : 1e-15);
}

TEST(Deform, HolesOfFlatFacesStayExact) {
    const Mesh mesh = rough_slab(shapes::mask_with_holes(2));
    papercraft::PapercraftOptions wanted;
    wanted.deform = papercraft::Deform::always;
    wanted.charts_number = 4;
    Progress progress;
    const atlas::ChartMap charts = papercraft::segment_papercraft(mesh, wanted, progress).charts;
    const auto exact_holes = [&](bool keep_holes) {
        DeformOptions options;
        options.keep_holes = keep_holes;
        const DeformResult result =
            deform_to_developable(mesh, charts, every_point(mesh), options, progress);
        EXPECT_TRUE(result.converged);
        const Mesh moved = with_points(mesh, result.points);
        Index holes = 0;
        for (const atlas::ChartSurface& s : atlas::extract_charts(moved, result.charts))
            for (const std::uint8_t exact : atlas::flat_holes(moved, s, atlas::HoleRule::exact()))
                holes += exact;
        return holes;
    };
    EXPECT_EQ(exact_holes(true), 4);
    EXPECT_LT(exact_holes(false), 4);
}

} // namespace
} // namespace devseg::develop
