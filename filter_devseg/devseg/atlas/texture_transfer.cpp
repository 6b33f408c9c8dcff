#include "devseg/atlas/texture_transfer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace devseg::atlas {

namespace {

// Pixels beside a face that bilinear sampling on it may reach.
constexpr double reach_of_sampling = 1.5;

// Barycentric coordinates of the place on a triangle that is nearest to p.
Vec3 nearest_place(const std::array<Vec2, 3>& corners, const Vec2& p) {
    const double area = plane::cross(corners[1] - corners[0], corners[2] - corners[0]);
    Vec3 inside;
    for (std::size_t k = 0; k < 3; ++k)
        inside[static_cast<Index>(k)] =
            plane::cross(corners[(k + 1) % 3] - p, corners[(k + 2) % 3] - p) / area;
    if (area != 0.0 && inside.minCoeff() >= 0.0)
        return inside;
    Vec3 best = Vec3::Unit(0);
    double least = infinite;
    for (Index k = 0; k < 3; ++k) {
        const Vec2& a = corners[at(k)];
        const Vec2 edge = corners[at((k + 1) % 3)] - a;
        const double length = edge.squaredNorm();
        const double t = length > 0.0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0.0;
        const double distance = (a + t * edge - p).squaredNorm();
        if (distance < least) {
            least = distance;
            best = Vec3::Zero();
            best[k] = 1.0 - t;
            best[(k + 1) % 3] = t;
        }
    }
    return best;
}

class Baking {
public:
    Baking(const TexturedLayout& old, int size) : old_(old), size_(size) {
        image_.width = image_.height = size;
        image_.rgb.assign(3 * at(size) * at(size), 0);
        distance_.assign(at(size) * at(size), std::numeric_limits<float>::infinity());
    }

    void add(Face f, const std::array<Vec2, 3>& corners, double reach) {
        if (old_.page[f] < 0 || at(old_.page[f]) >= old_.images.size() ||
            old_.images[at(old_.page[f])].is_empty())
            return;
        Eigen::AlignedBox2d box;
        for (const Vec2& p : corners)
            box.extend(p);
        const auto first = [&](double low) {
            return std::clamp(static_cast<int>(std::floor(low - reach)), 0, size_);
        };
        const auto last = [&](double high) {
            return std::clamp(static_cast<int>(std::ceil(high + reach)), 0, size_);
        };
        for (int y = first(box.min().y()); y < last(box.max().y()); ++y)
            for (int x = first(box.min().x()); x < last(box.max().x()); ++x)
                paint(f, corners, x, y, reach);
    }

    plane::Image image() { return std::move(image_); }
    double filled() const {
        const auto count = std::count_if(distance_.begin(), distance_.end(),
                                         [](float d) { return std::isfinite(d); });
        return static_cast<double>(count) / static_cast<double>(distance_.size());
    }

private:
    // The middle of pixel (x, y), y up.
    void paint(Face f, const std::array<Vec2, 3>& corners, int x, int y, double reach) {
        const Vec2 p(x + 0.5, y + 0.5);
        const Vec3 weights = nearest_place(corners, p);
        Vec2 place = Vec2::Zero();
        Vec2 source = Vec2::Zero();
        for (Index k = 0; k < 3; ++k) {
            place += weights[k] * corners[at(k)];
            source += weights[k] * old_.uv[3 * f + k];
        }
        const auto distance = static_cast<float>((place - p).norm());
        const std::size_t pixel = at(size_ - 1 - y) * at(size_) + at(x);
        if (distance > reach || !(distance < distance_[pixel]) || !source.allFinite())
            return;
        distance_[pixel] = distance;
        const std::array<double, 3> color = plane::sample(old_.images[at(old_.page[f])], source);
        for (std::size_t k = 0; k < 3; ++k)
            image_.rgb[3 * pixel + k] = static_cast<std::uint8_t>(std::lround(color[k]));
    }

    const TexturedLayout& old_;
    int size_;
    plane::Image image_;
    std::vector<float> distance_; // of each pixel from the face that has painted it, in pixels
};

} // namespace

plane::Image transfer_texture(const Mesh& mesh, const CornerUv& uv, const TexturedLayout& old,
                              int size, int padding, double& filled, const Progress& progress) {
    Baking baking(old, size);
    for (const Face f : mesh.all_faces()) {
        progress.check();
        std::array<Vec2, 3> corners;
        for (Index k = 0; k < 3; ++k)
            corners[at(k)] = static_cast<double>(size) * uv[3 * f + k];
        baking.add(f, corners, std::max(reach_of_sampling, static_cast<double>(padding)));
    }
    filled = baking.filled();
    return baking.image();
}

} // namespace devseg::atlas
