// References
//   ITU-T T.81: Digital compression and coding of continuous-tone still images. 1992 (JPEG; tables
//   K.1 to K.6). E. Hamilton: JPEG file interchange format, version 1.02. 1992.
#include "writers/jpeg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "devseg/base/errors.h"

namespace devseg::writers {

namespace {

constexpr int quality = 92;
constexpr int longest_side = 65535; // what the format can say

using Block = std::array<float, 64>;
using Bytes = std::array<std::uint8_t, 64>;

constexpr Bytes zigzag = {0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,
                          12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6,  7,  14, 21, 28,
                          35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51,
                          58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};
constexpr Bytes luminance = {16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
                             14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,
                             18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
                             49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};
constexpr Bytes chrominance = {17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99,
                               24, 26, 56, 99, 99, 99, 99, 99, 47, 66, 99, 99, 99, 99, 99, 99,
                               99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,
                               99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99};

// How many codes there are of each length from 1 to 16, and what they stand for.
struct HuffmanTable {
    std::array<std::uint8_t, 16> counts;
    std::vector<std::uint8_t> symbols;
};

const std::array<HuffmanTable, 2>& dc_tables() {
    static const std::vector<std::uint8_t> sizes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    static const std::array<HuffmanTable, 2> tables = {
        HuffmanTable{{0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0}, sizes},
        HuffmanTable{{0, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0}, sizes}};
    return tables;
}

const std::array<HuffmanTable, 2>& ac_tables() {
    static const std::array<HuffmanTable, 2> tables = {
        HuffmanTable{{0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 0x7d},
                     {0x01, 0x02, 0x03, 0x00, 0x04, 0x11, 0x05, 0x12, 0x21, 0x31, 0x41, 0x06, 0x13,
                      0x51, 0x61, 0x07, 0x22, 0x71, 0x14, 0x32, 0x81, 0x91, 0xa1, 0x08, 0x23, 0x42,
                      0xb1, 0xc1, 0x15, 0x52, 0xd1, 0xf0, 0x24, 0x33, 0x62, 0x72, 0x82, 0x09, 0x0a,
                      0x16, 0x17, 0x18, 0x19, 0x1a, 0x25, 0x26, 0x27, 0x28, 0x29, 0x2a, 0x34, 0x35,
                      0x36, 0x37, 0x38, 0x39, 0x3a, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49, 0x4a,
                      0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59, 0x5a, 0x63, 0x64, 0x65, 0x66, 0x67,
                      0x68, 0x69, 0x6a, 0x73, 0x74, 0x75, 0x76, 0x77, 0x78, 0x79, 0x7a, 0x83, 0x84,
                      0x85, 0x86, 0x87, 0x88, 0x89, 0x8a, 0x92, 0x93, 0x94, 0x95, 0x96, 0x97, 0x98,
                      0x99, 0x9a, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6, 0xa7, 0xa8, 0xa9, 0xaa, 0xb2, 0xb3,
                      0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba, 0xc2, 0xc3, 0xc4, 0xc5, 0xc6, 0xc7,
                      0xc8, 0xc9, 0xca, 0xd2, 0xd3, 0xd4, 0xd5, 0xd6, 0xd7, 0xd8, 0xd9, 0xda, 0xe1,
                      0xe2, 0xe3, 0xe4, 0xe5, 0xe6, 0xe7, 0xe8, 0xe9, 0xea, 0xf1, 0xf2, 0xf3, 0xf4,
                      0xf5, 0xf6, 0xf7, 0xf8, 0xf9, 0xfa}},
        HuffmanTable{{0, 2, 1, 2, 4, 4, 3, 4, 7, 5, 4, 4, 0, 1, 2, 0x77},
                     {0x00, 0x01, 0x02, 0x03, 0x11, 0x04, 0x05, 0x21, 0x31, 0x06, 0x12, 0x41, 0x51,
                      0x07, 0x61, 0x71, 0x13, 0x22, 0x32, 0x81, 0x08, 0x14, 0x42, 0x91, 0xa1, 0xb1,
                      0xc1, 0x09, 0x23, 0x33, 0x52, 0xf0, 0x15, 0x62, 0x72, 0xd1, 0x0a, 0x16, 0x24,
                      0x34, 0xe1, 0x25, 0xf1, 0x17, 0x18, 0x19, 0x1a, 0x26, 0x27, 0x28, 0x29, 0x2a,
                      0x35, 0x36, 0x37, 0x38, 0x39, 0x3a, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49,
                      0x4a, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59, 0x5a, 0x63, 0x64, 0x65, 0x66,
                      0x67, 0x68, 0x69, 0x6a, 0x73, 0x74, 0x75, 0x76, 0x77, 0x78, 0x79, 0x7a, 0x82,
                      0x83, 0x84, 0x85, 0x86, 0x87, 0x88, 0x89, 0x8a, 0x92, 0x93, 0x94, 0x95, 0x96,
                      0x97, 0x98, 0x99, 0x9a, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6, 0xa7, 0xa8, 0xa9, 0xaa,
                      0xb2, 0xb3, 0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba, 0xc2, 0xc3, 0xc4, 0xc5,
                      0xc6, 0xc7, 0xc8, 0xc9, 0xca, 0xd2, 0xd3, 0xd4, 0xd5, 0xd6, 0xd7, 0xd8, 0xd9,
                      0xda, 0xe2, 0xe3, 0xe4, 0xe5, 0xe6, 0xe7, 0xe8, 0xe9, 0xea, 0xf2, 0xf3, 0xf4,
                      0xf5, 0xf6, 0xf7, 0xf8, 0xf9, 0xfa}}};
    return tables;
}

struct Code {
    std::uint32_t bits = 0;
    int length = 0;
};

std::array<Code, 256> codes_of(const HuffmanTable& table) {
    std::array<Code, 256> codes{};
    std::uint32_t code = 0;
    std::size_t next = 0;
    for (int length = 1; length <= 16; ++length, code <<= 1)
        for (int i = 0; i < table.counts[static_cast<std::size_t>(length - 1)]; ++i)
            codes[table.symbols[next++]] = {code++, length};
    return codes;
}

Bytes scaled(const Bytes& table) {
    const int factor = 200 - 2 * quality; // for qualities of 50 and more, in percent
    Bytes result{};
    for (std::size_t i = 0; i < 64; ++i)
        result[i] = static_cast<std::uint8_t>(std::clamp((table[i] * factor + 50) / 100, 1, 255));
    return result;
}

// cos((2 i + 1) k pi / 16), scaled so that the transform is orthonormal: row k, column i.
const Block& cosines() {
    static const Block table = [] {
        Block c{};
        for (std::size_t k = 0; k < 8; ++k)
            for (std::size_t i = 0; i < 8; ++i)
                c[8 * k + i] = static_cast<float>((k == 0 ? std::sqrt(0.125) : 0.5) *
                                                  std::cos((2.0 * static_cast<double>(i) + 1.0) *
                                                           static_cast<double>(k) * pi / 16.0));
        return c;
    }();
    return table;
}

// One direction, by the symmetry of the cosines; transposes.
void transform(const Block& in, Block& out) {
    const Block& c = cosines();
    for (std::size_t row = 0; row < 8; ++row) {
        const float* x = in.data() + 8 * row;
        const std::array<float, 4> even = {x[0] + x[7], x[1] + x[6], x[2] + x[5], x[3] + x[4]};
        const std::array<float, 4> odd = {x[0] - x[7], x[1] - x[6], x[2] - x[5], x[3] - x[4]};
        for (std::size_t k = 0; k < 8; ++k) {
            const std::array<float, 4>& half = k % 2 == 0 ? even : odd;
            const float* w = c.data() + 8 * k;
            out[8 * k + row] = w[0] * half[0] + w[1] * half[1] + w[2] * half[2] + w[3] * half[3];
        }
    }
}

class Encoder {
public:
    explicit Encoder(const DrawingImage& image) : image_(image) {
        for (std::size_t t = 0; t < 2; ++t) {
            quantum_[t] = scaled(t == 0 ? luminance : chrominance);
            dc_[t] = codes_of(dc_tables()[t]);
            ac_[t] = codes_of(ac_tables()[t]);
        }
    }

