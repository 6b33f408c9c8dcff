#include <string>

#include "devseg/atlas/texture_transfer.h"
#include "devseg/base/errors.h"
#include "devseg/declare/declare.h"

namespace devseg::filters {

using namespace declare;

namespace {

struct TransferOptions {
    int texture_size = 2048;
    int padding_pixels = 4;

    static OptionRanges<TransferOptions> ranges() {
        return {{&TransferOptions::texture_size, {"texture_size", 16, 16384}},
                {&TransferOptions::padding_pixels, {"padding_pixels", 0, 64}}};
    }
};

constexpr const char* transfer_help =
    "Bakes the textures of the mesh into its new texture coordinates. So a textured scan keeps its "
    "look when it is segmented and flattened anew. The result is one image of the colours that the "
    "surface had, bilinear, with padding around the charts.<br>"
    "'Charts: Flatten' and 'Charts: Pack' keep the coordinates that fit the textures as face "
    "attributes <b>texcoord_before_u</b>, <b>texcoord_before_v</b> and <b>texture_before</b>; they "
    "are removed afterwards. The new coordinates must lie in the unit square.";

FilterOutput run_transfer(const FilterInput& input, const TransferOptions& options,
                          Progress& progress) {
    check_ranges(options);
    if (input.textures.empty() || !input.uv_before)
        throw InvalidMesh(
            "expected a mesh with textures and with the coordinates that fit them, as "
            "'Charts: Flatten' keeps them, found none; load a textured mesh and run "
            "that first");
    for (const Vec2& p : *input.uv)
        if (!(p.minCoeff() >= 0.0 && p.maxCoeff() <= 1.0))
            throw InvalidMesh("expected texture coordinates in the unit square, found others; run "
                              "'Charts: Pack' first");
    auto baking = progress.part("baking the texture", 1.0);
    FilterOutput output;
    double filled = 0.0;
    output.texture = atlas::transfer_texture(
        input.mesh, *input.uv, {*input.uv_before, input.page_before, input.textures},
        options.texture_size, options.padding_pixels, filled, baking);
    output.values = {{"textures_number", static_cast<int>(input.textures.size())},
                     {"filled_share", filled}};
    return output;
}

} // namespace

std::vector<FilterDeclaration> texture_filters() {
    using O = TransferOptions;
    return {Declare<O>("Texture: Transfer to New Layout", "transfer_texture_to_new_layout",
                       FilterCategory::texture, transfer_help)
                .integer(&O::texture_size, "Size of the texture",
                         "Pixels along each side of the new image, at most 16384.")
                .integer(&O::padding_pixels, "Padding",
                         "Pixels around each chart that take the colours of its border.")
                .needs_uv()
                .needs_texture()
                .writes(writes_texture)
                .result("textures_number", "images that the mesh had")
                .result("filled_share", "of the new image's pixels, 0 to 1")
                .runs(run_transfer)};
}

} // namespace devseg::filters
