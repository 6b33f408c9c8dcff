#include "sheet/export_options.h"

#include <cmath>

#include "devseg/base/errors.h"
#include "writers/number_text.h"

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

} // namespace

ExportOptions resolved(const ExportOptions& given) {
    ExportOptions options = given;
    check("seam_allowance_mm", options.seam_allowance_mm, 0.0, "a width of 0 mm or more");
    check("hem_allowance_mm", options.hem_allowance_mm, -1.0,
          "a width of 0 mm or more, or -1 for that of seams");
    check("tab_depth_mm", options.tab_depth_mm, 0.5, "a depth of 0.5 mm or more");
    check("page_margin_mm", options.page_margin_mm, 0.0, "a margin of 0 mm or more");
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
    if (options.glue_tabs && options.allowance().largest() > 0.0)
        throw InvalidParameter("glue_tabs: expected either glue tabs or a seam allowance, found "
                               "both; set the allowances to 0 or choose another preset");
    return options;
}

} // namespace devseg::sheet
