#include "devseg/flatten/repair/snap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    // Share of a face's area that rounding may change. Thin faces lose more: a corner of theirs is
    // moved to another place on the grid nearby, which has places for nearly every area.
    double kept_face_area = 0.02;
    int grid_reach = 8; // units in the last place that a vertex is moved by at most,
    // and on the boundary: inside, moves that flip nothing keep a map one-to-one, but not there.
    int boundary_reach = 2;
    double widened = 1.02; // area of a needle as flattened over that on the surface
    // Least height of a needle, of the model's size: a dozen steps of 32 bits in a packed square.
    // Needles in a row leave each other no room on that grid, and would be turned over by it.
    double needle_height = 1e-6;
    // Least height of a face before rounding, in steps of the largest coordinate. Rounding moves
    // each corner by 0.71 of them at most, and so changes a height by 1.41.
    double grid_height = 2.5;
    // How easily a vertex of the boundary gives way, beside one inside: rows of needles along two
    // borders that touch must not push them over each other.
    double boundary_mobility = 1.0 / 16.0;
    double reached = 1.05; // of the least height: what a face that is lower gets
    int room_rounds = 400; // visits of each low face: rows of needles push others away step by step
};
constexpr Tuning tuning;

// Faces of each vertex: [begin[v], begin[v + 1]).
struct Stars {
    std::vector<Index> begin;
    std::vector<Index> faces;
};

Stars build_stars(const std::vector<Triangle>& faces, std::size_t vertices) {
    Stars stars;
    stars.begin.assign(vertices + 1, 0);
    for (const Triangle& t : faces)
        for (const Vertex v : t)
            ++stars.begin[at(v) + 1];
    std::partial_sum(stars.begin.begin(), stars.begin.end(), stars.begin.begin());
    stars.faces.resize(3 * faces.size());
    std::vector<Index> cursor(stars.begin.begin(), stars.begin.end() - 1);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const Vertex v : faces[f])
            stars.faces[cursor[v]++] = static_cast<Index>(f);
    return stars;
}

// Whether the faces around the vertex close up.
bool is_inside(const std::vector<Triangle>& faces, const Stars& stars, Vertex v) {
    std::vector<Index> after;
    std::vector<Index> before;
    for (Index i = stars.begin[v]; i < stars.begin[at(v) + 1]; ++i) {
        const Triangle& t = faces[stars.faces[i]];
        const std::size_t k = t[0] == v ? 0 : t[1] == v ? 1 : 2;
        after.push_back(t[(k + 1) % 3]);
        before.push_back(t[(k + 2) % 3]);
    }
    return std::is_permutation(after.begin(), after.end(), before.begin());
}

// The distance between neighbouring single precision numbers near the point.
double unit_in_last_place(const Vec2& p) {
    const float size = static_cast<float>(p.cwiseAbs().maxCoeff());
    return static_cast<double>(std::nextafter(size, std::numeric_limits<float>::infinity()) - size);
}

// Moves vertices on the grid so that the faces around them come nearest to the areas that they had.
class AreaKeeper {
public:
    // `area`: twice that of each face.
    AreaKeeper(const std::vector<Triangle>& faces, std::vector<double> area, std::vector<Vec2>& uv)
        : faces_(faces), area_(std::move(area)), uv_(uv), stars_(build_stars(faces, uv.size())) {}

    void restore(Face face) {
        for (const Vertex v : faces_[face]) {
            const Vec2 home = uv_[v];
            const double unit = unit_in_last_place(home);
            Vec2 best = home;
            double least = loss_around(v);
            const int most =
                is_inside(faces_, stars_, v) ? tuning.grid_reach : tuning.boundary_reach;
            for (int x = -most; x <= most; ++x)
                for (int y = -most; y <= most; ++y) {
                    const Vec2 moved = home + unit * Vec2(x, y);
                    uv_[v] = Vec2(in_32_bits(moved.x()), in_32_bits(moved.y()));
                    const double loss = loss_around(v);
                    if (loss < least) {
                        least = loss;
                        best = uv_[v];
                    }
                }
            uv_[v] = best;
            if (std::abs(twice_area(face) - area_[face]) <= tuning.kept_face_area * area_[face])
                return;
        }
    }

private:
    double twice_area(Index face) const {
        const Triangle& t = faces_[face];
        return orientation(uv_[t[0]], uv_[t[1]], uv_[t[2]]);
    }

