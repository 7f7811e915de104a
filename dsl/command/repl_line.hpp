// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace trellis::command {

/// What may stand at the end of an unfinished line.
struct Completion {
  std::vector<std::string> words;
  bool files = false;  ///< names of files, too
};
/// \param before  the line up to the cursor
using Completer = std::function<Completion(const std::string& before)>;

/// Lines that somebody types: edited, completed and remembered where stdin is a terminal, read as they are elsewhere.
/// One at a time.
class LineReader {
 public:
  explicit LineReader(Completer completes);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// Whether somebody sits at a terminal.
  [[nodiscard]] bool interactive() const { return interactive_; }

  enum class Got { line, interrupted, end };
  /// Reads a line without its end. `interrupted`: Ctrl-C, what was typed is dropped; at a terminal only.
  Got read(const std::string& prompt, std::string& line);

  /// Keeps an input, of several lines perhaps, in the history.
  void remember(const std::string& input);

 private:
  Got edit(const std::string& prompt, std::string& line);

  bool interactive_;
  std::string history_;  ///< the file, "" where there is none
};

}  // namespace trellis::command
