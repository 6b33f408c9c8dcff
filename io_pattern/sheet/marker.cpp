#include "sheet/marker.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/pack/strip.h"
#include "devseg/plane/plane.h"
#include "sheet/drawing_plan.h"
#include "sheet/half_piece.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

struct Tuning {
    double fast = 0.3; // times the usual effort
    double best = 4.0;
    double caption = 12.0;    // mm at the end of the cloth, for its description
    double text = 6.0;        // mm
    double most_copies = 1e4; // pieces on one marker
};
constexpr Tuning tuning;

std::string mm(double length) {
    return writers::number_text(length, 1) + " mm";
}

double effort_of(Effort effort) {
    return effort == Effort::fast ? tuning.fast : effort == Effort::best ? tuning.best : 1.0;
}

// A piece as it is laid on the cloth.
struct Laid {
    SheetPiece piece;
    bool at_fold = false;
    Index layers = 1; // that are cut and kept
};

// Angles that turn the direction upwards.
std::vector<double> grain_angles(const Vec2& grain, const ExportOptions& options) {
    if (options.grain == pattern::GrainDirection::free)
        return {};
    const double angle = 0.5 * pi - std::atan2(grain.y(), grain.x());
    if (options.nap)
        return {angle};
    return {angle, angle + pi};
}

// On folded cloth: what of each shape is cut from both layers at once, along the fold, and alone.
class Folding {
public:
    Folding(const pattern::Pattern& pattern, const ExportOptions& options,
            const std::vector<SheetPiece>& pieces, Index fabric)
        : pattern_(pattern), options_(options), pieces_(pieces), fabric_(fabric) {}

    std::vector<Laid> all() {
        std::vector<Laid> laid;
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            if (at(pattern_.pieces[i].model) == i && pattern_.pieces[i].fabric == fabric_)
                add_shape(i, laid);
        return laid;
    }
    Index single_count() const { return single_count_; }

private:
    // Pieces of this shape, as they are (0) and mirrored (1), in the order of the pattern.
    void add_shape(std::size_t model, std::vector<Laid>& laid) {
        std::vector<std::size_t> kinds[2];
        for (int copy = 0; copy < options_.copies; ++copy)
            for (std::size_t i = 0; i < pieces_.size(); ++i)
                if (at(pattern_.pieces[i].model) == model)
                    kinds[pattern_.pieces[i].mirrored ? 1 : 0].push_back(i);
        const auto axis =
            pattern::find_mirror_axis(pattern_.pieces[model], options_.pair_tolerance_mm);
        if (axis) { // all are their own mirror images
            kinds[0].insert(kinds[0].end(), kinds[1].begin(), kinds[1].end());
            kinds[1].clear();
            while (kinds[0].size() > 1) {
                laid.push_back({pieces_[kinds[0].front()], false, 2});
                kinds[0].erase(kinds[0].begin(), kinds[0].begin() + 2);
            }
        }
        while (!kinds[0].empty() && !kinds[1].empty()) {
            laid.push_back({pieces_[kinds[0].back()], false, 2});
            kinds[0].pop_back();
            kinds[1].pop_back();
        }
        for (const auto& kind : kinds)
            for (const std::size_t i : kind)
                add_single(i, axis, laid);
    }

    void add_single(std::size_t i, const std::optional<pattern::MirrorAxis>& axis,
                    std::vector<Laid>& laid) {
        if (axis) {
            const pattern::PatternPiece& piece = pattern_.pieces[i];
            const double off = std::abs(plane::cross(axis->direction, piece.grain_direction));
            if (at(piece.model) == i && off <= std::sin(most_turn)) {
                laid.push_back({half_piece(pieces_[i], *axis, piece.grain_direction), true, 1});
                return;
            }
        }
        ++single_count_;
        laid.push_back({pieces_[i], false, 1});
    }

    static constexpr double most_turn = 5.0 * degrees; // of the grain beside the fold

    const pattern::Pattern& pattern_;
    const ExportOptions& options_;
    const std::vector<SheetPiece>& pieces_;
    const Index fabric_;
    Index single_count_ = 0;
};

std::vector<Laid> pieces_to_lay(const pattern::Pattern& pattern, const ExportOptions& options,
                                const std::vector<SheetPiece>& pieces, Index number,
                                FabricStrip& fabric) {
    const double count = static_cast<double>(pieces.size()) * options.copies;
    if (count > tuning.most_copies)
        throw InvalidParameter("copies: expected at most " +
                               writers::number_text(tuning.most_copies, 0) +
                               " pieces on a marker, found " + writers::number_text(count, 0));
    if (options.fold) {
        Folding folding(pattern, options, pieces, number);
        std::vector<Laid> laid = folding.all();
        fabric.single_layer_pieces = folding.single_count();
        return laid;
    }
    std::vector<Laid> laid;
    for (int copy = 0; copy < options.copies; ++copy)
        for (const SheetPiece& piece : pieces)
            if (pattern.pieces[at(piece.piece)].fabric == number)
                laid.push_back({piece, false, 1});
    return laid;
}

// Names are unique in a file: the second "P01" is "P01-2".
void number_copies(std::vector<Laid>& laid) {
    std::map<std::string, int> seen;
    for (Laid& one : laid)
        if (const int number = ++seen[one.piece.name]; number > 1)
            one.piece.name += '-' + std::to_string(number);
}

pack::StripItem item_of(const Laid& laid, const pattern::Pattern& pattern,
                        const ExportOptions& options) {
    pack::StripItem item;
    item.outline = pack::outline_of(laid.piece.cut);
    item.at_left = laid.at_fold;
    const Vec2 grain =
        laid.piece.frame.direction(pattern.pieces[at(laid.piece.piece)].grain_direction);
    item.angles = laid.at_fold ? std::vector<double>{0.0} : grain_angles(grain, options);
    return item;
}

