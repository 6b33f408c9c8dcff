#include "sheet/marks.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"
#include "sheet/segment_grid.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

// Font sizes in mm: the largest that fits. Less than the last cannot be read on paper.
constexpr double name_sizes[] = {8.0, 6.5, 5.0, 4.0, 3.2, 2.5};
constexpr double number_sizes[] = {3.5, 3.0, 2.5};
constexpr double clearance = 0.2;    // of the font size, around a text
constexpr double detail_share = 0.5; // of the name's size
constexpr double name_pitch = 1.3;   // of the font size

// A name may lie anywhere in its piece: so many places are tried along x and y.
constexpr int name_places = 14;
// The largest disk of a piece may be so much larger than the one that was found.
constexpr double label_slack = 2.0;

// Places of a number along its side, as shares of the length, the middle first.
constexpr double number_places[] = {0.5,  0.4,  0.6,  0.3,  0.7,  0.2,  0.8,  0.12, 0.88, 0.45,
                                    0.55, 0.35, 0.65, 0.25, 0.75, 0.16, 0.84, 0.08, 0.92};
constexpr double number_gap = 0.35; // of the font size, between the line and the text

// Lines to numbers: where they start, their angles with the normal, and how long they are.
constexpr double leader_places[] = {0.5, 0.35, 0.65, 0.2, 0.8};
constexpr double leader_angles[] = {0.0, 0.5, -0.5, 1.0, -1.0};
constexpr double shortest_leader = 2.0; // mm
constexpr double longest_leader = 30.0;
constexpr double leader_step = 1.4;  // factor from one length to the next
constexpr double leader_start = 0.2; // mm from the seam, so that it touches nothing there

using Box = std::array<Vec2, 4>;

// Around the text, with some room.
Box text_box(const writers::DrawingText& text) {
    const Vec2 along(std::cos(text.angle), std::sin(text.angle));
    const Vec2 up = plane::left_of(along);
    const Vec2 half =
        (0.5 * writers::text_width(text.text, text.size) + clearance * text.size) * along;
    const Vec2 rise = (0.5 * writers::capital_height + clearance) * text.size * up;
    return {text.position - half - rise, text.position + half - rise, text.position + half + rise,
            text.position - half + rise};
}

std::vector<Vec2> ring_of(const Box& box) {
    return {box.begin(), box.end()};
}

// Where texts may go: inside the piece, clear of outlines, of other texts, and of the lines inside.
class Room {
public:
    explicit Room(const SheetPiece& piece)
        : piece_(piece), inside_(piece.has_allowance() ? piece.sew : piece.cut),
          solid_(piece.box(), name_sizes[0]), lines_(piece.box(), name_sizes[0]) {
        for (const auto* rings : {&piece.cut, &piece.sew})
            for (const std::vector<Vec2>& ring : *rings)
                solid_.add_ring(ring, 0);
        for (const std::vector<Vec2>& slit : piece.slits)
            add_line(slit, solid_);
        for (const auto* lines : {&piece.mountains, &piece.valleys, &piece.grain, &piece.openings,
                                  &piece.perforations, &piece.shadows})
            for (const std::vector<Vec2>& line : *lines)
                add_line(line, lines_);
        for (const SheetNotch& notch : piece.notches)
            lines_.add(notch.outer, notch.inner, 0);
    }

    void take(const writers::DrawingText& text) {
        const Box box = text_box(text);
        solid_.add_ring(ring_of(box), 0);
        solid_.add(box[0], box[2], 0); // what lies inside touches a diagonal
        solid_.add(box[1], box[3], 0);
    }
    void take(const std::vector<Vec2>& leader) { add_line(leader, solid_); }

    /// `over_lines`: lines inside the piece may be crossed.
    bool is_free(const writers::DrawingText& text, bool over_lines) const {
        return plane::is_inside(inside_, text.position) && touches_nothing(text, over_lines);
    }
    /// On the allowance or a tab as well.
    bool is_free_outside(const writers::DrawingText& text, bool over_lines) const {
        return plane::is_inside(piece_.cut, text.position) && touches_nothing(text, over_lines);
    }
    /// For a line that leads to a text.
    bool is_free(const Vec2& from, const Vec2& to) const { return !solid_.touches(from, to, 1); }

private:
    static void add_line(const std::vector<Vec2>& line, SegmentGrid& grid) {
        for (std::size_t i = 1; i < line.size(); ++i)
            grid.add(line[i - 1], line[i], 0);
    }
    static bool touches(const Box& box, const SegmentGrid& grid) {
        return grid.ring_touches(ring_of(box), 1) || grid.touches(box[0], box[2], 1) ||
               grid.touches(box[1], box[3], 1);
    }
    bool touches_nothing(const writers::DrawingText& text, bool over_lines) const {
        const Box box = text_box(text);
        return !touches(box, solid_) && (over_lines || !touches(box, lines_));
    }

    const SheetPiece& piece_;
    const std::vector<std::vector<Vec2>>& inside_;
    SegmentGrid solid_;
    SegmentGrid lines_;
};

