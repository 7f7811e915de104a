// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <dsl/command/repl_plot.hpp>
#include <dsl/command/repl_run.hpp>
#include <dsl/language/program.hpp>
#include <dsl/language/vocabulary.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::command {

/// A session command: a function that scripts do not have.
struct Verb {
  std::string_view name;
  std::string_view usage;
  std::string_view summary;
};
std::span<const Verb> verbs();
/// Returns their usages and summaries, or those of the named one.
std::string verbs_text(std::string_view name = "", std::size_t width = dsl::help_width);

/// The state that the session commands share.
struct Bench {
  std::function<Screen()> screen;
  std::function<bool()> interrupted;
  std::function<void()> forget_interruption;

  std::vector<RunPointer> runs;
  RunPointer current;              ///< the default run of the commands
  std::optional<Problem> problem;  ///< of the last planning run
  std::string expression;          ///< gives that problem; "" if none is known
  std::optional<dsl::Program> script;
  std::string path;  ///< of the script, "" without one
  enum class Returned { nothing, experiment, table, pair };
  Returned returned = Returned::nothing;  ///< what the script returns
  /// The last planning run as an input would write it; "" for a problem without a name.
  struct Planned {
    std::string strategy;
    std::string problem;
  };
  std::optional<Planned> planned;
  std::vector<std::string> accepted;  ///< inputs for a script; those not valid in a script as comments
  std::string last_input;
  std::vector<std::string> inputs;  ///< all, by number: input 1 is the first

  bool loading = false;  ///< the script runs: what it calls is as in a script

  // Of the current input:
  bool used = false;                ///< it called a session command
  const void* announced = nullptr;  ///< the value that a command already printed
  std::string to_edit;              ///< the argument of edit(); see `edits`
  bool edits = false;
  bool reloads = false;  ///< it called reload()
  bool over = false;     ///< the session ends
};

/// Returns the path of a table's field in an expression: script.strategies.nested, script.strategies["a b"].
std::string field_path(const std::string& table, const std::string& name);

/// Registers the session commands. The bench must outlive the interpreter.
void open_verbs(lua::Stack& stack, Bench& bench);

}  // namespace trellis::command
