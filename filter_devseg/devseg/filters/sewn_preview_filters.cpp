#include <algorithm>
#include <utility>

#include "devseg/declare/declare.h"
#include "devseg/pattern/sewn_preview.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr double red_at = 0.02; // of the diagonal: distances from here on are all red

constexpr const char* preview_help =
    "Shows the toy before it is cut: the pieces of the pattern are sewn together along their seams "
    "and stuffed, and the result is a new layer. Cloth is a net of springs with the lengths that "
    "the pieces have on paper, under the pressure of the stuffing; it starts from the model "
    "without its details and comes to rest where the pieces let it.<br>"
    "Faces of the layer are white where the toy is like the model and red where it is off by 2 % "
    "of the model's diagonal and more; the face quality is the distance in model units. Pieces are "
    "read from the texture coordinates, whoever made them.<br>"
    "See:<br><i>Sofien Bouaziz, Sebastian Martin, Tiantian Liu, Ladislav Kavan, Mark Pauly</i><br>"
    "<b>\"Projective Dynamics: Fusing Constraint Projections for Fast Simulation\"</b><br>"
    "ACM Transactions on Graphics (SIGGRAPH), 2014, doi:10.1145/2601097.2601116";

FilterOutput run_preview(const FilterInput& input, const pattern::SewnOptions& options,
                         Progress& progress) {
    const Mesh& mesh = input.mesh;
    auto sewing = progress.part("sewing and stuffing", 1.0);
    const pattern::SewnPreview preview = pattern::sew_and_inflate(mesh, *input.uv, options, sewing);
    LayerMesh layer;
    layer.name = "sewn preview";
    for (const Vec3& p : preview.points)
        layer.geometry.points.push_back(input.to_model(p));
    layer.geometry.faces = mesh.faces;
    for (const Triangle& t : mesh.faces) {
        double distance = 0.0;
        for (const Vertex v : t)
            distance += preview.distance[v] / 3.0;
        const double share = std::min(1.0, distance / (red_at * mesh.diagonal()));
        const auto fade = static_cast<std::uint8_t>(255.0 * (1.0 - share));
        layer.face_color.push_back({255, fade, fade});
        layer.face_quality.push_back(distance * mesh.unit_length);
    }
    FilterOutput output;
    output.values = {{"mean_distance_share", preview.mean_distance},
                     {"largest_distance_share", preview.largest_distance},
                     {"rounds_number", preview.rounds},
                     {"converged", preview.converged}};
    if (preview.stuffing < options.stuffing)
        output.notes.push_back("the faces are too long to hold the stuffing that was asked for: " +
                               std::to_string(preview.stuffing) +
                               " was used; remesh the model for more.");
    output.layer = std::move(layer);
    return output;
}

} // namespace

std::vector<FilterDeclaration> sewn_preview_filters() {
    using O = pattern::SewnOptions;
    return {Declare<O>("Pattern: Sewn Preview", "generate_sewn_preview", FilterCategory::texture,
                       preview_help)
                .real(&O::stuffing, "Stuffing",
                      "How much the stuffing stretches the cloth of a ball of the model's size, as "
                      "a share: 0.01 = 1 %.")
                .integer(&O::max_iterations, "Most steps",
                         "The simulation ends here at the latest; usually the cloth is at rest "
                         "before.")
                .needs_uv()
                .writes(writes_layer)
                .result("mean_distance_share", "mean distance of the sewn toy from the model, as a "
                                               "share of the model's diagonal")
                .result("largest_distance_share", "largest distance, as a share of the diagonal")
                .result("rounds_number", "steps of the simulation")
                .result("converged", "whether the cloth came to rest")
                .runs(run_preview)};
}

} // namespace devseg::filters