    // What one face gains must not cost another one more.
    double loss_around(Vertex v) const {
        double loss = 0.0;
        for (Index i = stars_.begin[v]; i < stars_.begin[at(v) + 1]; ++i) {
            const Index f = stars_.faces[i];
            const double ratio = twice_area(f) / area_[f];
            loss += ratio > 0.0 ? ratio + 1.0 / ratio - 2.0 : infinite;
        }
        return loss;
    }

    const std::vector<Triangle>& faces_;
    std::vector<double> area_;
    std::vector<Vec2>& uv_;
    Stars stars_;
};

// A face with its longest edge as base.
struct Needle {
    HalfEdge leaving; // of the face, from the apex
    double length;    // of the base
    double height;
    Vec2 upwards; // unit normal of the base, to the side of the face
};

// Makes low faces higher by moving their corners along the gradients of their areas, as position
// based dynamics keeps volumes: those around that become too low by it come next.
class RoomMaker {
public:
    RoomMaker(const std::vector<Triangle>& faces, double least, std::vector<Vec2>& uv)
        : faces_(faces), least_(least), uv_(uv) {}

    // Whether all faces have the least height then.
    bool make() {
        std::vector<Index> low;
        for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f)
            if (is_low(f))
                low.push_back(f);
        if (low.empty())
            return true;
        const Stars stars = build_stars(faces_, uv_.size());
        std::vector<std::uint8_t> waits(faces_.size(), 0);
        for (const Index f : low)
            waits[f] = 1;
        const std::size_t most = tuning.room_rounds * low.size();
        for (std::size_t i = 0; i < low.size() && i < most; ++i) {
            waits[low[i]] = 0;
            if (!is_low(low[i]))
                continue;
            raise(low[i], stars);
            for (const Vertex v : faces_[low[i]])
                for (Index k = stars.begin[v]; k < stars.begin[at(v) + 1]; ++k) {
                    const Index g = stars.faces[k];
                    if (waits[g] == 0 && is_low(g)) {
                        waits[g] = 1;
                        low.push_back(g);
                    }
                }
        }
        return low.size() <= most;
    }

private:
    double longest(Index f) const {
        const Triangle& t = faces_[f];
        return std::sqrt(
            std::max({(uv_[t[1]] - uv_[t[0]]).squaredNorm(), (uv_[t[2]] - uv_[t[1]]).squaredNorm(),
                      (uv_[t[0]] - uv_[t[2]]).squaredNorm()}));
    }
    double twice_area(Index f) const {
        const Triangle& t = faces_[f];
        return plane::cross(uv_[t[1]] - uv_[t[0]], uv_[t[2]] - uv_[t[0]]);
    }
    // An equilateral triangle is as high as 0.87 of its sides: specks count as well.
    bool is_low(Index f) const { return !(twice_area(f) >= least_ * longest(f)); }

    void raise(Index f, const Stars& stars) {
        const Triangle& t = faces_[f];
        Vec2 gradient[3]; // of twice the area
        double mobility[3];
        double squares = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            gradient[k] = plane::left_of(uv_[t[(k + 2) % 3]] - uv_[t[(k + 1) % 3]]);
            mobility[k] = is_inside(faces_, stars, t[k]) ? 1.0 : tuning.boundary_mobility;
            squares += mobility[k] * gradient[k].squaredNorm();
        }
        // A speck has hardly any gradient: it grows from its middle instead.
        const double missing = tuning.reached * least_ * longest(f) - twice_area(f);
        if (!(longest(f) > least_)) {
            grow(t);
            return;
        }
        for (std::size_t k = 0; k < 3; ++k)
            uv_[t[k]] += missing * mobility[k] / squares * gradient[k];
    }
    void grow(const Triangle& t) {
        const Vec2 middle = (uv_[t[0]] + uv_[t[1]] + uv_[t[2]]) / 3.0;
        const double radius = 2.0 / 3.0 * tuning.reached * least_; // of an equilateral one
        for (std::size_t k = 0; k < 3; ++k) {
            const double angle = 2.0 * pi / 3.0 * static_cast<double>(k);
            uv_[t[k]] = middle + radius * Vec2(std::cos(angle), std::sin(angle));
        }
    }

    const std::vector<Triangle>& faces_;
    double least_;
    std::vector<Vec2>& uv_;
};

