// The rules that the declaration of every filter keeps.
#include <algorithm>
#include <cctype>
#include <limits>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "devseg/declare/filter.h"
#include "filters/export_filter.h"
#include "unit/checks.h"
#include "unit/host_checks.h"

namespace devseg::filters {
namespace {

using checks::contains;
using checks::number;

bool is_snake_case(const std::string& name) {
    return std::regex_match(name, std::regex("[a-z][a-z0-9]*(_[a-z0-9]+)*"));
}

TEST(FilterTable, NamesAreUniqueAndInTheHostsForms) {
    std::set<std::string> menu;
    std::set<std::string> python;
    EXPECT_GE(exporting::plugin_filters().size(), 7U);
    for (const declare::FilterDeclaration& filter : exporting::plugin_filters()) {
        SCOPED_TRACE(filter.menu_name);
        EXPECT_TRUE(menu.insert(filter.menu_name).second);
        EXPECT_TRUE(python.insert(filter.python_name).second);
        EXPECT_EQ(filter.menu_name.find('&'), std::string::npos); // a shortcut key in menus
        EXPECT_TRUE(std::regex_match(
            filter.menu_name,
            std::regex("(Segmentation|Charts|Pattern|Texture): ([A-Z]|t-).*[a-zA-Z]")));
        EXPECT_TRUE(is_snake_case(filter.python_name));
        EXPECT_TRUE(std::regex_search(
            filter.python_name,
            std::regex("^(compute|apply|meshing|generate|get|export|transfer)_")));
        EXPECT_TRUE(filter.run != nullptr);
    }
}

TEST(FilterTable, HelpHasTwoPartsAndMethodsNameTheirSource) {
    const std::regex reference("See:<br>(<i>[^<]+</i><br><b>\"[^<]+\"</b><br>[^<]+, \\d{4}, "
                               // Not every journal has identifiers.
                               "(doi:10\\.\\d{4,}/[^ <]+|pages \\d+-\\d+)(<br>)?)+$");
    for (const declare::FilterDeclaration& filter : exporting::plugin_filters()) {
        SCOPED_TRACE(filter.menu_name);
        EXPECT_GE(filter.help.size(), 100U);
        EXPECT_TRUE(contains(filter.help, "<br>"));
        EXPECT_EQ(filter.help.find("  "), std::string::npos);
        const bool is_method = std::regex_search(
            filter.python_name, std::regex("^(compute_(segmentation|texcoord|seams)_|"
                                           "get_parametrization_)"));
        if (is_method || filter.help.find("See:") != std::string::npos) {
            EXPECT_TRUE(std::regex_search(filter.help, reference)) << filter.help;
        }
        // Tags are closed.
        for (const char* tag : {"b", "i"}) {
            const std::regex open("<" + std::string(tag) + ">");
            const std::regex close("</" + std::string(tag) + ">");
            const auto count = [&](const std::regex& pattern) {
                return std::distance(
                    std::sregex_iterator(filter.help.begin(), filter.help.end(), pattern),
                    std::sregex_iterator());
            };
            EXPECT_EQ(count(open), count(close));
        }
    }
}

TEST(FilterTable, ParametersAreDescribedAndTheirDefaultsInRange) {
    for (const declare::FilterDeclaration& filter : exporting::plugin_filters()) {
        std::set<std::string> names;
        for (const declare::Parameter& p : filter.parameters) {
            SCOPED_TRACE(filter.menu_name + ", " + p.name);
            EXPECT_TRUE(names.insert(p.name).second);
            EXPECT_TRUE(is_snake_case(p.name));
            ASSERT_FALSE(p.label.empty());
            EXPECT_TRUE(std::isupper(static_cast<unsigned char>(p.label.front())) != 0);
            EXPECT_GE(p.help.size(), 30U);
            EXPECT_EQ(p.help.back(), '.');
            EXPECT_LE(p.minimum, p.maximum);
            if (!std::holds_alternative<std::string>(p.default_value)) {
                EXPECT_GE(number(p.default_value), p.minimum);
                EXPECT_LE(number(p.default_value), p.maximum);
            }
            switch (p.kind) {
            case declare::ParameterKind::boolean:
                EXPECT_TRUE(std::holds_alternative<bool>(p.default_value));
                break;
            case declare::ParameterKind::integer:
                EXPECT_TRUE(std::holds_alternative<int>(p.default_value));
                EXPECT_LE(p.maximum, std::numeric_limits<int>::max());
                break;
            case declare::ParameterKind::real:
                EXPECT_TRUE(std::holds_alternative<double>(p.default_value));
                EXPECT_TRUE(std::regex_search(
                    p.help, std::regex("unit|share|degree|radian|millimet|percent|%")))
                    << "no unit: " << p.help;
                break;
            case declare::ParameterKind::choice:
                EXPECT_TRUE(std::holds_alternative<int>(p.default_value));
                EXPECT_GE(p.choices.size(), 2U);
                EXPECT_EQ(p.maximum, static_cast<double>(p.choices.size()) - 1.0);
                for (const std::string& choice : p.choices)
                    EXPECT_TRUE(contains(p.help, choice));
                break;
            case declare::ParameterKind::text:
            case declare::ParameterKind::output_file:
                EXPECT_TRUE(std::holds_alternative<std::string>(p.default_value));
                break;
            }
        }
        // Segmentations that iterate can be repeated, and end.
        const bool iterates =
            std::any_of(filter.results.begin(), filter.results.end(),
                        [](const declare::ResultField& r) { return r.name == "rounds_number"; });
        if (filter.python_name.rfind("compute_segmentation_", 0) == 0) {
            EXPECT_EQ(names.count("random_seed"), names.count("max_iterations"));
            EXPECT_TRUE(!iterates || names.count("max_iterations") == 1U) << filter.menu_name;
        }
    }
}

TEST(FilterTable, ResultsAreDescribed) {
    for (const declare::FilterDeclaration& filter : exporting::plugin_filters()) {
        std::set<std::string> names;
        for (const declare::ResultField& r : filter.results) {
            SCOPED_TRACE(filter.menu_name + ", " + r.name);
            EXPECT_TRUE(names.insert(r.name).second);
            EXPECT_TRUE(is_snake_case(r.name));
            EXPECT_GE(r.meaning.size(), 6U);
        }
    }
}

} // namespace
} // namespace devseg::filters
