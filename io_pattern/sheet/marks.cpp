#include "sheet/marks.h"

#include <algorithm>
#include <cmath>

#include "sheet/segment_grid.h"
#include "writers/text_metrics.h"

namespace devseg {

namespace {

constexpr double pi = 3.14159265358979323846;

// Names fill this share of the circle around their place, up to a size that is easy to read.
constexpr double name_share = 0.7;
constexpr double largest_name = 8.0; // mm, font size
constexpr double detail_share = 0.5; // of the name's size
constexpr double least_detail = 1.8; // mm; smaller lines are left out
constexpr double line_pitch = 1.3;   // of the font size
constexpr double capital_share = 0.72;

// Seam numbers: the largest that fits, near the middle of the side; the last one always.
constexpr double number_sizes[] = {3.5, 2.8, 2.2, 1.7, 1.2}; // mm, font size
constexpr double number_places[] = {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.12, 0.88};
constexpr double number_gap = 0.35; // of the font size, between the line and the text

constexpr double notch_length = 4.0;   // mm, where there is no allowance
constexpr double notch_share = 0.6;    // of the allowance
constexpr double arrow_length = 4.0;   // mm
constexpr double arrow_angle = 0.4;    // radians
constexpr double shortest_grain = 6.0; // mm: less cannot be laid along a thread

struct OutlinePlace {
    Vec2 position = Vec2::Zero();
    Vec2 direction = Vec2::UnitX(); // along the outline, the piece on its left
};

// The place at this distance from the seam's start on one side.
OutlinePlace place_on(const PiecePath& path, const SeamSide& side, double distance) {
    const std::size_t count = path.points.size();
    double rest = side.reversed ? side.length - distance : distance;
    OutlinePlace place;
    for (Index i = 0; i < side.count; ++i) {
        const Vec2& a = path.points[at(side.first + i) % count];
        const Vec2& b = path.points[at(side.first + i + 1) % count];
        const double length = (b - a).norm();
        if (length > 0.0)
            place = {a + std::clamp(rest / length, 0.0, 1.0) * (b - a), (b - a) / length};
        if (rest <= length && length > 0.0)
            break;
        rest -= length;
    }
    return place;
}

using Box = std::array<Vec2, 4>;

Box text_box(const DrawingText& text) {
    const Vec2 along(std::cos(text.angle), std::sin(text.angle));
    const Vec2 up(-along.y(), along.x());
    const Vec2 half = 0.5 * text_width(text.text, text.size) * along;
    const Vec2 rise = 0.5 * capital_share * text.size * up;
    return {text.position - half - rise, text.position + half - rise, text.position + half + rise,
            text.position - half + rise};
}

// Where texts may go: inside the piece, clear of lines and of other texts.
class Room {
public:
    explicit Room(const SheetPiece& piece)
        : rings_(piece.has_allowance() ? piece.sew : piece.cut), grid_(piece.box(), largest_name) {
        for (const auto* rings : {&piece.cut, &piece.sew})
            for (const std::vector<Vec2>& ring : *rings)
                grid_.add_ring(ring, 0);
        for (const auto* lines : {&piece.slits, &piece.mountains, &piece.valleys})
            for (const std::vector<Vec2>& line : *lines)
                for (std::size_t i = 1; i < line.size(); ++i)
                    grid_.add(line[i - 1], line[i], 0);
    }

    void take(const DrawingText& text) {
        const Box box = text_box(text);
        grid_.add_ring({box.begin(), box.end()}, 0);
        grid_.add(box[0], box[2], 0); // what lies inside touches a diagonal
        grid_.add(box[1], box[3], 0);
    }