class Needles {
public:
    Needles(const FlatteningProblem& problem, std::vector<Vec2>& uv)
        : problem_(problem), uv_(uv), least_(tuning.needle_height * problem.model_size) {}

    // To the height on the surface, or the least, those that were widened.
    void lower() const {
        for (Face f = 0; f < face_count(); ++f) {
            if (problem_.area[f] < tuning.widened * problem_.given_area[f])
                continue;
            const Needle needle = of_face(f);
            const double wanted = std::max(2.0 * problem_.given_area[f] / needle.length, least_);
            if (!(wanted < needle.height))
                continue;
            Vec2& apex = uv_[origin(needle.leaving)];
            const Vec2 home = apex;
            apex += (wanted - needle.height) * needle.upwards;
            if (!is_positive_around(problem_.faces, problem_.twin, uv_, needle.leaving))
                apex = home;
        }
    }

private:
    Index face_count() const { return static_cast<Index>(problem_.faces.size()); }
    Vertex origin(HalfEdge h) const { return problem_.faces[face_of(h)][corner_of(h)]; }

    Needle of_face(Face f) const {
        const Triangle& t = problem_.faces[f];
        Needle needle{};
        for (Index k = 0; k < 3; ++k) {
            const Vec2 base = uv_[t[(k + 1) % 3]] - uv_[t[k]];
            if (k > 0 && base.norm() <= needle.length)
                continue;
            needle.length = base.norm();
            needle.leaving = half_edge_of(f, (k + 2) % 3);
            needle.upwards = plane::left_of(Vec2(base / needle.length));
            needle.height = needle.upwards.dot(uv_[t[(k + 2) % 3]] - uv_[t[k]]);
        }
        return needle;
    }

    const FlatteningProblem& problem_;
    std::vector<Vec2>& uv_;
    double least_; // height, in the plane
};

} // namespace

Index snap_to_single(const std::vector<Triangle>& faces, std::vector<Vec2>& uv) {
    double farthest = 0.0;
    for (const Vec2& p : uv)
        farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
    const double step = unit_in_last_place(Vec2::Constant(farthest));
    RoomMaker(faces, tuning.grid_height * step, uv).make();
    std::vector<double> area;
    for (const Triangle& t : faces)
        area.push_back(orientation(uv[t[0]], uv[t[1]], uv[t[2]]));
    for (Vec2& p : uv)
        p = Vec2(in_32_bits(p.x()), in_32_bits(p.y()));
    std::vector<Index> thin;
    for (Face f = 0; f < static_cast<Index>(faces.size()); ++f) {
        const Triangle& t = faces[f];
        const double off = std::abs(orientation(uv[t[0]], uv[t[1]], uv[t[2]]) - area[f]);
        if (!(off <= tuning.kept_face_area * area[f]))
            thin.push_back(f);
    }
    if (thin.empty())
        return 0;
    AreaKeeper keeper(faces, std::move(area), uv);
    for (const Face f : thin)
        keeper.restore(f);
    return static_cast<Index>(std::count_if(thin.begin(), thin.end(),
                                            [&](Face f) { return !is_positive(faces, uv, f); }));
}

void restore_needles(const FlatteningProblem& problem, std::vector<Vec2>& uv) {
    Needles(problem, uv).lower();
}

} // namespace devseg::flatten
