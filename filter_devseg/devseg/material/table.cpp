#include "devseg/material/material.h"

namespace devseg::material {

namespace {

constexpr const char* claimed =
    "largest stretch along the threads: usual claim of pattern makers, not measured; all else "
    "assumed";
constexpr const char* assumed = "assumed";

// A sheet of one kind: the same in all directions.
Material even(const char* name, double stretch, double compression, const char* source) {
    Material material;
    material.name = name;
    material.warp = material.weft = material.bias = stretch;
    material.compression = compression;
    material.source = source;
    return material;
}

Material woven(const char* name, double threads, double bias, double compression,
               const char* source) {
    Material material = even(name, threads, compression, source);
    material.bias = bias;
    material.has_grain = true;
    material.allowance_mm = 7.0; // what books on sewing give where a pattern says nothing
    return material;
}

Material thick(Material material, double thickness, double radius, double k_factor) {
    material.thickness_mm = thickness;
    material.least_radius_mm = radius;
    material.k_factor = k_factor;
    return material;
}

Material cut(Material material, double allowance, double kerf) {
    material.allowance_mm = allowance;
    material.kerf_mm = kerf;
    return material;
}

Material napped(Material material) {
    material.has_nap = true;
    return material;
}

std::vector<Material> make_table() {
    return {
        thick(woven("cotton", 0.05, 0.10, 0.05, claimed), 0.3, 0.0, 0.5),
        thick(cut(woven("canvas", 0.02, 0.05, 0.02, assumed), 10.0, 0.0), 0.6, 0.5, 0.5),
        thick(cut(even("felt", 0.06, 0.06, assumed), 5.0, 0.1), 1.5, 0.5, 0.5),
        thick(woven("fleece", 0.10, 0.12, 0.10, claimed), 2.0, 0.0, 0.5),
        thick(napped(woven("minky", 0.12, 0.14, 0.12, assumed)), 2.5, 0.0, 0.5),
        thick(cut(even("leather", 0.01, 0.01, claimed), 5.0, 0.2), 1.2, 1.0, 0.5),
        thick(cut(even("vinyl", 0.03, 0.02, assumed), 10.0, 0.0), 1.0, 0.5, 0.5),
        thick(cut(even("neoprene", 0.10, 0.08, claimed), 5.0, 0.2), 3.0, 1.5, 0.5),
        thick(cut(even("foam", 0.08, 0.08, assumed), 0.0, 0.3), 5.0, 5.0, 0.5),
        thick(cut(even("paper", 0.002, 0.002, assumed), 0.0, 0.1), 0.1, 0.0, 0.5),
        thick(cut(even("card", 0.001, 0.001, assumed), 0.0, 0.1), 0.3, 0.3, 0.5),
        thick(cut(even("sheet-metal", 0.001, 0.001,
                       "K factor of bends in air for radii of one to three thicknesses: usual "
                       "tables of DIN 6935; all else assumed"),
                  0.0, 0.2),
              1.0, 1.0, 0.44),
    };
}

} // namespace

const std::vector<Material>& material_table() {
    static const std::vector<Material> table = make_table();
    return table;
}

const std::vector<MaterialValue>& material_values() {
    using M = Material;
    static const std::vector<MaterialValue> values = {
        {"warp", &M::warp, nullptr, 0.0, 2.0, "largest stretch along the grain, 0.05 = 5 %"},
        {"weft", &M::weft, nullptr, 0.0, 2.0, "largest stretch across the grain"},
        {"bias", &M::bias, nullptr, 0.0, 2.0, "largest stretch at 45 degrees between both"},
        {"compression", &M::compression, nullptr, 0.0, 0.99, "largest shrinkage, any direction"},
        {"thickness_mm", &M::thickness_mm, nullptr, 0.0, 1000.0, "thickness in mm"},
        {"least_radius_mm", &M::least_radius_mm, nullptr, 0.0, 1e4,
         "least radius of a bend on its inner side, mm"},
        {"k_factor", &M::k_factor, nullptr, 0.0, 1.0,
         "neutral line, share of the thickness from the inner side"},
        {"allowance_mm", &M::allowance_mm, nullptr, 0.0, 1e4, "seam allowance in mm"},
        {"kerf_mm", &M::kerf_mm, nullptr, 0.0, 100.0, "width of the cut in mm"},
        {"grain", nullptr, &M::has_grain, 0.0, 1.0, "directions differ: 1, or 0"},
        {"nap", nullptr, &M::has_nap, 0.0, 1.0, "all pieces lie the same way round: 1, or 0"},
    };
    return values;
}

} // namespace devseg::material