std::string quantity_text(const pattern::PatternPiece& piece, const pattern::Pattern& pattern) {
    if (piece.mirrored)
        return "mirrored " + pattern.pieces[piece.model].name;
    if (piece.quantity == 0)
        return "same as " + pattern.pieces[piece.model].name;
    return "";
}

// The middle of the piece first, then places all over it, those near the middle before others.
std::vector<Vec2> places_for_name(const Vec2& middle, const Eigen::AlignedBox2d& box) {
    std::vector<Vec2> places{middle};
    for (int i = 0; i < name_places; ++i)
        for (int k = 0; k < name_places; ++k)
            places.emplace_back(box.min() +
                                box.sizes().cwiseProduct(Vec2(i + 0.5, k + 0.5) / name_places));
    std::stable_sort(places.begin(), places.end(), [&](const Vec2& a, const Vec2& b) {
        return (a - middle).squaredNorm() < (b - middle).squaredNorm();
    });
    return places;
}

bool write_name(const std::vector<Vec2>& places, double widest, const Room& room, bool over_lines,
                SheetPiece& result) {
    for (const double size : name_sizes) {
        // A text is no higher than twice the radius of the largest disk inside the piece.
        if ((0.5 * writers::capital_height + clearance) * size > widest)
            continue;
        for (const Vec2& place : places) {
            const writers::DrawingText text{place, size, result.name};
            if (!room.is_free(text, over_lines))
                continue;
            result.names.push_back(text);
            return true;
        }
    }
    return false;
}

// The name and, where there is room, a second line that names the piece of the same shape.
bool add_name(const pattern::PatternPiece& piece, const pattern::Pattern& pattern,
              SheetPiece& result, Room& room) {
    const std::vector<Vec2> places =
        places_for_name(result.frame(piece.label_position), result.box());
    const double widest = label_slack * piece.label_radius;
    if (!write_name(places, widest, room, false, result) &&
        !write_name(places, widest, room, true, result))
        return false;
    const writers::DrawingText name = result.names.back();
    room.take(name);
    const std::string detail = quantity_text(piece, pattern);
    const writers::DrawingText line{name.position - Vec2(0.0, name_pitch * 0.75 * name.size),
                                    std::max(detail_share * name.size, name_sizes[5]), detail};
    if (!detail.empty() && room.is_free(line, false)) {
        room.take(line);
        result.names.push_back(line);
    }
    return true;
}

double upright(double angle) {
    return angle > 0.5 * pi ? angle - pi : angle <= -0.5 * pi ? angle + pi : angle;
}

// The number of a seam on one side of it.
class NumberWriter {
public:
    NumberWriter(const pattern::PiecePath& path, const pattern::SeamSide& side,
                 const std::string& label, const SheetPiece& piece, const Room& room)
        : path_(path), side_(side), piece_(piece), room_(room), to_(side.length) {
        text_.text = label;
    }
    /// Only beside this stretch of the seam, mm.
    void keep_to(double from, double to) {
        from_ = from;
        to_ = to;
    }

    // Whether there is a place; `text` and `leader` are what to draw then.
    bool find() {
        return find_beside(1.0, false) || find_beside(-1.0, false) || find_apart(false) ||
               find_beside(1.0, true) || find_beside(-1.0, true) || find_apart(true);
    }

    const writers::DrawingText& text() const { return text_; }
    const std::vector<Vec2>& leader() const { return leader_; }

private:
    struct Place {
        Vec2 position;
        Vec2 along;
        Vec2 inward;
    };

    Place place(double share) const {
        const OutlinePlace found = place_on(path_, side_, from_ + share * (to_ - from_));
        const Vec2 inward = plane::left_of(found.direction);
        return {piece_.frame(found.position), piece_.frame.direction(found.direction),
                piece_.frame.direction(inward)};
    }

    // Along the seam, inside the piece (side 1) or on its allowance or tab (−1).
    bool find_beside(double side, bool over_lines) {
        for (const double size : number_sizes)
            for (const double share : number_places) {
                const Place p = place(share);
                text_.size = size;
                text_.position = p.position + side * (0.5 * writers::capital_height + number_gap) *
                                                  size * p.inward;
                text_.angle = upright(std::atan2(p.along.y(), p.along.x()));
                if (side > 0.0 ? room_.is_free(text_, over_lines)
                               : room_.is_free_outside(text_, over_lines))
                    return true;
            }
        return false;
    }

    // Farther inside, at the end of a line.
    bool find_apart(bool over_lines) {
        text_.angle = 0.0;
        text_.size = number_sizes[2];
        const double half =
            0.5 * writers::text_width(text_.text, text_.size) + clearance * text_.size;
        const double rise = (0.5 * writers::capital_height + clearance) * text_.size;
        for (double length = shortest_leader; length <= longest_leader; length *= leader_step)
            for (const double share : leader_places)
                for (const double angle : leader_angles) {
                    const Place p = place(share);
                    const Vec2 along = Eigen::Rotation2Dd(angle) * p.inward;
                    const Vec2 end = p.position + length * along;
                    // The line ends where it would enter the box around the text.
                    const double depth = std::min(half / std::max(std::abs(along.x()), 1e-9),
                                                  rise / std::max(std::abs(along.y()), 1e-9));
                    text_.position = end + depth * along;
                    const Vec2 start = p.position + leader_start * along;
                    const Vec2 last = end - leader_start * along;
                    if (!room_.is_free(text_, over_lines) || !room_.is_free(start, last))
                        continue;
                    leader_ = {start, last};
                    return true;
                }
        return false;
    }

