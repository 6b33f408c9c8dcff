// Builds a FilterDeclaration whose parameters are bound to the fields of an options struct: a
// default is written once, in the struct, and a declared parameter cannot be ignored.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "devseg/base/errors.h"
#include "devseg/declare/filter.h"

namespace devseg::declare {

/// The options of filters without parameters.
struct NoOptions {};

/// The value; throws InvalidParameter outside its range.
double checked(const std::string& name, double minimum, double maximum, double value);

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

    Declare& integer(int Options::*field, std::string name, std::string label, double minimum,
                     double maximum, std::string help) {
        return add(ParameterKind::integer, field, std::move(name), std::move(label), minimum,
                   maximum, {}, std::move(help));
    }
    Declare& real(double Options::*field, std::string name, std::string label, double minimum,
                  double maximum, std::string help) {
        add(ParameterKind::real, field, name, std::move(label), minimum, maximum, {},
            std::move(help));
        setters_.back() = [=](Options& options, const ParameterValue& value) {
            options.*field = checked(name, minimum, maximum, std::get<double>(value));
        };
        return *this;
    }
    Declare& boolean(bool Options::*field, std::string name, std::string label, std::string help) {
        return add(ParameterKind::boolean, field, std::move(name), std::move(label), 0.0, 1.0, {},
                   std::move(help));
    }
    Declare& text(std::string Options::*field, std::string name, std::string label,
                  std::string help) {
        return add(ParameterKind::text, field, std::move(name), std::move(label), 0.0, 0.0, {},
                   std::move(help));
    }
    /// `example`: what a dialog proposes.
    Declare& file(std::string Options::*field, std::string name, std::string label,
                  const std::string& example, std::string help) {
        add(ParameterKind::output_file, field, std::move(name), std::move(label), 0.0, 0.0, {},
            std::move(help));
        filter_.parameters.back().default_value = example;
        return *this;
    }
    /// `Enum` must count from 0 in the order of `choices`.
    template <class Enum>
    Declare& choice(Enum Options::*field, std::string name, std::string label,
                    std::vector<std::string> choices, std::string help) {
        Parameter parameter{std::move(name),
                            std::move(label),
                            std::move(help),
                            ParameterKind::choice,
                            static_cast<int>(Options{}.*field),
                            0.0,
                            static_cast<double>(choices.size()) - 1.0,
                            std::move(choices)};
        setters_.emplace_back([field, name = parameter.name, count = parameter.choices.size()](
                                  Options& options, const ParameterValue& value) {
            const int position = std::get<int>(value);
            if (position < 0 || static_cast<std::size_t>(position) >= count)
                throw InvalidParameter(name + ": expected a choice from 0 to " +
                                       std::to_string(count - 1) + ", found " +
                                       std::to_string(position));
            options.*field = static_cast<Enum>(position);
        });
        filter_.parameters.push_back(std::move(parameter));
        return *this;
    }
    Declare& writes(unsigned what) {
        filter_.writes = what;
        return *this;
    }
    Declare& joins_borders() {
        filter_.joins_borders = true;
        return *this;
    }
    Declare& needs_uv() {
        filter_.needs_uv = true;
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
        return filter_;
    }

private:
    template <class Value>
    Declare& add(ParameterKind kind, Value Options::*field, std::string name, std::string label,
                 double minimum, double maximum, std::vector<std::string> choices,
                 std::string help) {
        filter_.parameters.push_back({std::move(name), std::move(label), std::move(help), kind,
                                      Options{}.*field, minimum, maximum, std::move(choices)});
        setters_.emplace_back([field](Options& options, const ParameterValue& value) {
            options.*field = std::get<Value>(value);
        });
        return *this;
    }

    FilterDeclaration filter_;
    std::vector<std::function<void(Options&, const ParameterValue&)>> setters_;
};

} // namespace devseg::declare
