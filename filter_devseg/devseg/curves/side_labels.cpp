#include "devseg/curves/side_labels.h"

#include <algorithm>
#include <utility>

namespace devseg::curves {

namespace {

const Piece* piece_at(const std::vector<Piece>& pieces, Index from, Index to) {
    const Piece wanted{from, to, -1, -1};
    const auto found = std::lower_bound(pieces.begin(), pieces.end(), wanted);
    return found != pieces.end() && !(wanted < *found) ? &*found : nullptr;
}

// Marks the pieces as seams, and the faces beside them; returns these.
std::vector<Face> mark_sides(const Mesh& fine, const std::vector<Piece>& pieces,
                             atlas::ChartMap& charts, std::vector<Index>& failed) {
    std::vector<std::uint8_t> on_curve(fine.points.size(), 0);
    for (const Piece& piece : pieces)
        on_curve[piece.from] = 1;
    std::vector<Face> sides;
    for (const HalfEdge h : fine.all_half_edges()) {
        if (on_curve[fine.origin(h)] == 0 || on_curve[fine.target(h)] == 0)
            continue;
        const Piece* piece = piece_at(pieces, fine.origin(h), fine.target(h));
        if (piece == nullptr)
            continue;
        charts.seam[h] = 1;
        Index& label = charts.chart[face_of(h)];
        if (label >= 0 && label != piece->label)
            failed.push_back(piece->curve);
        label = piece->label;
        sides.push_back(face_of(h));
    }
    if (sides.size() != pieces.size()) // a piece is no edge
        for (const Piece& piece : pieces)
            failed.push_back(piece.curve);
    return sides;
}

// Every chart is there, hangs together, and ends at seams.
void check_parts(const Mesh& fine, const atlas::ChartMap& charts, const std::vector<Sides>& sides,
                 std::vector<Index>& failed) {
    const mesh::FaceComponents parts =
        mesh::face_components(fine, [&](HalfEdge h) { return charts.seam[h] == 0; });
    std::vector<Index> part_of(at(charts.count), -1);
    std::vector<std::uint8_t> torn(at(charts.count), 0);
    for (const Face f : fine.all_faces()) {
        Index& part = part_of[charts.chart[f]];
        if (part >= 0 && part != parts.label[f])
            torn[charts.chart[f]] = 1;
        part = parts.label[f];
    }
    // Labels that meet where a part of a curve is missing, both ways.
    std::vector<std::pair<Index, Index>> meet;
    for (const HalfEdge h : fine.all_half_edges())
        if (const Face g = fine.across(h);
            g >= 0 && charts.seam[h] == 0 && charts.chart[g] != charts.chart[face_of(h)])
            meet.emplace_back(charts.chart[face_of(h)], charts.chart[g]);
    std::sort(meet.begin(), meet.end());
    std::vector<std::pair<Index, Index>> neighbours;
    for (const Sides& side : sides) {
        neighbours.emplace_back(side.left, side.right);
        neighbours.emplace_back(side.right, side.left);
    }
    std::sort(neighbours.begin(), neighbours.end());
    for (const auto& pair : meet)
        if (!std::binary_search(neighbours.begin(), neighbours.end(), pair))
            torn[pair.first] = torn[pair.second] = 1; // some other curve of theirs let them through
    const auto is_bad = [&](Index c) { return torn[c] != 0 || part_of[c] < 0; };
    for (const Sides& side : sides)
        if (is_bad(side.left) || is_bad(side.right) ||
            std::binary_search(meet.begin(), meet.end(), std::pair(side.left, side.right)))
            failed.push_back(side.curve);
}

} // namespace

atlas::ChartMap label_sides(const mesh::Refinement& refinement, const atlas::ChartMap& old,
                            const std::vector<Piece>& pieces, const std::vector<Sides>& sides,
                            std::vector<Index>& failed) {
    const Mesh& fine = refinement.mesh;
    atlas::ChartMap charts;
    charts.count = old.count;
    charts.chart.assign(fine.faces.size(), -1);
    charts.seam.assign(fine.twin.size(), 0);
    std::vector<Face> stack = mark_sides(fine, pieces, charts, failed);
    while (!stack.empty()) {
        const Face f = stack.back();
        stack.pop_back();
        for (const HalfEdge h : half_edges_of(f)) {
            const Face g = fine.across(h);
            if (g < 0 || charts.seam[h] != 0 || charts.chart[g] >= 0)
                continue;
            charts.chart[g] = charts.chart[f];
            stack.push_back(g);
        }
    }
    // Without seams: as they were. Parts of faces are there where the seams that split them failed.
    for (const mesh::Refinement::Part& part : refinement.parts)
        if (charts.chart[part.face] < 0)
            charts.chart[part.face] = old.chart[part.source];
    for (std::size_t f = 0; f < old.chart.size(); ++f)
        if (charts.chart[f] < 0)
            charts.chart[f] = old.chart[f];
    check_parts(fine, charts, sides, failed);
    return charts;
}

} // namespace devseg::curves
