// What is close to what in a layout: vertices of an outline and edges of others.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "devseg/mesh/mesh.h"

namespace devseg::pack {

struct PlacedEdge {
    Vec2 from;
    Vec2 to;
    std::size_t chart;
};

/// A vertex of chart a and the nearest point of chart b.
struct ClosePair {
    std::size_t a;
    std::size_t b;
    Vec2 at_a;
    Vec2 at_b;
    Vec2 normal; // from b to a, of length 1
    double distance;
};

class Proximity {
public:
    /// All pairs at distances below `reach`, at most one for each vertex and other chart. `box`
    /// holds the edges, whose charts are numbers below `charts`; each vertex begins one of them.
    const std::vector<ClosePair>& find(const std::vector<PlacedEdge>& edges,
                                       const Eigen::AlignedBox2d& box, std::size_t charts,
                                       double reach);

private:
    struct Nearest {
        double distance = 0.0; // squared
        std::size_t edge = 0;
        std::size_t vertex = 0; // of which this is true; from 1 on
    };

    void fill(const std::vector<PlacedEdge>& edges, const Eigen::AlignedBox2d& box);
    void find_near(const std::vector<PlacedEdge>& edges, std::size_t vertex);
    std::size_t column(double x) const;
    std::size_t row(double y) const;
    template <typename Visit>
    void visit_cells(const PlacedEdge& e, Visit visit) const;

    double reach_ = 0.0;
    Vec2 low_ = Vec2::Zero();
    double cell_ = 1.0;
    std::size_t columns_ = 1;
    std::size_t rows_ = 1;
    std::vector<std::size_t> starts_; // of the cells' parts of `listed_`
    std::vector<std::size_t> listed_; // edges
    std::vector<Nearest> nearest_;    // for each chart
    std::vector<std::size_t> near_;   // charts close to the present vertex
    std::vector<ClosePair> pairs_;
};

} // namespace devseg::pack
