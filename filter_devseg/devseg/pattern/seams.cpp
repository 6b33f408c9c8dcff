#include "devseg/pattern/seams.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace devseg::pattern {

namespace {

// Where an edge of an outline lies.
struct EdgePlace {
    Index piece = -1; // −1: the half-edge lies on no outline
    Index path = 0;
    Index edge = 0;
};

// The outlines as they are traced: one edge for each half-edge.
class TracedEdges {
public:
    TracedEdges(const Mesh& mesh, const std::vector<PatternPiece>& pieces,
                const std::vector<std::uint8_t>& cut)
        : mesh_(mesh), pieces_(pieces), cut_(cut), place_(mesh.twin.size()) {
        for (std::size_t p = 0; p < pieces.size(); ++p)
            for (Index l = 0; l < pieces[p].path_count(); ++l) {
                const std::vector<Index>& half_edges = pieces[p].path(l).half_edge;
                for (std::size_t e = 0; e < half_edges.size(); ++e)
                    place_[half_edges[e]] = {static_cast<Index>(p), l, static_cast<Index>(e)};
            }
    }

    const EdgePlace& place(HalfEdge h) const { return place_[h]; }

    // The half-edge that h is sewn to, −1 where there is none on paper.
    HalfEdge partner(HalfEdge h) const {
        const HalfEdge twin = mesh_.twin[h];
        return twin >= 0 && place_[twin].piece >= 0 ? twin : HalfEdge();
    }

    Index next(HalfEdge h) const {
        const std::vector<Index>& half_edges = path_of(h).half_edge;
        return half_edges[(at(place_[h].edge) + 1) % half_edges.size()];
    }

    // Whether the outline after h goes on along the same seam, which must not turn back at a tip.
    bool goes_on(HalfEdge h) const {
        const Index after = next(h);
        const Index here = partner(h);
        const Index there = partner(after);
        if (here < 0 || there < 0)
            return here < 0 && there < 0;
        return here != after && next(there) == here && is_cut(h) == is_cut(after);
    }

    bool is_cut(HalfEdge h) const { return !cut_.empty() && cut_[h] != 0; }

    const PiecePath& path_of(HalfEdge h) const {
        return pieces_[place_[h].piece].path(place_[h].path);
    }

private:
    const Mesh& mesh_;
    const std::vector<PatternPiece>& pieces_;
    const std::vector<std::uint8_t>& cut_;
    std::vector<EdgePlace> place_; // #half-edges
};

SeamSide side_from(const EdgePlace& first, Index count, bool reversed) {
    SeamSide side;
    side.piece = first.piece;
    side.path = first.path;
    side.first = first.edge;
    side.count = count;
    side.reversed = reversed;
    return side;
}

// The chain along the half-edges, which lie on one outline in its order.
Chain chain_along(const TracedEdges& edges, const std::vector<Index>& run, bool closed) {
    const Index count = static_cast<Index>(run.size());
    Chain chain;
    chain.is_closed = closed;
    chain.is_cut = edges.is_cut(run.front());
    chain.sides[0] = side_from(edges.place(run.front()), count, false);
    if (edges.partner(run.front()) < 0) {
        chain.side_count = 1;
        return chain;
    }
    const Index first = edges.partner(run.front());
    const Index last = edges.partner(run.back());
    chain.sides[1] = side_from(edges.place(last), count, true);
    const bool tip_at_start = edges.next(first) == run.front();
    chain.is_dart = !closed && (tip_at_start || edges.next(run.back()) == last);
    // Darts end at their tips.
    if (tip_at_start && edges.next(run.back()) != last) {
        std::swap(chain.sides[0], chain.sides[1]);
        chain.sides[0].reversed = false;
        chain.sides[1].reversed = true;
    }
    return chain;
}

// Point k of a side as a subscript of its outline.
std::size_t subscript(const PiecePath& path, const SeamSide& side, Index k) {
    const Index size = static_cast<Index>(path.points.size());
    const Index position = side.reversed ? side.first + side.count - k : side.first + k;
    return at((position % size + size) % size);
}

// A seam shorter than this share of the spacing is sewn by its ends alone.
constexpr double shortest_seam = 0.5;
// The tip of a dart says which way round it goes, and holds its sides together.
constexpr double shortest_dart = 1.5;
// Bounds the drawing: closer notches than a thousand on a seam mark nothing.
constexpr double most_notches = 1000.0;

// The share u of even notches becomes u^p: p differs from seam to seam, so that sides of different
// seams do not fit by chance.
constexpr double least_power = 1.2;
constexpr double power_step = 0.05;
constexpr Index powers = 4;

// A notch keeps away from bends by moving along the seam, by these shares of the distance to its
// neighbour: an outline that turns by more than this angle near it is no place for a notch.
constexpr double shifts[] = {0.0, 0.08, -0.08, 0.16, -0.16, 0.24, -0.24, 0.32, -0.32};
constexpr double bend_cosine = 0.87; // 30 degrees
constexpr double near_by = 2.5;      // mm on both sides

// Cosine of the angle by which the sides turn around this share of their length, the sharper one.
double straightness(const Pattern& pattern, const Seam& seam, double share) {
    double least = 1.0;
    for (const SeamSide& side : seam.sides) {
        const double reach = std::min(near_by, 0.1 * side.length);
        const SidePoint before = point_on_side(pattern.pieces, side, share * side.length - reach);
        const SidePoint after = point_on_side(pattern.pieces, side, share * side.length + reach);
        least = std::min(least, before.outward.dot(after.outward));
    }
    return least;
}

// The share of the seam, near the one that is wished, where it is straight enough.
double straight_place(const Pattern& pattern, const Seam& seam, double wish, double room) {
    double best = wish;
    double best_cosine = -2.0;
    for (const double shift : shifts) {
        const double share = wish + shift * room;
        const double cosine = straightness(pattern, seam, share);
        if (cosine > best_cosine) {
            best = share;
            best_cosine = cosine;
        }
        if (cosine >= bend_cosine)
            break;
    }
    return best;
}

} // namespace

