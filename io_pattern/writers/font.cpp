#include "writers/font.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "writers/text.h"

extern "C" {
extern const char devseg_font[];
extern const char devseg_font_end[];
extern const char devseg_far_font[];
extern const char devseg_far_font_end[];
}

namespace devseg::writers {

namespace {

// Of points and parts of glyphs.
constexpr unsigned on_curve = 1, short_x = 2, short_y = 4, repeated = 8, same_x = 16, same_y = 32;
constexpr unsigned wide_offsets = 1, has_scale = 8, more_parts = 32, has_two_scales = 64,
                   has_matrix = 128;
constexpr double fixed_one = 16384.0; // of numbers with 14 bits behind the point

struct ContourPoint {
    Vec2 place = Vec2::Zero();
    bool is_on = true;
};

DrawingCurve quadratic(const Vec2& a, const Vec2& b, const Vec2& c) {
    DrawingCurve curve;
    curve.control = {a, a + 2.0 / 3.0 * (b - a), c + 2.0 / 3.0 * (b - c), c};
    curve.is_line = false;
    return curve;
}

// Between two points off the curve lies one on it.
DrawingPolyline closed_curve(std::vector<ContourPoint> points) {
    std::vector<ContourPoint> all;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const ContourPoint& next = points[(i + 1) % points.size()];
        all.push_back(points[i]);
        if (!points[i].is_on && !next.is_on)
            all.push_back({0.5 * (points[i].place + next.place), true});
    }
    const auto first =
        std::find_if(all.begin(), all.end(), [](const ContourPoint& p) { return p.is_on; });
    DrawingPolyline line;
    if (first == all.end())
        return line;
    std::rotate(all.begin(), first, all.end());
    all.push_back(all.front());
    for (std::size_t i = 0; i + 1 < all.size();) {
        const Vec2 from = all[i].place;
        if (all[i + 1].is_on) {
            const Vec2 to = all[i + 1].place;
            DrawingCurve curve;
            curve.control = {from, from + (to - from) / 3.0, to - (to - from) / 3.0, to};
            line.curves.push_back(curve);
            i += 1;
        } else {
            line.curves.push_back(quadratic(from, all[i + 1].place, all[i + 2].place));
            i += 2;
        }
        line.points.push_back(from);
    }
    return line;
}

template <class Change>
void change_points(std::vector<DrawingPolyline>& lines, Change change) {
    for (DrawingPolyline& line : lines) {
        for (Vec2& p : line.points)
            p = change(p);
        for (DrawingCurve& curve : line.curves)
            for (Vec2& p : curve.control)
                p = change(p);
    }
}

void put(std::string& bytes, std::uint32_t value, int size) {
    for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
        bytes.push_back(static_cast<char>(value >> shift & 0xffU));
}

} // namespace

const std::vector<Font>& built_in_fonts() {
    const auto between = [](const char* first, const char* last) {
        return std::string_view(first, static_cast<std::size_t>(last - first));
    };
    static const std::vector<Font> fonts{
        {"DejaVuSans", between(devseg_font, devseg_font_end)},
        {"DroidSansFallback", between(devseg_far_font, devseg_far_font_end)}};
    return fonts;
}

Glyph glyph_of(unsigned code_point) {
    const std::vector<Font>& fonts = built_in_fonts();
    for (std::size_t font = 0; font < fonts.size(); ++font)
        if (const int number = fonts[font].glyph(code_point); number != 0)
            return {font, number};
    return {};
}

double advance(const Glyph& glyph) {
    return built_in_fonts()[glyph.font].advance(glyph.number);
}

Font::Font(std::string name, std::string_view bytes) : name_(std::move(name)), bytes_(bytes) {
    const Table head = table("head");
    units_ = u16(head.start + 18);
    box_ = {Vec2(s16(head.start + 36), s16(head.start + 38)) / units_,
            Vec2(s16(head.start + 40), s16(head.start + 42)) / units_};
    ascent_ = s16(table("hhea").start + 4) / units_;
    descent_ = s16(table("hhea").start + 6) / units_;
    long_places_ = u16(head.start + 50) != 0;
    glyph_count_ = static_cast<int>(u16(table("maxp").start + 4));
    metric_count_ = static_cast<int>(u16(table("hhea").start + 34));
    loca_ = table("loca");
    glyf_ = table("glyf");
    hmtx_ = table("hmtx");
    const std::size_t cmap = table("cmap").start;
    for (unsigned i = 0; i < u16(cmap + 2); ++i) {
        const std::size_t map = cmap + u32(cmap + 4 + 8 * i + 4);
        if (u16(map) == 12) {
            groups_ = map + 16;
            group_count_ = u32(map + 12);
        }
    }
}

