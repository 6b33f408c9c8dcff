#include "host/pattern_export.h"

#include <algorithm>
#include <cmath>

#include "devseg/mesh/input_gate.h"
#include "devseg/pattern/pieces.h"
#include "host/host_errors.h"
#include "host/rich_parameters.h"
#include "writers/pattern_drawing.h"
#include "writers/svg_writer.h"

namespace devseg {

namespace {

using FaceUv = std::array<Vec2, 3>;

// Distance of two texture pages side by side, as a share of their width.
constexpr double page_gap = 0.05;

// Each texture image has a unit square of its own, and charts on two images may share their
// coordinates: the images that are in use are laid side by side.
void spread_pages(const CMeshO& m, std::vector<FaceUv>& uv) {
    std::vector<int> page_of_face;
    page_of_face.reserve(uv.size());
    for (const auto& f : m.face)
        if (!f.IsD())
            page_of_face.push_back(f.cWT(0).N());
    std::vector<int> pages = page_of_face;
    std::sort(pages.begin(), pages.end());
    pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
    if (pages.size() < 2)
        return;
    double low = 0.0;
    double high = 0.0;
    for (const FaceUv& corners : uv)
        for (const Vec2& p : corners)
            if (std::isfinite(p.x())) {
                low = std::min(low, p.x());
                high = std::max(high, p.x());
            }
    const double pitch = (1.0 + page_gap) * (high - low);
    for (std::size_t f = 0; f < uv.size(); ++f) {
        const auto rank =
            std::lower_bound(pages.begin(), pages.end(), page_of_face[f]) - pages.begin();
        for (Vec2& p : uv[f])
            p.x() += pitch * static_cast<double>(rank);
    }
}

// Coordinates at the vertices serve as well: they just have no seams of their own.
std::vector<FaceUv> read_vertex_uv(const CMeshO& m) {
    std::vector<FaceUv> uv;
    uv.reserve(static_cast<std::size_t>(m.fn));
    const auto at_vertex = [](const CVertexO* v) { return Vec2(v->cT().U(), v->cT().V()); };
    for (const auto& f : m.face)
        if (!f.IsD())
            uv.push_back({at_vertex(f.cV(0)), at_vertex(f.cV(1)), at_vertex(f.cV(2))});
    return uv;
}

std::vector<FaceUv> read_uv(const MeshModel& model) {
    if (model.hasDataMask(MeshModel::MM_WEDGTEXCOORD)) {
        std::vector<FaceUv> uv = read_wedge_uv(model.cm);
        spread_pages(model.cm, uv);
        return uv;
    }
    if (model.hasDataMask(MeshModel::MM_VERTTEXCOORD))
        return read_vertex_uv(model.cm);
    throw InvalidMesh("expected a mesh with texture coordinates, from which the pattern "
                      "pieces are read, found none; run 'Charts: Flatten' first");
}

CornerUv gated_uv(const GatedMesh& gated, const std::vector<FaceUv>& host_uv) {
    CornerUv uv;
    uv.reserve(3 * gated.source_face.size());
    for (Index f = 0; f < gated.mesh.face_count(); ++f)
        for (Index k = 0; k < 3; ++k)
            uv.push_back(host_uv[at(gated.source_face[at(f)])][at(gated.source_corner(f, k))]);
    return uv;
}

// Errors name the faces of the gated mesh: the host knows them by other numbers.
Pattern make_gated_pattern(const GatedMesh& gated, const CornerUv& uv,
                           const PatternOptions& options, Progress& progress) {
    try {
        return make_pattern(gated.mesh, uv, options, progress);
    } catch (const InvalidMesh& error) {
        std::vector<Index> faces;
        for (const Index f : error.faces)
            faces.push_back(gated.source_face[at(f)]);
        throw InvalidMesh(error.what(), std::move(faces));
    }
}

PatternOptions read_options(const RichParameterList& parameters) {
    PatternOptions options;
    options.mm_per_unit = static_cast<double>(parameters.getFloat("mm_per_unit"));
    options.height_mm = static_cast<double>(parameters.getFloat("height_mm"));
    options.labels = parameters.getBool("labels");
    return options;
}

} // namespace

RichParameterList pattern_parameters() {
    const PatternOptions defaults;
    RichParameterList list;
    list.addParam(RichFloat(
        "mm_per_unit", static_cast<Scalarm>(defaults.mm_per_unit), "Millimetres per unit",
        "Size on paper of one unit of the model, in millimetres: 1 for a model in millimetres, "
        "1000 for one in metres. Above 0."));
    list.addParam(RichFloat(
        "height_mm", static_cast<Scalarm>(defaults.height_mm), "Height of the finished model (mm)",
        "Scales the pattern so that the finished model is this high, measured along the y axis, "
        "in millimetres. 0 = use the millimetres per unit."));
    list.addParam(RichBool("labels", defaults.labels, "Piece names",
                           "Write its name (P01, P02, ...) into each piece, on a layer of its "
                           "own that a cutter can leave out."));
    return list;
}

SavedPattern save_pattern_svg(const std::string& file_name, MeshModel& model,
                              const RichParameterList& parameters, vcg::CallBackPos* callback) {
    Progress progress([callback](double fraction, const char* phase) {
        return callback == nullptr || callback(static_cast<int>(100.0 * fraction), phase);
    });
    return with_host_errors(model, [&] {
        const PatternOptions options = read_options(parameters);
        const std::vector<FaceUv> host_uv = read_uv(model);
        const GatedMesh gated = gate_mesh(read_raw_mesh(model.cm));
        const Pattern pattern =
            make_gated_pattern(gated, gated_uv(gated, host_uv), options, progress);
        save_svg(file_name, draw_pattern(pattern, options));
        return SavedPattern{gated.notes, pattern.notes};
    });
}

} // namespace devseg
