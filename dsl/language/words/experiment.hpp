// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/program.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers `experiment`.
void open_experiment(lua::Stack& stack);

const Construct& experiment_construct();

/// Reads the field 'strategies' of the construct `of`.
std::vector<std::pair<std::string, StrategySpec>> read_strategies(const Arguments& arguments, const std::string& of);
/// Reads the field 'seeds' of the construct `of`: a list, or a number of seeds from `first` on; the default number is
/// `otherwise`.
std::vector<std::uint64_t> read_seeds(const Arguments& arguments, const std::string& of, std::uint64_t first,
                                      std::uint64_t otherwise);

/// Reads a problem, a list of problems, or nested lists of them, in order. Messages begin with `prefix` and call the
/// value `what`.
std::vector<Problem> read_problem_list(const std::string& prefix, const std::string& what, lua::Value value);

/// Reads a script's results, from stack position `first` on, as a program: an experiment; a strategy and a problem; or
/// a table { strategy = s, problem = p }. \throws Error for other results.
Program read_program(lua::Stack& stack, int first);
/// Pushes a table with the fields `strategies` (by name), `problems` (by number and by name) and `seeds`.
lua::Value push_experiment(lua::Stack& stack, const Experiment& experiment);

/// Reads the results of a script that returns a problem or a list of problems.
std::vector<Problem> read_problems(lua::Stack& stack, int first);

}  // namespace trellis::dsl
