// References
//   P.-E. Danielsson: Euclidean distance mapping. Computer Graphics and Image Processing 14, 1980
//   (the nearest painted pixel, by two sweeps).
#include "devseg/plane/baking.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/plane/plane.h"

namespace devseg::plane {

namespace {

// Barycentric coordinates of the place on a triangle that is nearest to p, from outside.
Vec3 nearest_on_border(const std::array<Vec2, 3>& corners, const Vec2& p) {
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

// Barycentric coordinates as linear functions of the place.
struct Weights {
    explicit Weights(const std::array<Vec2, 3>& c)
        : area(cross(c[1] - c[0], c[2] - c[0])), corner(c) {
        for (std::size_t k = 0; k < 3; ++k)
            across[k] = left_of(Vec2(c[(k + 2) % 3] - c[(k + 1) % 3])) / area;
    }
    Vec3 operator()(const Vec2& p) const {
        Vec3 weights;
        for (std::size_t k = 0; k < 3; ++k)
            weights[static_cast<Index>(k)] = across[k].dot(p - corner[(k + 1) % 3]);
        return weights;
    }
    // The part of a row that is inside, with a pixel to spare at both ends.
    void limit(double y, double& low, double& high) const {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2& from = corner[(k + 1) % 3];
            const double x = from.x() - across[k].y() / across[k].x() * (y - from.y());
            if (across[k].x() > 0.0)
                low = std::max(low, x - 1.0);
            else if (across[k].x() < 0.0)
                high = std::min(high, x + 1.0);
        }
    }

    double area;
    const std::array<Vec2, 3>& corner;
    std::array<Vec2, 3> across;
};

// From a pixel to the nearest painted one.
struct Step {
    std::int16_t x = unreached;
    std::int16_t y = unreached;

    static constexpr std::int16_t unreached = std::numeric_limits<std::int16_t>::max();
    bool is_known() const { return x != unreached; }
    bool is_none() const { return x == 0 && y == 0; }
};

class Nearest {
public:
    // Within `reach` pixels.
    Nearest(int width, int height, double reach, const std::vector<float>& distance)
        : width_(width), height_(height), steps_(distance.size()) {
        reach = std::min(reach, Step::unreached - 1.0);
        most_ = static_cast<std::int64_t>(reach * reach);
        for (std::size_t i = 0; i < steps_.size(); ++i)
            if (std::isfinite(distance[i]))
                steps_[i] = {0, 0};
        for (int y = 0; y < height; ++y)
            sweep(y, -1);
        for (int y = height - 1; y >= 0; --y)
            sweep(y, 1);
    }
    const Step& operator[](std::size_t pixel) const { return steps_[pixel]; }

private:
    // What row y learns from the row beside it, then from left to right, then back.
    void sweep(int y, int beside) {
        if (y + beside >= 0 && y + beside < height_)
            for (int x = 0; x < width_; ++x)
                if (!row(y)[x].is_none())
                    for (const int aside : {-1, 0, 1})
                        learn(x, y, aside, beside);
        for (int x = 0; x < width_; ++x)
            learn(x, y, -1, 0);
        for (int x = width_ - 1; x >= 0; --x)
            learn(x, y, 1, 0);
    }
    void learn(int x, int y, int dx, int dy) {
        Step& own = row(y)[x];
        if (own.is_none() || x + dx < 0 || x + dx >= width_)
            return;
        const Step other = row(y + dy)[x + dx];
        if (!other.is_known())
            return;
        const Step candidate{static_cast<std::int16_t>(other.x + dx),
                             static_cast<std::int16_t>(other.y + dy)};
        const std::int64_t size = squared(candidate);
        if (size <= most_ && (!own.is_known() || size < squared(own)))
            own = candidate;
    }
    Step* row(int y) { return steps_.data() + static_cast<std::ptrdiff_t>(y) * width_; }
    static std::int64_t squared(const Step& step) {
        return std::int64_t{step.x} * step.x + std::int64_t{step.y} * step.y;
    }

