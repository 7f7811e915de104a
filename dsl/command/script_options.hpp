// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dsl/command/commands.hpp>
#include <dsl/language/session.hpp>

namespace trellis::command {

/// The options of a session whose scripts Ctrl-C ends, and that ends the program where a script does not end. Throws
/// Error for a number that is none.
dsl::SessionOptions session_options(const ScriptOptions& options);

}  // namespace trellis::command
