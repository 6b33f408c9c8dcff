// The filters that make charts from what the user has.
#include <numeric>
#include <string>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/texture.h"
#include "devseg/base/errors.h"
#include "devseg/curves/smooth_seams.h"
#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/edit/given_charts.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::edit {

using namespace declare;

namespace {

struct GivenOptions {
    bool cut_to_disks = true;
    bool smooth = false;
};

struct EdgesOptions : GivenOptions {
    bool complete_cuts = true; // lead ends inside the surface on
};

struct TextureOptions : GivenOptions {
    double weld_tolerance = 1e-6; // share of the layout's size

    static OptionRanges<TextureOptions> ranges() {
        return {{&TextureOptions::weld_tolerance, {"weld_tolerance", 0.0, 0.1}}};
    }
};

enum class Source { materials, face_colors, components };

struct MaterialsOptions : GivenOptions {
    Source source = Source::materials;
};

constexpr const char* edges_help =
    "Makes charts of the surface as the selected edges cut it. The borders of the selected faces "
    "count as selected, so that a region that was painted or lassoed becomes a chart. After a "
    "segmentation all of its seams are selected edges: select faces, and their border is added to "
    "the seams.<br>"
    "A cut that ends inside the surface is led on to another cut, to the border of the mesh, or to "
    "its own other end. It takes the shortest natural path ahead of it. Leaves the face attributes "
    "<b>chart_id</b> and <b>seam_edges</b> and a colour for each chart.";

constexpr const char* texture_help =
    "Makes charts of the islands of existing texture coordinates, such as Blender's seams leave in "
    "a file. An edge is a seam where the coordinates on its two sides differ.<br>"
    "Leaves the face attributes <b>chart_id</b> and <b>seam_edges</b> and a colour for each chart. "
    "'Charts: Flatten' then gives each island its true size.";

constexpr const char* materials_help =
    "Makes a chart of each connected region of one material, or of one face colour, or of each "
    "connected component of the mesh. Materials are the face attribute <b>material_id</b>; without "
    "it the texture image of each face.<br>"
    "Leaves the face attributes <b>chart_id</b> and <b>seam_edges</b> and a colour for each chart.";

constexpr const char* open_help =
    "Cuts the mesh open along the seams of its charts, darts and slits included. Each side gets "
    "vertices of its own, which other programs need that keep texture coordinates at vertices. "
    "Attributes are carried over.<br>"
    "Charts are read from the face attributes <b>chart_id</b> and <b>seam_edges</b>; without them "
    "from the wedge texture coordinates. 'Merge Close Vertices' closes the seams again.";

// Charts with their colours, cut to disks and with smooth seams if that is wanted, and the values
// that all filters of this kind return.
FilterOutput given_output(const FilterInput& input, atlas::ChartMap charts,
                          const GivenOptions& options, Progress& progress) {
    Index cut = 0;
    if (options.cut_to_disks) {
        auto cutting = progress.part("cutting charts to disks",
                                     (options.smooth ? 0.5 : 1.0) * progress.left());
        atlas::DiskCuts cuts = atlas::cut_charts_to_disks(input.mesh, charts, cutting);
        charts = std::move(cuts.charts);
        cut = cuts.cut_charts;
    }
    FilterOutput output;
    if (options.smooth) {
        auto smoothing = progress.part("smoothing seams", progress.left());
        curves::SmoothSeams made = curves::smooth_seams(input.mesh, charts, {}, smoothing);
        charts = std::move(made.charts);
        output.refinement = std::move(made.refinement);
    }
    const Mesh& mesh = output.refinement ? output.refinement->mesh : input.mesh;
    output.face_color = face_chart_colors(mesh, charts);
    output.values = {{"charts_number", charts.count},
                     {"cut_charts_number", cut},
                     {"seam_length", metrics::seam_length(mesh, charts)}};
    output.charts = std::move(charts);
    return output;
}

FilterOutput run_edges(const FilterInput& input, const EdgesOptions& options, Progress& progress) {
    const Mesh& mesh = input.mesh;
    if (input.selected.empty() && input.selected_edges.empty())
        throw InvalidMesh("expected selected edges or faces, found none; select some, such as with "
                          "'Select Crease Edges', or paint faces");
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    if (!input.selected.empty())
        seam = borders_of(mesh, input.selected);
    for (std::size_t h = 0; h < input.selected_edges.size(); ++h)
        seam[h] |= input.selected_edges[h];
    auto completing = progress.part("completing cuts", 0.5);
    CompletedCuts cuts;
    if (options.complete_cuts)
        cuts = complete_cuts(mesh, std::move(seam), completing);
    else
        cuts.seam = std::move(seam);
    FilterOutput output = given_output(
        input,
        atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), cuts.seam, true),
        options, progress);
    output.values.insert(output.values.end(), {{"completed_cuts_number", cuts.completed},
                                               {"loose_ends_number", cuts.loose}});
    return output;
}

