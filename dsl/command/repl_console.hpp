// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/command/repl_line.hpp>
#include <dsl/command/repl_verbs.hpp>
#include <dsl/language/session.hpp>

namespace trellis::command {

/// The interpreter of a session at a terminal, or of lines that are piped to it.
class Console {
 public:
  /// \param folder  where modules and scenes are looked for
  /// \param colour  whether what is printed may be coloured
  Console(const std::string& folder, bool colour, const dsl::SessionOptions& options);

  /// Runs a script and binds what it returns to the global `script`; says what there is. Throws Error.
  std::string load(const std::string& path);

  enum class Verdict { done, failed, incomplete };
  /// Runs an input, an expression or a chunk, and prints its values or its error.
  /// \param more  there may be more lines: an input that ends too early is incomplete, not wrong
  Verdict run(const std::string& input, bool more);

  /// Whether the lines of a text are one input: a chunk that declares locals, which line by line would be lost.
  bool together(const std::string& text);

  /// What may follow; `text` is the input up to the cursor, its earlier lines included.
  Completion complete(const std::string& text);

  [[nodiscard]] bool over() const { return bench_.over; }
  /// Opens an editor where an input asked for one. Returns what it left to be run, "" for nothing.
  std::string edited();

 private:
  void accept(const std::string& input);
  void warn_of_locals(const std::string& input);

  Bench bench_;
  dsl::Session session_;
  std::size_t inputs_ = 0;
  bool warned_ = false;
};

}  // namespace trellis::command