    const pattern::PiecePath& path_;
    const pattern::SeamSide& side_;
    const SheetPiece& piece_;
    const Room& room_;
    double from_ = 0.0;
    double to_;
    writers::DrawingText text_;
    std::vector<Vec2> leader_;
};

const char* const opening_text = "leave open";

void write_openings(const pattern::Pattern& pattern, const assembly::Assembly& assembly,
                    SheetPiece& piece, Room& room) {
    for (const assembly::Opening& opening : assembly.openings) {
        const pattern::Seam& seam = pattern.seams[at(opening.seam)];
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
            const pattern::SeamSide& side = seam.sides[k];
            if (side.piece != piece.piece)
                continue;
            NumberWriter text(pattern.pieces[at(side.piece)].path(side.path), side, opening_text,
                              piece, room);
            const auto [from, to] = opening_stretch(seam, k, opening);
            text.keep_to(from, to);
            if (!text.find())
                continue; // the marks are there, and the cover says what they mean
            room.take(text.text());
            room.take(text.leader());
            piece.names.push_back(text.text());
            if (!text.leader().empty())
                piece.leaders.push_back(text.leader());
        }
    }
}

// What stands beside a seam: its number, and the step that does it.
std::string seam_text(const pattern::Pattern& pattern, const assembly::Assembly& assembly,
                      const ExportOptions& options, std::size_t s) {
    const std::string& label = pattern.seams[s].label;
    return options.step_numbers ? label + " (" + std::to_string(assembly.seam_step[s]) + ")"
                                : label;
}

struct WrittenNumber {
    std::size_t piece = 0; // in the layout
    writers::DrawingText text;
    std::vector<Vec2> leader;
};

} // namespace

OutlinePlace place_on(const pattern::PiecePath& path, const pattern::SeamSide& side,
                      double distance) {
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

bool is_ambiguous(const std::string& number) {
    constexpr const char* upside_down = "01----9-86"; // of each digit
    std::string turned;
    for (auto c = number.rbegin(); c != number.rend(); ++c)
        turned += *c >= '0' && *c <= '9' ? upside_down[*c - '0'] : '-';
    return turned != number && turned.find('-') == std::string::npos && turned.front() != '0';
}

namespace {

// Both sides of a dart meet at its tip: one number stands for both.
std::size_t numbers_of(const pattern::Seam& seam) {
    return seam.is_dart ? 1 : seam.sides.size();
}

} // namespace

LeftOut add_texts(const pattern::Pattern& pattern, const assembly::Assembly& assembly,
                  const ExportOptions& options, std::vector<SheetPiece>& pieces,
                  const std::vector<std::vector<std::array<Vec2, 2>>>& borders) {
    LeftOut left_out;
    std::vector<std::vector<WrittenNumber>> written(pattern.seams.size());
    std::vector<std::size_t> wanted(pattern.seams.size(), 0);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        SheetPiece& piece = pieces[i];
        const pattern::PatternPiece& source = pattern.pieces[piece.piece];
        Room room(piece);
        if (!borders.empty())
            for (const auto& [from, to] : borders[at(piece.sheet)])
                room.take({from, to});
        if (options.labels && !add_name(source, pattern, piece, room))
            left_out.pieces.push_back(piece.piece);
        if (options.labels && options.marks_openings())
            write_openings(pattern, assembly, piece, room);
        if (!options.edge_numbers)
            continue;
        for (const Index seam : source.seams()) {
            const std::size_t s = at(seam);
            for (const pattern::SeamSide& side : pattern.seams[s].sides) {
                if (side.piece != piece.piece || written[s].size() == numbers_of(pattern.seams[s]))
                    continue;
                ++wanted[s];
                NumberWriter number(source.path(side.path), side,
                                    seam_text(pattern, assembly, options, s), piece, room);
                if (!number.find())
                    continue;
                room.take(number.text());
                room.take(number.leader());
                written[s].push_back({i, number.text(), number.leader()});
            }
        }
    }
    for (std::size_t s = 0; s < written.size() && options.edge_numbers; ++s) {
        if (written[s].size() < std::min(wanted[s], numbers_of(pattern.seams[s]))) {
            left_out.seams.push_back(static_cast<Index>(s));
            continue;
        }
        for (const WrittenNumber& number : written[s]) {
            pieces[number.piece].numbers.push_back(number.text);
            if (!number.leader.empty())
                pieces[number.piece].leaders.push_back(number.leader);
        }
    }
    return left_out;
}

} // namespace devseg::sheet
