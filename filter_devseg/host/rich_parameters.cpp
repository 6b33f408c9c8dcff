#include "host/rich_parameters.h"

#include <charconv>
#include <cmath>

namespace devseg::host {

namespace {

// Tells for which host a plugin file was built; `devseg info` looks for it.
[[gnu::used]] const char flavour[] = "devseg-flavour=" DEVSEG_FLAVOUR;

void add_parameter(RichParameterList& list, const declare::Parameter& p) {
    const QString name = to_qstring(p.name);
    const QString label = to_qstring(p.label);
    const QString help = to_qstring(p.help);
    switch (p.kind) {
    case declare::ParameterKind::boolean:
        list.addParam(RichBool(name, std::get<bool>(p.default_value), label, help));
        break;
    case declare::ParameterKind::integer:
        list.addParam(RichInt(name, std::get<int>(p.default_value), label, help));
        break;
    case declare::ParameterKind::real:
        list.addParam(
            RichFloat(name, static_cast<Scalarm>(std::get<double>(p.default_value)), label, help));
        break;
    case declare::ParameterKind::choice: {
        QStringList choices;
        for (const std::string& choice : p.choices)
            choices.push_back(to_qstring(choice));
        list.addParam(RichEnum(name, std::get<int>(p.default_value), choices, label, help));
        break;
    }
    case declare::ParameterKind::text:
        list.addParam(
            RichString(name, to_qstring(std::get<std::string>(p.default_value)), label, help));
        break;
    case declare::ParameterKind::output_file: {
        const QString example = to_qstring(std::get<std::string>(p.default_value));
        list.addParam(RichSaveFile(name, example, "*.svg *.pdf *.dxf", label, help));
        break;
    }
    }
}

declare::ParameterValue read_parameter(const RichParameterList& list, const declare::Parameter& p) {
    const QString name = to_qstring(p.name);
    switch (p.kind) {
    case declare::ParameterKind::boolean:
        return list.getBool(name);
    case declare::ParameterKind::integer:
        return list.getInt(name);
    case declare::ParameterKind::real:
        return as_written(list.getFloat(name));
    case declare::ParameterKind::choice:
        return list.getEnum(name);
    case declare::ParameterKind::text:
        return list.getString(name).toStdString();
    case declare::ParameterKind::output_file:
        return list.getSaveFileName(name).toStdString();
    }
    return p.default_value;
}

} // namespace

QString to_qstring(const std::string& utf8) {
    return QString::fromUtf8(utf8.data(), static_cast<int>(utf8.size()));
}

RichParameterList rich_parameters(const declare::FilterDeclaration& filter) {
    RichParameterList list;
    for (const declare::Parameter& p : filter.parameters)
        add_parameter(list, p);
    return list;
}

declare::ParameterValues parameter_values(const declare::FilterDeclaration& filter,
                                          const RichParameterList& list) {
    declare::ParameterValues values;
    for (const declare::Parameter& p : filter.parameters)
        values[p.name] = read_parameter(list, p);
    return values;
}

double as_written(Scalarm value) {
    const float single = static_cast<float>(value);
    if (!std::isfinite(single))
        return static_cast<double>(value);
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, single).ptr;
    double result = 0.0;
    std::from_chars(digits, end, result);
    return result;
}

} // namespace devseg::host
