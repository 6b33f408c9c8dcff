#include "devseg/material/material.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "devseg/base/errors.h"

namespace devseg::material {

namespace {

// What a search for seams asks of a material that bears nothing.
constexpr double least_bound = 1e-3;

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t");
    return first == std::string::npos
               ? ""
               : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

template <class Items, class Name>
std::string listed(const Items& items, Name name) {
    std::string text;
    for (const auto& item : items)
        text += (text.empty() ? "" : ", ") + std::string(name(item));
    return text;
}

const Material& preset(const std::string& name) {
    const std::vector<Material>& table = material_table();
    const auto found =
        std::find_if(table.begin(), table.end(), [&](const Material& m) { return m.name == name; });
    if (found == table.end())
        throw InvalidParameter("material: expected one of " + names() + ", found '" + name + "'");
    return *found;
}

double number_of(const MaterialValue& value, const std::string& text) {
    double number = 0.0;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    const bool is_flag = value.flag != nullptr;
    if (read.ec != std::errc() || read.ptr != end || !(number >= value.least) ||
        !(number <= value.most) || (is_flag && number != 0.0 && number != 1.0)) {
        std::string range = listed(std::array<double, 2>{value.least, value.most}, [](double x) {
            std::string digits = std::to_string(x);
            digits.erase(digits.find_last_not_of('0') + 1);
            return digits.back() == '.' ? digits.substr(0, digits.size() - 1) : digits;
        });
        range.replace(range.find(", "), 2, is_flag ? " or " : " to ");
        throw InvalidParameter("material: expected " + std::string(value.key) + " from " + range +
                               ", found '" + text + "'");
    }
    return number;
}

// "key=number"
void set_value(const std::string& word, Material& material) {
    const std::size_t sign = word.find('=');
    const std::string key = trimmed(word.substr(0, sign));
    const std::vector<MaterialValue>& values = material_values();
    const auto value = std::find_if(values.begin(), values.end(),
                                    [&](const MaterialValue& v) { return key == v.key; });
    if (sign == std::string::npos || value == values.end())
        throw InvalidParameter("material: expected a name and then values such as warp=0.05 (" +
                               listed(values, [](const MaterialValue& v) { return v.key; }) +
                               "), found '" + word + "'");
    const double number = number_of(*value, trimmed(word.substr(sign + 1)));
    if (value->flag != nullptr)
        material.*(value->flag) = number != 0.0;
    else
        material.*(value->number) = number;
}

} // namespace

double Material::stretch_limit(double angle) const {
    const double along = std::cos(angle) * std::cos(angle);
    const double twice = std::sin(2.0 * angle);
    const double on_bias = twice * twice;
    return (1.0 - on_bias) * (along * warp + (1.0 - along) * weft) + on_bias * bias;
}

double Material::least_limit() const {
    return std::min({warp, weft, bias, compression});
}

double Material::search_bound() const {
    return std::max(least_bound, least_limit());
}

std::string names() {
    return listed(material_table(), [](const Material& m) { return m.name; });
}

Material read_material(const std::string& text) {
    std::size_t end = text.find(',');
    Material material = preset(trimmed(text.substr(0, end)));
    while (end != std::string::npos) {
        const std::size_t start = end + 1;
        end = text.find(',', start);
        set_value(trimmed(text.substr(start, end == std::string::npos ? end : end - start)),
                  material);
        material.source = "given";
    }
    return material;
}

} // namespace devseg::material
