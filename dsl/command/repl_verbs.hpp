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
#include <dsl/lua/stack.hpp>

namespace trellis::command {

/// A function of sessions that scripts do not have.
struct Verb {
  std::string_view name;
  std::string_view usage;
  std::string_view summary;
};
std::span<const Verb> verbs();
/// Their usages and summaries; of the one that is named, where there is one.
std::string verbs_text(std::string_view name = "");

/// What the verbs of a session share.
struct Bench {
  std::function<Screen()> screen;
  std::function<bool()> interrupted;

  std::vector<RunPointer> runs;
  RunPointer current;              ///< that verbs speak of where no other is named
  std::optional<Problem> problem;  ///< the last that was planned on
  std::optional<dsl::Program> script;
  std::vector<std::string> accepted;  ///< inputs for a script, what a script cannot hold as comments
  std::string last_input;

  // Of the input that is at work:
  bool used = false;                ///< it called a verb
  const void* announced = nullptr;  ///< a value that a verb has printed already
  std::string to_edit;              ///< what edit() was asked for; see `edits`
  bool edits = false;
  bool over = false;  ///< the session ends
};

/// Makes the verbs known. The bench outlives the interpreter.
void open_verbs(lua::Stack& stack, Bench& bench);

}  // namespace trellis::command
