#include "writers/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <QBuffer>
#include <QImage>

#include "devseg/base/errors.h"
#include "devseg/plane/plane.h"
#include "writers/font.h"
#include "writers/text.h"

namespace devseg::writers {

namespace {

constexpr double pixels_per_mm = 300.0 / 25.4;
constexpr double chord = 0.02; // mm, between curves and their lines

// A page of pixels, drawn on in millimetres from its lower left corner.
class Canvas {
public:
    Canvas(double width, double height) : height_(height) {
        const double columns = std::ceil(width * pixels_per_mm);
        const double rows = std::ceil(height * pixels_per_mm);
        if (!(columns * rows <= most_pixels))
            throw InvalidParameter(
                "page: expected a page of at most " + number_text(most_pixels * 1e-6, 0) +
                " million pixels at 300 for an inch in .png, found " + number_text(width, 0) +
                " x " + number_text(height, 0) + " mm; give a page");
        image_.columns = std::max(1, static_cast<int>(columns));
        image_.rows = std::max(1, static_cast<int>(rows));
        image_.size = Vec2(image_.columns, image_.rows) / pixels_per_mm;
        image_.rgb.assign(3 * static_cast<std::size_t>(image_.columns) *
                              static_cast<std::size_t>(image_.rows),
                          255);
        show_all();
    }

    const DrawingImage& image() const { return image_; }

    /// What is drawn from now on lies inside of a rectangle, mm.
    void show(const Vec2& low, const Vec2& high) {
        const Vec2 first = pixel_of(Vec2(low.x(), high.y()));
        const Vec2 last = pixel_of(Vec2(high.x(), low.y()));
        const auto within = [](double value, int most) {
            return static_cast<int>(std::clamp(std::round(value), 0.0, static_cast<double>(most)));
        };
        left_ = within(first.x(), image_.columns);
        top_ = within(first.y(), image_.rows);
        right_ = within(last.x(), image_.columns);
        bottom_ = within(last.y(), image_.rows);
    }
    void show_all() {
        left_ = top_ = 0;
        right_ = image_.columns;
        bottom_ = image_.rows;
    }

    /// `scale` and `shift` lead from the image's place to the page.
    void add(const DrawingImage& image, double scale, const Vec2& shift) {
        const Vec2 low = scale * image.low + shift;
        const Vec2 step = scale * image.size.cwiseQuotient(Vec2(image.columns, image.rows));
        std::vector<std::vector<Vec2>> rings;
        for (const DrawingPolyline& ring : image.clip) {
            rings.emplace_back();
            for (const Vec2& p : ring.points)
                rings.back().push_back(pixel_of(scale * p + shift));
        }
        fill(rings, [&](int x, int y) {
            const Vec2 p = (place_of(x, y) - low).cwiseQuotient(step);
            const auto column = static_cast<int>(std::floor(p.x()));
            const int row = image.rows - 1 - static_cast<int>(std::floor(p.y()));
            if (column < 0 || column >= image.columns || row < 0 || row >= image.rows)
                return;
            const std::uint8_t* from =
                image.rgb.data() + 3 * (static_cast<std::ptrdiff_t>(row) * image.columns + column);
            std::copy_n(from, 3, pixel(x, y));
        });
    }

    void add(const std::vector<DrawingLayer>& layers, double scale, const Vec2& shift) {
        Drawing lettered;
        lettered.layers = layers;
        lettered = with_outlined_texts(std::move(lettered));
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const DrawingLayer& layer = lettered.layers[i];
            std::array<double, 3> ink{};
            for (std::size_t k = 0; k < 3; ++k)
                ink[k] = std::stoi(layer.colour.substr(1 + 2 * k, 2), nullptr, 16);
            for (std::size_t k = 0; k < layer.paths.size(); ++k) {
                std::vector<std::vector<Vec2>> lines;
                for (const DrawingPolyline& part : layer.paths[k].parts) {
                    lines.emplace_back();
                    for (const Vec2& p : points_of(part))
                        lines.back().push_back(pixel_of(scale * p + shift));
                    if (k < layers[i].paths.size())
                        stroke(lines.back(), part.closed, layer.dash, ink);
                }
                if (k >= layers[i].paths.size()) // letters
                    fill(lines, [&](int x, int y) {
                        for (std::size_t c = 0; c < 3; ++c)
                            pixel(x, y)[c] = static_cast<std::uint8_t>(ink[c]);
                    });
            }
        }
    }

private:
    Vec2 pixel_of(const Vec2& p) const { return pixels_per_mm * Vec2(p.x(), height_ - p.y()); }
    Vec2 place_of(int x, int y) const {
        return Vec2((x + 0.5) / pixels_per_mm, height_ - (y + 0.5) / pixels_per_mm);
    }
    std::uint8_t* pixel(int x, int y) {
        return image_.rgb.data() + 3 * (static_cast<std::ptrdiff_t>(y) * image_.columns + x);
    }

