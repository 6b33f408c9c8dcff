#include "devseg/declare/filter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/worker.h"
#include "devseg/declare/collapsed_faces.h"
#include "devseg/declare/opening.h"
#include "devseg/declare/part.h"
#include "devseg/declare/refined_faces.h"

namespace devseg::declare {

Mesh FilterInput::as_stored(const Mesh& made) const {
    Mesh stored = made;
    for (Vec3& p : stored.points)
        p = from_model(to_model(p).unaryExpr(&in_32_bits));
    mesh::compute_face_geometry(stored);
    return stored;
}

namespace {

std::vector<Index> read_chart_id(const HostMesh& host, const mesh::GatedMesh& gated) {
    std::vector<Index> labels;
    if (host.chart_id.empty())
        return labels;
    for (const Index source : gated.source_face) {
        const double id = host.chart_id[source];
        if (!(std::abs(id) <= std::numeric_limits<Index>::max()))
            throw InvalidMesh("expected whole numbers in the face attribute chart_id, found " +
                                  std::to_string(id) + " at face " + std::to_string(source) +
                                  "; run a segmentation filter again",
                              {source});
        labels.push_back(static_cast<Index>(std::lround(id)));
    }
    return labels;
}

// Marks of half-edges and their twins (3 #F), from the bits of the host's faces, those that lie on
// an edge of others included.
template <class Bits>
std::vector<std::uint8_t> of_edges(const mesh::GatedMesh& gated, Bits bits) {
    const Mesh& mesh = gated.mesh;
    std::vector<std::uint8_t> marks(mesh.twin.size(), 0);
    for (const Face f : mesh.all_faces()) {
        const int mask = bits(gated.source_face[f]);
        for (Index e = 0; e < 3; ++e)
            marks[3 * f + e] = (mask >> gated.source_edge(f, e)) & 1 ? 1 : 0;
    }
    for (const mesh::CollapsedFace& face : gated.collapsed)
        for (Index e = 0; e < 3; ++e)
            if (face.on[at(e)] >= 0 && ((bits(face.source) >> e) & 1) != 0)
                marks[face.on[at(e)]] = 1;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && marks[h] != 0)
            marks[mesh.twin[h]] = 1;
    return marks;
}

std::optional<atlas::ChartMap> read_charts(const HostMesh& host, const mesh::GatedMesh& gated) {
    if (host.chart_id.empty() && host.seam_edges.empty())
        return std::nullopt;
    const Mesh& mesh = gated.mesh;
    std::vector<Index> labels = read_chart_id(host, gated);
    labels.resize(mesh.faces.size(), 0);
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    if (!host.seam_edges.empty())
        seam = of_edges(gated, [&](Index f) { return edge_bits(host.seam_edges[f]); });
    return atlas::make_chart_map(mesh, labels, seam, true);
}

std::vector<std::uint8_t> read_selected_edges(const HostMesh& host, const mesh::GatedMesh& gated) {
    if (host.edge_selected.empty())
        return {};
    return of_edges(gated, [&](Index f) { return int{host.edge_selected[f]}; });
}

// A vertex is selected where one of those is that were joined at its place.
std::vector<std::uint8_t> read_selected_vertices(const HostMesh& host,
                                                 const mesh::GatedMesh& gated) {
    if (host.vertex_selected.empty())
        return {};
    std::vector<std::uint8_t> selected(gated.mesh.points.size(), 0);
    for (const mesh::CollapsedFace& face : gated.collapsed)
        for (Index k = 0; k < 3; ++k)
            if (face.at[at(k)] >= 0)
                selected[gated.mesh.origin(face.at[at(k)])] |=
                    host.vertex_selected[host.geometry.faces[face.source][at(k)]];
    for (const Face f : gated.mesh.all_faces())
        for (Index k = 0; k < 3; ++k) {
            const Triangle& corners = host.geometry.faces[gated.source_face[f]];
            selected[gated.mesh.faces[f][k]] |=
                host.vertex_selected[corners[gated.source_corner(f, k)]];
        }
    return selected;
}

// Hosts keep texture coordinates in 32 bits, where larger numbers are infinite.
bool is_coordinate(const Vec2& p) {
    return (p.array().abs() <= std::numeric_limits<float>::max()).all();
}

// Broken texture coordinates only matter to filters that need them.
std::optional<CornerUv> read_uv(const std::vector<std::array<Vec2, 3>>& wedge_uv,
                                const mesh::GatedMesh& gated, bool needed) {
    if (wedge_uv.empty())
        return std::nullopt;
    CornerUv uv(3 * gated.mesh.faces.size());
    for (const Face f : gated.mesh.all_faces())
        for (Index k = 0; k < 3; ++k) {
            const std::size_t source = at(gated.source_face[f]);
            const Vec2& p = wedge_uv[source][gated.source_corner(f, k)];
            if (!is_coordinate(p) && !needed)
                return std::nullopt;
            if (!is_coordinate(p))
                throw InvalidMesh("expected finite texture coordinates, found a NaN or a number "
                                  "beyond 32 bits at face " +
                                      std::to_string(source) + "; run 'Charts: Flatten' again",
                                  {static_cast<Index>(source)});
            uv[3 * f + k] = p;
        }
    return uv;
}

// What the host has for each of its faces, for those behind the gate.
template <class Value>
std::vector<Value> of_faces(const std::vector<Value>& source, const mesh::GatedMesh& gated) {
    std::vector<Value> values;
    if (!source.empty())
        for (const Face f : gated.source_face)
            values.push_back(source[f]);
    return values;
}

// Colours of the corners of the faces behind the gate.
std::vector<Color> read_corner_colors(const HostMesh& host, const mesh::GatedMesh& gated) {
    std::vector<Color> colors;
    if (!host.corner_color.empty())
        for (const Face f : gated.mesh.all_faces())
            for (Index k = 0; k < 3; ++k)
                colors.push_back(
                    host.corner_color[at(gated.source_face[f])][at(gated.source_corner(f, k))]);
    return colors;
}

// A face of the output as the host has it: whole, or a part of a face that was split.
struct OutputFace {
    Face face;       // of the output
    Face gated;      // the face behind the gate that it is, or is a part of
    bool own = true; // not a stand-in for a face that the gate has left out
    const mesh::Refinement::Part* part = nullptr;
};

// Bits of the host face's cut edges; edges that the gate had to cut are seams as well.
int seam_bits(const mesh::GatedMesh& gated, const atlas::ChartMap& charts, const OutputFace& f) {
    int bits = 0;
    for (Index e = 0; e < 3; ++e) {
        const Index edge = f.part != nullptr ? mesh::old_edge(*f.part, e) : e;
        if (charts.seam[3 * f.face + e] != 0 || (edge >= 0 && gated.cut[3 * f.gated + edge] != 0))
            bits |= 1 << gated.source_edge(f.gated, e);
    }
    return bits;
}

// Whether the faces on both sides share the edge in the host as well: not where the gate has joined
// vertices, and a collapsed face may lie between.
bool is_shared(const HostMesh& host, const mesh::GatedMesh& gated, HalfEdge h) {
    const auto ends = [&](HalfEdge side) {
        const Face f = face_of(side);
        const Triangle& corners = host.geometry.faces[gated.source_face[f]];
        const Index e = gated.source_edge(f, corner_of(side));
        return std::minmax({corners[at(e)], corners[at((e + 1) % 3)]});
    };
    return ends(h) == ends(gated.mesh.twin[h]);
}

// Bits of the edges of an untouched face that lie beside others.
int bits_to_touched(const HostMesh& host, const mesh::GatedMesh& gated,
                    const std::vector<std::uint8_t>& untouched, Face f) {
    int bits = 0;
    for (const HalfEdge h : half_edges_of(f))
        if (const Face g = gated.mesh.across(h);
            g >= 0 && untouched[g] == 0 && is_shared(host, gated, h))
            bits |= 1 << gated.source_edge(f, corner_of(h));
    return bits;
}

// The host's faces in their order, then those that splitting adds.
std::vector<OutputFace> output_faces(const mesh::GatedMesh& gated, const FilterOutput& output) {
    std::vector<OutputFace> faces;
    for (std::size_t source = 0; source < gated.stand_in.size(); ++source) {
        const Face f = gated.stand_in[source];
        faces.push_back({f, f, gated.source_face[f] == static_cast<Index>(source), nullptr});
    }
    if (!output.refinement)
        return faces;
    std::vector<const mesh::Refinement::Part*> first(gated.source_face.size(), nullptr);
    for (const mesh::Refinement::Part& part : output.refinement->parts)
        if (at(part.face) < first.size())
            first[part.face] = &part;
    for (OutputFace& f : faces)
        f.part = f.own ? first[f.gated] : nullptr;
    for (const mesh::Refinement::Part& part : output.refinement->parts)
        if (at(part.face) >= first.size())
            faces.push_back({part.face, part.source, true, &part});
    return faces;
}

// Where the vertices have moved to, all that were joined alike; those that no face uses stay.
std::vector<Vec3> moved_points(const HostMesh& host, const mesh::GatedMesh& gated,
                               const std::vector<Vec3>& points) {
    const Mesh& mesh = gated.mesh;
    std::vector<Vec3> moved = host.geometry.points;
    const auto move = [&](Index face, Index corner, Vertex v) {
        const std::size_t source = at(host.geometry.faces[face][at(corner)]);
        moved[source] =
            host.geometry.points[source] + mesh.unit_length * (points[v] - mesh.points[v]);
    };
    for (const mesh::CollapsedFace& face : gated.collapsed)
        for (Index k = 0; k < 3; ++k)
            if (face.at[at(k)] >= 0)
                move(face.source, k, mesh.origin(face.at[at(k)]));
    for (const Face f : mesh.all_faces())
        for (Index k = 0; k < 3; ++k)
            move(gated.source_face[f], gated.source_corner(f, k), mesh.faces[f][k]);
    return moved;
}

// What a filter says of faces, for the host's.
class MapBack {
public:
    MapBack(const HostMesh& host, const mesh::GatedMesh& gated, const FilterOutput& output,
            HostResult& result)
        : host_(host), gated_(gated), output_(output), result_(result),
          cut_(gated.mesh.twin.size(), 0) {
        if (output.uv)
            collapsed_corners_.emplace(gated, *output.uv);
    }

