// Refusals that the segmentation methods share.
#pragma once

#include <sstream>
#include <string>

#include "devseg/base/errors.h"
#include "devseg/base/numbers.h"

namespace devseg {

template <class T>
[[noreturn]] void refuse_option(const char* name, const std::string& expected, T found) {
    std::ostringstream text;
    text << name << ": expected " << expected << ", found " << found;
    throw InvalidParameter(text.str());
}

/// Refuses values outside of low < value ≤ high, and those that are no number.
inline void check_range(const char* name, double value, double low, double high,
                        const std::string& expected) {
    if (!(value > low) || !(value <= high))
        refuse_option(name, expected, value);
}

inline void check_charts_number(Index faces, int charts_number) {
    if (charts_number < 1 || charts_number > faces)
        refuse_option("charts_number",
                      "a number from 1 to " + std::to_string(faces) + " (the number of faces)",
                      charts_number);
}

inline void check_rounds(int max_iterations, int random_seed) {
    if (max_iterations < 1)
        refuse_option("max_iterations", "a number of at least 1", max_iterations);
    if (random_seed < 0)
        refuse_option("random_seed", "a number of at least 0", random_seed);
}

} // namespace devseg
