// A filter, declared once: both host adapters, the documentation and the tests read these records.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/atlas/texture.h"
#include "devseg/base/progress.h"
#include "devseg/mesh/input_gate.h"
#include "devseg/mesh/refinement.h"
#include "devseg/plane/image.h"

namespace devseg::declare {

using plane::Color;

/// A mesh of its own, in model units or millimetres as the filter says.
struct LayerMesh {
    std::string name;
    mesh::RawMesh geometry;
    std::vector<Color> face_color;                                         // #F
    std::vector<double> face_quality;                                      // #F
    std::vector<std::pair<std::string, std::vector<int>>> face_attributes; // by name, #F each
};

enum class ParameterKind { boolean, integer, real, choice, text, output_file };
// A choice is the int of its position, texts and file names are UTF-8.
using ParameterValue = std::variant<bool, int, double, std::string>;
using ParameterValues = std::map<std::string, ParameterValue>;

struct Parameter {
    std::string name;  // snake_case: the word in C++, scripts and Python
    std::string label; // for dialogs
    std::string help;  // meaning, unit, usual values
    ParameterKind kind = ParameterKind::real;
    ParameterValue default_value;
    double minimum = 0.0; // integers and reals
    double maximum = 0.0;
    std::vector<std::string> choices;
};

/// A number that a filter returns. Text and unsigned sizes do not survive the hosts.
using ResultValue = std::variant<bool, int, double, std::vector<double>>;
using ResultValues = std::vector<std::pair<std::string, ResultValue>>;
struct ResultField {
    std::string name;
    std::string meaning; // with unit
};

/// One number of each record, by a member or a function.
template <class Record, class Number>
std::vector<double> column(const std::vector<Record>& records, Number number) {
    std::vector<double> values;
    for (const Record& record : records)
        values.push_back(static_cast<double>(std::invoke(number, record)));
    return values;
}

/// The menu of the host that the filter belongs to.
enum class FilterCategory { remeshing, texture, color, measure };

/// What a filter leaves on the mesh, as bits.
enum Writes : unsigned {
    writes_nothing = 0,
    writes_charts = 1, // chart_id, seam_edges and the face-edge selection
    writes_quality = 2,
    writes_color = 4,
    writes_uv = 8,
    writes_layer = 16,   // a new mesh; the host's own stays as it is
    writes_points = 32,  // coordinates of the vertices
    writes_mesh = 64,    // faces are split: new faces and vertices
    writes_texture = 128 // an image for the wedge texture coordinates, instead of the old ones
};

/// What filters see of a mesh: checked, in internal units.
struct FilterInput {
    const Mesh& mesh;
    std::optional<atlas::ChartMap> charts;    // from chart_id and seam_edges, if the mesh has them
    std::optional<CornerUv> uv;               // wedge texture coordinates, if the mesh has them
    const std::vector<Index>& source_face;    // #F: the host's number of each face, for results
    const std::vector<Index>& source_vertex;  // #V: the host's number of each vertex; the parts of
                                              // a vertex that the gate had to split share one
    std::vector<std::uint8_t> selected;       // #F: 1 for selected faces; empty if none is
    std::vector<Color> color;                 // #F; empty if the mesh has no face colours
    Vec3 center = Vec3::Zero();               // model coordinates of the mesh's origin
    std::vector<Index> chart_id;              // #F: as the host has them; empty if it has none
    std::vector<Index> material;              // #F; empty if the host has none
    std::vector<std::uint8_t> selected_edges; // 3 #F, symmetric; empty if none is
    std::vector<std::uint8_t> selected_vertices; // #V; empty if none is
    std::optional<CornerUv> uv_before; // that fit the textures, for filters that need them
    std::vector<Index> page_before;    // #F: number of the texture
    std::vector<plane::Image> textures;
    std::vector<Color> corner_color; // 3 #F, of the model itself; empty if it has none

