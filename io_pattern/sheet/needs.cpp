#include "sheet/needs.h"

#include <algorithm>
#include <cmath>

#include "devseg/assembly/sections.h"
#include "devseg/plane/plane.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

std::string names(const pattern::Pattern& pattern, const std::vector<Index>& pieces) {
    std::string text;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        text += (i == 0                   ? ""
                 : i + 1 == pieces.size() ? " and "
                                          : ", ") +
                pattern.pieces[at(pieces[i])].name;
    return text;
}

std::string labels(const pattern::Pattern& pattern, const std::vector<Index>& seams) {
    std::string text;
    for (const Index s : seams)
        text += (text.empty() ? "" : ", ") + pattern.seams[at(s)].label;
    return (seams.size() == 1 ? "seam " : "seams ") + text;
}

std::string verb(const ExportOptions& options) {
    return options.craft() == assembly::Craft::sewing ? "sew" : "glue";
}

} // namespace

Needs find_needs(const pattern::Pattern& pattern, const PatternLayout& layout,
                 const ExportOptions& options, Index pages) {
    Needs needs;
    needs.fabric_mm2.assign(pattern.fabrics.size(), 0.0);
    for (const SheetPiece& piece : layout.pieces) {
        double area = 0.0;
        for (const std::vector<Vec2>& ring : piece.cut)
            area += plane::signed_area(ring);
        needs.material_mm2 += area;
        if (!pattern.fabrics.empty())
            needs.fabric_mm2[at(pattern.pieces[at(piece.piece)].fabric)] += area;
    }
    for (const pattern::Seam& seam : pattern.seams)
        needs.seam_mm += 0.5 * (seam.sides[0].length + seam.sides[1].length);
    needs.hem_mm = pattern.hem_length;
    needs.sheets_of_paper = layout.page ? pages : 0;
    if (options.craft() != assembly::Craft::sewing)
        return needs;
    needs.minutes = (needs.seam_mm + needs.hem_mm) / options.sewing_mm_per_minute;
    for (const double volume : assembly::PieceGraph(pattern).volume)
        needs.stuffing_mm3 += volume;
    needs.stuffing_g = 1e-6 * needs.stuffing_mm3 * options.stuffing_g_per_litre;
    return needs;
}

std::vector<std::pair<std::string, std::string>>
needs_texts(const pattern::Pattern& pattern, const Needs& needs, const ExportOptions& options) {
    const auto number = [](double value, int decimals) {
        return writers::number_text(value, decimals);
    };
    const bool is_sewn = options.craft() == assembly::Craft::sewing;
    std::vector<std::pair<std::string, std::string>> texts;
    const std::string kind = is_sewn ? "Fabric" : "Paper or board";
    const auto area = [&](const std::string& name, double mm2) {
        texts.emplace_back(name, number(1e-2 * mm2, 0) + " cm\xc2\xb2 inside the cut lines");
    };
    if (pattern.fabrics.empty())
        area(kind, needs.material_mm2);
    for (std::size_t k = 0; k < pattern.fabrics.size(); ++k)
        area(kind + ", " + pattern.fabrics[k], needs.fabric_mm2[k]);
    texts.emplace_back("Seams", number(1e-3 * needs.seam_mm, 2) + " m");
    if (needs.hem_mm > 0.0)
        texts.emplace_back("Hems", number(1e-3 * needs.hem_mm, 2) + " m");
    if (is_sewn)
        texts.emplace_back("Sewing", number(std::ceil(needs.minutes), 0) + " min at " +
                                         number(options.sewing_mm_per_minute, 0) +
                                         " mm per minute");
    if (needs.stuffing_mm3 > 0.0)
        texts.emplace_back("Stuffing", number(1e-6 * needs.stuffing_mm3, 2) + " litres, about " +
                                           number(needs.stuffing_g, 0) + " g");
    if (needs.sheets_of_paper > 0)
        texts.emplace_back("Sheets of paper", std::to_string(needs.sheets_of_paper));
    return texts;
}

std::string step_text(const pattern::Pattern& pattern, const PatternLayout& layout,
                      const ExportOptions& options, std::size_t k) {
    const assembly::AssemblyStep& step = layout.assembly.steps[k];
    const std::string section = "Section " + assembly::section_name(step.section) + ": ";
    const std::string along = " along " + labels(pattern, step.seams) + ".";
    switch (step.kind) {
    case assembly::StepKind::dart:
        return section + verb(options) + " the darts of " + names(pattern, step.pieces) + "," +
               along;
    case assembly::StepKind::tube:
        return section + verb(options) + " " + names(pattern, step.pieces) + " to itself" + along;
    case assembly::StepKind::join:
        return section + verb(options) + " " + names(pattern, step.pieces) +
               (step.pieces.size() > 1 ? " together" : " to what is made") + along;
    case assembly::StepKind::attach:
        return section + verb(options) + " it (" + names(pattern, step.pieces) +
               ") to what is built," + along;
    case assembly::StepKind::close:
        break;
    }
    if (options.craft() == assembly::Craft::sewing)
        return "Turn it right side out and stuff it, then close the opening by hand," + along;
    return "Last, " + verb(options) + " " +
           (step.pieces.empty() ? "it shut" : names(pattern, step.pieces)) + along;
}

std::vector<std::string> opening_texts(const pattern::Pattern& pattern,
                                       const PatternLayout& layout) {
    std::vector<std::string> texts;
    for (const assembly::Opening& opening : layout.assembly.openings) {
        const std::string& label = pattern.seams[at(opening.seam)].label;
        texts.push_back(opening.is_whole
                            ? "Leave all of seam " + label +
                                  " open: no seam is long enough for an opening of 40 mm."
                            : "Leave " + writers::number_text(opening.to - opening.from, 0) +
                                  " mm of seam " + label + " open, between the marks.");
    }
    return texts;
}

} // namespace devseg::sheet
