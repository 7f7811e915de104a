// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <trellis/base/component.hpp>

namespace trellis::dsl {

/// A name that Trellis provides to scripts, in one form, whether it comes from a component of the runtime, a construct,
/// or a function of the standard library.
struct Word {
  enum class Kind { planner, guide, target, estimator, constructor, function, module };

  Kind kind = Kind::constructor;
  std::string name;  ///< "shrink", "robot.disc", "strategies.irc"
  std::string summary;
  std::string source;                   ///< the publication of the method, "" for none
  std::string usage;                    ///< an example in the language, "" if the name suffices
  std::string list;                     ///< the meaning of its positional elements, "" for none
  std::string element;                  ///< their type
  std::vector<Field> arguments;         ///< positional arguments of a function, before the table
  std::vector<Field> fields;            ///< named, with values that are no plain options
  std::vector<Option> options;          ///< named, and plain
  std::vector<std::string> positional;  ///< the options that a script may give by position, in order
  std::string returns;                  ///< the type of its result, "" for none
  std::string text;                     ///< of a module: the comment at its beginning

  /// Returns "scenes" of "scenes.trap", "" of a global.
  [[nodiscard]] std::string module() const;
  /// Returns the names that its table may contain, fields first.
  [[nodiscard]] std::vector<std::string> named() const;
  /// "guide".
  [[nodiscard]] std::string_view kind_text() const;
};

/// The result of an operator for a value and an operand.
struct Operation {
  std::string event;   ///< in LuaCATS: "shr"
  std::string symbol;  ///< ">>"
  std::string operand;
  std::string result;
};

/// A type of Lua values.
struct ObjectType {
  std::string name;  ///< "trellis.Guide"
  std::string summary;
  std::string parent;          ///< its base type, "" for none
  std::vector<Field> members;  ///< readable members; methods have a type that begins with "fun(self"
  std::vector<Operation> operations;
};

/// Returns an option's default in the syntax of a script.
std::string default_text(const Option& option);

}  // namespace trellis::dsl