    static std::vector<Vec2> points_of(const DrawingPolyline& part) {
        if (part.curves.empty())
            return part.points;
        std::vector<Vec2> points = {part.curves.front().control[0]};
        for (const DrawingCurve& curve : part.curves) {
            const auto& c = curve.control;
            const double bend =
                (c[0] - 2.0 * c[1] + c[2]).norm() + (c[1] - 2.0 * c[2] + c[3]).norm();
            const int steps = curve.is_line ? 1 : 1 + static_cast<int>(std::sqrt(bend / chord));
            for (int i = 1; i <= steps; ++i) {
                const double t = static_cast<double>(i) / steps;
                const double s = 1.0 - t;
                points.push_back(s * s * s * c[0] + 3.0 * s * s * t * c[1] +
                                 3.0 * s * t * t * c[2] + t * t * t * c[3]);
            }
        }
        return points;
    }

    // Pixels whose middles lie inside of the rings (pixels, y down) by the even-odd rule.
    template <class Paint>
    void fill(const std::vector<std::vector<Vec2>>& rings, Paint paint) {
        double low = image_.rows;
        double high = 0.0;
        for (const std::vector<Vec2>& ring : rings)
            for (const Vec2& p : ring) {
                low = std::min(low, p.y());
                high = std::max(high, p.y());
            }
        const int first = std::max(top_, static_cast<int>(std::floor(low)));
        const int last = std::min(bottom_, static_cast<int>(std::ceil(high)));
        std::vector<std::vector<double>> crossings(
            static_cast<std::size_t>(std::max(0, last - first)));
        for (const std::vector<Vec2>& ring : rings)
            for (std::size_t i = 0; i < ring.size(); ++i) {
                Vec2 a = ring[i];
                Vec2 b = ring[(i + 1) % ring.size()];
                if (a.y() > b.y())
                    std::swap(a, b);
                for (int y = std::max(first, static_cast<int>(std::ceil(a.y() - 0.5)));
                     y < last && y + 0.5 < b.y(); ++y)
                    crossings[static_cast<std::size_t>(y - first)].push_back(
                        plane::x_at_height(a, b, y + 0.5));
            }
        for (int y = first; y < last; ++y) {
            std::vector<double>& row = crossings[static_cast<std::size_t>(y - first)];
            std::sort(row.begin(), row.end());
            for (std::size_t i = 0; i + 1 < row.size(); i += 2)
                for (int x = std::max(left_, static_cast<int>(std::ceil(row[i] - 0.5)));
                     x < right_ && x + 0.5 < row[i + 1]; ++x)
                    paint(x, y);
        }
    }

    void stroke(const std::vector<Vec2>& line, bool closed, const std::vector<double>& dash,
                const std::array<double, 3>& ink) {
        std::size_t stretch = 0; // of the dash
        double left = dash.empty() ? infinite : dash[0] * pixels_per_mm;
        const std::size_t count =
            closed ? line.size() : line.size() - std::min<std::size_t>(1, line.size());
        for (std::size_t i = 0; i < count; ++i) {
            Vec2 from = line[i];
            const Vec2 to = line[(i + 1) % line.size()];
            for (double length = (to - from).norm(); length > 0.0;) {
                const double part = std::min(length, left);
                const Vec2 next = part == length ? to : Vec2(from + part / length * (to - from));
                if (stretch % 2 == 0)
                    segment(from, next, ink);
                from = next;
                length -= part;
                left -= part;
                if (left <= 0.0) {
                    ++stretch;
                    left = dash[stretch % dash.size()] * pixels_per_mm;
                }
            }
        }
    }

