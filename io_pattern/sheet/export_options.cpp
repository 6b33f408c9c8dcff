#include "sheet/export_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "devseg/base/errors.h"
#include "devseg/base/option_checks.h"
#include "devseg/material/material.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

// What books on sewing give where a pattern says nothing.
constexpr double usual_allowance = 7.0; // mm

void check(const char* name, double value, double least, const char* expected) {
    if (value >= least && std::isfinite(value))
        return;
    throw InvalidParameter(
        std::string(name) + ": expected " + expected + ", found " +
        (std::isfinite(value) ? writers::number_text(value, 6) : "no finite number"));
}

constexpr double longest_side = 1e5; // mm
// Two pages share the overlap; what they add to the sheet must be more than a sliver.
constexpr double least_room = tile_overlap + 20.0; // mm

// What turning a piece to its least box by steps and the clearance of pages take.
constexpr double page_play = 4.0; // mm

struct NamedPage {
    const char* name;
    double width;
    double height;
};
constexpr NamedPage named_pages[] = {
    {"a4", 210.0, 297.0}, {"letter", 215.9, 279.4}, {"a3", 297.0, 420.0}};

double side(const std::string& text) {
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    const bool whole = read.ec == std::errc() && read.ptr == end;
    return whole && value > 0.0 && value <= longest_side ? value : 0.0;
}

Vec2 page_size(const std::string& given) {
    std::string name = given;
    for (char& c : name)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    for (const NamedPage& page : named_pages)
        if (name == page.name)
            return Vec2(page.width, page.height);
    const std::size_t cross = name.find('x');
    if (cross != std::string::npos) {
        const Vec2 size(side(name.substr(0, cross)), side(name.substr(cross + 1)));
        if (size.x() > 0.0 && size.y() > 0.0)
            return size;
    }
    throw InvalidParameter("page: expected none, a4, letter, a3 or width x height in mm such as "
                           "600x400, found '" +
                           given + "'");
}

// What the material says where nobody else does.
void take_material(ExportOptions& options) {
    const bool burns = options.preset == PatternPreset::laser;
    if (options.material.empty()) {
        options.kerf_mm = std::max(0.0, options.kerf_mm);
        return;
    }
    const material::Material material = material::read_material(options.material);
    if (options.preset == PatternPreset::sewing && options.seam_allowance_mm == 0.0)
        options.seam_allowance_mm = material.allowance_mm;
    if (options.kerf_mm < 0.0)
        options.kerf_mm = burns ? material.kerf_mm : 0.0;
    options.nap = options.nap || (material.has_nap && options.is_marker());
    if (!material.has_grain && options.grain == pattern::GrainDirection::best && !options.nap)
        options.grain = pattern::GrainDirection::free;
}

[[noreturn]] void refuse_marker(const std::string& message) {
    throw InvalidParameter("fabric_width_mm: expected " + message);
}

void check_marker(const ExportOptions& options) {
    check("fabric_width_mm", options.fabric_width_mm, 0.0, "a width of 0 mm or more");
    check("selvedge_mm", options.selvedge_mm, 0.0, "a width of 0 mm or more");
    check("piece_gap_mm", options.piece_gap_mm, 0.0, "a distance of 0 mm or more");
    if (!options.is_marker()) {
        if (options.fold || options.nap || options.selvedge_mm > 0.0)
            refuse_marker("the width of the cloth beside fold, nap and selvedge, found none");
        return;
    }
    if (options.page != "none" && !options.page.empty())
        refuse_marker("either a roll of cloth or a page, found both; leave the page out");
    if (options.glue_tabs)
        refuse_marker("pieces to sew or to cut, found glue tabs; choose another preset");
    if (options.fold && options.mirror)
        throw InvalidParameter("mirror: expected it off on folded cloth, which shows its inside "
                               "already, found both; leave one out");
    const bool is_free = options.grain == pattern::GrainDirection::free;
    if (is_free && (options.fold || options.nap))
        throw InvalidParameter("grain: expected a grain on cloth that is folded or has a nap, "
                               "found pieces that may lie as they like; give another grain");
    const double room = (options.fold ? 0.5 : 1.0) * options.fabric_width_mm -
                        (options.fold ? 1.0 : 2.0) * options.selvedge_mm;
    if (!(room > 0.0))
        refuse_marker("cloth between its selvedges, found " + writers::number_text(room, 1) +
                      " mm; give a smaller selvedge_mm");
}

} // namespace

AllowanceWidths ExportOptions::allowance() const {
    AllowanceWidths widths = hem_allowance_mm < 0.0
                                 ? AllowanceWidths(seam_allowance_mm, seam_allowance_mm, 0.0)
                                 : AllowanceWidths(seam_allowance_mm, hem_allowance_mm);
    if (dart_allowance_mm >= 0.0)
        widths.darts = dart_allowance_mm;
    if (zip_allowance_mm >= 0.0 && !zip_seams.empty())
        widths.zips = zip_allowance_mm;
    const char* const end = zip_seams.data() + zip_seams.size();
    for (const char* from = zip_seams.data(); from < end;) {
        Index number = 0;
        const auto read = std::from_chars(from, end, number);
        if (read.ec != std::errc() || number < 1 || (read.ptr != end && *read.ptr != ','))
            throw InvalidParameter("zip_seams: expected numbers of seams such as 3,7, found '" +
                                   zip_seams + "'");
        widths.zip_seams.push_back(number - 1);
        from = read.ptr + 1;
    }
    return widths;
}

