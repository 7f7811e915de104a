// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <dsl/language/construct.hpp>
#include <dsl/language/program.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Makes `experiment` known.
void open_experiment(lua::Stack& stack);

const Construct& experiment_construct();

/// The field 'strategies' of a construct called `of`.
std::vector<std::pair<std::string, StrategySpec>> read_strategies(const Arguments& arguments, const std::string& of);
/// The field 'seeds' of a construct called `of`: a list, or how many from `first` on; `otherwise` so many.
std::vector<std::uint64_t> read_seeds(const Arguments& arguments, const std::string& of, std::uint64_t first,
                                      std::uint64_t otherwise);

/// What a script returned, from stack position `first` on, as a program: an experiment; a strategy and a problem; or a
/// table { strategy = s, problem = p }. Throws Error for anything else.
Program read_program(lua::Stack& stack, int first);
/// Likewise of a script that returns a problem or a list of problems.
std::vector<Problem> read_problems(lua::Stack& stack, int first);

}  // namespace trellis::dsl
