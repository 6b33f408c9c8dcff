// Prints the filter table as JSON: the reference in docs/, the shipped scripts and the tests that
// ask the live hosts are made from it.
#include <iostream>
#include <sstream>
#include <string>

#include "devseg/material/material.h"
#include "filters/export_filter.h"

namespace devseg {
namespace {

std::string json(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            quoted += '\\';
        if (c == '\n')
            quoted += "\\n";
        else
            quoted += c;
    }
    return quoted + '"';
}

std::string json(const declare::ParameterValue& value) {
    if (const auto* truth = std::get_if<bool>(&value))
        return *truth ? "true" : "false";
    if (const auto* count = std::get_if<int>(&value))
        return std::to_string(*count);
    if (const auto* text = std::get_if<std::string>(&value))
        return json(*text);
    std::ostringstream digits;
    digits.precision(17);
    digits << std::get<double>(value);
    return digits.str();
}

std::string kind_name(declare::ParameterKind kind) {
    switch (kind) {
    case declare::ParameterKind::boolean:
        return "boolean";
    case declare::ParameterKind::integer:
        return "integer";
    case declare::ParameterKind::real:
        return "real";
    case declare::ParameterKind::choice:
        return "choice";
    case declare::ParameterKind::text:
        return "text";
    case declare::ParameterKind::output_file:
        return "output file";
    }
    return "";
}

std::string category_name(declare::FilterCategory category) {
    switch (category) {
    case declare::FilterCategory::remeshing:
        return "Remeshing, Simplification and Reconstruction";
    case declare::FilterCategory::texture:
        return "Texture";
    case declare::FilterCategory::color:
        return "Color Creation and Processing";
    case declare::FilterCategory::measure:
        return "Quality Measure and Computations";
    }
    return "";
}

template <class Items, class Print>
std::string list(const Items& items, Print print) {
    std::string joined;
    for (const auto& item : items)
        joined += (joined.empty() ? "" : ", ") + print(item);
    return "[" + joined + "]";
}

std::string describe(const declare::Parameter& p) {
    const auto number = [](double value) { return json(declare::ParameterValue(value)); };
    return "{\"name\": " + json(p.name) + ", \"label\": " + json(p.label) +
           ", \"kind\": " + json(kind_name(p.kind)) + ", \"default\": " + json(p.default_value) +
           ", \"minimum\": " + number(p.minimum) + ", \"maximum\": " + number(p.maximum) +
           ", \"choices\": " + list(p.choices, [](const std::string& c) { return json(c); }) +
           ", \"help\": " + json(p.help) + "}";
}

std::string describe(const declare::Command& command) {
    return "{\"name\": " + json(command.name) + ", \"flatten\": " + json(command.flatten) +
           ", \"preset\": " + json(command.preset) + ", \"deforms\": " + json(command.deforms) +
           "}";
}

std::string describe(const declare::FilterDeclaration& filter) {
    return "{\"menu_name\": " + json(filter.menu_name) +
           ", \"python_name\": " + json(filter.python_name) + ", \"help\": " + json(filter.help) +
           ", \"menu\": " + json(category_name(filter.category)) +
           ", \"writes\": " + std::to_string(filter.writes) +
           ", \"needs_uv\": " + json(filter.needs_uv) +
           ", \"needs_texture\": " + json(filter.needs_texture) +
           ", \"needs_selection\": " + json(filter.needs_selection) +
           ", \"command\": " + describe(filter.command) + ", \"parameters\": " +
           list(filter.parameters,
                [](const declare::Parameter& p) { return "\n  " + describe(p); }) +
           ", \"results\": " +
           list(filter.results,
                [](const declare::ResultField& r) {
                    return "\n  {\"name\": " + json(r.name) + ", \"meaning\": " + json(r.meaning) +
                           "}";
                }) +
           "}";
}

std::string describe(const material::Material& material) {
    std::string text = "{\"name\": " + json(material.name);
    for (const material::MaterialValue& value : material::material_values()) {
        const declare::ParameterValue found =
            value.flag != nullptr ? declare::ParameterValue(material.*(value.flag))
                                  : declare::ParameterValue(material.*(value.number));
        text += ", " + json(std::string(value.key)) + ": " + json(found);
    }
    return text + ", \"source\": " + json(material.source) + "}";
}

std::string describe(const material::MaterialValue& value) {
    return "{\"key\": " + json(std::string(value.key)) +
           ", \"meaning\": " + json(std::string(value.meaning)) + "}";
}

template <class Items>
std::string lines(const Items& items) {
    return list(items, [](const auto& item) { return "\n " + describe(item); });
}

} // namespace
} // namespace devseg

// With an argument, the table of materials instead.
int main(int count, char**) {
    using namespace devseg;
    if (count > 1)
        std::cout << "{\"values\": " << lines(material::material_values())
                  << ", \"materials\": " << lines(material::material_table()) << "}\n";
    else
        std::cout << lines(exporting::plugin_filters()) << "\n";
    return std::cout.good() ? 0 : 1;
}