ExportOptions resolved(const ExportOptions& given) {
    ExportOptions options = given;
    check("seam_allowance_mm", options.seam_allowance_mm, 0.0, "a width of 0 mm or more");
    check("hem_allowance_mm", options.hem_allowance_mm, -1.0,
          "a width of 0 mm or more, or -1 for that of seams");
    check("zip_allowance_mm", options.zip_allowance_mm, -1.0,
          "a width of 0 mm or more, or -1 for that of seams");
    check("dart_allowance_mm", options.dart_allowance_mm, -1.0,
          "a width of 0 mm or more, or -1 for that of seams");
    check("tab_depth_mm", options.tab_depth_mm, 0.5, "a depth of 0.5 mm or more");
    check("perforation_mm", options.perforation_mm, 0.0, "cuts of 0 mm or more");
    check("perforation_gap_mm", options.perforation_gap_mm, 0.1, "gaps of 0.1 mm or more");
    if (!(options.bleed_mm >= 0.0 && options.bleed_mm <= widest_bleed))
        refuse_option("bleed_mm", "a width from 0 to 3 mm, the distance of two pieces",
                      options.bleed_mm);
    check("page_margin_mm", options.page_margin_mm, 0.0, "a margin of 0 mm or more");
    check("sewing_mm_per_minute", options.sewing_mm_per_minute, 1.0, "a rate of 1 mm or more");
    check("stuffing_g_per_litre", options.stuffing_g_per_litre, 0.0, "a density of 0 g or more");
    check("kerf_mm", options.kerf_mm, -1.0, "a width of 0 mm or more, or -1 for the material's");
    options.edge_numbers = options.edge_numbers || options.step_numbers;
    take_material(options);
    switch (options.preset) {
    case PatternPreset::plain:
        break;
    case PatternPreset::sewing:
        if (options.seam_allowance_mm == 0.0)
            options.seam_allowance_mm = usual_allowance;
        if (options.notch_spacing_mm == 0.0)
            options.notch_spacing_mm = pattern::PatternOptions().notch_spacing_mm;
        options.grain_line = options.edge_numbers = true;
        break;
    case PatternPreset::papercraft:
        options.glue_tabs = options.fold_lines = options.edge_numbers = true;
        break;
    case PatternPreset::laser:
        options.edge_numbers = true;
        break;
    }
    if (options.tabs != TabSides::automatic)
        options.glue_tabs = options.tabs != TabSides::none;
    if (options.perforation_mm > 0.0)
        options.fold_lines = true;
    if (options.zip_allowance_mm >= 0.0 && options.zip_seams.empty())
        throw InvalidParameter("zip_seams: expected the seams that get a zip, found none; give "
                               "their numbers or leave zip_allowance_mm out");
    if (options.glue_tabs && options.allowance().largest() > 0.0)
        throw InvalidParameter("glue_tabs: expected either glue tabs or a seam allowance, found "
                               "both; set the allowances to 0 or choose another preset");
    check_marker(options);
    return options;
}

std::optional<PageFormat> page_format(const ExportOptions& options) {
    if (options.page.empty() || options.page == "none" || options.page == "None")
        return std::nullopt;
    const PageFormat format{page_size(options.page), options.page_margin_mm};
    if (format.printable().minCoeff() < least_room)
        throw InvalidParameter("page_margin_mm: expected margins that leave " +
                               writers::number_text(least_room, 0) + " mm of a page of " +
                               writers::number_text(format.size.x(), 1) + " x " +
                               writers::number_text(format.size.y(), 1) + " mm, found " +
                               writers::number_text(options.page_margin_mm, 3) +
                               " mm; take a larger page or smaller margins");
    return format;
}

ExportOptions limited_to_page(const ExportOptions& given) {
    if (!given.fit_page)
        return given;
    const std::optional<PageFormat> format = page_format(given);
    if (!format)
        throw InvalidParameter("fit_page: expected a page that pieces are to fit on, found none; "
                               "give page");
    const double around = given.glue_tabs ? given.tab_depth_mm : given.allowance().largest();
    const Vec2 room = (format->printable() - Vec2::Constant(2.0 * around + page_play))
                          .cwiseMax(Vec2::Constant(least_room));
    ExportOptions options = given;
    const auto limit = [](double& most, double by) { most = most > 0.0 ? std::min(most, by) : by; };
    limit(options.max_piece_mm, room.maxCoeff());
    limit(options.max_width_mm, room.minCoeff());
    return options;
}

} // namespace devseg::sheet
