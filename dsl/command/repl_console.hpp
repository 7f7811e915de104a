// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/command/repl_line.hpp>
#include <dsl/command/repl_verbs.hpp>
#include <dsl/language/session.hpp>

namespace trellis::command {

/// The interpreter of a session at a terminal, or of piped lines.
class Console {
 public:
  /// \param folder  the folder of modules and scenes
  /// \param colour  whether the output may have colours
  Console(const std::string& folder, bool colour, const dsl::SessionOptions& options);

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

  [[nodiscard]] bool over() const { return bench_.over; }
  /// Opens an editor if an input requested one. Returns the edited text to run, "" for none.
  std::string edited();

 private:
  void accept(const std::string& input);
  void warn_of_locals(const std::string& input);
  /// Prints what the input has that does something else than it seems to.
  void print_warnings();
  /// Runs the script again and says what has changed. \throws Error
  void reload();

  Bench bench_;
  dsl::Session session_;
  std::size_t inputs_ = 0;
  bool warned_ = false;
};

}  // namespace trellis::command
