// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/component.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace trellis {

double parse_number(std::string_view text) {
  double number = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::string to_string(const OptionValue& value) {
  struct Text {
    std::string operator()(double x) const {
      if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
      // Prints as many digits as reading the same number back requires.
      std::string text = fmt::format("{:g}", x);
      return parse_number(text) == x || std::isnan(x) ? text : fmt::format("{}", x);
    }
    std::string operator()(std::int64_t x) const { return fmt::format("{}", x); }
    std::string operator()(bool x) const { return x ? "true" : "false"; }
    std::string operator()(const std::string& x) const { return fmt::format("\"{}\"", x); }
    std::string operator()(const std::vector<std::string>& names) const {
      std::string all;
      for (const auto& name : names) all += (all.empty() ? "" : ", ") + (*this)(name);
      return names.empty() ? "{}" : "{ " + all + " }";
    }
  };
  return std::visit(Text{}, value);
}

bool Range::contains(double x) const {
  if (or_zero && x == 0.0) return true;
  return (open_lo ? x > lo : x >= lo) && (open_hi ? x < hi : x <= hi);
}

std::string Range::text() const {
  if (or_zero) {
    Range rest = *this;
    rest.or_zero = false;
    return rest.text() + ", or 0";
  }
  const bool below = std::isfinite(lo);
  const bool above = std::isfinite(hi);
  if (below && above) return fmt::format("in {}{:g}, {:g}{}", open_lo ? '(' : '[', lo, hi, open_hi ? ')' : ']');
  if (below) return fmt::format("{} {:g}", open_lo ? "greater than" : "at least", lo);
  if (above) return fmt::format("{} {:g}", open_hi ? "less than" : "at most", hi);
  return "any finite number";
}

const Option* Component::find(std::string_view option) const {
  const auto it = std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.name == option; });
  return it != options.end() ? &*it : nullptr;
}

std::string_view to_string(Component::Kind kind) {
  switch (kind) {
    case Component::Kind::planner: return "planner";
    case Component::Kind::guide: return "guide";
    case Component::Kind::combinator: return "combinator";
    case Component::Kind::target: return "target";
    case Component::Kind::estimator: return "estimator";
    case Component::Kind::scene: return "scene";
    case Component::Kind::motion: return "motion model";
  }
  throw Fault("unknown kind of component");
}

std::string expectation(const Option& option) {
  const std::string unit = option.unit.empty() ? "" : " (" + option.unit + ")";
  switch (option.type) {
    case Option::Type::number: return "a number " + option.range.text() + unit;
    case Option::Type::integer: return "an integer " + option.range.text() + unit;
    case Option::Type::boolean: return "true or false";
    case Option::Type::choice: {
      std::string all;
      for (const auto& c : option.choices) all += (all.empty() ? "" : ", ") + fmt::format("\"{}\"", c);
      return "one of " + all;
    }
    case Option::Type::names: return "a list of names";
    case Option::Type::file: return "the name of a file";
  }
  throw Fault("unknown type of option");
}

