#include "devseg/mesh/coherent_faces.h"

#include <algorithm>
#include <array>
#include <utility>

#include "devseg/base/buckets.h"

namespace devseg::mesh {

namespace {

// Visits the items of each bucket, sorted.
template <class Item, class Visit>
void for_sorted(Buckets<Item> buckets, Visit visit) {
    for (Index b = 0; b < buckets.count(); ++b) {
        const auto first = buckets.items.begin() + buckets.begin[b];
        const auto last = buckets.items.begin() + buckets.begin[at(b) + 1];
        std::sort(first, last);
        visit(first, last);
    }
}

} // namespace

FaceSelection select_proper_faces(const std::vector<Triangle>& faces, Index vertex_count) {
    const Range<FaceKind> all(0, static_cast<Index>(faces.size()));
    const auto sorted = [&](Face f) {
        Triangle t = faces[f];
        std::sort(t.begin(), t.end());
        return t;
    };
    using Key = std::array<Index, 3>; // middle vertex, largest vertex, face
    FaceSelection result;
    result.duplicate_of.assign(faces.size(), -1);
    for_sorted(make_buckets<Key>(vertex_count,
                                 [&](auto put) {
                                     for (const Face f : all) {
                                         const Triangle t = sorted(f);
                                         put(t[0], Key{t[1], t[2], f});
                                     }
                                 }),
               [&](auto key, auto last) {
                   if (key == last)
                       return;
                   for (auto before = key++; key != last; before = key++)
                       if ((*key)[0] == (*before)[0] && (*key)[1] == (*before)[1]) {
                           const Index first = result.duplicate_of[(*before)[2]];
                           result.duplicate_of[(*key)[2]] = first >= 0 ? first : (*before)[2];
                       }
               });
    result.kept.reserve(faces.size());
    for (const Face f : all) {
        const Triangle t = sorted(f);
        if (t[0] == t[1] || t[1] == t[2]) {
            result.duplicate_of[f] = -1;
            ++result.repeated;
        } else if (result.duplicate_of[f] >= 0) {
            ++result.duplicates;
        } else {
            result.kept.push_back(f);
        }
    }
    return result;
}

std::vector<HalfEdge> neighbours_regardless_of_direction(const Mesh& mesh,
                                                         std::vector<std::uint8_t>& crowded) {
    crowded.assign(3 * mesh.faces.size(), 0);
    std::vector<HalfEdge> neighbour(crowded.size());
    using Use = std::pair<Index, Index>; // (larger vertex, half-edge)
    const auto put_all = [&](auto put) {
        for (const HalfEdge h : mesh.all_half_edges()) {
            const auto [low, high] = std::minmax({mesh.origin(h), mesh.target(h)});
            put(low, Use(high, h));
        }
    };
    for_sorted(make_buckets<Use>(mesh.vertex_count(), put_all), [&](auto run, auto last) {
        for (auto end = run; run != last; run = end) {
            while (end != last && end->first == run->first)
                ++end;
            if (end - run == 2) {
                neighbour[run->second] = (run + 1)->second;
                neighbour[(run + 1)->second] = run->second;
            } else if (end - run > 2) {
                for (auto use = run; use != end; ++use)
                    crowded[use->second] = 1;
            }
        }
    });
    return neighbour;
}

Orientation orient(const Mesh& mesh, std::vector<HalfEdge>& neighbour,
                   std::vector<std::uint8_t>& cut) {
    Orientation result;
    result.flipped.assign(mesh.faces.size(), 2); // 2 = not reached yet
    std::vector<Index> component;
    for (const Face seed : mesh.all_faces()) {
        if (result.flipped[seed] != 2)
            continue;
        component.assign(1, seed);
        result.flipped[seed] = 0;
        Index turned = 0;
        for (std::size_t i = 0; i < component.size(); ++i) {
            const Face f = component[i];
            turned += result.flipped[f];
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge opposite = neighbour[h];
                if (opposite < 0)
                    continue;
                // Two faces that run along their edge in the same direction disagree.
                const bool disagree = mesh.origin(h) == mesh.origin(opposite);
                const std::uint8_t wanted = result.flipped[f] ^ (disagree ? 1 : 0);
                std::uint8_t& state = result.flipped[face_of(opposite)];
                if (state == 2) {
                    state = wanted;
                    component.push_back(face_of(opposite));
                } else if (state != wanted) {
                    ++result.one_sided_edges;
                    cut[h] = cut[opposite] = 1;
                    neighbour[h] = neighbour[opposite] = -1;
                }
            }
        }
        const Index size = static_cast<Index>(component.size());
        if (2 * turned > size) {
            for (const Face f : component)
                result.flipped[f] ^= 1;
            turned = size - turned;
        }
        result.turned += turned;
    }
    return result;
}

} // namespace devseg::mesh