    void take(const std::vector<OutputFace>& faces) {
        for (const OutputFace& f : faces) {
            const auto source = static_cast<Index>(result_.untouched.size());
            const bool stays = !output_.untouched.empty() &&
                               at(source) < host_.geometry.faces.size() &&
                               (!f.own || output_.untouched[f.gated] != 0);
            result_.untouched.push_back(stays ? 1 : 0);
            if (output_.charts)
                take_charts(f, source, stays);
            if (output_.face_quality)
                result_.face_quality.push_back((*output_.face_quality)[f.face]);
            if (!output_.selected.empty())
                result_.face_selected.push_back(f.own ? output_.selected[f.face] : 0);
            if (output_.face_color)
                result_.face_color.push_back((*output_.face_color)[f.face]);
            if (output_.uv)
                result_.wedge_uv.push_back(corners_of(f, source));
        }
        if (output_.charts)
            set_collapsed_seams(gated_, host_, cut_, result_);
    }

private:
    void take_charts(const OutputFace& f, Index source, bool stays) {
        result_.chart_id.push_back(stays && !host_.chart_id.empty()
                                       ? static_cast<int>(std::lround(host_.chart_id[source]))
                                       : output_.charts->chart[f.face]);
        int bits = f.own ? seam_bits(gated_, *output_.charts, f) : 0;
        if (stays && !host_.seam_edges.empty()) // and its edges to faces that have changed
            bits = edge_bits(host_.seam_edges[source]) |
                   (f.own ? bits & bits_to_touched(host_, gated_, output_.untouched, f.gated) : 0);
        result_.seam_edges.push_back(bits);
        for (Index e = 0; f.own && e < 3; ++e) {
            const Index edge = f.part != nullptr ? mesh::old_edge(*f.part, e) : e;
            if (edge >= 0 && (bits >> gated_.source_edge(f.gated, e) & 1) != 0)
                cut_[half_edge_of(f.gated, edge)] = 1;
        }
    }

