// Gauss area: how much of the unit sphere the normals of a mesh element sweep. It stands for
// Gaussian curvature, but is bounded and needs no division by areas [YGZS05, section 3.2].
//
// References
//   [YGZS05] H. Yamauchi, S. Gumhold, R. Zayer, H.-P. Seidel: Mesh Segmentation Driven by Gaussian
//            Curvature. The Visual Computer 21, 2005. doi:10.1007/s00371-005-0319-x
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::metrics {

/// Absolute Gauss areas in steradians. Only creases and corners give edges and vertices an area;
/// elements on the mesh's boundary have none, as they never lie inside of a chart.
struct GaussAreas {
    std::vector<double> face;         // #F
    std::vector<double> edge;         // 3 #F: a half-edge and its twin agree
    std::vector<double> vertex;       // #V
    std::vector<std::uint8_t> crease; // 3 #F: edges that bend by more than the crease angle
    double total = 0.0;               // every element once
};

/// Area of the spherical polygon with these unit vectors as corners; positive if they run
/// counter-clockwise seen from outside. Fewer than three corners enclose nothing.
double signed_spherical_area(const std::vector<Vec3>& corners);

/// One unit normal for each corner, 3 #F: the faces around a vertex, split at its creases, share
/// one normal for each smooth part, weighted as in N. Max: Weights for Computing Vertex Normals
/// from Facet Normals, Journal of Graphics Tools 4, 1999. `crease` is 3 #F.
std::vector<Vec3> split_normals(const Mesh& mesh, const std::vector<std::uint8_t>& crease);

/// Edges that bend by more than `angle` (radians), 3 #F, symmetric.
std::vector<std::uint8_t> find_creases(const Mesh& mesh, double angle);

/// The creases that matter to a segmentation into `charts` charts, 3 #F: those in connected chains
/// of three quarters of an average chart's size and more. Shorter ones are noise of scans.
std::vector<std::uint8_t> long_creases(const Mesh& mesh, const std::vector<std::uint8_t>& crease,
                                       Index charts);

GaussAreas compute_gauss_areas(const Mesh& mesh, double crease_angle);

/// Gauss area of each chart [YGZS05, equation 2]: its faces, and those edges and vertices all of
/// whose faces belong to it. `chart` (#F) holds labels 0 … count − 1.
std::vector<double> chart_gauss_areas(const Mesh& mesh, const GaussAreas& areas,
                                      const std::vector<Index>& chart, Index count);

/// Standard deviation [YGZS05, equation 3, with the sum divided by the number of values].
double standard_deviation(const std::vector<double>& values);

} // namespace devseg::metrics
