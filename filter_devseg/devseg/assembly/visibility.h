// How well places on a model are seen by who looks at it: from the front and a little from above
// most of all, hardly from below, and not at all where the model itself stands in front.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"

namespace devseg::assembly {

class Visibility {
public:
    /// Upright: y up, its front towards +z.
    Visibility(const Mesh& mesh, const Progress& progress);

    /// Of a place on the surface with its unit normal: 0 = nobody sees it.
    double at(const Vec3& place, const Vec3& normal) const;

private:
    struct View {
        Vec3 towards = Vec3::UnitZ(); // the eye, unit
        double weight = 1.0;
        Vec3 right = Vec3::UnitX();
        Vec3 up = Vec3::UnitY();
        Vec2 low = Vec2::Zero();
        double pixel = 1.0;
        std::vector<double> depth; // the nearest along `towards` at each pixel
    };
    static void draw(const Mesh& mesh, View& view, const Progress& progress);

    double tolerance_ = 0.0;
    std::vector<View> views_;
};

} // namespace devseg::assembly
