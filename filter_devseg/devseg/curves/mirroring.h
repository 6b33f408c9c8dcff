// Curves drawn to the mirror images of others, so that both sides of a model get the same seams.
#pragma once

#include <optional>
#include <vector>

#include "devseg/curves/network.h"
#include "devseg/mesh/mirror_plane.h"
#include "devseg/mesh/nearest_points.h"

namespace devseg::curves {

class MirrorImage {
public:
    /// The curves as they are now. `chain` (#curves): those with one number move as one. `reach`:
    /// how far images may lie from each other; `spacing`: of the points along them; internal units.
    MirrorImage(const Network& network, const std::vector<Index>& chain,
                const mesh::MirrorPlane& plane, double reach, double spacing);

    /// From a point of a chain to the mirror image of another, or of itself; nothing where none is
    /// near that runs the same way, or where another chain is nearer to that image. `direction`: of
    /// the chain, a unit vector.
    std::optional<Vec3> way(Index chain, const Vec3& point, const Vec3& direction) const;

    /// The same from a junction to the image of a junction.
    std::optional<Vec3> way_of_junction(const Vec3& point) const;

private:
    void add_line(Index chain, const Vec3& from, const Vec3& to, double spacing);

    mesh::MirrorPlane plane_;
    double reach_;
    std::vector<Vec3> points_; // of the images
    std::vector<Vec3> directions_;
    std::vector<Index> chain_; // of each point
    std::vector<Vec3> sources_;
    std::vector<Vec3> source_directions_;
    std::vector<Vec3> junctions_;
    std::optional<mesh::NearestPoints> nearest_;
    std::optional<mesh::NearestPoints> nearest_source_;
    std::optional<mesh::NearestPoints> nearest_junction_;
};

/// Where a crossing or a node is.
Vec3 place_of_crossing(const Network& network, Index crossing);
Vec3 place_of_node(const Network& network, Index node);

} // namespace devseg::curves