    bool is_free(const DrawingText& text) const {
        const Box box = text_box(text);
        return is_inside(rings_, text.position) &&
               !grid_.ring_touches({box.begin(), box.end()}, 1) &&
               !grid_.touches(box[0], box[2], 1) && !grid_.touches(box[1], box[3], 1);
    }

private:
    std::vector<std::vector<Vec2>> rings_;
    SegmentGrid grid_;
};

std::string quantity_text(const PatternPiece& piece, const Pattern& pattern) {
    if (piece.mirrored)
        return "mirrored " + pattern.pieces[at(piece.model)].name;
    if (piece.quantity == 0)
        return "same as " + pattern.pieces[at(piece.model)].name;
    return "";
}

// The name and, where there is room, a second line that names the piece of the same shape.
void add_name(const PatternPiece& piece, const Pattern& pattern, SheetPiece& result, Room& room) {
    if (piece.label_radius <= 0.0)
        return;
    const double half_width = 0.5 * text_width(piece.name, 1.0);
    const double size =
        std::min(largest_name, name_share * piece.label_radius / std::hypot(half_width, 0.5));
    result.names.push_back({piece.label_position, size, piece.name});
    room.take(result.names.back());
    const std::string detail = quantity_text(piece, pattern);
    if (detail.empty() || detail_share * size < least_detail)
        return;
    const DrawingText line{piece.label_position - Vec2(0.0, line_pitch * 0.75 * size),
                           detail_share * size, detail};
    if (!room.is_free(line))
        return;
    room.take(line);
    result.names.push_back(line);
}

void add_number(const PiecePath& path, const SeamSide& side, const std::string& label,
                SheetPiece& result, Room& room) {
    DrawingText text;
    text.text = label;
    for (const double size : number_sizes)
        for (const double share : number_places) {
            const OutlinePlace place = place_on(path, side, share * side.length);
            const Vec2 inward(-place.direction.y(), place.direction.x());
            text.size = size;
            text.position = place.position + (0.5 * capital_share + number_gap) * size * inward;
            const double angle = std::atan2(place.direction.y(), place.direction.x());
            text.angle = angle > 0.5 * pi ? angle - pi : angle <= -0.5 * pi ? angle + pi : angle;
            if (room.is_free(text)) {
                room.take(text);
                result.numbers.push_back(text);
                return;
            }
        }
    const OutlinePlace place = place_on(path, side, 0.5 * side.length);
    text.position = place.position + (0.5 * capital_share + number_gap) * text.size *
                                         Vec2(-place.direction.y(), place.direction.x());
    result.numbers.push_back(text);
}

// Distance from p along the direction to the nearest cut line, or a negative number.
double reach(const SheetPiece& piece, const Vec2& p, const Vec2& direction, double most) {
    double best = -1.0;
    for (const std::vector<Vec2>& ring : piece.cut)
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vec2 a = ring[i] - p;
            const Vec2 d = ring[(i + 1) % ring.size()] - ring[i];
            const double across = direction.x() * d.y() - direction.y() * d.x();
            if (across == 0.0)
                continue;
            const double t = (a.x() * d.y() - a.y() * d.x()) / across;
            const double s = (a.x() * direction.y() - a.y() * direction.x()) / across;
            if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= most && (best < 0.0 || t < best))
                best = t;
        }
    return best;
}

// In the allowance, from the cut line towards the sew line; without one, and in the folded
// allowance of a narrow dart, from the sew line inwards.
void add_notch(const PiecePath& path, const SeamSide& side, double distance, double allowance,
               SheetPiece& result) {
    const OutlinePlace place = place_on(path, side, distance);
    const Vec2 outward(place.direction.y(), -place.direction.x());
    if (allowance > 0.0) {
        const double out = reach(result, place.position, outward, 1.01 * allowance);
        if (out > 0.0) {
            result.notches.push_back({place.position + out * outward,
                                      place.position + (1.0 - notch_share) * out * outward});
            return;
        }
    }
    result.notches.push_back({place.position, place.position - notch_length * outward});
}

void add_grain(const PatternPiece& piece, SheetPiece& result) {
    const Vec2 from = piece.grain[0];
    const Vec2 to = piece.grain[1];
    const double length = (to - from).norm();
    if (length < shortest_grain)
        return;
    result.grain_line = piece.grain;
    const Vec2 direction = (to - from) / length;
    const double head = std::min(arrow_length, 0.3 * length);
    const auto barb = [&](const Vec2& tip, const Vec2& along, double angle) {
        return Vec2(tip - head * (Eigen::Rotation2Dd(angle) * along));
    };
    result.grain = {
        {from, to},
        {barb(to, direction, arrow_angle), to, barb(to, direction, -arrow_angle)},
        {barb(from, -direction, arrow_angle), from, barb(from, -direction, -arrow_angle)}};
}

template <class Visit>
void for_sides(const std::vector<Seam>& seams, Index piece, Visit visit) {
    for (const Seam& seam : seams)
        for (const SeamSide& side : seam.sides)
            if (side.piece == piece)
                visit(seam, side);
}

} // namespace

void add_marks(const Pattern& pattern, const std::vector<Seam>& numbered,
               const ExportOptions& options, SheetPiece& result) {
    const PatternPiece& piece = pattern.pieces[at(result.piece)];
    Room room(result);
    if (options.labels)
        add_name(piece, pattern, result, room);
    if (options.grain_line)
        add_grain(piece, result);
    for_sides(pattern.seams, result.piece, [&](const Seam&, const SeamSide& side) {
        for (const double distance : side.notches)
            add_notch(piece.path(side.path), side, distance, options.seam_allowance_mm, result);
    });
    if (options.edge_numbers)
        for_sides(numbered, result.piece, [&](const Seam& seam, const SeamSide& side) {
            add_number(piece.path(side.path), side, seam.label, result, room);
        });
}

} // namespace devseg
