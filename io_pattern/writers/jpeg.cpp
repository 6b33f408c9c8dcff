#include "writers/jpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>

#include <jpeglib.h>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"

namespace devseg::writers {

namespace {

constexpr int quality = 92;
constexpr int most_pixels = 65535; // what the format can say

// The library's own answers to errors write to the terminal and end the process. It is C, through
// which no exception may pass.
struct Errors {
    jpeg_error_mgr base{};
    std::jmp_buf back{};

    Errors() {
        base.error_exit = [](j_common_ptr state) {
            std::longjmp(reinterpret_cast<Errors*>(state->err)->back, 1);
        };
        base.emit_message = [](j_common_ptr, int) {};
        base.output_message = [](j_common_ptr) {};
        base.format_message = [](j_common_ptr, char*) {};
        base.reset_error_mgr = [](j_common_ptr) {};
    }
};

// False where it fails: with sides that are checked, for want of memory. Nothing in here has a
// destructor that a jump would miss.
bool encode(const DrawingImage& image, std::uint8_t** bytes, unsigned long* size) {
    jpeg_compress_struct state{};
    Errors errors;
    state.err = &errors.base;
    if (setjmp(errors.back) != 0) {
        jpeg_destroy_compress(&state);
        return false;
    }
    jpeg_create_compress(&state);
    jpeg_mem_dest(&state, bytes, size);
    state.image_width = static_cast<JDIMENSION>(image.columns);
    state.image_height = static_cast<JDIMENSION>(image.rows);
    state.input_components = 3;
    state.in_color_space = JCS_RGB;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, quality, TRUE);
    state.dct_method = JDCT_ISLOW; // the same bytes on every processor
    state.comp_info[0].h_samp_factor = state.comp_info[0].v_samp_factor = 1; // colours in full
    jpeg_start_compress(&state, TRUE);
    while (state.next_scanline < state.image_height) {
        // The library reads rows only, but takes no const ones.
        JSAMPROW row = const_cast<std::uint8_t*>(image.rgb.data()) +
                       3 * static_cast<std::size_t>(state.next_scanline) *
                           static_cast<std::size_t>(image.columns);
        jpeg_write_scanlines(&state, &row, 1);
    }
    jpeg_finish_compress(&state);
    jpeg_destroy_compress(&state);
    return true;
}

} // namespace

std::string jpeg_bytes(const DrawingImage& image) {
    if (std::min(image.columns, image.rows) < 1 ||
        std::max(image.columns, image.rows) > most_pixels)
        throw InvalidParameter("page: expected pictures of at most " + std::to_string(most_pixels) +
                               " pixels on each side, found " + std::to_string(image.columns) +
                               " x " + std::to_string(image.rows));
    std::uint8_t* bytes = nullptr;
    unsigned long size = 0;
    const bool done = encode(image, &bytes, &size);
    const std::unique_ptr<std::uint8_t, decltype(&std::free)> owner(bytes, &std::free);
    if (!done)
        throw std::bad_alloc();
    return {reinterpret_cast<const char*>(bytes), size};
}

std::vector<std::string> jpeg_files(const std::vector<DrawingImage>& images) {
    std::vector<std::string> files(images.size());
    Progress progress;
    parallel_for(
        static_cast<int>(images.size()), [&](int i) { files[at(i)] = jpeg_bytes(images[at(i)]); },
        progress);
    return files;
}

} // namespace devseg::writers
