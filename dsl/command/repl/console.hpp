// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include <dsl/command/repl/line.hpp>
#include <dsl/command/repl/verbs.hpp>
#include <dsl/language/tools/session.hpp>

namespace trellis::command {

/// The interpreter of a session at a terminal, or of piped lines.
class Console {
 public:
  /// \param folder  the folder of modules and scenes
  /// \param colour  whether the output may have colours
  /// \param confirmed  asks the person at the terminal a question; nullptr where there is none
  Console(const std::string& folder, bool colour, const dsl::SessionOptions& options,
          std::function<bool(const std::string& question)> confirmed = {});

  /// Runs a script and assigns its result to the global `script`; prints a summary. \throws Error.
  std::string load(const std::string& path);

  enum class Verdict { done, failed, incomplete };
  /// Runs an input, an expression or a chunk, and prints its values or its error.
  /// \param more  whether more lines may follow: then an input that ends too early is incomplete, not an error
  Verdict run(const std::string& typed, bool more);

  /// Whether the lines of a text form one input: a chunk with local variables, which separate lines would lose.
  bool together(const std::string& text);

  /// Returns completions; `text` is the input up to the cursor, including its earlier lines.
  Completion complete(const std::string& text);

  [[nodiscard]] bool over() const { return state_.over; }
  /// Opens an editor if an input requested one. Returns the edited text to run, "" for none.
  std::string edited();

 private:
  /// Adds the statements of an input to those that save() writes.
  void accept(const std::string& input);
  /// Adds a statement as it is, or as a comment with the values that it assigned.
  /// \param used  whether it calls a session command
  void accept_statement(const std::string& text, bool used);
  /// The text of a global that save() can write (SourceWriter); "" for others.
  std::string literal(const std::string& name);
  void warn_of_locals(const std::string& input);
  /// Prints what the input has that does something else than it seems to.
  void print_warnings();
  /// Runs the script again and says what has changed. \throws Error
  void reload();

  SessionState state_;
  dsl::Session session_;
  std::size_t inputs_ = 0;
  bool warned_ = false;
};

}  // namespace trellis::command
