// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/error.hpp>

namespace trellis {

/// The value of an option. Integers and other numbers have separate types so that messages distinguish 15 and 15.5.
using OptionValue = std::variant<double, std::int64_t, bool, std::string, std::vector<std::string>>;

/// Returns the text of a value in the syntax of a script, as `0.5`, `"full"` or `{ "a", "b" }`.
/// \param value  a number is written with as many digits as reading the same number back requires, infinity as `inf`
std::string to_string(const OptionValue& value);
/// Returns the number that the text begins with, in the notation of C whatever the locale; NaN if it begins with none.
/// \param text  what follows the number is ignored
double parse_number(std::string_view text);

/// The range of a number: an interval, closed unless `open_lo` or `open_hi`, in the unit of its option.
struct Range {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
  bool open_lo = false;
  bool open_hi = false;
  bool or_zero = false;  ///< contains 0, too

  /// Whether x is in the range; false for NaN.
  /// \param x  in the unit of the option
  [[nodiscard]] bool contains(double x) const;
  /// Describes the range: "in (0, 1]", "greater than 0", "any finite number".
  [[nodiscard]] std::string text() const;

  // The ranges of most options: all finite numbers, (0, inf), [0, inf), [0, 1], [lo, inf), and 0 or (lo, inf).
  static Range any() { return {}; }
  static Range positive() { return {.lo = 0, .open_lo = true}; }
  static Range non_negative() { return {.lo = 0}; }
  static Range share() { return {.lo = 0, .hi = 1}; }
  /// Returns [lo, inf).
  /// \param lo  finite, in the unit of the option
  static Range at_least(double lo) { return {.lo = lo}; }
  /// Returns (lo, inf) and 0.
  /// \param lo  finite, greater than 0, in the unit of the option
  static Range zero_or_above(double lo) { return {.lo = lo, .open_lo = true, .or_zero = true}; }
};

/// One option of a component. Validation, messages, help, stubs and the reference use this one description.
struct Option {
  enum class Type { number, integer, boolean, choice, names, file };

  std::string name;
  Type type = Type::number;
  std::string unit;                  ///< "m", "rad", "proposals", "" for a pure number
  OptionValue default_value;         ///< an infinite number means "no limit"
  Range range;                       ///< of numbers and integers
  std::vector<std::string> choices;  ///< of a choice
  std::string doc;
};

/// Returns the values that an option accepts, as text: "a number greater than 0 (m)", "one of \"planar\", \"full\"".
/// \param option  its type, range, choices and unit
std::string expectation(const Option& option);

/// A planner, guide, combinator, target or other part that a script can name.
struct Component {
  enum class Kind { planner, guide, combinator, target, estimator, scene, motion };

  Kind kind = Kind::guide;
  std::string name;
  std::string summary;  ///< one line
  std::string source;   ///< the publication of the method
  std::vector<Option> options;
  /// Names of the options that a script may give by position, in order: shrink(0.5).
  std::vector<std::string> positional;

  /// Returns the option with this name; nullptr if there is none.
  /// \param option  its exact name
  /// \return a pointer into `options`
  [[nodiscard]] const Option* find(std::string_view option) const;
};

/// Returns the kind as messages name it: "guide".
/// \param kind  a value of the enumeration
/// \throws Fault for another value
std::string_view to_string(Component::Kind kind);

/// A complete, validated set of a component's options, in the component's order, with the defaults filled in.
class Options {
 public:
  using Entry = std::pair<std::string, OptionValue>;

  Options() = default;

  /// Checks `given` against the component.
  /// \param component  its options and their ranges
  /// \param given  names and values, in any order; of a repeated name the first counts. An option that is not given has
  ///     its default.
  /// \throws Error that names the component, the option, the expected value and, for a misspelt name, the nearest valid
  ///     name. NaN is never valid; infinity is valid only where the default is infinite.
  static Options validate(const Component& component, const std::vector<Entry>& given);

  /// All options of the component, in its order.
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// The value of an option.
  /// \param name  exact name
  /// \return valid as long as this object
  /// \throws Fault for a name that the component has not
  [[nodiscard]] const OptionValue& at(std::string_view name) const;

  friend bool operator==(const Options&, const Options&) = default;

 private:
  std::vector<Entry> entries_;
};

/// Binds a component's options to the fields of its settings struct. Name, type, unit, default, range and docstring of
/// an option thus stand in one place. The default is the field's initialiser.
///
///     static const Settings<RrtSettings> settings = Settings<RrtSettings>(Component::Kind::planner, "rrt", "...",
///     "LaValle 1998")
///         .number("step", &RrtSettings::step, "m", Range::positive(), "longest extension in the metric");
template <class S>
class Settings {
 public:
  /// \param kind  groups the component in help and the reference
  /// \param name  in scripts
  /// \param summary  one line
  /// \param source  the publication of the method; may be empty
  Settings(Component::Kind kind, std::string name, std::string summary, std::string source) {
    component_.kind = kind;
    component_.name = std::move(name);
    component_.summary = std::move(summary);
    component_.source = std::move(source);
  }