    // Pixels by the share that a line as wide as it covers of them, by distance from its middle.
    void segment(const Vec2& a, const Vec2& b, const std::array<double, 3>& ink) {
        const double half = 0.5 * line_width * pixels_per_mm;
        const Eigen::AlignedBox2d box =
            Eigen::AlignedBox2d(a.cwiseMin(b), a.cwiseMax(b)); // pixels, y down
        const auto bound = [&](double value, int least, int most) {
            return static_cast<int>(
                std::clamp(value, static_cast<double>(least), static_cast<double>(most)));
        };
        const double reach = half + 1.0;
        const int top = bound(std::floor(box.min().y() - reach), top_, bottom_);
        const int bottom = bound(std::ceil(box.max().y() + reach), top_, bottom_);
        const Vec2 along = b - a;
        for (int y = top; y < bottom; ++y) {
            // Of long slanted lines, the part beside this row.
            double low = box.min().x();
            double high = box.max().x();
            if (std::abs(along.y()) > 1.0) {
                const double one = a.x() + along.x() * (y - reach - a.y()) / along.y();
                const double other = a.x() + along.x() * (y + 1.0 + reach - a.y()) / along.y();
                low = std::max(low, std::min(one, other));
                high = std::min(high, std::max(one, other));
            }
            const int right = bound(std::ceil(high + reach), left_, right_);
            for (int x = bound(std::floor(low - reach), left_, right_); x < right; ++x) {
                const double cover = half + 0.5 - plane::distance(Vec2(x + 0.5, y + 0.5), a, b);
                if (cover <= 0.0)
                    continue;
                const double share = std::min(1.0, cover);
                std::uint8_t* p = pixel(x, y);
                for (std::size_t k = 0; k < 3; ++k)
                    p[k] = static_cast<std::uint8_t>(
                        std::lround((1.0 - share) * p[k] + share * ink[k]));
            }
        }
    }

    double height_; // mm
    DrawingImage image_;
    int left_ = 0;
    int top_ = 0;
    int right_ = 0;
    int bottom_ = 0;
};

} // namespace

std::string png_bytes(const DrawingImage& image) {
    QImage picture(image.rgb.data(), image.columns, image.rows, 3 * image.columns,
                   QImage::Format_RGB888);
    const auto per_metre =
        static_cast<int>(std::lround(1e3 * image.columns / std::max(1e-9, image.size.x())));
    picture.setDotsPerMeterX(per_metre);
    picture.setDotsPerMeterY(per_metre);
    QBuffer file;
    file.open(QIODevice::WriteOnly);
    if (!picture.save(&file, "PNG"))
        throw InvalidParameter("page: expected pictures that fit into memory in .png, found " +
                               std::to_string(image.columns) + " x " + std::to_string(image.rows) +
                               " pixels; give a smaller page");
    return file.data().toStdString();
}

std::vector<std::string> png_pages(const Document& document) {
    std::vector<std::string> files;
    for (const DocumentPage& page : document.pages) {
        Canvas canvas(page.width, page.height);
        for (const DrawingImage& image : page.images) {
            DrawingImage whole = image;
            const Vec2& s = image.size;
            whole.clip = {{{image.low, image.low + Vec2(s.x(), 0.0), image.low + s,
                            image.low + Vec2(0.0, s.y())},
                           true}};
            canvas.add(whole, 1.0, Vec2::Zero());
        }
        for (const PageWindow& window : page.windows) {
            const Vec2 shift = window.position - window.scale * window.low;
            canvas.show(window.position, window.position + window.scale * window.size);
            for (const DrawingImage& image : document.drawing.images)
                canvas.add(image, window.scale, shift);
            canvas.add(document.drawing.layers, window.scale, shift);
        }
        canvas.show_all();
        canvas.add(page.marks, 1.0, Vec2::Zero());
        files.push_back(png_bytes(canvas.image()));
    }
    return files;
}

} // namespace devseg::writers