namespace {

[[noreturn]] void reject(const Component& component, const Option& option, const OptionValue& value,
                         const std::string& more = {}) {
  throw Error(fmt::format("{}: option '{}' must be {}, got {}{}", component.name, option.name, expectation(option),
                          to_string(value), more));
}

OptionValue checked(const Component& component, const Option& option, const OptionValue& value) {
  switch (option.type) {
    case Option::Type::number: {
      double x = 0.0;
      if (const auto* real = std::get_if<double>(&value)) {
        x = *real;
      } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        x = static_cast<double>(*whole);
      } else {
        reject(component, option, value);
      }
      const bool limitless = std::isinf(std::get<double>(option.default_value));
      if (std::isnan(x) || (std::isinf(x) && !limitless) || !option.range.contains(x)) reject(component, option, value);
      return x;
    }
    case Option::Type::integer: {
      std::int64_t x = 0;
      if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        x = *whole;
      } else if (const auto* real = std::get_if<double>(&value);
                 real != nullptr && std::floor(*real) == *real && std::abs(*real) < 9.0e15) {
        x = static_cast<std::int64_t>(*real);
      } else {
        reject(component, option, value);
      }
      if (!option.range.contains(static_cast<double>(x))) reject(component, option, value);
      return x;
    }
    case Option::Type::boolean:
      if (!std::holds_alternative<bool>(value)) reject(component, option, value);
      return value;
    case Option::Type::choice: {
      const auto* text = std::get_if<std::string>(&value);
      if (text == nullptr) reject(component, option, value);
      if (std::find(option.choices.begin(), option.choices.end(), *text) == option.choices.end()) {
        reject(component, option, value, did_you_mean(*text, option.choices));
      }
      return value;
    }
    case Option::Type::names: {
      const auto* names = std::get_if<std::vector<std::string>>(&value);
      if (names == nullptr) reject(component, option, value);
      for (auto name = names->begin(); name != names->end(); ++name) {
        if (std::find(names->begin(), name, *name) != name) reject(component, option, value, "; one is there twice");
      }
      return value;
    }
    case Option::Type::file: {
      const auto* file = std::get_if<std::string>(&value);
      if (file == nullptr || file->find('\0') != std::string::npos) reject(component, option, value);
      if (file->empty() && value != option.default_value) reject(component, option, value);
      return value;
    }
  }
  throw Fault("unknown type of option");
}

}  // namespace

namespace {

/// Suggests the option of another library's name, such as OMPL's `range`, else the nearest name.
std::string suggestion(const std::string& given, const std::vector<std::string>& known) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 10> meanings = {{{"time", "seconds"},
                                                                                       {"timeout", "seconds"},
                                                                                       {"max_time", "seconds"},
                                                                                       {"time_limit", "seconds"},
                                                                                       {"iterations", "proposals"},
                                                                                       {"max_iterations", "proposals"},
                                                                                       {"samples", "proposals"},
                                                                                       {"range", "step"},
                                                                                       {"max_distance", "step"},
                                                                                       {"step_size", "step"}}};
  for (const auto& [name, option] : meanings) {
    const bool there = std::find(known.begin(), known.end(), option) != known.end();
    if (given == name && there) return fmt::format(" (did you mean '{}'?)", option);
  }
  std::string near = did_you_mean(given, known);
  if (!near.empty()) return near;
  // The longest option that the name begins with: stepsize, step_length.
  constexpr std::size_t least = 4;
  const std::string* longest = nullptr;
  for (const std::string& name : known) {
    const bool longer = longest == nullptr || name.size() > longest->size();
    if (name.size() >= least && given.starts_with(name) && longer) longest = &name;
  }
  return longest != nullptr ? fmt::format(" (did you mean '{}'?)", *longest) : "";
}

}  // namespace

Options Options::validate(const Component& component, const std::vector<Entry>& given) {
  for (const auto& [name, value] : given) {
    if (component.find(name) == nullptr) {
      std::vector<std::string> known;
      for (const auto& option : component.options) known.push_back(option.name);
      std::string all;
      for (const auto& k : known) all += (all.empty() ? "" : ", ") + k;
      const std::string offer = known.empty() ? "; it has no options" : "; its options are: " + all;
      throw Error(fmt::format("{}: unknown option '{}'{}{}", component.name, name, suggestion(name, known), offer));
    }
  }
  Options result;
  for (const auto& option : component.options) {
    const auto it = std::find_if(given.begin(), given.end(), [&](const Entry& e) { return e.first == option.name; });
    result.entries_.emplace_back(option.name,
                                 it != given.end() ? checked(component, option, it->second) : option.default_value);
  }
  return result;
}

const OptionValue& Options::at(std::string_view name) const {
  for (const auto& [key, value] : entries_) {
    if (key == name) return value;
  }
  throw Fault("no option '" + std::string(name) + "'");
}

}  // namespace trellis
