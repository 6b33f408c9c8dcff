// The bytes of a fuzzer as numbers: what is missing at the end is zero.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace devseg::fuzz {

class Bytes {
public:
    Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

    bool empty() const { return left_ == 0; }
    std::uint8_t byte() {
        if (left_ == 0)
            return 0;
        --left_;
        return *data_++;
    }
    int below(int count) { return byte() % count; }
    bool flag() { return (byte() & 1U) != 0; }

    /// Mostly small whole numbers, now and then any bits of a double.
    double number() {
        const std::uint8_t kind = byte();
        if (kind < 240)
            return static_cast<double>(static_cast<std::int8_t>(byte())) / (1 + kind % 16);
        std::uint64_t bits = 0;
        for (int i = 0; i < 8; ++i)
            bits = bits << 8 | byte();
        double value = 0.0;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    double between(double low, double high) { return low + (high - low) * byte() / 255.0; }
    std::string text(int longest) {
        std::string result;
        for (int length = below(longest + 1); length > 0; --length)
            result.push_back(static_cast<char>(byte()));
        return result;
    }

private:
    const std::uint8_t* data_;
    std::size_t left_;
};

/// Ends the process: fuzzers and the replay see it as a finding.
[[noreturn]] void fail(const std::string& what);

} // namespace devseg::fuzz
