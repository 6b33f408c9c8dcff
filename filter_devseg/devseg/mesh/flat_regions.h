// Faces of one plane: polygons of the file, walls, boards. To a person each is one face.
#pragma once

#include "devseg/base/buckets.h"
#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

/// Edge-connected faces in one plane, to within what 32-bit coordinates can tell: one label for
/// each face, in the order of each region's first face. Faces of curved parts are regions of their
/// own.
FaceComponents flat_regions(const Mesh& mesh);

/// Gives all faces of a flat region the label that covers most of its area, if the region has at
/// least `share` of the surface; `label` is #F. A label may fall apart or vanish.
void keep_regions_whole(const Mesh& mesh, double share, std::vector<Index>& label);

/// The faces of the flat regions of at least `share` of the surface that have holes, whatever
/// stands in them.
std::vector<std::vector<Index>> flat_regions_with_holes(const Mesh& mesh, double share);

/// 1 for each half-edge (3 #F) within a flat region that has at least `share` of the surface.
std::vector<std::uint8_t> within_flat_regions(const Mesh& mesh, double share);

/// Flat regions of several faces, which methods take as one face: charts get all of one or nothing.
class Facets {
public:
    /// None: every face stands for itself.
    Facets() = default;
    /// Those that have at least a 500th of the surface: smaller ones are happenstance. None where
    /// fewer facets and single faces are left than `count`, which are wanted to be told apart.
    Facets(const Mesh& mesh, Index count);

    /// The faces of the facet that the face is in; none where it stands for itself.
    Span<Index> around(Face f) const {
        return number_.empty() || number_[f] < 0 ? Span<Index>(faces_.items, 0, 0)
                                                 : faces_[number_[f]];
    }
    /// Whether they are the same, or in one facet.
    bool are_one(Face f, Face g) const {
        return f == g || (!number_.empty() && number_[f] >= 0 && number_[f] == number_[g]);
    }

private:
    std::vector<Index> number_; // #F; −1 for faces that stand for themselves
    Buckets<Index> faces_;
};

} // namespace devseg::mesh