    // Faces that were left out collapse onto one corner.
    std::array<Vec2, 3> corners_of(const OutputFace& f, Index source) const {
        if (const mesh::CollapsedFace* face = gated_.find_collapsed(source);
            face != nullptr && !f.own)
            return collapsed_corners_->of(*face);
        std::array<Vec2, 3> corners{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
        for (Index k = 0; k < 3; ++k)
            corners[at(gated_.source_corner(f.gated, k))] =
                (*output_.uv)[3 * f.face + (f.own ? k : 0)];
        return corners;
    }

    const HostMesh& host_;
    const mesh::GatedMesh& gated_;
    const FilterOutput& output_;
    HostResult& result_;
    std::vector<std::uint8_t> cut_; // 3 #F: seams as the host's faces have them
    std::optional<CollapsedCorners> collapsed_corners_;
};

HostResult map_back(const HostMesh& host, const mesh::GatedMesh& gated, FilterOutput output) {
    HostResult result;
    if (output.points)
        result.points = moved_points(host, gated, *output.points);
    result.values = std::move(output.values);
    result.layer = std::move(output.layer);
    result.texture = std::move(output.texture);
    result.notes = gated.notes;
    result.notes.insert(result.notes.end(), output.notes.begin(), output.notes.end());
    const std::vector<OutputFace> faces = output_faces(gated, output);
    if (output.refinement && !output.refinement->parts.empty()) {
        std::vector<const mesh::Refinement::Part*> parts;
        for (const OutputFace& f : faces)
            parts.push_back(f.part);
        result.refinement = host_refinement(host, gated, *output.refinement, parts);
    }
    if (output.fans) {
        HostRefinement opening = host_opening(host, gated, *output.fans);
        result.values.emplace_back(new_vertices_number, static_cast<int>(opening.points.size()));
        if (!opening.parts.empty())
            result.refinement = std::move(opening);
    }
    MapBack(host, gated, output, result).take(faces);
    if (output.untouched.empty())
        result.untouched.clear();
    return result;
}

const OptionRange weld_range{"weld", -1.0, 0.01};

double weld_of(const ParameterValues& values) {
    const auto given = values.find(weld_range.name);
    if (given == values.end())
        return mesh::GateOptions().weld;
    const double weld = std::get<double>(given->second);
    weld_range.check(weld);
    return weld;
}

// A run owns all that it reads and writes: a cancelled one is abandoned.
struct FilterRun {
    FilterDeclaration filter;
    HostMesh host;
    ParameterValues values;
    HostResult result;
    std::function<void()> save;