Font::Table Font::table(const char* name) const {
    for (unsigned i = 0; i < u16(4); ++i) {
        const std::size_t entry = 12 + 16 * std::size_t{i};
        if (bytes_.compare(entry, 4, name) == 0)
            return {u32(entry + 8), u32(entry + 12)};
    }
    return {};
}

unsigned Font::u16(std::size_t at) const {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes_[at])) << 8 |
           static_cast<unsigned char>(bytes_[at + 1]);
}
std::uint32_t Font::u32(std::size_t at) const {
    return u16(at) << 16 | u16(at + 2);
}
int Font::s16(std::size_t at) const {
    return static_cast<std::int16_t>(u16(at));
}

int Font::glyph(unsigned code_point) const {
    std::uint32_t low = 0;
    std::uint32_t high = group_count_;
    while (low < high) {
        const std::uint32_t middle = (low + high) / 2;
        const std::size_t group = groups_ + 12 * std::size_t{middle};
        if (code_point > u32(group + 4))
            low = middle + 1;
        else if (code_point < u32(group))
            high = middle;
        else
            return static_cast<int>(u32(group + 8) + code_point - u32(group));
    }
    return 0;
}

double Font::advance(int glyph) const {
    const int metric = std::min(glyph, metric_count_ - 1);
    return u16(hmtx_.start + 4 * static_cast<std::size_t>(metric)) / units_;
}

Font::Table Font::glyph_data(int glyph) const {
    const auto i = static_cast<std::size_t>(glyph);
    const auto place = [&](std::size_t k) -> std::size_t {
        return long_places_ ? u32(loca_.start + 4 * k) : 2 * u16(loca_.start + 2 * k);
    };
    return {glyf_.start + place(i), place(i + 1) - place(i)};
}

std::vector<DrawingPolyline> Font::outline(int glyph) const {
    std::vector<DrawingPolyline> result;
    const Table data = glyph_data(glyph);
    if (data.size == 0)
        return result; // a blank
    const int contours = s16(data.start);
    if (contours >= 0)
        add_simple(data.start + 10, contours, result);
    else
        add_parts(data.start + 10, result);
    return result;
}

void Font::add_simple(std::size_t at, int contours, std::vector<DrawingPolyline>& result) const {
    std::vector<std::size_t> ends;
    for (int i = 0; i < contours; ++i, at += 2)
        ends.push_back(u16(at));
    if (ends.empty())
        return;
    at += 2 + u16(at); // instructions
    std::vector<unsigned> flags;
    while (flags.size() <= ends.back()) {
        const auto flag = static_cast<unsigned char>(bytes_[at++]);
        const int count = (flag & repeated) != 0 ? static_cast<unsigned char>(bytes_[at++]) : 0;
        flags.insert(flags.end(), static_cast<std::size_t>(count) + 1, flag);
    }
    std::vector<ContourPoint> points(flags.size());
    for (const int axis : {0, 1}) {
        const unsigned is_short = axis == 0 ? short_x : short_y;
        const unsigned is_same = axis == 0 ? same_x : same_y;
        int value = 0;
        for (std::size_t i = 0; i < flags.size(); ++i) {
            if ((flags[i] & is_short) != 0) {
                const int step = static_cast<unsigned char>(bytes_[at++]);
                value += (flags[i] & is_same) != 0 ? step : -step;
            } else if ((flags[i] & is_same) == 0) {
                value += s16(at);
                at += 2;
            }
            points[i].place[axis] = value / units_;
            points[i].is_on = (flags[i] & on_curve) != 0;
        }
    }
    std::size_t first = 0;
    for (const std::size_t last : ends) {
        result.push_back(closed_curve({points.begin() + static_cast<std::ptrdiff_t>(first),
                                       points.begin() + static_cast<std::ptrdiff_t>(last + 1)}));
        first = last + 1;
    }
}

// Letters with accents are made of two glyphs.
void Font::add_parts(std::size_t at, std::vector<DrawingPolyline>& result) const {
    for (unsigned flags = more_parts; (flags & more_parts) != 0;) {
        flags = u16(at);
        const int part = static_cast<int>(u16(at + 2));
        at += 4;
        Vec2 shift(static_cast<signed char>(bytes_[at]), static_cast<signed char>(bytes_[at + 1]));
        if ((flags & wide_offsets) != 0)
            shift = Vec2(s16(at), s16(at + 2));
        at += (flags & wide_offsets) != 0 ? 4 : 2;
        Eigen::Matrix2d matrix = Eigen::Matrix2d::Identity();
        const auto number = [&] {
            at += 2;
            return s16(at - 2) / fixed_one;
        };
        if ((flags & has_scale) != 0) {
            matrix *= number();
        } else if ((flags & has_two_scales) != 0) {
            matrix(0, 0) = number();
            matrix(1, 1) = number();
        } else if ((flags & has_matrix) != 0) {
            matrix(0, 0) = number();
            matrix(1, 0) = number();
            matrix(0, 1) = number();
            matrix(1, 1) = number();
        }
        std::vector<DrawingPolyline> lines = outline(part);
        change_points(lines, [&](const Vec2& p) { return Vec2(matrix * p + shift / units_); });
        result.insert(result.end(), lines.begin(), lines.end());
    }
}