FilterOutput run_texture(const FilterInput& input, const TextureOptions& options,
                         Progress& progress) {
    return given_output(input, atlas::charts_from_uv(input.mesh, *input.uv, options.weld_tolerance),
                        options, progress);
}

FilterOutput run_materials(const FilterInput& input, const MaterialsOptions& options,
                           Progress& progress) {
    std::vector<Index> label(input.mesh.faces.size(), 0);
    std::vector<std::string> notes;
    if (options.source == Source::materials) {
        if (input.material.empty())
            notes.emplace_back("the mesh has no materials: each component is a chart");
        else
            label = input.material;
    } else if (options.source == Source::face_colors) {
        if (input.color.empty())
            notes.emplace_back("the mesh has no face colours: each component is a chart");
        for (std::size_t f = 0; f < input.color.size(); ++f)
            label[f] = input.color[f][0] * 65536 + input.color[f][1] * 256 + input.color[f][2];
    }
    FilterOutput output =
        given_output(input, atlas::make_chart_map(input.mesh, label, {}, false), options, progress);
    output.notes = std::move(notes);
    return output;
}

FilterOutput run_open(const FilterInput& input, const NoOptions&, Progress& progress) {
    auto cutting = progress.part("cutting the mesh", 1.0);
    atlas::ChartMap charts = find_charts(input);
    FilterOutput output;
    std::vector<Index> all(input.mesh.faces.size());
    std::iota(all.begin(), all.end(), 0);
    output.fans = atlas::extract_surface(input.mesh, std::move(all), charts.seam).faces;
    output.values = {{"charts_number", charts.count},
                     {"seam_length", metrics::seam_length(input.mesh, charts)}};
    output.charts = std::move(charts);
    cutting.check();
    return output;
}

template <class O>
Declare<O> given(Declare<O> filter) {
    return filter
        .boolean(&O::cut_to_disks, "cut_to_disks", "Cut to disks",
                 "Cut charts that are not disks open, which flattening needs.")
        .boolean(
            &O::smooth, "smooth", "Smooth",
            "Make smooth curves of the new seams, which splits faces, as 'Charts: Smooth Seams' "
            "does with its usual values. Seams on creases stay on edges.")
        .on_part()
        .keeps()
        .writes(writes_charts | writes_color | writes_mesh)
        .result("charts_number", "charts")
        .result("cut_charts_number", "charts that were no disks and were cut open")
        .result("seam_length", "length of all cut edges, model units");
}

FilterDeclaration from_edges() {
    using O = EdgesOptions;
    return given(Declare<O>("Charts: From Selected Edges",
                            "compute_charts_from_selected_edges_per_face",
                            FilterCategory::remeshing, edges_help)
                     .boolean(&O::complete_cuts, "complete_cuts", "Complete cuts",
                              "Lead cuts that end inside the surface on. Off: they stay darts."))
        .needs_selection()
        .result("completed_cuts_number", "ends of cuts that were led on")
        .result("loose_ends_number", "ends of cuts that nothing lies ahead of, and that stay darts")
        .runs(run_edges);
}

FilterDeclaration from_texture() {
    using O = TextureOptions;
    return given(Declare<O>("Charts: From Texture Coordinates",
                            "compute_charts_from_texcoord_per_face", FilterCategory::remeshing,
                            texture_help)
                     .real(&O::weld_tolerance, "Largest difference",
                           "Coordinates that differ by less are the same, as a share of the size "
                           "of the whole layout."))
        .needs_uv()
        .runs(run_texture);
}

FilterDeclaration from_materials() {
    using O = MaterialsOptions;
    return given(Declare<O>("Charts: From Colors or Materials",
                            "compute_charts_from_materials_per_face", FilterCategory::remeshing,
                            materials_help)
                     .choice(&O::source, "source", "Source",
                             {"Materials", "Face colors", "Components"},
                             "Materials: regions of one material. Face colors: regions of one "
                             "colour. Components: connected components."))
        .runs(run_materials);
}

FilterDeclaration cut_open() {
    return Declare<NoOptions>("Charts: Cut Mesh Along Seams", "meshing_cut_along_seams",
                              FilterCategory::remeshing, open_help)
        .writes(writes_charts | writes_mesh)
        .result("charts_number", "charts, as many as before")
        .result("seam_length", "length of all cut edges, model units")
        .result(new_vertices_number, "vertices that were duplicated")
        .runs(run_open);
}

} // namespace

std::vector<FilterDeclaration> given_filters() {
    return {from_edges(), from_texture(), from_materials(), cut_open()};
}

} // namespace devseg::edit