  // Each of the following declares an option and returns the settings.
  /// \param name  in scripts, unique among the options of the component
  /// \param field  receives the value; its initialiser is the default
  /// \param unit  as "m" or "validity checks"; "" for a pure number
  /// \param range  of the values that a script may give
  /// \param doc  one sentence for help and reference
  Settings& number(std::string name, double S::*field, std::string unit, Range range, std::string doc) {
    add({std::move(name), Option::Type::number, std::move(unit), S{}.*field, range, {}, std::move(doc)},
        [field](S& s, const OptionValue& v) { s.*field = std::get<double>(v); });
    return *this;
  }
  /// Declares an option that is an integer.
  /// \param name  in scripts, unique among the options of the component
  /// \param field  receives the value; its initialiser is the default
  /// \param unit  as "proposals"; "" for a pure number
  /// \param range  of the values that a script may give
  /// \param doc  one sentence for help and reference
  Settings& integer(std::string name, std::int64_t S::*field, std::string unit, Range range, std::string doc) {
    add({std::move(name), Option::Type::integer, std::move(unit), S{}.*field, range, {}, std::move(doc)},
        [field](S& s, const OptionValue& v) { s.*field = std::get<std::int64_t>(v); });
    return *this;
  }
  /// Declares an option that is true or false.
  /// \param name  in scripts, unique among the options of the component
  /// \param field  receives the value; its initialiser is the default
  /// \param doc  one sentence for help and reference
  Settings& boolean(std::string name, bool S::*field, std::string doc) {
    add({std::move(name), Option::Type::boolean, "", S{}.*field, {}, {}, std::move(doc)},
        [field](S& s, const OptionValue& v) { s.*field = std::get<bool>(v); });
    return *this;
  }
  /// Declares an option that is one of several words.
  /// \param name  in scripts, unique among the options of the component
  /// \param field  receives the word; its initialiser is the default and must be one of the choices, which is not
  ///     checked
  /// \param choices  the words, in the order of help and messages
  /// \param doc  one sentence for help and reference
  Settings& choice(std::string name, std::string S::*field, std::vector<std::string> choices, std::string doc) {
    add({std::move(name), Option::Type::choice, "", S{}.*field, {}, std::move(choices), std::move(doc)},
        [field](S& s, const OptionValue& v) { s.*field = std::get<std::string>(v); });
    return *this;
  }
  /// Declares an option whose words stand for values of an enumeration, or for false and true. The default is the word
  /// of the field's initialiser.
  /// \param name  in scripts, unique among the options of the component
  /// \param field  receives the value of the word
  /// \param words  words with their values, in the order of help and messages
  /// \param doc  one sentence for help and reference
  /// \throws Fault where no word has the value of the field's initialiser
  template <class T, class Owner>
  requires(!std::is_same_v<T, std::string>) Settings& choice(
      std::string name, T Owner::*field, const std::vector<std::pair<std::string, std::type_identity_t<T>>>& words,
      std::string doc) {
    std::vector<std::string> choices;
    choices.reserve(words.size());
    for (const auto& [word, value] : words) choices.push_back(word);
    const auto standard = std::ranges::find(words, S{}.*field, [](const auto& entry) { return entry.second; });
    if (standard == words.end()) throw Fault("option " + name + ": no word for the default");
    add({std::move(name), Option::Type::choice, "", standard->first, {}, std::move(choices), std::move(doc)},
        [field, words](S& s, const OptionValue& v) {
          s.*field =
              std::ranges::find(words, std::get<std::string>(v), [](const auto& entry) { return entry.first; })->second;
        });
    return *this;
  }
  /// Declares an option that names a file to read; the default is no file.
  /// \param name  in scripts, unique among the options of the component
  /// \param field  receives the path of the file; "" where the script gives none
  /// \param doc  one sentence for help and reference
  Settings& file(std::string name, std::string S::*field, std::string doc) {
    add({std::move(name), Option::Type::file, "", S{}.*field, {}, {}, std::move(doc)},
        [field](S& s, const OptionValue& v) { s.*field = std::get<std::string>(v); });
    return *this;
  }
  /// Declares an option that is a list of names. A call without option names may give these names after the other
  /// positional options.
  /// \param name  in scripts, unique among the options of the component
  /// \param field  receives the names in the order of the script; its initialiser is the default
  /// \param doc  one sentence for help and reference
  Settings& names(std::string name, std::vector<std::string> S::*field, std::string doc) {
    add({std::move(name), Option::Type::names, "", S{}.*field, {}, {}, std::move(doc)},
        [field](S& s, const OptionValue& v) { s.*field = std::get<std::vector<std::string>>(v); });
    return *this;
  }
  /// Sets the options that a script may give by position, in order.
  /// \param names  declared options, which is not checked; replaces an earlier list
  Settings& positional(std::vector<std::string> names) {
    component_.positional = std::move(names);
    return *this;
  }

  /// The component with all options declared so far.
  [[nodiscard]] const Component& component() const { return component_; }

  /// Returns the settings struct that has the values of the validated options.
  /// \param options  validated for this component (Options::validate)
  /// \throws Fault for options of a component that has another number of options
  [[nodiscard]] S read(const Options& options) const {
    S settings;
    const auto& entries = options.entries();
    if (entries.size() != setters_.size()) throw Fault("options of another component given to " + component_.name);
    for (std::size_t i = 0; i < setters_.size(); ++i) setters_[i](settings, entries[i].second);
    return settings;
  }

 private:
  void add(Option option, std::function<void(S&, const OptionValue&)> setter) {
    component_.options.push_back(std::move(option));
    setters_.push_back(std::move(setter));
  }

  Component component_;
  std::vector<std::function<void(S&, const OptionValue&)>> setters_;
};

}  // namespace trellis
