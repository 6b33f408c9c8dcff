#include <cmath>
#include <string>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/texture.h"
#include "devseg/base/errors.h"
#include "devseg/declare/declare.h"
#include "devseg/filters/sheet_layout.h"
#include "devseg/flatten/flatten.h"
#include "devseg/pack/pack.h"

namespace devseg::filters {

using namespace declare;

namespace {

struct FlattenOptions {
    flatten::FlattenMethod method = flatten::FlattenMethod::symmetric_dirichlet;
    bool pack = true; // into the unit square; otherwise side by side in model units
    pack::PackEffort effort = pack::PackEffort::normal;
};

constexpr const char* flatten_help =
    "Lays every chart flat, positively oriented and with its own area, and writes the result as "
    "wedge texture coordinates: packed into the unit square at one common scale, or side by side "
    "in model units.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>. Without them "
    "they are read from existing texture coordinates, and without those each connected component "
    "of the mesh is a chart. Charts that are not disks are cut first. <b>Symmetric Dirichlet</b> "
    "keeps lengths as well as possible and never turns a face over; <b>ARAP</b> keeps lengths as "
    "well; <b>LSCM</b> and <b>ABF++</b> keep angles and change lengths more; <b>LPFB</b> keeps the "
    "length of every boundary edge instead of the area, for sewing, and strains the cloth inside "
    "as little as possible; <b>LPFB Even Areas</b> keeps the areas of faces instead, whatever "
    "their shapes. Charts on which a method turns faces over are flattened with Symmetric "
    "Dirichlet, and counted. Charts that are exactly developable, such as those that 'Charts: "
    "Deform to Exact Developability' leaves, are unfolded without any stretch, whatever the "
    "method. Parts of a chart that would lie on each other are pushed apart (Symmetric Dirichlet) "
    "or cut apart along a short path, and counted too.<br>"
    "See:<br><i>Jason Smith, Scott Schaefer</i><br>"
    "<b>\"Bijective Parameterization with Free Boundaries\"</b><br>"
    "ACM Transactions on Graphics (SIGGRAPH), 2015, doi:10.1145/2766947<br>"
    "<i>Bruno Lévy, Sylvain Petitjean, Nicolas Ray, Jérome Maillot</i><br>"
    "<b>\"Least Squares Conformal Maps for Automatic Texture Atlas Generation\"</b><br>"
    "ACM Transactions on Graphics (SIGGRAPH), 2002, doi:10.1145/566654.566590<br>"
    "<i>Alla Sheffer, Bruno Lévy, Maxim Mogilnitsky, Alexander Bogomyakov</i><br>"
    "<b>\"ABF++: Fast and Robust Angle Based Flattening\"</b><br>"
    "ACM Transactions on Graphics 24(2), 2005, doi:10.1145/1061347.1061354<br>"
    "<i>Ligang Liu, Lei Zhang, Yin Xu, Craig Gotsman, Steven J. Gortler</i><br>"
    "<b>\"A Local/Global Approach to Mesh Parameterization\"</b><br>"
    "Computer Graphics Forum (SGP), 2008, doi:10.1111/j.1467-8659.2008.01290.x<br>"
    "<i>Charlie C. L. Wang</i><br>"
    "<b>\"Computing Length-Preserved Free Boundary for Quasi-Developable Mesh "
    "Segmentation\"</b><br>"
    "IEEE Transactions on Visualization and Computer Graphics 14(1), 2008, "
    "doi:10.1109/TVCG.2007.1067";

constexpr const char* pack_help =
    "Packs the charts of existing texture coordinates, whoever made them, into the unit square: "
    "each at the scale of its area on the surface, by outline, so that charts lie in the holes and "
    "bays of others.<br>"
    "Charts are read from the texture coordinates and keep their shape; they are turned, but never "
    "mirrored.";

FilterOutput run_flatten(const FilterInput& input, const FlattenOptions& options,
                         Progress& progress) {
    auto cutting = progress.part("cutting charts to disks", 0.02);
    atlas::DiskCuts cuts = atlas::cut_charts_to_disks(input.mesh, find_charts(input), cutting);
    auto flattening = progress.part("flattening charts", options.pack ? 0.5 : 0.98);
    flatten::FlattenResult flattened =
        flatten::flatten_charts(input.mesh, cuts.charts, options.method, flattening);
    auto packing = progress.part("packing charts", progress.left());
    const SheetLayout layout = options.pack ? lay_out(input.mesh, flattened.flat,
                                                      packing_with(options.effort), 1.0, packing)
                                            : lay_out_in_rows(input.mesh, flattened.flat);

    FilterOutput output;
    int mended = 0;
    int pushed = 0;
    int developed = 0;
    bool converged = true;
    double energy = 0.0;
    for (const flatten::FlatChart& chart : flattened.flat) {
        pushed += chart.pushed ? 1 : 0;
        developed += chart.developed ? 1 : 0;
        mended += chart.mended ? 1 : 0;
        converged = converged && chart.converged;
        energy = std::max(energy, chart.energy);
    }
    output.values = {
        {"charts_number", flattened.charts.count},
        {"cut_charts_number", cuts.cut_charts},
        {"overlap_cuts_number", flattened.cuts},
        {"reattached_parts_number", flattened.reattached},
        {"developed_charts_number", developed},
        {"pushed_charts_number", pushed},
        {"mended_charts_number", mended},
        {"converged", converged},
        {"worst_chart_energy", energy},
        {"thin_charts_number", layout.thin},
    };
    if (cuts.cut_charts > 0)
        output.notes.push_back(std::to_string(cuts.cut_charts) +
                               " charts had to be cut open to disks first");
    if (mended > 0)
        output.notes.push_back(std::to_string(mended) + " charts had flipped faces and were "
                                                        "flattened with Symmetric Dirichlet");
    if (flattened.cuts > 0)
        output.notes.push_back(std::to_string(flattened.cuts) +
                               " cuts were made where parts of a chart lay on top of each other");
    note_unsettled(layout, output);
    output.uv = layout.uv;
    output.charts = std::move(flattened.charts);
    return output;
}

// A chart of existing texture coordinates at the scale of its area on the surface.
flatten::FlatChart read_flat_chart(const Mesh& mesh, const CornerUv& uv,
                                   atlas::ChartSurface surface) {
    flatten::FlatChart chart;
    double plane = 0.0;
    double area = 0.0;
    for (const Face f : surface.face) {
        plane += std::abs(plane::uv_area(uv, f));
        area += mesh.face_areas[f];
    }
    if (!(plane > 0.0))
        throw InvalidMesh("expected charts with an area in the plane, found one of " +
                              std::to_string(surface.face.size()) +
                              " faces without; run 'Charts: Flatten' first",
                          surface.face);
    chart.uv = atlas::read_map(surface, uv, Vec2::Constant(std::sqrt(area / plane)));
    chart.surface = std::move(surface);
    return chart;
}

FilterOutput run_pack(const FilterInput& input, const pack::PackOptions& options,
                      Progress& progress) {
    auto packing = progress.part("packing charts", 1.0);
    const atlas::ChartMap charts = atlas::charts_from_uv(input.mesh, *input.uv);
    std::vector<flatten::FlatChart> flat;
    for (atlas::ChartSurface& surface : atlas::extract_charts(input.mesh, charts))
        flat.push_back(read_flat_chart(input.mesh, *input.uv, std::move(surface)));
    const SheetLayout layout = lay_out(input.mesh, flat, options, 1.0, packing);
    FilterOutput output;
    output.values = {{"charts_number", charts.count}};
    note_unsettled(layout, output);
    output.uv = layout.uv;
    return output;
}

FilterDeclaration flatten() {
    using O = FlattenOptions;
    return Declare<O>("Charts: Flatten", "compute_texcoord_parametrization_charts_per_wedge",
                      FilterCategory::texture, flatten_help)
        .choice(
            &O::method, "method", "Method",
            {"Symmetric Dirichlet", "LSCM", "ABF++", "ARAP", "LPFB", "LPFB Even Areas"},
            "Symmetric Dirichlet: least change of lengths, no face turned over. LSCM: least "
            "change of angles, fast. ABF++: least change of angles, more even on curved "
            "charts. ARAP: lengths, milder where they cannot be kept. LPFB: every boundary "
            "edge keeps its length, so that both sides of a seam are equally long, with the least "
            "strain inside. LPFB Even Areas: the same, with even areas inside.")
        .boolean(&O::pack, "pack", "Pack into the unit square",
                 "On: all charts in the unit square at one common scale, for textures. Off: side "
                 "by side in rows and in model units, which takes no time.")
        .choice(&O::effort, "effort", "Effort of packing", effort_names(), effort_help)
        .on_part()
        .keeps()
        .writes(writes_charts | writes_uv)
        .result("charts_number", "charts")
        .result("cut_charts_number", "charts that had to be cut to disks first")
        .result("overlap_cuts_number", "cuts between parts of a chart that lay on each other")
        .result("reattached_parts_number", "small parts that were hinged to another chart then")
        .result("developed_charts_number", "charts that are exactly developable and were unfolded")
        .result("pushed_charts_number", "charts whose parts were pushed apart instead")
        .result("mended_charts_number", "charts that needed the injective method")
        .result("converged", "whether all charts reached the tolerance")
        .result("worst_chart_energy", "largest symmetric Dirichlet energy of a chart, 1 for an "
                                      "isometry, no unit")
        .result("thin_charts_number", "charts too thin for 32-bit coordinates, which stretch them; "
                                      "their faces are selected")
        .runs(run_flatten);
}

FilterDeclaration pack() {
    using O = pack::PackOptions;
    return Declare<O>("Charts: Pack", "apply_texcoord_chart_packing_per_wedge",
                      FilterCategory::texture, pack_help)
        .real(&O::padding, {"padding", 0.0, 0.1}, "Padding",
              "Least distance of two charts, as a share of the square's side.")
        .boolean(&O::allow_rotation, "allow_rotation", "Allow rotation",
                 "Turn charts to their best box and by quarter turns; off keeps the direction of "
                 "the texture.")
        .choice(&O::effort, "effort", "Effort", effort_names(), effort_help)
        .needs_uv()
        .on_part()
        .writes(writes_uv)
        .result("charts_number", "charts that were packed")
        .runs(run_pack);
}

} // namespace

std::vector<FilterDeclaration> flattening_filters() {
    return {flatten(), pack()};
}

} // namespace devseg::filters
