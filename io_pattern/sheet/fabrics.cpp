#include "sheet/fabrics.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "devseg/base/errors.h"

namespace devseg::sheet {

namespace {

constexpr double negligible = 0.02; // of a piece: smooth seams split faces along borders

std::vector<std::string> names_of(const std::vector<Index>& numbers, const std::string& given) {
    std::vector<std::string> names;
    if (given.empty()) {
        for (const Index number : numbers)
            names.push_back("material " + std::to_string(number));
        return names;
    }
    for (std::size_t from = 0; from <= given.size();) {
        const std::size_t end = std::min(given.find(',', from), given.size());
        const std::size_t first = std::min(given.find_first_not_of(' ', from), end);
        names.push_back(given.substr(first, end - first));
        from = end + 1;
    }
    if (names.size() != numbers.size())
        throw InvalidParameter("material_names: expected a name for each of " +
                               std::to_string(numbers.size()) +
                               " materials with commas between them, found '" + given + "'");
    return names;
}

// Pieces of one shape are cut together where they are of one material.
void part_shapes(pattern::Pattern& pattern) {
    std::map<std::pair<Index, Index>, Index> first; // by shape and fabric
    const std::vector<pattern::PatternPiece> before = pattern.pieces;
    for (std::size_t p = 0; p < before.size(); ++p) {
        pattern::PatternPiece& piece = pattern.pieces[p];
        piece.model = first.emplace(std::pair(piece.model, piece.fabric), static_cast<Index>(p))
                          .first->second;
        piece.mirrored = before[p].mirrored != before[at(piece.model)].mirrored;
        piece.quantity = piece.mirrored_quantity = 0;
        pattern::PatternPiece& model = pattern.pieces[at(piece.model)];
        ++(piece.mirrored ? model.mirrored_quantity : model.quantity);
    }
}

} // namespace

void set_fabrics(const std::vector<Index>& face_material, const std::string& names,
                 pattern::Pattern& pattern) {
    std::vector<Index> numbers = face_material;
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    if (numbers.size() < 2)
        return;
    pattern.fabrics = names_of(numbers, names);
    std::vector<std::vector<double>> areas(pattern.pieces.size(),
                                           std::vector<double>(numbers.size(), 0.0));
    for (const Face f : pattern.mesh.all_faces())
        if (const Index piece = pattern.face_piece[f]; piece >= 0) {
            const Index number = face_material[at(pattern.source_face[f])];
            const auto place = std::lower_bound(numbers.begin(), numbers.end(), number);
            areas[at(piece)][static_cast<std::size_t>(place - numbers.begin())] +=
                pattern.mesh.face_areas[f];
        }
    std::string mixed;
    for (std::size_t p = 0; p < areas.size(); ++p) {
        const auto most = std::max_element(areas[p].begin(), areas[p].end());
        pattern.pieces[p].fabric = static_cast<Index>(most - areas[p].begin());
        const double all = std::accumulate(areas[p].begin(), areas[p].end(), 0.0);
        if (all - *most > negligible * all)
            mixed += (mixed.empty() ? "" : ", ") + pattern.pieces[p].name;
    }
    part_shapes(pattern);
    if (!mixed.empty())
        pattern.notes.push_back("pieces are cut from what most of them is made of, but some have "
                                "faces of other materials (" +
                                mixed + "): make the borders of materials seams");
}

} // namespace devseg::sheet
