#include "sheet/cloth_texts.h"

#include <cmath>

#include "writers/text.h"

namespace devseg::sheet {

namespace {

constexpr double gathered = 0.5; // mm: sides that differ by less are eased in without a word

std::string percent(double share) {
    return writers::number_text(100.0 * share, 1) + " %";
}

} // namespace

std::string cloth_text(const pattern::Pattern& pattern, const pattern::PatternPiece& piece) {
    const pattern::ClothStrain& strain = piece.cloth;
    return "along the grain " + percent(strain.along_95) + " (at most " + percent(strain.along) +
           "), across it " + percent(strain.across_95) + " (" + percent(strain.across) + "), " +
           writers::number_text(100.0 * strain.use_99, 0) + " % of what " + pattern.material->name +
           " bears" + (strain.is_within ? "" : ": too much");
}

std::vector<std::string> cloth_texts(const pattern::Pattern& pattern) {
    std::vector<std::string> lines;
    if (!pattern.material)
        return lines;
    lines.push_back("Strain of 95 % of each piece on the model:");
    for (const pattern::PatternPiece& piece : pattern.pieces)
        lines.push_back(piece.name + ": " + cloth_text(pattern, piece));
    for (const pattern::Seam& seam : pattern.seams) {
        const double ease = seam.mismatch();
        if (std::abs(ease) <= gathered)
            continue;
        const pattern::SeamSide& longer = seam.sides[ease > 0.0 ? 0 : 1];
        lines.push_back("Gather seam " + seam.label + " by " +
                        writers::number_text(std::abs(ease), 1) + " mm on " +
                        pattern.pieces[at(longer.piece)].name);
    }
    return lines;
}

} // namespace devseg::sheet
