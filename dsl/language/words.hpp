// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <dsl/language/construct.hpp>
#include <trellis/base/component.hpp>

// The registry of the language: every name that Trellis gives to scripts, in one form, whether a component of the
// runtime, a construct, or a function of the standard library describes itself behind it. Help, messages, stubs,
// the reference and completions are made from it.

namespace trellis::dsl {

struct Word {
  enum class Kind { planner, guide, target, estimator, constructor, function, module };

  Kind kind = Kind::constructor;
  std::string name;  ///< "shrink", "robot.disc", "strategies.irc"
  std::string summary;
  std::string source;                   ///< the publication the idea comes from, "" without
  std::string usage;                    ///< an example in the language, "" where the name says it
  std::string list;                     ///< what its unnamed elements are, "" where it takes none
  std::string element;                  ///< their type
  std::vector<Field> arguments;         ///< what a function takes by place, before the table
  std::vector<Field> fields;            ///< named, and more than an option can hold
  std::vector<Option> options;          ///< named, and plain
  std::vector<std::string> positional;  ///< the options that may be given without a name, in order
  std::string returns;                  ///< the type of what it makes, "" where it returns nothing
  std::string text;                     ///< of a module: the comment that it begins with

  /// "scenes" of "scenes.trap", "" of a global.
  [[nodiscard]] std::string module() const;
  /// The names that its table may hold, fields first.
  [[nodiscard]] std::vector<std::string> named() const;
  /// "guide".
  [[nodiscard]] std::string_view kind_text() const;
};

/// What an operator makes of a value and an operand.
struct Operation {
  std::string event;   ///< as LuaCATS has it: "shr"
  std::string symbol;  ///< ">>"
  std::string operand;
  std::string result;
};

/// A type of the values that scripts hold.
struct ObjectType {
  std::string name;  ///< "trellis.Guide"
  std::string summary;
  std::string parent;          ///< the type that it is a kind of, "" without
  std::vector<Field> members;  ///< what can be read of it; methods have a type that begins with "fun(self"
  std::vector<Operation> operations;
};

/// An option's default as a script writes it.
std::string default_text(const Option& option);

/// The constructs of the language that are no planner, guide, target or estimator by themselves.
std::vector<const Construct*> constructs();

/// Every word, by kind: planners, guides, targets, estimators, constructors, functions, modules. The standard library
/// is loaded to ask it for its functions, once per process; throws Error where that fails.
const std::vector<Word>& words();

/// The types of values, those first that compose.
const std::vector<ObjectType>& object_types();

/// The globals of scripts that are Lua's own, and the fields of its libraries as "math.sin"; sorted.
const std::vector<std::string>& lua_names();

}  // namespace trellis::dsl
