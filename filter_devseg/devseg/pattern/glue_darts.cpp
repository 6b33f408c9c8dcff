#include <cmath>

#include "devseg/plane/plane.h"

#include "devseg/pattern/optimize.h"

namespace devseg::pattern {

namespace {

double angle_at(const CornerUv& uv, HalfEdge h) {
    return plane::angle_between(uv[Mesh::next(h)] - uv[h], uv[Mesh::previous(h)] - uv[h]);
}

class Zipper {
public:
    Zipper(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv, double angle)
        : mesh_(mesh), seam_(charts.seam), uv_(uv), angle_(angle) {}

    // Glues from the tip that `h` runs into, whose twin runs back; returns the number of edges.
    Index close(HalfEdge h) {
        Index glued = 0;
        while (glue_edge(h)) {
            ++glued;
            const Index before = boundary_before(h);
            const Index after = boundary_after(mesh_.twin[h]);
            seam_[h] = seam_[mesh_.twin[h]] = 0;
            if (mesh_.twin[before] != after)
                break;
            h = before;
        }
        return glued;
    }

    bool is_open(HalfEdge h) const { return mesh_.twin[h] < 0 || seam_[h] != 0; }

    // Whether h is cut and the outline turns back at its end.
    bool runs_into_tip(HalfEdge h) const {
        return seam_[h] != 0 && mesh_.twin[h] >= 0 && boundary_after(h) == mesh_.twin[h];
    }

    const std::vector<std::uint8_t>& seam() const { return seam_; }
    const CornerUv& uv() const { return uv_; }

private:
    // The edge of the outline after the edge h of it.
    Index boundary_after(HalfEdge h) const {
        Index next = Mesh::next(h);
        while (!is_open(next))
            next = Mesh::next(mesh_.twin[next]);
        return next;
    }

    // The edge of the outline before the edge h of it.
    Index boundary_before(HalfEdge h) const {
        Index before = Mesh::previous(h);
        while (!is_open(before))
            before = Mesh::previous(mesh_.twin[before]);
        return before;
    }

    // The corners of one copy of a vertex; `first` leaves it along the outline.
    std::vector<Index> corners_from(Index first) const {
        std::vector<Index> corners{first};
        while (!is_open(Mesh::previous(corners.back())))
            corners.push_back(mesh_.twin[Mesh::previous(corners.back())]);
        return corners;
    }

    bool glue_edge(HalfEdge h) {
        const Index back = mesh_.twin[h];
        double around = 0.0;
        for (const Index corner : corners_from(back))
            around += angle_at(uv_, corner);
        if (!(std::abs(2.0 * pi - around) <= angle_))
            return false;
        std::vector<Index> corners = corners_from(h);
        const std::vector<Index> others = corners_from(boundary_after(back));
        if (others.front() == h)
            return false; // the only outline is this dart: the chart would have none
        const Vec2 middle = 0.5 * (uv_[h] + uv_[Mesh::next(back)]);
        const Vec2 rounded(static_cast<double>(static_cast<float>(middle.x())),
                           static_cast<double>(static_cast<float>(middle.y())));
        corners.insert(corners.end(), others.begin(), others.end());
        const double side = plane::uv_area(uv_, h / 3);
        std::vector<Vec2> old;
        for (const Index corner : corners) {
            old.push_back(uv_[corner]);
            uv_[corner] = rounded;
        }
        for (const Index corner : corners) {
            const Face f = corner / 3;
            const double area = plane::orientation(uv_[3 * f], uv_[3 * f + 1], uv_[3 * f + 2]);
            if (!(side > 0.0 ? area > 0.0 : area < 0.0)) {
                for (std::size_t i = 0; i < corners.size(); ++i)
                    uv_[corners[i]] = old[i];
                return false;
            }
        }
        return true;
    }

    const Mesh& mesh_;
    std::vector<std::uint8_t> seam_;
    CornerUv uv_;
    double angle_;
};

} // namespace

GluedDarts glue_darts(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv,
                      double angle) {
    GluedDarts result;
    Zipper zipper(mesh, charts, uv, angle);
    for (const HalfEdge h : mesh.all_half_edges())
        if (zipper.runs_into_tip(h)) {
            const Index glued = zipper.close(h);
            result.edges += glued;
            result.darts += glued > 0 ? 1 : 0;
        }
    result.charts = atlas::make_chart_map(mesh, charts.chart, zipper.seam(), true);
    result.uv = zipper.uv();
    return result;
}

} // namespace devseg::pattern
