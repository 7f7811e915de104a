// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/program.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers `tune`.
void open_tuning(lua::Stack& stack);

const Construct& tune_construct();

/// Reads a call tune(strategy, problems, { over = ... }): calls the function `strategy` with each combination of
/// values. Runs nothing.
Program read_tuning(lua::Stack& call);

}  // namespace trellis::dsl