    /// Between internal units and model coordinates.
    Vec3 to_model(const Vec3& p) const { return center + mesh.unit_length * p; }
    Vec3 from_model(const Vec3& p) const { return (p - center) / mesh.unit_length; }
    /// A mesh of this one's units with its points where the host keeps them, in 32 bits: whether
    /// the parts of a chart come apart may hang on the last digit.
    Mesh as_stored(const Mesh& made) const;
};

constexpr const char* new_vertices_number = "new_vertices_number";

struct FilterOutput {
    std::optional<atlas::ChartMap> charts;
    std::optional<std::vector<double>> face_quality; // #F
    std::optional<std::vector<Color>> face_color;    // #F
    std::optional<CornerUv> uv;
    std::optional<std::vector<Vec3>> points; // #V, internal units
    std::optional<LayerMesh> layer;
    std::optional<mesh::Refinement> refinement; // charts, quality and colours are of its faces then
    bool charts_go_on = false; // the charts of a refinement are those that the mesh has already
    // #F: numbers of corners, to cut the host's mesh open: those of one vertex with the same number
    // stay together. How many vertices that adds comes with the values (new_vertices_number).
    std::optional<std::vector<Triangle>> fans;
    std::optional<plane::Image> texture;
    std::vector<std::uint8_t> untouched; // #F of the mesh: 1 where all stays as it is
    std::vector<std::uint8_t> selected;  // #F: 1 for faces that need a look; empty: the selection
                                         // stays
    ResultValues values;
    std::vector<std::string> notes; // for the user, one sentence each
    std::function<void()> save;     // writes the filter's file, if it has one: comes last, because
                                    // what fails leaves none
};

/// What the command line makes of a segmentation filter.
struct Command {
    std::string name;     // of --method; empty: not offered
    std::string flatten;  // --flatten, where none is given
    std::string preset;   // --preset, where none is given; empty: that of the export
    bool deforms = false; // charts are deformed to exact developability
};

struct FilterDeclaration {
    std::string menu_name;
    std::string python_name;
    std::string help; // HTML
    FilterCategory category = FilterCategory::remeshing;
    unsigned writes = writes_nothing;
    bool needs_uv = false;
    bool needs_selection = false; // of faces, edges or vertices, where no parameter names charts
    bool shows_outside = false;   // closed surfaces that are inside out are turned over
    bool needs_texture = false;   // and the coordinates that fit them
    bool takes_surface = false;   // the same and colours, where its parameter `texture` asks for it
    bool on_part = false;         // takes `selected_only` (declare/part.h)
    bool keeps = false;           // takes `keep`
    std::vector<Parameter> parameters;
    std::vector<ResultField> results;
    Command command;
    std::function<FilterOutput(const FilterInput&, const ParameterValues&, Progress&)> run;
};

/// Whether a run with these values reads what the surface looks like.
bool wants_surface(const FilterDeclaration& filter, const ParameterValues& values);

/// `weld`, the parameter of every filter: which vertices are read as one (mesh::GateOptions).
Parameter weld_parameter();

/// Charts of the mesh's attributes; without them, those of its texture coordinates; without those,
/// its connected components.
atlas::ChartMap find_charts(const FilterInput& input);

/// A mesh as a host has it; per-face data is for all faces or empty.
struct HostMesh {
    mesh::RawMesh geometry;
    std::vector<double> chart_id;
    std::vector<double> seam_edges; // bits 1, 2, 4
    std::vector<std::array<Vec2, 3>> wedge_uv;
    std::vector<std::uint8_t> face_selected; // 1 for selected faces
    std::vector<Color> face_color;
    std::vector<std::uint8_t> edge_selected;   // of each face: bits 1, 2, 4, as seam_edges
    std::vector<std::uint8_t> vertex_selected; // #V: 1 for selected vertices
    std::vector<Index> face_material;
    // For filters that need textures: the images, and what fits them.
    std::vector<std::array<Vec2, 3>> uv_before;
    std::vector<Index> page_before;
    std::vector<plane::Image> textures;
    std::vector<std::array<Color, 3>> corner_color; // of the model itself, where a filter wants it
};

/// How the host's own faces are split. All that a host keeps for its faces and vertices is carried
/// over: a part has what its face has, a new vertex the mean of what is at the corners.
struct HostRefinement {
    struct Point {
        Index face;
        Vec3 weights; // barycentric: of the face's corners
    };
    struct Part {
        Index face;       // from the number of faces on: a new one, all of them in their order
        Index source;     // the face that it is a part of
        Triangle corners; // from the number of vertices on: new ones
        std::array<Vec3, 3> weights; // barycentric: each corner in the source face
    };
    std::vector<Point> points; // new vertices
    std::vector<Part> parts;   // ascending
};

/// The results for the host's own elements, new faces included. Vectors are for all faces or empty.
struct HostResult {
    std::vector<int> chart_id;
    std::vector<int> seam_edges;
    std::vector<double> face_quality;
    std::vector<Color> face_color;
    std::vector<std::array<Vec2, 3>> wedge_uv;
    std::vector<std::uint8_t> face_selected; // empty: the selection stays
    // Empty, or 1 for the host's own faces that must stay as they are: their coordinates, quality
    // and colours here mean nothing, and only their seams may have changed.
    std::vector<std::uint8_t> untouched;
    std::vector<Vec3> points; // for all vertices or empty
    std::optional<LayerMesh> layer;
    std::optional<plane::Image> texture;
    std::optional<HostRefinement> refinement;
    ResultValues values;
    std::vector<std::string> notes;
};

/// Gates the mesh, runs the filter and maps its output back. Parameters that are not given take
/// their defaults. Throws the errors of errors.h; the host's mesh has not been touched then, and no
/// file has changed. Whatever the filter is busy with, Cancelled comes at once (base/worker.h).
HostResult run_filter(const FilterDeclaration& filter, HostMesh host, const ParameterValues& values,
                      Progress& progress);

} // namespace devseg::declare
