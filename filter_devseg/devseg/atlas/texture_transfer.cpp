#include "devseg/atlas/texture_transfer.h"

#include <algorithm>

#include "devseg/plane/baking.h"

namespace devseg::atlas {

namespace {

// Pixels beside a face that bilinear sampling on it may reach.
constexpr double reach_of_sampling = 1.5;

} // namespace

plane::Image transfer_texture(const Mesh& mesh, const CornerUv& uv, const TexturedLayout& old,
                              int size, int padding, double& filled, const Progress& progress) {
    plane::Baking baking(size, size);
    for (const Face f : mesh.all_faces()) {
        progress.check();
        plane::BakedTriangle triangle;
        triangle.source = image_of(old, f);
        if (triangle.source == nullptr)
            continue;
        for (Index k = 0; k < 3; ++k) {
            triangle.place[at(k)] = static_cast<double>(size) * uv[3 * f + k];
            triangle.uv[at(k)] = old.uv[3 * f + k];
        }
        baking.add(triangle, std::max(reach_of_sampling, static_cast<double>(padding)));
    }
    filled = baking.filled();
    return baking.take();
}

const plane::Image* image_of(const TexturedLayout& layout, Face f) {
    const Index page = layout.page.empty() ? -1 : layout.page[f];
    if (page < 0 || at(page) >= layout.images.size() || layout.images[at(page)].is_empty())
        return nullptr;
    for (Index k = 0; k < 3; ++k)
        if (!layout.uv[3 * f + k].allFinite())
            return nullptr;
    return &layout.images[at(page)];
}

} // namespace devseg::atlas