std::vector<Chain> find_chains(const Mesh& mesh, const std::vector<PatternPiece>& pieces,
                               const std::vector<std::uint8_t>& cut) {
    const TracedEdges edges(mesh, pieces, cut);
    std::vector<std::uint8_t> done(mesh.twin.size(), 0);
    std::vector<Chain> chains;
    const auto add_run = [&](const std::vector<Index>& run, bool closed) {
        if (done[run.front()] != 0)
            return;
        chains.push_back(chain_along(edges, run, closed));
        for (const HalfEdge h : run) {
            done[h] = 1;
            if (edges.partner(h) >= 0)
                done[edges.partner(h)] = 1;
        }
    };
    for (const PatternPiece& piece : pieces)
        for (Index l = 0; l < piece.path_count(); ++l) {
            const std::vector<Index>& half_edges = piece.path(l).half_edge;
            const std::size_t size = half_edges.size();
            std::size_t start = 0; // the first edge after a break
            while (start < size && edges.goes_on(half_edges[(start + size - 1) % size]))
                ++start;
            if (start == size) {
                add_run(half_edges, true);
                continue;
            }
            std::vector<Index> run;
            for (std::size_t i = 0; i < size; ++i) {
                run.push_back(half_edges[(start + i) % size]);
                if (edges.goes_on(run.back()))
                    continue;
                add_run(run, false);
                run.clear();
            }
        }
    return chains;
}

void measure_surface(const Mesh& mesh, const std::vector<PatternPiece>& pieces, double mm,
                     std::vector<Chain>& chains) {
    for (Chain& chain : chains) {
        const SeamSide& side = chain.sides[0];
        const PiecePath& path = pieces[side.piece].path(side.path);
        chain.surface_length = 0.0;
        chain.true_length.clear();
        for (Index k = 0; k < chain.count(); ++k) {
            const HalfEdge h = path.half_edge[subscript(path, side, k)];
            chain.true_length.push_back(mm * mesh.edge_length(h));
            chain.surface_length += chain.true_length.back();
        }
    }
}

Vec2 side_point(const std::vector<PatternPiece>& pieces, const SeamSide& side, Index k) {
    const PiecePath& path = pieces[side.piece].path(side.path);
    return path.points[subscript(path, side, k)];
}

