// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <dsl/language/script_place.hpp>
#include <dsl/language/types.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Lists in lists are opened down to this depth.
inline constexpr std::size_t deepest_list = 50;

/// A named field of a constructor that holds more than an option can: a list, a world, a planner. Also an argument that
/// a function takes by its place, and a member that scripts read of a value.
struct Field {
  std::string name;
  std::string type;     ///< as LuaCATS has it: "number[]", "trellis.World"
  std::string expects;  ///< "a list of numbers"
  std::string doc;
  bool required = false;
  std::string default_text = {};  ///< as a script would write it, "" where there is none or `doc` tells it
};

/// A constructor or function that is no component: world, problem, scenes.load, ... Described once; unknown and missing
/// fields, messages, help, stubs and the reference come from here.
struct Construct {
  std::string name;
  std::string usage;  ///< an example in the language
  std::string summary;
  std::string list;     ///< what its unnamed elements are, "" where it takes none
  std::string element;  ///< the type of an unnamed element, "" where it takes none
  std::vector<Field> fields;
  Component options;                  ///< the fields that are plain options; none where it has no name
  std::string returns;                ///< the type of what it makes, "" where it returns nothing
  std::vector<Field> arguments = {};  ///< what a function takes by place, before the table
  std::string source = {};            ///< the publication the idea comes from, where it is not in `options`
};

/// What a call of a construct was given: one table, or only unnamed elements.
class Arguments {
 public:
  /// Throws Error for fields that the construct does not have, keys that are no names, and required fields that are
  /// missing.
  Arguments(const Construct& construct, lua::Stack& call);

  /// Calls `visit` with each unnamed element and its number, from 1.
  void each(const std::function<void(std::size_t, lua::Value)>& visit) const;
  [[nodiscard]] std::size_t count() const { return count_; }
  /// The field's value, nil where it was not given.
  [[nodiscard]] lua::Value operator[](const std::string& name) const;
  /// The field's string; none where it was not given. Throws Error where it is something else.
  [[nodiscard]] std::optional<std::string> string(const std::string& name) const;
  /// The options of the construct, validated.
  [[nodiscard]] Options options() const;
  /// Throws an Error that the field is not what is expected.
  [[noreturn]] void reject(const std::string& name) const;

 private:
  const Construct& construct_;
  lua::Stack& call_;
  std::optional<lua::Value> table_;
  std::size_t count_ = 0;
};

/// The options that a component was given in a call, from argument `first`: unnamed ones by the component's
/// `positional`, then named ones of a table.
struct Given {
  std::vector<Options::Entry> options;
  std::optional<PlannerSpec> planner;
};
/// \param planner  the component may be given a planner of its own search, as `planner = ...`
Given read_options(const Component& component, lua::Stack& call, int first, bool planner);

/// Adds what was given for an option. Whether the option exists is left to Options::validate, which knows what to say.
void read_option(const Component& component, const std::string& name, lua::Value value,
                 std::vector<Options::Entry>& given);

/// The finite numbers in a list. `what` names it in messages: "problem: field 'start'".
std::vector<double> read_numbers(lua::Value value, const std::string& what);

/// The names of files among the options, as they are looked for: in the script's folder. Throws Error for one that a
/// script may not reach, and where there is no file of a name that was given.
void place_files(const Component& component, std::vector<Options::Entry>& given, const ScriptPlace& place);

/// For lua::Stack::on_missing: reading a field that a module does not have is an error with the nearest name.
lua::Callback missing_field(const std::string& module);

/// What a value is, for messages: specs with their text, constructors with a hint.
std::string describe(lua::Value value);

}  // namespace trellis::dsl
