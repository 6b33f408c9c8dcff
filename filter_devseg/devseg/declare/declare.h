// Builds a FilterDeclaration whose parameters are bound to the fields of an options struct: a
// default is written once, in the struct, and a declared parameter cannot be ignored.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "devseg/base/option_checks.h"
#include "devseg/declare/filter.h"
#include "devseg/declare/part.h"

namespace devseg::declare {

/// The options of filters without parameters.
struct NoOptions {};

template <class Options>
class Declare {
public:
    Declare(std::string menu_name, std::string python_name, FilterCategory category,
            std::string help) {
        filter_.menu_name = std::move(menu_name);
        filter_.python_name = std::move(python_name);
        filter_.category = category;
        filter_.help = std::move(help);
    }

    /// With name and range of `Options::ranges()`; what runs must check them itself.
    Declare& integer(int Options::*field, std::string label, std::string help) {
        return number(ParameterKind::integer, field, range_of(field), std::move(label),
                      std::move(help));
    }
    Declare& integer(int Options::*field, const OptionRange& range, std::string label,
                     std::string help) {
        number(ParameterKind::integer, field, range, std::move(label), std::move(help));
        setters_.back() = [=](Options& options, const ParameterValue& value) {
            options.*field = std::get<int>(value);
            range.check(options.*field);
        };
        return *this;
    }
    Declare& real(double Options::*field, std::string label, std::string help) {
        return real(field, range_of(field), std::move(label), std::move(help));
    }
    Declare& real(double Options::*field, const OptionRange& range, std::string label,
                  std::string help) {
        number(ParameterKind::real, field, range, std::move(label), std::move(help));
        setters_.back() = [=](Options& options, const ParameterValue& value) {
            options.*field = std::get<double>(value);
            range.check(options.*field);
        };
        return *this;
    }
    Declare& boolean(bool Options::*field, std::string name, std::string label, std::string help) {
        return number(ParameterKind::boolean, field, {std::move(name), 0.0, 1.0}, std::move(label),
                      std::move(help));
    }
    Declare& text(std::string Options::*field, std::string name, std::string label,
                  std::string help) {
        return add(ParameterKind::text, field, std::move(name), std::move(label), std::move(help));
    }
    /// `example`: what a dialog proposes.
    Declare& file(std::string Options::*field, std::string name, std::string label,
                  const std::string& example, std::string help) {
        add(ParameterKind::output_file, field, std::move(name), std::move(label), std::move(help));
        filter_.parameters.back().default_value = example;
        return *this;
    }
    /// `Enum` must count from 0 in the order of `choices`.
    template <class Enum>
    Declare& choice(Enum Options::*field, std::string name, std::string label,
                    std::vector<std::string> choices, std::string help) {
        const auto most = static_cast<int>(choices.size()) - 1;
        setters_.emplace_back([=](Options& options, const ParameterValue& value) {
            const int position = std::get<int>(value);
            if (position < 0 || position > most)
                refuse_option(name, "a choice from 0 to " + std::to_string(most), position);
            options.*field = static_cast<Enum>(position);
        });
        filter_.parameters.push_back({std::move(name), std::move(label), std::move(help),
                                      ParameterKind::choice, static_cast<int>(Options{}.*field),
                                      0.0, static_cast<double>(most), std::move(choices)});
        return *this;
    }
    /// The method of the command line, with the flattening it takes there, the preset of its
    /// patterns, and whether its charts are deformed first.
    Declare& command(std::string name, std::string flatten = "symmetric-dirichlet",
                     std::string preset = "", bool deforms = false) {
        filter_.command = {std::move(name), std::move(flatten), std::move(preset), deforms};
        return *this;
    }
    Declare& writes(unsigned what) {
        filter_.writes = what;
        return *this;
    }
    Declare& shows_outside() {
        filter_.shows_outside = true;
        return *this;
    }
    Declare& needs_uv() {
        filter_.needs_uv = true;
        return *this;
    }
    Declare& needs_texture() {
        filter_.needs_texture = true;
        return *this;
    }
    /// It reads textures and colours where its parameter `texture` is not 0.
    Declare& takes_surface() {
        filter_.takes_surface = true;
        return *this;
    }
    /// It refuses to run where neither a selection nor a parameter says what is meant.
    Declare& needs_selection() {
        filter_.needs_selection = true;
        return *this;
    }
    /// It works on the selected faces alone where `selected_only` says so.
    Declare& on_part() {
        filter_.on_part = true;
        return *this;
    }
    /// Existing seams or charts stay where `keep` says so.
    Declare& keeps() {
        filter_.keeps = true;
        return *this;
    }
    Declare& result(std::string name, std::string meaning) {
        filter_.results.push_back({std::move(name), std::move(meaning)});
        return *this;
    }

    using Run = FilterOutput (*)(const FilterInput&, const Options&, Progress&);
    FilterDeclaration runs(Run run) {
        filter_.run = [run, setters = setters_, parameters = filter_.parameters](
                          const FilterInput& input, const ParameterValues& values,
                          Progress& progress) {
            Options options;
            for (std::size_t i = 0; i < parameters.size(); ++i) {
                const auto given = values.find(parameters[i].name);
                if (given != values.end())
                    setters[i](options, given->second);
            }
            return run(input, options, progress);
        };
        for (Parameter& parameter : part_parameters(filter_.on_part, filter_.keeps))
            filter_.parameters.push_back(std::move(parameter));
        filter_.parameters.push_back(weld_parameter());
        return filter_;
    }

private:
    template <class Value>
    static OptionRange range_of(Value Options::*wanted) {
        const auto is_wanted = [&](auto field) {
            if constexpr (std::is_convertible_v<decltype(field), Value Options::*>)
                return field == wanted;
            else
                return false;
        };
        for (const auto& [field, range] : Options::ranges())
            if (std::visit(is_wanted, field))
                return range;
        throw std::logic_error("a parameter without a range");
    }

    template <class Value>
    Declare& number(ParameterKind kind, Value Options::*field, const OptionRange& range,
                    std::string label, std::string help) {
        add(kind, field, range.name, std::move(label), std::move(help));
        filter_.parameters.back().minimum = range.minimum;
        filter_.parameters.back().maximum = range.maximum;
        return *this;
    }
    template <class Value>
    Declare& add(ParameterKind kind, Value Options::*field, std::string name, std::string label,
                 std::string help) {
        filter_.parameters.push_back({std::move(name),
                                      std::move(label),
                                      std::move(help),
                                      kind,
                                      Options{}.*field,
                                      0.0,
                                      0.0,
                                      {}});
        setters_.emplace_back([field](Options& options, const ParameterValue& value) {
            options.*field = std::get<Value>(value);
        });
        return *this;
    }

    FilterDeclaration filter_;
    std::vector<std::function<void(Options&, const ParameterValue&)>> setters_;
};

} // namespace devseg::declare
