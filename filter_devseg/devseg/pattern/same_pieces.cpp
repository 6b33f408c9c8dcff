#include "devseg/pattern/same_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
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

// What pieces of one shape agree on, however they are turned or mirrored: the strengths of the
// waves of their outlines.
using Signature = std::array<double, 2 * Shape::frequencies>;

Signature signature_of(const Shape& shape) {
    Signature strengths{};
    for (std::size_t w = 0; w < strengths.size(); ++w)
        strengths[w] = std::abs(shape.waves[w]);
    return strengths;
}

double squared_distance(const Signature& a, const Signature& b) {
    double sum = 0.0;
    for (std::size_t w = 0; w < a.size(); ++w)
        sum += (a[w] - b[w]) * (a[w] - b[w]);
    return sum;
}

// What is known of a piece before its shape is: enough to tell most pairs apart.
struct Size {
    double around = 0.0; // length of the outline
    double area = 0.0;
    double edges = 0.0; // of the outline
    std::size_t holes = 0;
    std::size_t piece = 0;
    bool is_model = false; // others are compared with it
};

bool may_be_same(const Size& a, const Size& b, double tolerance) {
    // An outline that moves by d changes the area by d times its length at most, and each of its
    // edges by twice d.
    return a.holes == b.holes &&
           std::abs(a.area - b.area) <= tolerance * std::max(a.around, b.around) &&
           std::abs(a.around - b.around) <=
               std::min(length_raggedness * a.around, 2.0 * tolerance * std::max(a.edges, b.edges));
}

// All pieces, sorted by the length of their outlines, and the shapes of those that are models.
class Models {
public:
    explicit Models(const std::vector<PatternPiece>& pieces)
        : place_(pieces.size()), shapes_(pieces.size()), signatures_(pieces.size()) {
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const std::vector<Vec2>& outline = pieces[i].outer.points;
            sizes_.push_back({plane::perimeter(outline), pieces[i].area,
                              static_cast<double>(outline.size()), pieces[i].holes.size(), i,
                              false});
            most_edges_ = std::max(most_edges_, sizes_.back().edges);
        }
        std::stable_sort(sizes_.begin(), sizes_.end(),
                         [](const Size& a, const Size& b) { return a.around < b.around; });
        for (std::size_t k = 0; k < sizes_.size(); ++k)
            place_[sizes_[k].piece] = k;
    }

    const Size& size(std::size_t piece) const { return sizes_[place_[piece]]; }
    const Shape& shape(std::size_t model) const { return *shapes_[model]; }

    void add(std::size_t piece, Shape shape, const Signature& signature) {
        sizes_[place_[piece]].is_model = true;
        shapes_[piece] = std::move(shape);
        signatures_[piece] = signature;
    }

    // The models that are most similar, in their order.
    std::vector<std::size_t> closest(std::size_t piece, const Signature& signature,
                                     double tolerance) const {
        const Size& mine = size(piece);
        const double longer =
            std::min(length_raggedness * mine.around, 2.0 * tolerance * most_edges_);
        std::vector<std::pair<double, std::size_t>> found;
        auto it =
            std::lower_bound(sizes_.begin(), sizes_.end(), mine.around - longer,
                             [](const Size& size, double around) { return size.around < around; });
        for (; it != sizes_.end() && it->around <= mine.around + longer; ++it) {
            if (!it->is_model || !may_be_same(mine, *it, tolerance))
                continue;
            // However outlines are turned, they are as far apart as their strengths at least.
            const double apart =
                most_apart(std::abs(mine.around - it->around), mine.around, tolerance);
            const double distance = squared_distance(signature, signatures_[it->piece]);
            if (distance > apart * apart)
                continue;
            const std::pair<double, std::size_t> entry{distance, it->piece};
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

private:
    std::vector<Size> sizes_;
    std::vector<std::size_t> place_; // of each piece in sizes_
    std::vector<std::optional<Shape>> shapes_;
    std::vector<Signature> signatures_;
    double most_edges_ = 0.0; // of an outline
};

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
    Models models(pieces);
    std::vector<Likeness> result(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        progress.check();
        result[i].model = i;
        const double tolerance = tolerance_for(pieces[i], tolerance_mm, share);
        Shape straight(pieces[i], false);
        const Signature signature = signature_of(straight);
        const std::vector<std::size_t> candidates = models.closest(i, signature, tolerance);
        const std::optional<Shape> mirrored =
            candidates.empty() ? std::nullopt
                               : std::optional<Shape>(std::in_place, pieces[i], true);
        for (const std::size_t m : candidates) {
            const double around = models.size(i).around;
            const double longer = std::abs(around - models.size(m).around);
            const auto motion_of = [&](const Shape& shape) {
                return same_shape(shape, models.shape(m), longer, around, tolerance);
            };
            std::optional<Motion> motion = motion_of(straight);
            const bool same = motion.has_value();
            if (!same)
                motion = motion_of(*mirrored);
            if (!motion)
                continue;
            result[i] = {m, !same, *motion};
            break;
        }
        if (result[i].model == i)
            models.add(i, std::move(straight), signature);
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
