#include "devseg/edit/chosen.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/graph/unions.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/pattern/pieces.h"

namespace devseg::edit {

using atlas::ChartMap;
using declare::FilterInput;

namespace {

constexpr int most_digits = 9;

// The pattern on which the numbers stand, with all points of its outlines.
pattern::Pattern numbered_pattern(const FilterInput& input, const std::string& parameter,
                                  Progress& progress) {
    if (!input.uv)
        throw InvalidMesh(parameter +
                          ": expected texture coordinates, on whose pattern the numbers "
                          "stand, found none; run 'Charts: Flatten', or select faces");
    pattern::PatternOptions options;
    options.labels = false;
    options.simplify_mm = 0.0;
    options.match_seams = false;
    options.notch_spacing_mm = 0.0;
    auto reading = progress.part("reading the pattern", 0.3);
    return pattern::make_pattern(input.mesh, *input.uv, options, reading);
}

[[noreturn]] void refuse_number(const std::string& parameter, const char* what, std::size_t most,
                                int found) {
    throw InvalidParameter(parameter + ": expected numbers of " + what + ", from 1 to " +
                           std::to_string(most) + ", found " + std::to_string(found));
}

std::vector<std::uint8_t> faces_of_pieces(const FilterInput& input, const std::string& pieces,
                                          Progress& progress) {
    const pattern::Pattern pattern = numbered_pattern(input, "pieces", progress);
    std::vector<std::uint8_t> named(pattern.pieces.size(), 0);
    for (const int n : read_numbers("pieces", pieces)) {
        if (n < 1 || at(n) > named.size())
            refuse_number("pieces", "pieces", named.size(), n);
        named[at(n - 1)] = 1;
    }
    std::vector<std::uint8_t> faces(input.mesh.faces.size(), 0);
    for (std::size_t f = 0; f < faces.size(); ++f)
        if (const Index piece = pattern.face_piece[f]; piece >= 0)
            faces[f] = named[at(piece)];
    return faces;
}

std::vector<std::uint8_t> edges_of_seams(const FilterInput& input, const std::string& seams,
                                         Progress& progress) {
    const pattern::Pattern pattern = numbered_pattern(input, "seams", progress);
    std::vector<std::uint8_t> marks(input.mesh.twin.size(), 0);
    for (const int n : read_numbers("seams", seams)) {
        if (n < 1 || at(n) > pattern.seams.size())
            refuse_number("seams", "seams", pattern.seams.size(), n);
        for (const pattern::SeamSide& side : pattern.seams[at(n - 1)].sides) {
            const pattern::PiecePath& path = pattern.pieces[at(side.piece)].path(side.path);
            for (Index i = 0; i < side.count; ++i) {
                const std::size_t edge = at(side.first + i) % path.half_edge.size();
                marks[at(path.half_edge[edge])] = 1;
            }
        }
    }
    return marks;
}

// Seam edges hang together at vertices where just two of them meet, inside the surface.
void spread_along_seams(const Mesh& mesh, const std::vector<std::uint8_t>& seam,
                        std::vector<std::uint8_t>& marks) {
    const std::vector<std::uint8_t> boundary = mesh::boundary_vertices(mesh);
    const Buckets<HalfEdge> leaving = make_buckets<HalfEdge>(mesh.vertex_count(), [&](auto put) {
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] >= 0 && seam[h] != 0)
                put(mesh.origin(h), h);
    });
    graph::Unions edges(mesh.twin.size());
    const auto join = [&](HalfEdge a, HalfEdge b) {
        const Index root = edges.find(a);
        if (const Index other = edges.find(b); other != root)
            edges.join(root, other);
    };
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h)
            join(h, mesh.twin[h]);
    for (const Vertex v : mesh.all_vertices())
        if (const Span<HalfEdge> both = leaving[v]; both.size() == 2 && boundary[v] == 0)
            join(*both.begin(), *(both.begin() + 1));
    std::vector<std::uint8_t> chosen(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (marks[h] != 0)
            chosen[at(edges.find(h))] = 1;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && seam[h] != 0)
            marks[h] = chosen[at(edges.find(h))];
}

} // namespace