    void operator()(Progress& progress);
};

void FilterRun::operator()(Progress& progress) {
    auto reading = progress.part("reading the mesh", 0.02);
    mesh::GatedMesh gated =
        mesh::gate_mesh(host.geometry, {weld_of(values), filter.shows_outside}, reading);
    reading.check();
    const FilterInput input{gated.mesh,
                            read_charts(host, gated),
                            read_uv(host.wedge_uv, gated, filter.needs_uv),
                            gated.source_face,
                            gated.source_vertex,
                            of_faces(host.face_selected, gated),
                            of_faces(host.face_color, gated),
                            gated.center,
                            read_chart_id(host, gated),
                            of_faces(host.face_material, gated),
                            read_selected_edges(host, gated),
                            read_selected_vertices(host, gated),
                            read_uv(host.uv_before, gated, false),
                            of_faces(host.page_before, gated),
                            std::move(host.textures),
                            read_corner_colors(host, gated)};
    auto running = progress.part(0.98);
    try {
        FilterOutput output = run_on_part(filter, input, std::move(values), running);
        save = std::move(output.save);
        result = map_back(host, gated, std::move(output));
    } catch (InvalidMesh& error) {
        for (Index& f : error.faces)
            f = gated.source_face[f];
        throw;
    }
}

} // namespace

bool wants_surface(const FilterDeclaration& filter, const ParameterValues& values) {
    const auto given = values.find("texture");
    return filter.takes_surface && given != values.end() && std::get<int>(given->second) != 0;
}

Parameter weld_parameter() {
    return {
        weld_range.name,
        "Join vertices within",
        "Vertices at the same place are read as one where that closes open edges, or where an edge "
        "without length joins them. Files that give a vertex to each normal or texture coordinate "
        "have such. 0 = at the same place; above: up to this share of the model's size; -1 = none "
        "are joined.",
        ParameterKind::real,
        mesh::GateOptions().weld,
        weld_range.minimum,
        weld_range.maximum,
        {}};
}

atlas::ChartMap find_charts(const FilterInput& input) {
    if (input.charts)
        return *input.charts;
    if (input.uv)
        return atlas::charts_from_uv(input.mesh, *input.uv);
    return atlas::make_chart_map(input.mesh, std::vector<Index>(input.mesh.faces.size(), 0), {},
                                 false);
}

HostResult run_filter(const FilterDeclaration& filter, HostMesh host, const ParameterValues& values,
                      Progress& progress) {
    if (filter.needs_uv && host.wedge_uv.empty())
        throw InvalidMesh("expected wedge texture coordinates, found none; run 'Charts: Flatten' "
                          "or load a mesh that has them");
    const auto run =
        std::make_shared<FilterRun>(FilterRun{filter, std::move(host), values, {}, {}});
    run_on_worker([run](Progress& own) { (*run)(own); }, progress);
    if (run->save)
        run->save();
    return std::move(run->result);
}

} // namespace devseg::declare