void check_widths(const std::vector<Laid>& laid, const std::vector<pack::StripItem>& items,
                  double room) {
    for (std::size_t i = 0; i < items.size(); ++i) {
        const double width = pack::least_width(items[i]);
        if (!(width <= room))
            throw InvalidParameter(
                "fabric_width_mm: expected cloth that is as wide as its pieces, found " +
                laid[i].piece.name + " of " + mm(width) + " on " + mm(room) +
                "; take wider cloth, another grain, no fold, or split large pieces with "
                "max_piece_mm");
    }
}

FabricStrip empty_strip(const pattern::Pattern& pattern, const ExportOptions& options,
                        std::size_t number) {
    FabricStrip fabric;
    fabric.width = options.fabric_width_mm;
    fabric.selvedge = options.selvedge_mm;
    fabric.is_folded = options.fold;
    fabric.material = pattern.material ? pattern.material->name : "cloth";
    if (!pattern.fabrics.empty())
        fabric.material = pattern.fabrics[number];
    return fabric;
}

// The pieces of one material.
void lay_out_strip(const pattern::Pattern& pattern, const ExportOptions& options,
                   const std::vector<SheetPiece>& pieces, FabricStrip& fabric,
                   PatternLayout& layout, Progress& progress) {
    const double seen = options.fold ? 0.5 * fabric.width : fabric.width;
    const double left = options.fold ? 0.0 : fabric.selvedge;
    const double room = seen - left - fabric.selvedge;
    const auto number = static_cast<Index>(layout.sheets.size());
    std::vector<Laid> laid = pieces_to_lay(pattern, options, pieces, number, fabric);
    if (laid.empty()) // no piece is mostly of it
        return;
    number_copies(laid);
    std::vector<pack::StripItem> items;
    for (const Laid& piece : laid) {
        items.push_back(item_of(piece, pattern, options));
        fabric.covered += static_cast<double>(piece.layers) * items.back().outline.area *
                          (piece.at_fold ? 2.0 : 1.0);
    }
    check_widths(laid, items, room);
    const pack::StripResult strip = pack::pack_strip(
        items, {room, std::max(options.piece_gap_mm, options.bleed()), effort_of(options.effort)},
        progress);
    fabric.length = strip.length;
    fabric.use = fabric.covered / (strip.length * room * (options.fold ? 2.0 : 1.0));
    for (std::size_t i = 0; i < laid.size(); ++i) {
        pack::Placement place = strip.placements[i];
        place.offset.x() += left;
        laid[i].piece.move(place);
        laid[i].piece.sheet = number;
        layout.pieces.push_back(std::move(laid[i].piece));
    }
}

} // namespace

void lay_out_marker(const pattern::Pattern& pattern, const ExportOptions& options,
                    PatternLayout& layout, Progress& progress) {
    const std::vector<SheetPiece> pieces = std::move(layout.pieces);
    layout.pieces.clear();
    const std::size_t count = std::max<std::size_t>(1, pattern.fabrics.size());
    for (std::size_t k = 0; k < count; ++k) {
        auto laying = progress.part(1.0 / static_cast<double>(count));
        FabricStrip fabric = empty_strip(pattern, options, k);
        lay_out_strip(pattern, options, pieces, fabric, layout, laying);
        const double seen = options.fold ? 0.5 * fabric.width : fabric.width;
        layout.sheets.push_back({Vec2(seen, std::ceil(fabric.length) + tuning.caption), 1, 1});
        layout.fabrics.push_back(std::move(fabric));
    }
}

namespace {

void draw_strip(const FabricStrip& fabric, const Vec2& low, const std::string& suffix,
                writers::DrawingLayer& layer) {
    const Vec2 seen(fabric.is_folded ? 0.5 * fabric.width : fabric.width, fabric.length);
    layer.paths.push_back({"fabric-outline" + suffix, {rectangle(low, seen)}});
    if (fabric.selvedge > 0.0) {
        const double right = low.x() + seen.x() - fabric.selvedge;
        writers::DrawingPath lines{"selvedge" + suffix, {}};
        lines.parts.push_back(
            {{Vec2(right, low.y()), Vec2(right, low.y() + fabric.length)}, false});
        if (!fabric.is_folded) {
            const double left = low.x() + fabric.selvedge;
            lines.parts.push_back(
                {{Vec2(left, low.y()), Vec2(left, low.y() + fabric.length)}, false});
        }
        layer.paths.push_back(std::move(lines));
    }
    std::string text = fabric.material + ", " + mm(fabric.width) + " wide, " + mm(fabric.length) +
                       " long, " + writers::number_text(100.0 * fabric.use, 1) + " % used";
    if (fabric.is_folded)
        text += "; folded: the fold is at the left";
    double size = tuning.text;
    const double wide = writers::text_width(text, size);
    size *= std::min(1.0, 0.95 * seen.x() / wide);
    layer.texts.push_back({low + Vec2(0.5 * size, fabric.length + 0.5 * tuning.caption), size, text,
                           0.0, writers::TextAnchor::left});
}

} // namespace

writers::DrawingLayer fabric_layer(const PatternLayout& layout, const std::vector<Vec2>& sheets) {
    writers::DrawingLayer layer{"fabric", "Fabric", "#666666", {}, {}, {}};
    for (std::size_t k = 0; k < layout.fabrics.size(); ++k)
        draw_strip(layout.fabrics[k], sheets[k], k > 0 ? "-" + std::to_string(k + 1) : "", layer);
    return layer;
}

} // namespace devseg::sheet
