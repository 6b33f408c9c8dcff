// What numeric options may be: stated once beside the options, declared to users from there, and
// checked where an algorithm is called directly.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "devseg/base/errors.h"
#include "devseg/base/numbers.h"

namespace devseg {

/// Throws InvalidParameter: what was expected of the option, and what was found.
[[noreturn]] void refuse_option(const std::string& name, const std::string& expected, double found);

struct OptionRange {
    std::string name; // of the option
    double minimum;
    double maximum;     // from a million on, none for users
    bool above = false; // the minimum itself is refused

    /// Throws InvalidParameter outside of the range, and for NaN.
    void check(double value) const;
};

/// Of fields: what an options struct returns from `static OptionRanges<Options> ranges()`.
template <class Options>
using OptionRanges =
    std::vector<std::pair<std::variant<int Options::*, double Options::*>, OptionRange>>;

template <class Options>
void check_ranges(const Options& options) {
    for (const auto& [field, range] : Options::ranges())
        range.check(std::visit([&](auto f) { return static_cast<double>(options.*f); }, field));
}

/// Those of the number of charts, which are checked with the faces as well, rounds and seeds.
template <class Options>
OptionRanges<Options> with_rounds(OptionRanges<Options> ranges) {
    ranges.push_back({&Options::max_iterations, {"max_iterations", 1, 1e6}});
    ranges.push_back({&Options::random_seed, {"random_seed", 0, 2147483647}});
    return ranges;
}

/// Throws InvalidParameter for others than 1 … #F.
void check_charts_number(Index faces, int charts_number);

} // namespace devseg