    std::string write() {
        header();
        std::array<int, 3> last{};
        std::array<Block, 3> planes{};
        for (int y = 0; y < image_.rows; y += 8)
            for (int x = 0; x < image_.columns; x += 8) {
                const bool is_even = read(x, y, planes);
                for (std::size_t p = 0; p < 3; ++p)
                    encode(planes[p], is_even, p == 0 ? 0 : 1, last[p]);
            }
        put(0x7f, 7);
        bytes_ += "\xff\xd9";
        return std::move(bytes_);
    }

private:
    void word(int value) {
        bytes_ += static_cast<char>(value >> 8 & 255);
        bytes_ += static_cast<char>(value & 255);
    }
    void segment(int marker, const std::string& content) {
        word(0xff00 + marker);
        word(static_cast<int>(content.size()) + 2);
        bytes_ += content;
    }

    void header() {
        word(0xffd8);
        segment(0xe0, std::string("JFIF\0\1\1\0\0\1\0\1\0\0", 14));
        for (std::size_t t = 0; t < 2; ++t) {
            std::string table(1, static_cast<char>(t));
            for (const std::uint8_t place : zigzag)
                table += static_cast<char>(quantum_[t][place]);
            segment(0xdb, table);
        }
        word(0xffc0);
        word(17);
        bytes_ += '\x08';
        word(image_.rows);
        word(image_.columns);
        bytes_ += std::string("\3\1\x11\0\2\x11\1\3\x11\1", 10); // all at full resolution
        for (std::size_t t = 0; t < 2; ++t)
            for (const auto& [kind, table] :
                 {std::pair(0x00, &dc_tables()[t]), std::pair(0x10, &ac_tables()[t])}) {
                std::string content(1, static_cast<char>(kind + static_cast<int>(t)));
                content.append(table->counts.begin(), table->counts.end());
                content.append(table->symbols.begin(), table->symbols.end());
                segment(0xc4, content);
            }
        segment(0xda, std::string("\3\1\0\2\x11\3\x11\0\x3f\0", 10));
    }