Chain part_of(const std::vector<PatternPiece>& pieces, const Chain& chain, Index from, Index to) {
    Chain part = chain;
    part.is_closed = false;
    part.is_dart = chain.is_dart && to == chain.count();
    for (int s = 0; s < chain.side_count; ++s) {
        const SeamSide& side = chain.sides[s];
        const PiecePath& path = pieces[side.piece].path(side.path);
        SeamSide& own = part.sides[s];
        own.first = static_cast<Index>(subscript(path, side, side.reversed ? to : from));
        own.count = to - from;
    }
    return part;
}

namespace {

// Lengths on the model of what remains of a chain's edges.
std::vector<double> kept_lengths(const std::vector<PatternPiece>& pieces, const Chain& chain,
                                 const std::vector<Index>& kept) {
    std::vector<double> lengths;
    for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
        double length = 0.0;
        for (Index k = kept[i]; k < kept[i + 1]; ++k)
            length += chain.true_length[k];
        double shorter = 0.0;
        for (std::size_t s = 0; s < at(chain.side_count); ++s) {
            double path = 0.0;
            for (Index k = kept[i]; k < kept[i + 1]; ++k)
                path += (side_point(pieces, chain.sides[s], k + 1) -
                         side_point(pieces, chain.sides[s], k))
                            .norm();
            const double chord = (side_point(pieces, chain.sides[s], kept[i + 1]) -
                                  side_point(pieces, chain.sides[s], kept[i]))
                                     .norm();
            shorter += path > 0.0 ? chord / path : 1.0;
        }
        lengths.push_back(length * shorter / chain.side_count);
    }
    return lengths;
}

} // namespace

void keep_points(std::vector<PatternPiece>& pieces, std::vector<Chain>& chains,
                 const std::vector<std::vector<Index>>& kept) {
    // The sides of each outline in the order of its edges.
    using Key = std::tuple<Index, Index, Index>; // piece, path, first edge
    std::map<Key, std::pair<std::size_t, std::size_t>> order;
    for (std::size_t c = 0; c < chains.size(); ++c)
        for (std::size_t s = 0; s < at(chains[c].side_count); ++s) {
            const SeamSide& side = chains[c].sides[s];
            order[{side.piece, side.path, side.first}] = {c, s};
        }
    std::vector<PatternPiece> old = pieces;
    for (std::size_t c = 0; c < chains.size(); ++c)
        chains[c].true_length = kept_lengths(old, chains[c], kept[c]);
    for (PatternPiece& piece : pieces)
        for (Index l = 0; l < piece.path_count(); ++l) {
            piece.path(l).points.clear();
            piece.path(l).half_edge.clear();
        }
    for (const auto& [key, value] : order) {
        SeamSide& side = chains[value.first].sides[value.second];
        const std::vector<Index>& points = kept[value.first];
        const PiecePath& from = old[side.piece].path(side.path);
        PiecePath& path = pieces[side.piece].path(side.path);
        const Index first = static_cast<Index>(path.points.size());
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const Index k = side.reversed ? points[points.size() - 1 - i] : points[i];
            path.points.push_back(from.points[subscript(from, side, k)]);
            path.half_edge.push_back(from.half_edge[subscript(from, side, k)]);
        }
        side.first = first;
        side.count = static_cast<Index>(points.size()) - 1;
    }
}

void drop_empty_edges(std::vector<PatternPiece>& pieces, std::vector<Chain>& chains) {
    std::map<std::pair<Index, Index>, std::vector<Index>> places; // of outlines that changed
    for (std::size_t p = 0; p < pieces.size(); ++p)
        for (Index l = 0; l < pieces[p].path_count(); ++l) {
            PiecePath& path = pieces[p].path(l);
            const std::size_t size = path.points.size();
            std::vector<Index> place(size + 1, 0); // edges with a length before each edge
            for (std::size_t e = 0; e < size; ++e) {
                const bool empty = path.points[e] == path.points[(e + 1) % size];
                if (!empty && at(place[e]) != e) {
                    path.points[place[e]] = path.points[e];
                    path.half_edge[place[e]] = path.half_edge[e];
                }
                place[e + 1] = place[e] + (empty ? 0 : 1);
            }
            if (at(place[size]) == size)
                continue;
            path.points.resize(at(place[size]));
            path.half_edge.resize(at(place[size]));
            places[{static_cast<Index>(p), l}] = std::move(place);
        }
    for (Chain& chain : chains)
        for (std::size_t s = 0; s < at(chain.side_count); ++s) {
            SeamSide& side = chain.sides[s];
            const auto changed = places.find({side.piece, side.path});
            if (changed == places.end())
                continue;
            const std::vector<Index>& place = changed->second;
            const Index size = static_cast<Index>(place.size()) - 1;
            const Index end = side.first + side.count;
            const Index last = end <= size ? place[end] : place.back() + place[end - size];
            side.count = last - place[side.first];
            side.first = place.back() > 0 ? place[side.first] % place.back() : 0;
        }
}

