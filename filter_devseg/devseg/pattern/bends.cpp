#include "devseg/pattern/bends.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "devseg/pattern/inside.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

struct Tuning {
    double flat = 0.1 * degrees; // between two faces of one flat part
    double contradiction = 0.01; // mm, between two ways to the same part
};
constexpr Tuning tuning;

// The flat parts of one piece, and how each is moved.
class Parts {
public:
    Parts(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv, const Bend& bend,
          double fold_angle, const PatternPiece& piece, const std::vector<Index>& faces)
        : mesh_(mesh), charts_(charts), uv_(uv), bend_(bend), fold_angle_(fold_angle),
          piece_(piece), faces_(faces), part_(mesh.faces.size(), -1) {
        for (const Index f : faces)
            if (part_[at(f)] < 0)
                fill(f);
    }

    /// False where bends contradict each other.
    bool place() {
        Index root = 0;
        for (Index p = 0; p < static_cast<Index>(area_.size()); ++p)
            root = area_[at(p)] > area_[at(root)] ? p : root;
        moves_.assign(area_.size(), std::nullopt);
        if (moves_.empty())
            return true;
        moves_[at(root)] = Vec2(Vec2::Zero());
        std::vector<Index> open{root};
        while (!open.empty()) {
            const Index part = open.back();
            open.pop_back();
            for (const HalfEdge h : bends_[at(part)]) {
                const Index other = part_[face_of(mesh_.twin[h])];
                const Vec2 move = *moves_[at(part)] - shortening(h);
                if (!moves_[at(other)]) {
                    moves_[at(other)] = move;
                    open.push_back(other);
                } else if ((*moves_[at(other)] - move).norm() > tuning.contradiction) {
                    return false;
                }
            }
        }
        return true;
    }

    /// Of the corner at the start of the half-edge: the mean of the parts that meet there.
    Vec2 move_at(HalfEdge start) const {
        std::vector<Index> met;
        HalfEdge h = start;
        while (true) {
            const Index part = part_[face_of(h)];
            if (std::find(met.begin(), met.end(), part) == met.end())
                met.push_back(part);
            const HalfEdge before = Mesh::next(Mesh::next(h));
            if (!is_inside(before) || mesh_.twin[before] == start)
                break;
            h = mesh_.twin[before];
        }
        Vec2 sum = Vec2::Zero();
        for (const Index part : met)
            sum += moves_[at(part)].value_or(Vec2(Vec2::Zero()));
        return sum / static_cast<double>(met.size());
    }

private:
    bool is_inside(HalfEdge h) const { return charts_.seam[h] == 0 && mesh_.twin[h] >= 0; }

    void fill(Index first) {
        const auto part = static_cast<Index>(area_.size());
        area_.push_back(0.0);
        bends_.emplace_back();
        std::vector<Index> open{first};
        part_[at(first)] = part;
        while (!open.empty()) {
            const Face f(open.back());
            open.pop_back();
            area_.back() += mesh_.face_areas[f];
            for (const HalfEdge h : half_edges_of(f)) {
                if (!is_inside(h))
                    continue;
                const Index other = face_of(mesh_.twin[h]);
                if (std::abs(fold_angle_at(mesh_, h)) > tuning.flat) {
                    bends_.back().push_back(h);
                } else if (part_[at(other)] < 0) {
                    part_[at(other)] = part;
                    open.push_back(other);
                }
            }
        }
    }

    // From this side of the bend to the other, by which the other one comes closer.
    Vec2 shortening(HalfEdge h) const {
        const double angle = fold_angle_at(mesh_, h);
        const double deduction = std::abs(angle) > fold_angle_ ? bend_.sharp_deduction(angle)
                                                               : bend_.smooth_deduction(angle);
        const Vec2 from = piece_.place(uv_[h]);
        const Vec2 along = piece_.place(uv_[Mesh::next(h)]) - from;
        const double length = along.norm();
        if (!(length > 0.0))
            return Vec2::Zero();
        Vec2 across = plane::left_of(Vec2(along / length));
        const Vec2 apex = piece_.place(uv_[Mesh::next(Mesh::next(h))]);
        if (across.dot(apex - from) > 0.0)
            across = -across;
        return deduction * across;
    }

    const Mesh& mesh_;
    const atlas::ChartMap& charts_;
    const CornerUv& uv_;
    const Bend& bend_;
    double fold_angle_;
    const PatternPiece& piece_;
    const std::vector<Index>& faces_;
    std::vector<Index> part_;                  // of each face of the mesh; −1: of other pieces
    std::vector<double> area_;                 // of each part
    std::vector<std::vector<HalfEdge>> bends_; // of each part, on its side
    std::vector<std::optional<Vec2>> moves_;
};

} // namespace

double Bend::sharp_deduction(double angle) const {
    const double turn = std::abs(angle);
    const double outer = angle > 0.0 ? radius + thickness : radius;
    return 2.0 * outer * std::tan(0.5 * turn) - turn * (radius + k_factor * thickness);
}

double Bend::smooth_deduction(double angle) const {
    return angle > 0.0 ? angle * (1.0 - k_factor) * thickness : angle * k_factor * thickness;
}

Bend find_bend(const PatternOptions& options, const std::optional<material::Material>& material) {
    Bend bend;
    bend.thickness = options.thickness_mm;
    const bool has_any = options.thickness_mm > 0.0 || options.bend_radius_mm > 0.0;
    if (!has_any)
        return bend;
    bend.radius = options.bend_radius_mm;
    bend.k_factor = options.k_factor;
    if (bend.radius < 0.0)
        bend.radius = material ? material->least_radius_mm : options.thickness_mm;
    if (bend.k_factor < 0.0)
        bend.k_factor = material ? material->k_factor : material::Material().k_factor;
    return bend;
}

void compensate_bends(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv,
                      const Bend& bend, double fold_angle, Pattern& pattern) {
    const Buckets<Index> groups = atlas::group_faces(charts);
    Index refused = 0;
    for (PatternPiece& piece : pattern.pieces) {
        const Span<Index> group = groups[piece.chart];
        const std::vector<Index> faces(group.begin(), group.end());
        Parts parts(mesh, charts, uv, bend, fold_angle, piece, faces);
        if (!parts.place()) {
            ++refused;
            continue;
        }
        for (Index i = 0; i < piece.path_count(); ++i) {
            PiecePath& path = piece.path(i);
            for (std::size_t k = 0; k < path.points.size(); ++k)
                path.points[k] += parts.move_at(path.half_edge[k]);
        }
    }
    if (refused > 0)
        pattern.notes.push_back("the thickness is left out on " + std::to_string(refused) + " of " +
                                std::to_string(pattern.pieces.size()) +
                                (refused == 1 ? " pieces" : " pieces") +
                                ", which bend in more than one direction");
}

} // namespace devseg::pattern