    // 8 x 8 pixels as brightness and two colour differences, the last ones repeated beyond the
    // image; whether all are the same.
    bool read(int left, int top, std::array<Block, 3>& planes) const {
        bool is_even = true;
        const std::uint8_t* first = nullptr;
        for (int y = 0; y < 8; ++y) {
            const int row = std::min(top + y, image_.rows - 1);
            for (int x = 0; x < 8; ++x) {
                const int column = std::min(left + x, image_.columns - 1);
                const std::uint8_t* c =
                    image_.rgb.data() +
                    3 * (static_cast<std::ptrdiff_t>(row) * image_.columns + column);
                first = first == nullptr ? c : first;
                is_even = is_even && std::equal(c, c + 3, first);
                const float r = c[0];
                const float g = c[1];
                const float b = c[2];
                const auto i = static_cast<std::size_t>(8 * y + x);
                planes[0][i] = 0.299F * r + 0.587F * g + 0.114F * b - 128.0F;
                planes[1][i] = -0.168736F * r - 0.331264F * g + 0.5F * b;
                planes[2][i] = 0.5F * r - 0.418688F * g - 0.081312F * b;
            }
        }
        return is_even;
    }

    void encode(const Block& plane, bool is_even, std::size_t table, int& last) {
        Block values{};
        if (is_even) {
            values[0] = 8.0F * plane[0];
        } else {
            Block half;
            transform(plane, half);
            transform(half, values);
        }
        const auto quantized = [&](std::size_t place) {
            return static_cast<int>(
                std::lround(values[place] / static_cast<float>(quantum_[table][place])));
        };
        const int dc = quantized(0);
        put_number(dc - last, 0, dc_[table]);
        last = dc;
        int zeros = 0;
        for (std::size_t i = 1; i < 64 && !is_even; ++i) {
            const int value = quantized(zigzag[i]);
            if (value == 0) {
                ++zeros;
                continue;
            }
            for (; zeros > 15; zeros -= 16)
                put(ac_[table][0xf0]);
            put_number(value, zeros, ac_[table]);
            zeros = 0;
        }
        if (zeros > 0 || is_even)
            put(ac_[table][0]);
    }

    void put_number(int value, int zeros, const std::array<Code, 256>& codes) {
        int size = 0;
        while (std::abs(value) >> size != 0)
            ++size;
        put(codes[static_cast<std::size_t>(16 * zeros + size)]);
        const int bits = value < 0 ? value + (1 << size) - 1 : value;
        if (size > 0)
            put(static_cast<std::uint32_t>(bits), size);
    }
    void put(const Code& code) { put(code.bits, code.length); }
    void put(std::uint32_t bits, int length) {
        buffer_ = buffer_ << length | bits;
        for (held_ += length; held_ >= 8; held_ -= 8) {
            const auto byte = static_cast<std::uint8_t>(buffer_ >> (held_ - 8) & 255);
            bytes_ += static_cast<char>(byte);
            if (byte == 255)
                bytes_ += '\0';
        }
    }

    const DrawingImage& image_;
    std::array<Bytes, 2> quantum_{};
    std::array<std::array<Code, 256>, 2> dc_{};
    std::array<std::array<Code, 256>, 2> ac_{};
    std::string bytes_;
    std::uint64_t buffer_ = 0;
    int held_ = 0; // bits of the buffer that are not written yet
};

} // namespace

std::string jpeg_bytes(const DrawingImage& image) {
    if (std::min(image.columns, image.rows) < 1 ||
        std::max(image.columns, image.rows) > longest_side)
        throw InvalidParameter("page: expected pictures of at most " +
                               std::to_string(longest_side) + " pixels on each side, found " +
                               std::to_string(image.columns) + " x " + std::to_string(image.rows));
    return Encoder(image).write();
}

} // namespace devseg::writers
