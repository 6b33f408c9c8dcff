// How much of the surface and of the plane charts cover, and which of them cannot be cut out.
#pragma once

#include "devseg/atlas/texture.h"
#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// The end of errors about texture coordinates.
constexpr const char* flatten_first = "; run 'Charts: Flatten' first";

struct ChartAreas {
    std::vector<double> surface;      // of each chart, internal units squared
    std::vector<double> plane;        // of each chart, signed, uv units squared
    std::vector<double> covered;      // the same, faces counted without sign
    std::vector<double> surface_edge; // longest of each chart, internal units
    std::vector<double> plane_edge;   // the same in the plane, uv units
    double surface_total = 0.0;
    double plane_total = 0.0; // of all faces, without sign
    Index left_out = 0;       // small charts that have collapsed: their area in the plane is 0
    Index crumbs = 0;         // charts without an area worth cutting

    double scale = 1.0; // internal units for one unit of the texture coordinates
    bool is_crumb(std::size_t chart) const;
    // Signed areas in the plane, 0 for crumbs.
    std::vector<double> worth_cutting() const;
};

/// `scale`: internal units for one unit of the texture coordinates. Throws InvalidMesh where these
/// cover no area.
ChartAreas measure_charts(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts,
                          double scale);

/// Counts crumbs, and leaves small charts out that have collapsed. Throws InvalidMesh, with the
/// faces, where large ones have.
void check_charts(const atlas::ChartMap& charts, ChartAreas& areas);

/// Tells what is left out, and which pieces fold over.
void note_folds(Pattern& pattern, const ChartAreas& areas);

} // namespace devseg::pattern
