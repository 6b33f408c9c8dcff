#include "sheet/model_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/declare/segmentation_output.h"

namespace devseg::sheet {

namespace {

constexpr int supersampling = 2;   // pixels in each direction that are averaged
constexpr double elevation = 0.32; // radians
constexpr double frame = 0.03;     // of the picture's side that stays empty on each side
constexpr double ambient = 0.55;
constexpr double line_shade = 0.25;
const Vec3 light(-0.45, 0.65, 0.61);

// What is seen at each pixel: the face nearest to the eye.
class DepthBuffer {
public:
    explicit DepthBuffer(int side)
        : side_(side), face_(at(side) * at(side), -1),
          depth_(face_.size(), std::numeric_limits<double>::lowest()) {}

    /// Corners in pixels, y down; z towards the eye.
    void draw(const std::array<Vec3, 3>& p, Index face) {
        const double area = cross(p[0], p[1], p[2]);
        if (area == 0.0)
            return;
        const auto clamped = [&](double v) {
            return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(side_ - 1)));
        };
        const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
        const auto [top, bottom] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
        for (int y = clamped(top); y <= clamped(bottom); ++y)
            for (int x = clamped(left); x <= clamped(right); ++x) {
                const Vec3 centre(x + 0.5, y + 0.5, 0.0);
                const double a = cross(p[1], p[2], centre) / area;
                const double b = cross(p[2], p[0], centre) / area;
                const double c = 1.0 - a - b;
                if (a < 0.0 || b < 0.0 || c < 0.0)
                    continue;
                const double z = a * p[0].z() + b * p[1].z() + c * p[2].z();
                const std::size_t i = index(x, y);
                if (z > depth_[i]) {
                    depth_[i] = z;
                    face_[i] = face;
                }
            }
    }

    Index face(int x, int y) const {
        return x >= 0 && y >= 0 && x < side_ && y < side_ ? face_[index(x, y)] : -1;
    }

private:
    static double cross(const Vec3& a, const Vec3& b, const Vec3& c) {
        return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    }
    std::size_t index(int x, int y) const { return at(y) * at(side_) + at(x); }

    int side_;
    std::vector<Index> face_;
    std::vector<double> depth_;
};

// Rows are right, up and towards the eye.
Eigen::Matrix3d view_rotation(double azimuth) {
    const Vec3 back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                    std::cos(azimuth) * std::cos(elevation));
    const Vec3 right(std::cos(azimuth), 0.0, -std::sin(azimuth));
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), back.cross(right).transpose(), back.transpose();
    return rotation;
}

DepthBuffer project(const Mesh& mesh, const Eigen::Matrix3d& rotation, int side) {
    Eigen::AlignedBox3d box;
    std::vector<Vec3> seen;
    for (const Vec3& p : mesh.points) {
        seen.push_back(rotation * p);
        box.extend(seen.back());
    }
    const double extent = std::max(box.sizes().x(), box.sizes().y());
    const double scale = (1.0 - 2.0 * frame) * side / extent;
    DepthBuffer buffer(side);
    for (Vec3& p : seen) {
        const Vec3 q = scale * (p - box.center());
        p = Vec3(q.x() + 0.5 * side, 0.5 * side - q.y(), q.z());
    }
    for (const Face f : mesh.all_faces()) {
        const Triangle& t = mesh.faces[f];
        buffer.draw({seen[t[0]], seen[t[1]], seen[t[2]]}, f);
    }
    return buffer;
}

std::vector<declare::Color> piece_colors(const Mesh& mesh, const pattern::Pattern& pattern) {
    atlas::ChartMap charts;
    charts.count = static_cast<Index>(pattern.pieces.size()) + 1;
    for (const Index piece : pattern.face_piece)
        charts.chart.push_back(piece < 0 ? charts.count - 1 : piece);
    return declare::chart_colors(mesh, charts);
}

// For each piece the pixel that is farthest from others, in city blocks.
std::vector<PieceLabel> find_labels(const std::vector<Index>& piece_of_pixel, int side,
                                    std::size_t pieces) {
    std::vector<int> depth(piece_of_pixel.size(), 0);
    const auto at_pixel = [&](int x, int y) { return at(y) * at(side) + at(x); };
    const auto reach = [&](int x, int y, int dx, int dy) {
        const int u = x + dx;
        const int v = y + dy;
        const bool outside = u < 0 || v < 0 || u >= side || v >= side;
        return outside || piece_of_pixel[at_pixel(u, v)] != piece_of_pixel[at_pixel(x, y)]
                   ? 1
                   : 1 + depth[at_pixel(u, v)];
    };
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            depth[at_pixel(x, y)] = std::min(reach(x, y, -1, 0), reach(x, y, 0, -1));
    std::vector<PieceLabel> best(pieces);
    for (int y = side - 1; y >= 0; --y)
        for (int x = side - 1; x >= 0; --x) {
            const std::size_t i = at_pixel(x, y);
            depth[i] = std::min({depth[i], reach(x, y, 1, 0), reach(x, y, 0, 1)});
            const Index piece = piece_of_pixel[i];
            const double radius = static_cast<double>(depth[i]) / side;
            if (piece >= 0 && radius > best[piece].radius)
                best[piece] = {piece, Vec2(x + 0.5, side - y - 0.5) / side, radius};
        }
    best.erase(std::remove_if(best.begin(), best.end(),
                              [](const PieceLabel& label) { return label.piece < 0; }),
               best.end());
    return best;
}

} // namespace

ModelView draw_model(const Mesh& mesh, const pattern::Pattern& pattern, double azimuth,
                     int pixels) {
    const int side = pixels * supersampling;
    const Eigen::Matrix3d rotation = view_rotation(azimuth);
    const DepthBuffer buffer = project(mesh, rotation, side);
    const std::vector<declare::Color> colors = piece_colors(mesh, pattern);
    const auto piece_at = [&](int x, int y) {
        const Index f = buffer.face(x, y);
        return f < 0 ? Index{-2} : pattern.face_piece[f];
    };
    ModelView view;
    view.image.columns = view.image.rows = pixels;
    std::vector<int> sums(3 * at(pixels) * at(pixels), 0);
    std::vector<Index> pieces;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const Index piece = piece_at(x, y);
            pieces.push_back(std::max(piece, Index{-1}));
            const bool border = piece != piece_at(x + 1, y) || piece != piece_at(x, y + 1) ||
                                piece != piece_at(x - 1, y) || piece != piece_at(x, y - 1);
            double shade = 1.0;
            declare::Color color{255, 255, 255};
            if (piece > -2) {
                const Vec3 normal = rotation * mesh.face_normals[buffer.face(x, y)];
                shade = ambient + (1.0 - ambient) * std::abs(normal.dot(light));
                color = piece >= 0 ? colors[piece] : colors.back();
            }
            if (border)
                shade *= line_shade;
            for (std::size_t k = 0; k < 3; ++k)
                sums[3 * (at(y / supersampling) * at(pixels) + at(x / supersampling)) + k] +=
                    static_cast<int>(std::lround(shade * color[k]));
        }
    for (const int sum : sums)
        view.image.rgb.push_back(
            static_cast<std::uint8_t>(std::min(255, sum / (supersampling * supersampling))));
    view.labels = find_labels(pieces, side, pattern.pieces.size());
    return view;
}

} // namespace devseg::sheet
