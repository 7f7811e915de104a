// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include <dsl/command/command_line.hpp>
#include <dsl/language/tools/session.hpp>

namespace trellis::command {

/// Permissions and limits of a script.
struct ScriptOptions {
  std::optional<std::uint64_t> memory;  ///< MiB
  std::optional<std::uint64_t> instructions;
  bool trust = false;
};

void add_script_options(Subcommand& verb, ScriptOptions& options);

/// Returns the options of a session whose scripts Ctrl-C ends; if a script does not stop, it ends the program.
dsl::SessionOptions session_options(const ScriptOptions& options);

}  // namespace trellis::command
