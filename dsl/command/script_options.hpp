// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dsl/command/commands.hpp>
#include <dsl/language/session.hpp>

namespace trellis::command {

/// Returns the options of a session whose scripts Ctrl-C ends; if a script does not stop, it ends the program. \throws
/// Error for an invalid number.
dsl::SessionOptions session_options(const ScriptOptions& options);

}  // namespace trellis::command
