// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <dsl/lua/stack.hpp>
#include <trellis/scene/scene.hpp>

/// Values and inputs of a session as texts of the language, which save() writes.
namespace trellis::command {

/// Returns a text in quotes, as Lua reads it.
std::string quoted(const std::string& text);
/// Writes a field's name in Lua's syntax: label, ["two words"].
std::string key_text(const std::string& name);

/// Returns the shortest text of a number that Lua reads as the same number.
std::string number_source(double x);

/// Returns the number as people write it, with at most so many significant digits: 1000, 0.3, 2.5e-7.
std::string number_text(double x, int digits);

/// Splits an input into its statements. An input with local variables outside of blocks, or that does not compile, is
/// one statement.
std::vector<std::string> statements(lua::Stack& stack, const std::string& input);

/// Returns the texts of the arguments of the last call of one of these functions outside of blocks, in an input without
/// local variables there; empty where there is none.
std::vector<std::string> arguments_of_call(const std::string& input, const std::set<std::string>& functions);

/// Gives values as texts.
class SourceWriter {
 public:
  /// \param lost   globals that have no value where the text is read
  /// \param known  a problem and a text that gives it
  SourceWriter(lua::Stack& stack, const std::set<std::string>& lost, const Problem* known, std::string known_text);

  /// Returns a text that gives an equal value: of a number, text, boolean, table of such, strategy, guide, planner,
  /// problem, world or robot; "" where there is none.
  std::string text(const lua::Value& value);

 private:
  std::string table(const lua::Value& value, int depth);
  template <class Spec>
  std::string spec(const Spec& value, const std::function<bool(const lua::Value&)>& equal);
  std::string problem(const Problem& problem);
  std::string world(const lua::Value& value);
  std::string robot(const lua::Value& value);
  /// Calls `visit` with the name and the problem of each global, and of each problem of the script.
  void each_problem(const std::function<void(const std::string&, const Problem&)>& visit);

  lua::Stack& stack_;
  const std::set<std::string>& lost_;
  const Problem* known_;
  std::string known_text_;
  std::size_t values_ = 0;  ///< written in tables
};

/// The call of a function of the module `scenes` that makes an equal problem; "" for none.
std::string scene_call(lua::Stack& stack, const Problem& problem);

}  // namespace trellis::command
