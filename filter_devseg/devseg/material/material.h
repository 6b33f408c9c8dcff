// Materials that pieces are cut from: what they bear, how thick they are, and how they lie.
//
// The table is the only place for their values; docs/materials.md is written from it.
//
// References
//   J. W. S. Hearle, P. Grosberg, S. Backer: Structural Mechanics of Fibers, Yarns, and Fabrics.
//   Wiley, 1969: woven cloth is stiff along its threads and soft on the bias. DIN 6935:2011:
//   bending of flat steel, the neutral line and least radii.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace devseg::material {

/// Shares of a length: 0.05 = 5 %.
struct Material {
    std::string name;
    double warp = 0.05;        // how much longer lines along the grain may get,
    double weft = 0.05;        // across it,
    double bias = 0.05;        // and at 45 degrees between both
    double compression = 0.05; // how much shorter lines may get, in every direction
    double thickness_mm = 0.0;
    double least_radius_mm = 0.0; // of a bend, on its inner side
    double k_factor = 0.5;        // neutral line: share of the thickness from the inner side
    double allowance_mm = 0.0;    // of seams
    double kerf_mm = 0.0;         // width of what a laser or blade burns away
    bool has_grain = false;       // directions differ: pieces lie along the grain
    bool has_nap = false;         // and all the same way round
    std::string source;           // of the values; "assumed" where nothing was measured

    /// The limit at this angle from the grain, radians: warp, weft and bias at 0, 90 and 45
    /// degrees, and smooth between them.
    double stretch_limit(double angle) const;
    /// What is within the limits in every direction.
    double least_limit() const;
    /// The same as a bound of a search, where 0 would be none.
    double search_bound() const;
};

/// Of one value of a material: its key in texts and files, what it means, and its range.
struct MaterialValue {
    const char* key;
    double Material::*number; // one of the two
    bool Material::*flag;
    double least;
    double most;
    const char* meaning;
};
const std::vector<MaterialValue>& material_values();

/// All presets, in the order of the table.
const std::vector<Material>& material_table();

/// Their names, with commas.
std::string names();

/// A preset, or one with values of its own: "fleece", or "fleece, warp=0.12, thickness_mm=2".
/// Throws InvalidParameter for unknown names and keys, and for values outside of their range.
Material read_material(const std::string& text);

} // namespace devseg::material
