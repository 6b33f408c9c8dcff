#include "devseg/base/option_checks.h"

#include <locale>
#include <sstream>

namespace devseg {

void refuse_option(const std::string& name, const std::string& expected, double found) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << name << ": expected " << expected << ", found " << found;
    throw InvalidParameter(text.str());
}

void OptionRange::check(double value) const {
    if ((value > minimum || (value == minimum && !above)) && value <= maximum)
        return;
    std::ostringstream expected;
    expected.imbue(std::locale::classic());
    if (maximum >= 1e6)
        expected << "a number " << (above ? "above " : "of at least ") << minimum;
    else if (above)
        expected << "a number above " << minimum << " and at most " << maximum;
    else
        expected << "a number from " << minimum << " to " << maximum;
    refuse_option(name, expected.str(), value);
}

void check_charts_number(Index faces, int charts_number) {
    if (charts_number < 1 || charts_number > faces)
        refuse_option("charts_number",
                      "a number from 1 to " + std::to_string(faces) + " (the number of faces)",
                      charts_number);
}

} // namespace devseg
