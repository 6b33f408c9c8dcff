#include "devseg/pattern/same_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Two pieces of one shape differ by less than this share of their size, whatever the tolerance.
constexpr double size_share = 0.01;

// Outlines of one shape differ in length by less than this share, however ragged they are.
constexpr double length_raggedness = 0.1;

// Models that a piece is compared with, the most similar ones: thousands of pieces of as many
// shapes must not be compared each with each.
constexpr std::size_t closest_models = 8;

// What pieces of one shape agree on, however they are turned or mirrored.
struct Signature {
    double around = 0.0;                                    // length of the outline
    std::array<double, 2 * Shape::frequencies> strengths{}; // of its waves

    Signature(const PatternPiece& piece, const Shape& shape)
        : around(plane::perimeter(piece.outer.points)) {
        for (std::size_t w = 0; w < strengths.size(); ++w)
            strengths[w] = std::abs(shape.waves[w]);
    }

    double squared_distance(const Signature& other) const {
        double sum = 0.0;
        for (std::size_t w = 0; w < strengths.size(); ++w)
            sum += (strengths[w] - other.strengths[w]) * (strengths[w] - other.strengths[w]);
        return sum;
    }
};

struct Known {
    std::size_t piece = 0;
    Shape shape;
    Signature signature;
};

bool may_be_same(const PatternPiece& a, const PatternPiece& b, const Signature& of_a,
                 const Signature& of_b, double tolerance) {
    // An outline that moves by d changes the area by d times its length at most, and each of its
    // edges by twice d.
    const double edges =
        static_cast<double>(std::max(a.outer.points.size(), b.outer.points.size()));
    return a.holes.size() == b.holes.size() &&
           std::abs(a.area - b.area) <= tolerance * std::max(of_a.around, of_b.around) &&
           std::abs(of_a.around - of_b.around) <=
               std::min(length_raggedness * of_a.around, 2.0 * tolerance * edges);
}

// The pieces that others are compared with, found by the length of their outlines.
struct Models {
    std::vector<Known> known;
    std::multimap<double, std::size_t> by_length;
    double most_edges = 0.0; // of an outline

    void add(Known model, const PatternPiece& piece) {
        by_length.emplace(model.signature.around, known.size());
        most_edges = std::max(most_edges, static_cast<double>(piece.outer.points.size()));
        known.push_back(std::move(model));
    }
};

// The models that are most similar, in their order.
std::vector<std::size_t> closest(const Models& models, const std::vector<PatternPiece>& pieces,
                                 const PatternPiece& piece, const Signature& signature,
                                 double tolerance) {
    const double edges =
        std::max(models.most_edges, static_cast<double>(piece.outer.points.size()));
    const double longer = std::min(length_raggedness * signature.around, 2.0 * tolerance * edges);
    std::vector<std::pair<double, std::size_t>> found;
    const auto end = models.by_length.upper_bound(signature.around + longer);
    for (auto it = models.by_length.lower_bound(signature.around - longer); it != end; ++it) {
        const Known& model = models.known[it->second];
        if (!may_be_same(piece, pieces[model.piece], signature, model.signature, tolerance))
            continue;
        const std::pair<double, std::size_t> entry{signature.squared_distance(model.signature),
                                                   it->second};
        if (found.size() == closest_models && !(entry < found.back()))
            continue;
        if (found.size() == closest_models)
            found.pop_back();
        found.insert(std::upper_bound(found.begin(), found.end(), entry), entry);
    }
    std::vector<std::size_t> result;
    for (const auto& entry : found)
        result.push_back(entry.second);
    std::sort(result.begin(), result.end());
    return result;
}

// Direction of the axis of a mirror image, which has half the angle of −turn.
std::complex<double> axis_of(const Motion& mirror) {
    return std::polar(1.0, 0.5 * std::arg(-mirror.turn));
}

double tolerance_for(const PatternPiece& piece, double tolerance_mm, double share) {
    return std::min(tolerance_mm, share * std::sqrt(piece.area));
}

} // namespace

std::optional<Motion> mirror_motion(const PatternPiece& piece, double tolerance_mm, double share) {
    std::optional<Motion> motion =
        same_shape(Shape(piece, true), Shape(piece, false), 0.0,
                   plane::perimeter(piece.outer.points), tolerance_for(piece, tolerance_mm, share));
    if (!motion)
        return motion;
    // In complex numbers around the middle of the box, the mirror image of z is −turn z̄ + shift:
    // a mirror image of that is z again where nothing of the shift lies along the axis.
    const std::complex<double> along = axis_of(*motion);
    motion->shift -= (motion->shift * std::conj(along)).real() * along;
    return motion;
}

std::optional<MirrorAxis> find_mirror_axis(const PatternPiece& piece, double tolerance_mm) {
    const auto motion = mirror_motion(piece, tolerance_mm, size_share);
    if (!motion)
        return std::nullopt;
    const std::complex<double> along = axis_of(*motion);
    return MirrorAxis{piece.box.center() + 0.5 * Vec2(motion->shift.real(), motion->shift.imag()),
                      Vec2(along.real(), along.imag())};
}

std::vector<Likeness> find_likenesses(const std::vector<PatternPiece>& pieces, double tolerance_mm,
                                      double share, const Progress& progress) {
    Models models;
    std::vector<Likeness> result(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        progress.check();
        const PatternPiece& piece = pieces[i];
        result[i].model = i;
        const double tolerance = tolerance_for(piece, tolerance_mm, share);
        Shape straight(piece, false);
        const Signature signature(piece, straight);
        const Shape mirrored(piece, true);
        for (const std::size_t m : closest(models, pieces, piece, signature, tolerance)) {
            const Known& model = models.known[m];
            const double longer = std::abs(signature.around - model.signature.around);
            const auto motion_of = [&](const Shape& shape) {
                return same_shape(shape, model.shape, longer, signature.around, tolerance);
            };
            std::optional<Motion> motion = motion_of(straight);
            const bool same = motion.has_value();
            if (!same)
                motion = motion_of(mirrored);
            if (!motion)
                continue;
            result[i] = {model.piece, !same, *motion};
            break;
        }
        if (result[i].model == i)
            models.add({i, std::move(straight), signature}, piece);
    }
    return result;
}

void find_same_pieces(std::vector<PatternPiece>& pieces, double tolerance_mm,
                      const Progress& progress) {
    const std::vector<Likeness> found = find_likenesses(pieces, tolerance_mm, size_share, progress);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        PatternPiece& piece = pieces[i];
        piece.model = static_cast<Index>(found[i].model);
        piece.mirrored = found[i].mirrored;
        piece.quantity = found[i].model == i ? 1 : 0;
        piece.mirrored_quantity = 0;
    }
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (found[i].model != i) {
            PatternPiece& model = pieces[found[i].model];
            ++(found[i].mirrored ? model.mirrored_quantity : model.quantity);
        }
}

} // namespace devseg::pattern