std::vector<int> read_numbers(const std::string& parameter, const std::string& text) {
    std::vector<int> numbers;
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] == ',' || text[i] == ' ') {
            ++i;
            continue;
        }
        const std::size_t end = std::min(text.find_first_of(", ", i), text.size());
        const std::size_t first = text[i] == 'P' || text[i] == 'p' ? i + 1 : i;
        const std::string digits = text.substr(first, end - first);
        if (digits.empty() || digits.size() > most_digits ||
            !std::all_of(digits.begin(), digits.end(),
                         [](unsigned char c) { return std::isdigit(c) != 0; }))
            throw InvalidParameter(parameter + ": expected numbers such as 3,5, found '" +
                                   text.substr(i, end - i) + "'");
        numbers.push_back(std::stoi(digits));
        i = end;
    }
    return numbers;
}

std::vector<Index> chosen_charts(const FilterInput& input, const ChartMap& charts,
                                 const std::string& pieces, Progress& progress) {
    const Mesh& mesh = input.mesh;
    std::vector<std::uint8_t> faces = input.selected;
    if (!pieces.empty())
        faces = faces_of_pieces(input, pieces, progress);
    else if (faces.empty() && !input.selected_vertices.empty())
        for (const Face f : mesh.all_faces()) {
            const Triangle& t = mesh.faces[f];
            faces.push_back(std::any_of(
                t.begin(), t.end(), [&](Index v) { return input.selected_vertices[at(v)] != 0; }));
        }
    if (faces.empty())
        throw InvalidMesh(
            "expected selected faces in the charts that are meant, found none; select "
            "some, or give their numbers on the pattern as pieces");
    std::vector<Index> chosen;
    for (const Face f : mesh.all_faces())
        if (faces[f] != 0)
            chosen.push_back(charts.chart[f]);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen;
}

std::vector<std::uint8_t> chosen_seams(const FilterInput& input, const ChartMap& charts,
                                       const std::string& seams, bool whole, Progress& progress) {
    const Mesh& mesh = input.mesh;
    std::vector<std::uint8_t> marks(mesh.twin.size(), 0);
    if (!seams.empty())
        marks = edges_of_seams(input, seams, progress);
    else if (input.selected.empty() && input.selected_edges.empty())
        throw InvalidMesh(
            "expected selected faces on both sides of a seam, or selected edges, found "
            "none; select some, or give numbers on the pattern as seams");
    else if (input.selected.empty())
        marks = input.selected_edges;
    else
        for (const HalfEdge h : mesh.all_half_edges())
            if (const Face g = mesh.across(h); g >= 0)
                marks[h] = input.selected[face_of(h)] != 0 && input.selected[g] != 0 ? 1 : 0;
    for (const HalfEdge h : mesh.all_half_edges())
        marks[h] = mesh.twin[h] >= 0 && charts.seam[h] != 0 ? marks[h] : 0;
    if (std::none_of(marks.begin(), marks.end(), [](auto m) { return m != 0; }))
        throw InvalidMesh(seams.empty() ? "expected selected seams, found none: no chosen edge is "
                                          "a seam"
                                        : "seams: expected seams of the charts, found that those "
                                          "of these numbers are there no more: joining the charts "
                                          "on both sides takes them away as well");
    if (whole)
        spread_along_seams(mesh, charts.seam, marks);
    for (const HalfEdge h : mesh.all_half_edges())
        if (marks[h] != 0)
            marks[mesh.twin[h]] = 1;
    return marks;
}

std::vector<Index> chosen_vertices(const FilterInput& input, const std::string& vertices) {
    std::vector<Index> chosen;
    const Mesh& mesh = input.mesh;
    if (vertices.empty()) {
        if (input.selected_vertices.empty())
            throw InvalidMesh("expected selected vertices, where darts are to end, found none; "
                              "select some, or give their numbers as vertices");
        for (const Vertex v : mesh.all_vertices())
            if (input.selected_vertices[v] != 0)
                chosen.push_back(v);
        return chosen;
    }
    for (const int n : read_numbers("vertices", vertices)) {
        const auto found = std::find(input.source_vertex.begin(), input.source_vertex.end(), n);
        if (found == input.source_vertex.end())
            throw InvalidParameter(
                "vertices: expected numbers of vertices that have faces, counted "
                "from 0, found " +
                std::to_string(n));
        chosen.push_back(static_cast<Index>(found - input.source_vertex.begin()));
    }
    return chosen;
}

} // namespace devseg::edit
