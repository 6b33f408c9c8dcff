// Changes of raw meshes, and random numbers that are the same everywhere.
#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "devseg/mesh/input_gate.h"

namespace devseg::shapes {

/// A fixed generator without the standard distributions, which differ between libraries.
class Random {
public:
    explicit Random(std::uint32_t seed) : generator_(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * static_cast<double>(generator_()) / 4294967296.0;
    }
    Index below(Index count) {
        return static_cast<Index>(generator_() % static_cast<std::uint32_t>(count));
    }
    Vec3 direction(); // uniform on the unit sphere
    template <class T>
    void shuffle(std::vector<T>& items) {
        for (std::size_t i = items.size(); i > 1; --i)
            std::swap(items[i - 1], items[below(static_cast<Index>(i))]);
    }

private:
    std::mt19937 generator_;
};

mesh::RawMesh join(const mesh::RawMesh& a, const mesh::RawMesh& b);
mesh::RawMesh moved(mesh::RawMesh mesh, double scale, const Vec3& offset);
mesh::RawMesh turned_over(mesh::RawMesh mesh);
/// Every face is turned over with probability ½.
mesh::RawMesh with_random_orientations(mesh::RawMesh mesh, std::uint32_t seed);
/// Moves every vertex by up to `amplitude` along each axis.
mesh::RawMesh with_noise(mesh::RawMesh mesh, double amplitude, std::uint32_t seed);
/// The same surface with its faces in another order: face i is face order[i] of `mesh`.
mesh::RawMesh with_face_order(const mesh::RawMesh& mesh, const std::vector<Index>& order);
std::vector<Index> random_order(std::size_t count, std::uint32_t seed);

} // namespace devseg::shapes