void Font::add_needed(int glyph, std::set<int>& all) const {
    if (!all.insert(glyph).second)
        return;
    const Table data = glyph_data(glyph);
    if (data.size == 0 || s16(data.start) >= 0)
        return;
    std::size_t at = data.start + 10;
    for (unsigned flags = more_parts; (flags & more_parts) != 0;) {
        flags = u16(at);
        add_needed(static_cast<int>(u16(at + 2)), all);
        at += 4 + ((flags & wide_offsets) != 0 ? 4U : 2U);
        at += (flags & has_scale) != 0        ? 2U
              : (flags & has_two_scales) != 0 ? 4U
              : (flags & has_matrix) != 0     ? 8U
                                              : 0U;
    }
}

std::string Font::subset(const std::set<int>& glyphs) const {
    std::set<int> all;
    add_needed(0, all);
    for (const int glyph : glyphs)
        add_needed(glyph, all);
    std::string outlines;
    std::string places;
    for (int i = 0; i <= glyph_count_; ++i) {
        put(places, static_cast<std::uint32_t>(outlines.size()), 4);
        if (i < glyph_count_ && all.count(i) > 0) {
            const Table data = glyph_data(i);
            outlines += bytes_.substr(data.start, data.size);
            outlines.resize((outlines.size() + 3) / 4 * 4, '\0');
        }
    }
    const char* const names[] = {"cvt ", "fpgm", "glyf", "head", "hhea",
                                 "hmtx", "loca", "maxp", "prep"};
    constexpr std::uint32_t count = 9;
    std::string head;
    put(head, 0x00010000, 4);
    put(head, count, 2);
    put(head, 128, 2); // of the greatest power of two below the count, for searches
    put(head, 3, 2);
    put(head, 16 * count - 128, 2);
    std::string body;
    for (const char* name : names) {
        const Table found = table(name);
        std::string content(bytes_.substr(found.start, found.size));
        if (std::string(name) == "glyf")
            content = outlines;
        if (std::string(name) == "loca")
            content = places;
        if (std::string(name) == "head")
            content[51] = 1; // places of four bytes
        const std::size_t size = content.size();
        content.resize((size + 3) / 4 * 4, '\0');
        std::uint32_t sum = 0;
        for (std::size_t i = 0; i < content.size(); i += 4)
            for (std::size_t k = 0; k < 4; ++k)
                sum += static_cast<std::uint32_t>(static_cast<unsigned char>(content[i + k]))
                       << (8 * (3 - k));
        head += name;
        put(head, sum, 4);
        put(head, static_cast<std::uint32_t>(12 + 16 * count + body.size()), 4);
        put(head, static_cast<std::uint32_t>(size), 4);
        body += content;
    }
    return head + body;
}

bool needs_font(const std::string& utf8) {
    const std::vector<unsigned> points = code_points(utf8);
    return std::any_of(points.begin(), points.end(), [](unsigned p) { return p > 0xff; });
}

int missing_glyphs(const std::string& utf8) {
    const std::vector<unsigned> points = code_points(utf8);
    return static_cast<int>(std::count_if(points.begin(), points.end(), [](unsigned p) {
        return p >= 0x20 && glyph_of(p).number == 0;
    }));
}

Drawing with_outlined_texts(Drawing drawing) {
    for (DrawingLayer& layer : drawing.layers) {
        for (const DrawingText& text : layer.texts) {
            double own_width = 0.0;
            for (const unsigned point : code_points(text.text))
                own_width += advance(glyph_of(point));
            // The room for it was found by other widths.
            const double stretch = own_width > 0.0 ? text_width(text.text, 1.0) / own_width : 1.0;
            const Vec2 start = text_start(text);
            const Eigen::Rotation2Dd turn(text.angle);
            DrawingPath path;
            path.owner = text.owner;
            double x = 0.0;
            for (const unsigned point : code_points(text.text)) {
                const Glyph glyph = glyph_of(point);
                std::vector<DrawingPolyline> lines =
                    built_in_fonts()[glyph.font].outline(glyph.number);
                change_points(lines, [&](const Vec2& p) {
                    return Vec2(start + turn * (text.size * Vec2(stretch * (x + p.x()), p.y())));
                });
                path.parts.insert(path.parts.end(), lines.begin(), lines.end());
                x += advance(glyph);
            }
            if (!path.parts.empty())
                layer.paths.push_back(std::move(path));
        }
        layer.texts.clear();
    }
    return drawing;
}

} // namespace devseg::writers
