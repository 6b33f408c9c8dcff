// Faces, half-edges and vertices as numbers that the compiler tells apart.
#pragma once

#include "devseg/base/numbers.h"

namespace devseg {

/// A number of one kind of element. Converts from and to Index, so that it subscripts any container
/// and costs nothing; but never to a number of another kind: a face is no half-edge.
template <class Kind>
class Element {
public:
    constexpr Element() = default;                       // none
    constexpr Element(Index number) : number_(number) {} // NOLINT: numbers in files and containers
    constexpr operator Index() const { return number_; } // NOLINT
    constexpr Element& operator++() {
        ++number_;
        return *this;
    }

private:
    Index number_ = -1;
};
using Face = Element<struct FaceKind>;
using HalfEdge = Element<struct HalfEdgeKind>;
using Vertex = Element<struct VertexKind>;

/// Elements first … end − 1, for range-based loops.
template <class Kind>
class Range {
public:
    struct Iterator {
        Element<Kind> at;
        constexpr Element<Kind> operator*() const { return at; }
        constexpr Iterator& operator++() {
            ++at;
            return *this;
        }
        constexpr bool operator!=(const Iterator& other) const {
            return Index{at} != Index{other.at};
        }
    };
    constexpr Range(Index first, Index end) : first_{first}, end_{end} {}
    constexpr Iterator begin() const { return first_; }
    constexpr Iterator end() const { return end_; }

private:
    Iterator first_;
    Iterator end_;
};

/// Half-edge 3 f + e runs from corner e to corner e + 1 (mod 3) of face f.
constexpr HalfEdge half_edge_of(Face f, Index corner) {
    return 3 * f + corner;
}
constexpr Range<HalfEdgeKind> half_edges_of(Face f) {
    return {3 * f, 3 * f + 3};
}
constexpr Face face_of(HalfEdge h) {
    return h / 3;
}
constexpr Index corner_of(HalfEdge h) {
    return h % 3;
}
} // namespace devseg
