#include "writers/number_text.h"

#include <charconv>

namespace devseg::writers {

std::string number_text(double value, int decimals) {
    char digits[400]; // the largest double has 309 digits
    const auto end =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals);
    std::string text(digits, end.ptr);
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.')
            text.pop_back();
    }
    return text == "-0" ? "0" : text;
}

} // namespace devseg::writers
