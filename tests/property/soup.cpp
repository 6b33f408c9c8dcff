#include "property/soup.h"

#include <algorithm>
#include <map>
#include <utility>

#include "unit/shapes.h"

namespace devseg::shapes {

namespace {

constexpr double unevenness = 0.2; // of a cell: how far vertices leave their places

class Foam {
public:
    Foam(Random& random, Index cells, Index bubbles) : random_(random), cells_(cells) {
        for (Index b = 0; b < bubbles; ++b)
            centers_.push_back(0.5 * cells * random.uniform(0.0, 1.0) * random.direction());
    }

    mesh::RawMesh make() {
        for (Index x = 0; x <= cells_; ++x)
            for (Index y = 0; y <= cells_; ++y)
                for (Index z = 0; z <= cells_; ++z)
                    for (Index axis = 0; axis < 3; ++axis)
                        add_wall({x, y, z}, axis);
        return std::move(raw_);
    }

private:
    using Place = std::array<Index, 3>;

    Random& random_;
    Index cells_;
    std::vector<Vec3> centers_;
    std::map<Place, Index> vertex_;
    mesh::RawMesh raw_;

    // The bubble that the cell belongs to, −1 outside of the ball.
    Index bubble(const Place& cell) const {
        const Vec3 p = Vec3(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5) -
                       Vec3::Constant(0.5 * static_cast<double>(cells_));
        if (p.norm() > 0.5 * cells_)
            return -1;
        Index best = 0;
        for (std::size_t b = 1; b < centers_.size(); ++b)
            if ((p - centers_[b]).norm() < (p - centers_[at(best)]).norm())
                best = static_cast<Index>(b);
        return best;
    }

    // The square between a cell and the one before it along the axis.
    void add_wall(const Place& cell, Index axis) {
        Place before = cell;
        --before[at(axis)];
        const Index here = bubble(cell);
        const Index there = bubble(before);
        if (here == there)
            return;
        std::array<Index, 4> corners{};
        for (std::size_t i = 0; i < 4; ++i) {
            Place place = cell;
            place[at((axis + 1) % 3)] += i == 1 || i == 2 ? 1 : 0;
            place[at((axis + 2) % 3)] += i >= 2 ? 1 : 0;
            corners[i] = vertex(place);
        }
        if (here > there)
            std::swap(corners[1], corners[3]);
        raw_.faces.push_back({corners[0], corners[1], corners[2]});
        raw_.faces.push_back({corners[0], corners[2], corners[3]});
    }

    Index vertex(const Place& place) {
        const auto [found, fresh] =
            vertex_.try_emplace(place, static_cast<Index>(raw_.points.size()));
        if (fresh)
            raw_.points.push_back(Vec3(place[0], place[1], place[2]) +
                                  unevenness * random_.uniform(0.0, 1.0) * random_.direction());
        return found->second;
    }
};

} // namespace

mesh::RawMesh foam(Random& random, Index cells, Index bubbles, Index bits) {
    mesh::RawMesh raw = Foam(random, cells, bubbles).make();
    for (Index i = 0; i < bits; ++i) {
        const Vec3 place = Vec3::Constant(0.5 * cells) + 0.7 * cells * random.direction();
        raw = join(raw, moved(tetrahedron(), random.uniform(0.2, 2.0), place));
    }
    return raw;
}

double crowded_share(const mesh::RawMesh& raw) {
    std::vector<std::pair<Index, Index>> edges;
    for (const Triangle& t : raw.faces)
        for (std::size_t k = 0; k < 3; ++k)
            edges.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
    std::sort(edges.begin(), edges.end());
    double all = 0.0;
    double crowded = 0.0;
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
        while (j < edges.size() && edges[j] == edges[i])
            ++j;
        ++all;
        crowded += j - i > 2 ? 1.0 : 0.0;
    }
    return crowded / all;
}

} // namespace devseg::shapes
