// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <dsl/command/repl/run.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::lua {

template <>
struct TypeName<command::RunPointer> {
  static constexpr const char* value = "run";
};

}  // namespace trellis::lua

namespace trellis::command {

/// Registers runs as values with fields.
void open_runs(lua::Stack& stack);
/// Returns the names of a run's fields.
std::vector<std::string> run_fields();

/// Prints a value as a session shows it: specs as trees, tables in Lua's syntax, a few levels deep. Ends with a
/// newline.
std::string value_text(lua::Stack& stack, lua::Value value);

}  // namespace trellis::command
