#include "sheet/sizes.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "devseg/base/errors.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

constexpr std::size_t most_sizes = 12;
constexpr double largest_size = 1e6; // mm
constexpr double legend_text = 4.0;  // mm
// Told apart on white paper, and from the red of the largest size.
constexpr std::array<const char*, 6> colours = {"#0055ff", "#009933", "#aa00aa",
                                                "#cc6600", "#008899", "#666600"};

std::string size_name(double height) {
    return writers::number_text(height, 3);
}

SheetPiece on_large(const pattern::PatternPiece& large, const pattern::PatternPiece& small,
                    SheetPiece drawn, const SheetFrame& frame) {
    // The same point of the texture.
    const Vec2 origin =
        large.place.origin +
        (large.label_position - large.place.offset).cwiseQuotient(large.place.scale);
    const Vec2 shift = large.label_position - small.place(origin);
    const auto move = [&](const Vec2& p) { return frame(p + shift); };
    for (auto* rings : {&drawn.cut, &drawn.slits})
        for (std::vector<Vec2>& ring : *rings)
            for (Vec2& p : ring)
                p = move(p);
    for (SheetNotch& notch : drawn.notches) {
        notch.outer = move(notch.outer);
        notch.inner = move(notch.inner);
    }
    return drawn;
}

} // namespace

std::vector<double> read_sizes(const std::string& text) {
    std::vector<double> sizes;
    const char* from = text.data();
    const char* const end = text.data() + text.size();
    while (from != end) {
        double size = 0.0;
        const auto read = std::from_chars(from, end, size);
        const bool is_last = read.ptr == end;
        if (read.ec != std::errc() || !(size > 0.0) || !(size <= largest_size) ||
            (!is_last && (*read.ptr != ',' || read.ptr + 1 == end)) || sizes.size() == most_sizes)
            throw InvalidParameter("sizes: expected up to " + std::to_string(most_sizes) +
                                   " heights in mm such as 200,250,300, found '" + text + "'");
        sizes.push_back(size);
        from = is_last ? end : read.ptr + 1;
    }
    std::sort(sizes.begin(), sizes.end());
    if (std::adjacent_find(sizes.begin(), sizes.end()) != sizes.end())
        throw InvalidParameter("sizes: expected sizes that differ, found '" + text + "'");
    return sizes;
}

void add_sizes(const Mesh& mesh, const CornerUv& uv, const pattern::Pattern& largest,
               const ExportOptions& options, PatternLayout& layout, Progress& progress) {
    std::vector<double> sizes = read_sizes(options.sizes);
    sizes.pop_back();
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, sizes.size()));
    for (const double height : sizes) {
        ExportOptions own = options;
        own.height_mm = height;
        auto making = progress.part(share);
        const pattern::Pattern small = pattern::make_pattern(mesh, uv, own, making);
        if (small.pieces.size() != largest.pieces.size())
            throw InvalidParameter("sizes: expected the same pieces in all sizes, found " +
                                   std::to_string(small.pieces.size()) + " and " +
                                   std::to_string(largest.pieces.size()) +
                                   "; leave max_piece_mm out");
        SizedPieces drawn{height, {}};
        for (std::size_t i = 0; i < small.pieces.size(); ++i) {
            SheetPiece piece = compose_piece(small, static_cast<Index>(i), {}, own);
            piece.sheet = layout.pieces[i].sheet;
            drawn.pieces.push_back(on_large(largest.pieces[i], small.pieces[i], std::move(piece),
                                            layout.pieces[i].frame));
        }
        layout.sizes.push_back(std::move(drawn));
    }
}

std::vector<writers::DrawingLayer> size_layers(const PatternLayout& layout,
                                               const std::vector<Vec2>& sheets, NotchKind kind) {
    std::vector<writers::DrawingLayer> layers;
    for (std::size_t s = 0; s < layout.sizes.size(); ++s) {
        const SizedPieces& size = layout.sizes[s];
        const std::string name = size_name(size.height);
        writers::DrawingLayer layer{
            "size-" + name, "Size " + name + " mm", colours[s % colours.size()], {}, {}, {}};
        for (const SheetPiece& piece : size.pieces) {
            const Vec2& low = sheets[at(piece.sheet)];
            writers::DrawingPath path{piece.name + "-" + name, {}, piece.name};
            const auto add = [&](std::vector<Vec2> line, bool closed) {
                for (Vec2& p : line)
                    p += low;
                path.parts.push_back({std::move(line), closed});
            };
            for (const std::vector<Vec2>& ring : piece.cut)
                add(ring, true);
            for (const std::vector<Vec2>& slit : piece.slits)
                add(slit, false);
            for (const SheetNotch& notch : piece.notches)
                add(notch.line(kind), false);
            layer.paths.push_back(std::move(path));
        }
        const Vec2 place(sheet_margin + 12.0 * legend_text * static_cast<double>(s),
                         0.5 * sheet_margin);
        layer.texts.push_back({sheets.front() + place, legend_text, "size " + name + " mm", 0.0,
                               writers::TextAnchor::left});
        layers.push_back(std::move(layer));
    }
    return layers;
}

} // namespace devseg::sheet
