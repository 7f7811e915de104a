// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <dsl/command/repl/plot.hpp>
#include <dsl/command/repl/run.hpp>
#include <dsl/language/core/program.hpp>
#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::command {

/// A session command: a function of typed inputs, which scripts do not have.
struct Verb {
  std::string_view name;
  std::string_view usage;
  std::string_view summary;
};
std::span<const Verb> verbs();
/// Whether a session command has this name.
bool is_command(std::string_view name);
/// Returns their usages and summaries, or those of the named one.
std::string verbs_text(std::string_view name = "", std::size_t width = dsl::help_width);

/// Returns the names of the session commands and of the words of the language, by kind, on one screen.
/// \param rows  of the screen; where the words of modules do not fit, it names the modules alone
std::string names_text(std::size_t width = dsl::help_width, std::size_t rows = 45);

/// The state that the session commands share.
struct SessionState {
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
    std::string text;  ///< the strategy without names of the session
    StrategySpec spec;
    std::string problem;
    Problem instance;
    std::uint64_t seed = 1;
    std::string typed_strategy{};  ///< the arguments of plan or start as they were typed; "" if not known
    std::string typed_problem{};
  };
  std::optional<Planned> planned;
  std::vector<std::string> accepted;  ///< inputs for a script; those not valid in a script as comments
  std::size_t accepted_inputs = 0;
  std::set<std::string> lost;  ///< globals whose values no line of `accepted` gives
  /// Files that save() and plot() have written, by their absolute paths, and their contents.
  std::map<std::string, std::string> written;
  /// Asks the person at the terminal a question; false where there is none.
  std::function<bool(const std::string& question)> confirmed = [](const std::string&) { return false; };
  std::string last_input;
  std::vector<std::string> inputs;  ///< all, by number: input 1 is the first

  // Of the current input:
  std::vector<std::string> typed;   ///< the arguments of its last plan or start
  bool used = false;                ///< it called a session command
  const void* announced = nullptr;  ///< the value that a command already printed
  std::string to_edit;              ///< the argument of edit(); see `edits`
  bool edits = false;
  bool reloads = false;  ///< it called reload()
  bool over = false;     ///< the session ends
};

/// Returns how a problem has changed, "" where it has not.
std::string change_of(const Problem& before, const Problem& after);

/// Returns the path of a table's field in an expression: script.strategies.nested, script.strategies["a b"].
std::string field_path(const std::string& table, const std::string& name);

/// Makes the session commands. They are in the environment of what a person types, not among the globals: scripts,
/// modules and their functions do not have them. The state must outlive the interpreter.
void open_verbs(lua::Stack& stack, SessionState& state);

/// The hidden table that is the environment of typed inputs: the session commands, and the globals, which inputs read
/// and assign.
inline constexpr const char* typed_environment = "session";

/// Pushes the table of the session commands by name.
lua::Value push_verbs(lua::Stack& stack);

}  // namespace trellis::command
