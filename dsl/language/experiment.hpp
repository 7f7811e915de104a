// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <dsl/language/construct.hpp>
#include <dsl/language/program.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Makes `experiment` known.
void open_experiment(lua::Stack& stack);

const Construct& experiment_construct();

/// What a script returned, from stack position `first` on, as a program: an experiment; a strategy and a problem; or a
/// table { strategy = s, problem = p }. Throws Error for anything else.
Program read_program(lua::Stack& stack, int first);
/// Likewise of a script that returns a problem or a list of problems.
std::vector<Problem> read_problems(lua::Stack& stack, int first);

}  // namespace trellis::dsl
