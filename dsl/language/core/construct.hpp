// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <dsl/language/core/script_place.hpp>
#include <dsl/language/core/types.hpp>
#include <dsl/lua/mistakes.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Nested lists are flattened down to this depth.
inline constexpr std::size_t deepest_list = 50;

/// A named field of a constructor with a value that is no plain option: a list, a world, a planner. Also a positional
/// argument of a function, and a readable member of a value.
struct Field {
  std::string name;
  std::string type;     ///< in LuaCATS: "number[]", "trellis.World"
  std::string expects;  ///< "a list of numbers"
  std::string doc;
  bool required = false;
  std::string default_text = {};  ///< in the syntax of a script, "" for none or if `doc` states it
};

/// A constructor or function that is no component: world, problem, scenes.load, ... Messages (also about unknown and
/// missing fields), help, stubs and the reference use this one description.
struct Construct {
  std::string name;
  std::string usage;  ///< an example in the language
  std::string summary;
  std::string list;     ///< the meaning of its positional elements, "" for none
  std::string element;  ///< the type of a positional element, "" for none
  std::vector<Field> fields;
  Component options;    ///< the fields that are plain options; the component has no name if there are none
  std::string returns;  ///< the type of its result, "" for none
  std::vector<Field> arguments = {};  ///< positional arguments of a function, before the table
  std::string source = {};            ///< the publication of the method, if it is not in `options`
};

/// The arguments of a construct's call: one table, or only positional elements.
class Arguments {
 public:
  /// \throws Error for unknown fields, keys that are no names, missing required fields, and invalid options beside
  /// them.
  Arguments(const Construct& construct, lua::Stack& call);
  /// The same; records these faults and does not throw them.
  Arguments(const Construct& construct, lua::Stack& call, lua::Faults& faults);

  /// Calls `visit` with each positional element and its number, from 1.
  void each(const std::function<void(std::size_t, lua::Value)>& visit) const;
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Returns the field's value, nil if it is missing.
  [[nodiscard]] lua::Value operator[](const std::string& name) const;
  /// Returns the field's string; none if it is missing. \throws Error for another type.
  [[nodiscard]] std::optional<std::string> string(const std::string& name) const;
  /// Returns the validated options of the construct.
  [[nodiscard]] Options options() const;
  /// Whether the call is a table, or a list of the construct's elements, so that its fields can be read.
  [[nodiscard]] bool readable() const { return readable_; }
  /// \throws Error that the field has an invalid value.
  [[noreturn]] void reject(const std::string& name) const;

 private:
  void read(lua::Faults& faults);
  void read_keys(lua::Faults& faults);

  const Construct& construct_;
  lua::Stack& call_;
  std::optional<lua::Value> table_;
  std::size_t count_ = 0;
  bool readable_ = true;
  std::vector<std::string> misspelt_;  ///< the fields that unknown ones seem to mean
};

/// The options of a component in a call, from argument `first`: positional ones by the component's `positional`, then
/// named ones of a table.
struct Given {
  std::vector<Options::Entry> options;
  std::optional<PlannerSpec> planner;
};
/// \param planner  whether the component accepts a planner for its own search, as `planner = ...`
Given read_options(const Component& component, lua::Stack& call, int first, bool planner);

/// Validates each of the options, so that every one that is invalid has its message. \throws Error, SeveralFaults
Options validated(const Component& component, const std::vector<Options::Entry>& given);

/// Reads the value of an option. Options::validate checks later that the option exists, and has the better message.
void read_option(const Component& component, const std::string& name, lua::Value value,
                 std::vector<Options::Entry>& given);

/// Reads a list of finite numbers. Messages call it `what`: "problem: field 'start'".
std::vector<double> read_numbers(lua::Value value, const std::string& what);

/// Replaces the names of files in the options by their paths in the script's folder. \throws Error for a file that a
/// script may not read, and for a missing file.
void place_files(const Component& component, std::vector<Options::Entry>& given, const ScriptPlace& place);

/// For lua::Stack::on_missing: reading an unknown field of a module is an error with the nearest name.
lua::Callback missing_field(const std::string& module);

/// Returns a planner or strategy as a strategy, none for other values.
std::optional<StrategySpec> as_strategy(lua::Value value);

/// Describes a value for messages: specs by their text, constructors with a hint.
std::string describe(lua::Value value);

}  // namespace trellis::dsl
