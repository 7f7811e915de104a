// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <dsl/command/repl_run.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::lua {

template <>
struct TypeName<command::RunPointer> {
  static constexpr const char* value = "run";
};

}  // namespace trellis::lua

namespace trellis::command {

/// Makes runs known to scripts: values with fields to compute with.
void open_runs(lua::Stack& stack);
/// What can be read of a run.
std::vector<std::string> run_fields();

/// A value as a session shows it: specs as trees, tables as Lua writes them, a few levels deep. Ends with a newline.
std::string value_text(lua::Stack& stack, lua::Value value);

}  // namespace trellis::command
