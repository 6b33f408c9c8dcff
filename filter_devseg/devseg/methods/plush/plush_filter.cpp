#include <algorithm>
#include <string>
#include <utility>

#include "devseg/declare/declare.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/material/material.h"
#include "devseg/methods/plush/plush_seams.h"
#include "devseg/metrics/segmentation.h"

namespace devseg::plush {

using namespace declare;

namespace {

constexpr const char* plush_help =
    "Finds the seams of a plush toy: patches that lie flat, with seams where people expect them: "
    "around limbs, along the skeleton and along sharp bends. Seams that may be are shortest paths "
    "between the tips and saddles of the surface, loops around limbs along concave lines, and cuts "
    "through patches that do not lie flat; left and right are the same where the model is "
    "symmetric. Then seams are taken away, the least natural first, as long as every patch, "
    "flattened with <b>LPFB</b>, strains the cloth by no more than a bound and does not lie on "
    "itself. What stays of a seam inside a patch is a dart. Turned and scaled models get "
    "the same seams. Some hundred thousand faces take minutes: simplify larger meshes first.<br>"
    "Leaves the face attributes <b>chart_id</b> (0 to n − 1) and <b>seam_edges</b> (bits 1, 2, 4: "
    "the face's edges that are cut), the same cuts as selected face-edges, the change of area as "
    "face quality and a colour for each patch. Every patch is a disk but for flat holes. Flatten "
    "them with 'Charts: Flatten', method LPFB: both sides of every seam keep their length.<br>"
    "See:<br><i>Charlie C. L. Wang</i><br>"
    "<b>\"Computing Length-Preserved Free Boundary for Quasi-Developable Mesh "
    "Segmentation\"</b><br>"
    "IEEE Transactions on Visualization and Computer Graphics 14(1), 2008, "
    "doi:10.1109/TVCG.2007.1067<br>"
    "<i>Andrea Tagliasacchi, Ibraheem Alhashim, Matt Olson, Hao Zhang</i><br>"
    "<b>\"Mean Curvature Skeletons\"</b><br>"
    "Computer Graphics Forum (SGP), 2012, doi:10.1111/j.1467-8659.2012.03178.x<br>"
    "<i>Mirela Ben-Chen, Craig Gotsman, Guy Bunin</i><br>"
    "<b>\"Conformal Flattening by Curvature Prescription and Metric Scaling\"</b><br>"
    "Computer Graphics Forum (Eurographics), 2008, doi:10.1111/j.1467-8659.2008.01142.x";

enum class MaterialBorders { none, selection, colors };

struct Options : PlushOptions {
    std::string skeleton_file;
    std::string material; // that sets max_strain where nobody else does
    MaterialBorders material_borders = MaterialBorders::none;
};

// 1 on the edges between faces of different materials; empty without materials.
std::vector<std::uint8_t> find_hard_seams(const FilterInput& input, MaterialBorders borders) {
    std::vector<std::uint8_t> hard;
    if (borders == MaterialBorders::none)
        return hard;
    const bool by_color = borders == MaterialBorders::colors;
    if (by_color ? input.color.empty() : input.selected.empty())
        throw InvalidParameter(by_color ? "material_borders: expected a mesh with face colours, "
                                          "found none; paint the faces or choose None"
                                        : "material_borders: expected selected faces, found none; "
                                          "select the faces of one material or choose None");
    const Mesh& mesh = input.mesh;
    hard.assign(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin < 0)
            continue;
        const Face f = face_of(h);
        const Face g = face_of(twin);
        hard[h] =
            by_color ? input.color[f] != input.color[g] : input.selected[f] != input.selected[g];
    }
    return hard;
}

std::string note_on_failed(const std::vector<Index>& charts, bool by_strain) {
    std::string names;
    for (const Index c : charts)
        names += (names.empty() ? "" : ", ") + std::to_string(c);
    return "patches above " + std::string(by_strain ? "max_strain" : "max_area_change") +
           " (chart_id): " + names +
           "; their faces are selected; a larger bound or a cleaner mesh helps";
}

// A material bounds the strain, unless max_strain was set.
Options with_limits(Options options) {
    if (options.material.empty())
        return options;
    const material::Material material = material::read_material(options.material);
    if (options.max_strain == Options().max_strain)
        options.max_strain = material.search_bound();
    return options;
}

FilterOutput run_plush(const FilterInput& input, const Options& given, Progress& progress) {
    const Mesh& mesh = input.mesh;
    const Options options = with_limits(given);
    const std::vector<std::uint8_t> hard = find_hard_seams(input, options.material_borders);
    Skeleton skeleton;
    if (!options.skeleton_file.empty())
        skeleton = read_skeleton(options.skeleton_file,
                                 [&](const Vec3& p) { return input.from_model(p); });
    PlushSeams seams = segment_plush_seams(mesh, options, std::move(skeleton), hard, progress);
    ResultValues values = {{"charts_number", seams.charts.count},
                           {"darts_number", seams.darts},
                           {"limbs_number", seams.limbs},
                           {"extrema_number", seams.extrema},
                           {"bones_number", seams.bones},
                           {"candidate_seams_number", seams.candidates},
                           {"trials_number", seams.trials},
                           {"largest_area_change", seams.max_area_change},
                           {"largest_strain", seams.strain.worst},
                           {"strain_99", seams.strain.most_of_it},
                           {"all_developable", seams.all_developable},
                           {"is_symmetric", seams.is_symmetric},
                           {"mirrored_share", seams.shares.mirrored},
                           {"guided_share", seams.shares.guided},
                           {"seam_length", metrics::seam_length(mesh, seams.charts)}};
    FilterOutput output = chart_output(mesh, std::move(seams.charts), std::move(seams.area_change),
                                       std::move(values));
    std::vector<std::uint8_t> failed(at(output.charts->count), 0);
    for (const Index c : seams.failed)
        failed[c] = 1;
    select_charts(failed, output);
    if (!seams.all_developable)
        output.notes.push_back(note_on_failed(seams.failed, options.max_strain > 0.0));
    return output;
}

Declare<Options> with_parameters(Declare<Options> filter) {
    using O = Options;
    return filter
        .real(&O::max_area_change, "Largest change of area",
              "How much the area of a face may change when its patch is flattened, as a share: "
              "0.15 = 15 %. Counts where max_strain is 0: flatten with LPFB Even Areas then.")
        .real(
            &O::max_strain, "Largest strain",
            "How much longer or shorter lines in the cloth may get when a patch is flattened, as a "
            "share. 0.2 allows 20 % on 99 % of each patch's area, and at most twice that anywhere. "
            "Woven cotton takes 0.05, fleece and minky 0.1 to 0.2. 0: patches are judged by "
            "max_area_change alone.")
        .text(
            &O::material, "material", "Material",
            "What the pieces are cut from: " + material::names() +
                ". A name may have values of its own, as in fleece, warp=0.12. It sets max_strain "
                "to the least of its limits, unless another one than the default is given.")
        .real(&O::geodesic_weight, "Weight of short seams",
              "Exponent of the length of an edge in its weight, without unit. Larger values make "
              "straighter seams.")
        .real(&O::skeleton_weight, "Weight of the skeleton",
              "Exponent of how far an edge turns away from the skeleton, without unit. Larger "
              "values lay seams along limbs and body.")
        .real(&O::curvature_weight, "Weight of curvature",
              "Exponent of the flatness at an edge, without unit. Larger values draw seams to "
              "sharp bends.")
        .integer(&O::max_extrema, "Most ends of seams",
                 "Tips and saddles between which seams may run, the most prominent ones; a number, "
                 "0 for at most the root of the number of vertices.")
        .text(
            &O::skeleton_file, "skeleton_file", "Skeleton file",
            "Path of a text file with joints and bones, as in OBJ files. Joints are lines v X Y Z, "
            "in model units; bones are lines l I J, joints counted from 1. Empty: the skeleton is "
            "found automatically on closed surfaces.")
        .choice(&O::material_borders, "material_borders", "Borders of materials",
                {"None", "Face selection", "Face colours"},
                "Seams that must be. None: no materials. Face selection: around the selected "
                "faces. Face colours: between faces of different colours.")
        .boolean(&O::symmetric, "symmetric", "Symmetric seams",
                 "Keep left and right the same where the model is nearly its own mirror image.")
        .integer(
            &O::max_iterations, "Most rounds",
            "Rounds of trials, of six removals each, in every step that takes seams away; they "
            "usually end before, when nothing more can go.")
        .integer(&O::random_seed, "Random seed",
                 "0 takes the least natural seams away first; other numbers change that order a "
                 "little at random. The same number always gives the same seams.");
}

FilterDeclaration plush() {
    return with_parameters(Declare<Options>("Segmentation: Plush Toy Seams",
                                            "compute_segmentation_plush_seams_per_face",
                                            FilterCategory::remeshing, plush_help))
        .command("plush", "lpfb")
        .on_part()
        .keeps()
        .writes(writes_charts | writes_quality | writes_color)
        .result("charts_number", "patches, each a disk but for flat holes")
        .result("darts_number", "seams that end inside a patch")
        .result("limbs_number", "limbs with a seam around their root, before seams were removed")
        .result("extrema_number", "tips and saddles that seams were laid between")
        .result("bones_number", "bones of the skeleton")
        .result("candidate_seams_number", "seams that there were before any was removed")
        .result("trials_number", "removals that were tried")
        .result("largest_area_change", "of a face in the accepted maps, as a share, no unit")
        .result("largest_strain", "of a face in the accepted maps, as a share, no unit; 0 where "
                                  "patches are judged by areas")
        .result("strain_99", "what 99 % of the area keeps, in the worst patch; 0 as above")
        .result(
            "all_developable",
            "whether all patches keep max_strain, or max_area_change; the faces of those that do "
            "not are selected")
        .result("is_symmetric", "whether the model was found to be symmetric")
        .result("mirrored_share", "of the seam length, that has its mirror image within 2 % of the "
                                  "model's diagonal; 0 without a mirror plane")
        .result(
            "guided_share",
            "of the seam length, that runs within 30 degrees of the skeleton, as it lies on the "
            "surface, on creases, or where limbs begin")
        .result("seam_length", "length of all cut edges, model units")
        .runs(run_plush);
}

} // namespace

std::vector<FilterDeclaration> filters() {
    return {plush()};
}

} // namespace devseg::plush