void set_seams(Pattern& pattern, const std::vector<Chain>& chains) {
    for (PatternPiece& piece : pattern.pieces)
        for (Index l = 0; l < piece.path_count(); ++l)
            piece.path(l).edges.assign(piece.path(l).points.size(), OutlineSeam{});
    pattern.seams.clear();
    for (const Chain& chain : chains) {
        if (chain.side_count < 2)
            continue;
        Seam seam;
        seam.number = static_cast<Index>(pattern.seams.size()) + 1;
        seam.label = std::to_string(seam.number);
        seam.sides = chain.sides;
        seam.surface_length = chain.surface_length;
        seam.is_dart = chain.is_dart;
        seam.is_closed = chain.is_closed;
        for (int s = 0; s < 2; ++s) {
            const SeamSide& side = seam.sides[s];
            PiecePath& path = pattern.pieces[side.piece].path(side.path);
            for (Index e = 0; e < side.count; ++e)
                path.edges[at(side.first + e) % path.edges.size()] = {seam.number - 1, s,
                                                                      seam.is_dart};
        }
        pattern.seams.push_back(std::move(seam));
    }
    measure_sides(pattern);
}

void measure_sides(Pattern& pattern) {
    pattern.hem_length = 0.0;
    for (const PatternPiece& piece : pattern.pieces)
        for (Index l = 0; l < piece.path_count(); ++l) {
            const PiecePath& path = piece.path(l);
            for (std::size_t i = 0; i < path.points.size(); ++i)
                if (path.edges[i].seam < 0)
                    pattern.hem_length +=
                        (path.points[(i + 1) % path.points.size()] - path.points[i]).norm();
        }
    for (Seam& seam : pattern.seams)
        for (SeamSide& side : seam.sides) {
            side.length = 0.0;
            for (Index k = 0; k < side.count; ++k)
                side.length +=
                    (side_point(pattern.pieces, side, k + 1) - side_point(pattern.pieces, side, k))
                        .norm();
        }
}

SidePoint point_on_side(const std::vector<PatternPiece>& pieces, const SeamSide& side, double mm) {
    SidePoint result;
    double left = mm;
    for (Index k = 0; k < side.count; ++k) {
        const Vec2 from = side_point(pieces, side, k);
        const Vec2 along = side_point(pieces, side, k + 1) - from;
        const double length = along.norm();
        if (length > 0.0) {
            const double share = std::clamp(left / length, 0.0, 1.0);
            const double turn = side.reversed ? -1.0 : 1.0;
            result.position = from + share * along;
            result.outward = turn / length * Vec2(along.y(), -along.x());
        }
        if (left <= length)
            break;
        left -= length;
    }
    return result;
}

void set_notches(Pattern& pattern, double spacing_mm) {
    for (Seam& seam : pattern.seams) {
        for (SeamSide& side : seam.sides)
            side.notches.clear();
        const double length = std::min(seam.sides[0].length, seam.sides[1].length);
        const double shortest = seam.is_dart ? shortest_dart : shortest_seam;
        if (!(spacing_mm > 0.0) || !(length >= shortest * spacing_mm))
            continue;
        const double count = std::clamp(std::round(length / spacing_mm), 1.0, most_notches);
        const double power = least_power + power_step * static_cast<double>(seam.number % powers);
        const auto place = [&](double i) { return std::pow(i / count, power); };
        for (double i = 0.5; i < count; ++i) {
            const double room = std::min(place(i) - place(std::max(0.0, i - 1.0)),
                                         place(std::min(count, i + 1.0)) - place(i));
            const double share = straight_place(pattern, seam, place(i), room);
            for (SeamSide& side : seam.sides)
                side.notches.push_back(share * side.length);
        }
    }
}

} // namespace devseg::pattern