    int width_;
    int height_;
    std::int64_t most_; // squared
    std::vector<Step> steps_;
};

} // namespace

Baking::Baking(int width, int height) {
    image_.width = width;
    image_.height = height;
    image_.rgb.assign(3 * at(width) * at(height), 0);
    distance_.assign(at(width) * at(height), std::numeric_limits<float>::infinity());
}

void Baking::add(const BakedTriangle& triangle, double reach) {
    Eigen::AlignedBox2d box;
    for (const Vec2& p : triangle.place) {
        if (!p.allFinite())
            return;
        box.extend(p);
    }
    const auto first = [&](double low, int size) {
        return static_cast<int>(std::clamp(std::floor(low - reach), 0.0, double(size)));
    };
    const auto last = [&](double high, int size) {
        return static_cast<int>(std::clamp(std::ceil(high + reach), 0.0, double(size)));
    };
    const Weights weights(triangle.place);
    for (int y = first(box.min().y(), image_.height); y < last(box.max().y(), image_.height); ++y) {
        double low = box.min().x();
        double high = box.max().x();
        if (reach <= 0.0)
            weights.limit(y + 0.5, low, high);
        for (int x = first(low, image_.width); x < last(high, image_.width); ++x) {
            const std::size_t pixel = at(image_.height - 1 - y) * at(image_.width) + at(x);
            if (distance_[pixel] == 0.0F)
                continue;
            const Vec2 p(x + 0.5, y + 0.5);
            Vec3 place = weights.area != 0.0 ? weights(p) : Vec3(-1.0, -1.0, -1.0);
            float distance = 0.0F;
            if (!(place.minCoeff() >= 0.0)) {
                if (reach <= 0.0)
                    continue;
                place = nearest_on_border(triangle.place, p);
                Vec2 nearest = Vec2::Zero();
                for (Index k = 0; k < 3; ++k)
                    nearest += place[k] * triangle.place[at(k)];
                distance = static_cast<float>((nearest - p).norm());
            }
            if (distance > reach || !(distance < distance_[pixel]))
                continue;
            distance_[pixel] = distance;
            paint(triangle, pixel, place);
        }
    }
}

void Baking::paint(const BakedTriangle& triangle, std::size_t pixel, const Vec3& weights) {
    std::array<double, 3> color{};
    if (triangle.source != nullptr) {
        Vec2 source = Vec2::Zero();
        for (std::size_t k = 0; k < 3; ++k)
            source += weights[static_cast<Index>(k)] * triangle.uv[k];
        color = sample(*triangle.source, source);
    } else {
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                color[channel] +=
                    weights[static_cast<Index>(k)] * triangle.color[k][static_cast<Index>(channel)];
    }
    for (std::size_t k = 0; k < 3; ++k)
        image_.rgb[3 * pixel + k] =
            static_cast<std::uint8_t>(std::clamp(color[k], 0.0, 255.0) + 0.5);
}

void Baking::spread(double reach, const Color& far) {
    const Nearest nearest(image_.width, image_.height, reach, distance_);
    for (int y = 0; y < image_.height; ++y)
        for (int x = 0; x < image_.width; ++x) {
            const std::size_t pixel = at(y) * at(image_.width) + at(x);
            const Step& step = nearest[pixel];
            if (step.is_none())
                continue;
            const std::uint8_t* color =
                step.is_known()
                    ? image_.rgb.data() + 3 * (at(y + step.y) * at(image_.width) + at(x + step.x))
                    : far.data();
            std::copy(color, color + 3, image_.rgb.data() + 3 * pixel);
        }
}

double Baking::filled() const {
    const auto count =
        std::count_if(distance_.begin(), distance_.end(), [](float d) { return std::isfinite(d); });
    return static_cast<double>(count) / static_cast<double>(distance_.size());
}

} // namespace devseg::plane
