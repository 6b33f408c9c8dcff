#include "devseg/assembly/visibility.h"

#include <algorithm>
#include <cmath>

namespace devseg::assembly {

namespace {

constexpr int pixels = 192; // along a side of each picture

struct Tuning {
    double behind = 0.01; // of the model's diagonal: what lies this far behind is hidden
};
constexpr Tuning tuning;

struct Eye {
    double x, y, z;
    double weight;
};
// Toys are looked at from the front and from above, and stand or sit on the rest.
constexpr Eye eyes[] = {
    {0, 0, 1, 1.0},   {0, 0.6, 0.8, 1.0},     {0.7, 0.2, 0.7, 0.9}, {-0.7, 0.2, 0.7, 0.9},
    {1, 0, 0, 0.7},   {-1, 0, 0, 0.7},        {0, 1, 0, 0.6},       {0.7, 0.2, -0.7, 0.5},
    {0, 0, -1, 0.35}, {-0.7, 0.2, -0.7, 0.5}, {0, -1, 0, 0.05},
};

} // namespace

Visibility::Visibility(const Mesh& mesh, const Progress& progress) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : mesh.points)
        box.extend(p);
    tolerance_ = tuning.behind * box.diagonal().norm();
    for (const Eye& eye : eyes) {
        View view;
        view.towards = Vec3(eye.x, eye.y, eye.z).normalized();
        view.weight = eye.weight;
        view.right = view.towards.unitOrthogonal();
        view.up = view.towards.cross(view.right);
        Eigen::AlignedBox2d seen;
        for (const Vec3& p : mesh.points)
            seen.extend(Vec2(view.right.dot(p), view.up.dot(p)));
        view.low = seen.min();
        view.pixel = std::max(seen.sizes().maxCoeff() / (pixels - 1), 1e-300);
        draw(mesh, view, progress);
        views_.push_back(std::move(view));
    }
}

void Visibility::draw(const Mesh& mesh, View& view, const Progress& progress) {
    view.depth.assign(static_cast<std::size_t>(pixels * pixels), -infinite);
    Heartbeat beat(progress);
    const auto clamped = [](double v) {
        return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(pixels - 1)));
    };
    for (const Triangle& t : mesh.faces) {
        beat();
        std::array<Vec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& q = mesh.points[devseg::at(t[k])];
            p[k] = Vec3((view.right.dot(q) - view.low.x()) / view.pixel,
                        (view.up.dot(q) - view.low.y()) / view.pixel, view.towards.dot(q));
        }
        const Vec3 a = p[1] - p[0];
        const Vec3 b = p[2] - p[0];
        const double area = a.x() * b.y() - a.y() * b.x();
        const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
        const auto [low, high] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
        for (int y = clamped(std::ceil(low)); y <= clamped(high) && area != 0.0; ++y)
            for (int x = clamped(std::ceil(left)); x <= clamped(right); ++x) {
                const Vec2 d(x - p[0].x(), y - p[0].y());
                const double s = (d.x() * b.y() - d.y() * b.x()) / area;
                const double r = (a.x() * d.y() - a.y() * d.x()) / area;
                if (s < 0.0 || r < 0.0 || s + r > 1.0)
                    continue;
                double& depth = view.depth[static_cast<std::size_t>(y * pixels + x)];
                depth = std::max(depth, p[0].z() + s * a.z() + r * b.z());
            }
    }
}

double Visibility::at(const Vec3& place, const Vec3& normal) const {
    double sum = 0.0;
    for (const View& view : views_) {
        const double facing = normal.dot(view.towards);
        const int x = static_cast<int>((view.right.dot(place) - view.low.x()) / view.pixel + 0.5);
        const int y = static_cast<int>((view.up.dot(place) - view.low.y()) / view.pixel + 0.5);
        const double front = view.depth[static_cast<std::size_t>(y * pixels + x)];
        if (facing > 0.0 && view.towards.dot(place) >= front - tolerance_)
            sum += view.weight * facing;
    }
    return sum;
}

} // namespace devseg::assembly
