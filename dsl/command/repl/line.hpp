// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace trellis::command {

/// The possible ends of an unfinished line.
struct Completion {
  std::vector<std::string> words;
  bool files = false;  ///< names of files, too
};
/// \param before  the line up to the cursor
using Completer = std::function<Completion(const std::string& before)>;

/// Reads typed lines: with editing, completion and history if stdin is a terminal, plainly otherwise. Only one may
/// exist at a time.
class LineReader {
 public:
  explicit LineReader(Completer completes);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// Whether stdin is a terminal.
  [[nodiscard]] bool interactive() const { return interactive_; }

  /// Why this session has no history, "" if it has one or was asked for none.
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

  enum class Got { line, interrupted, end };
  /// Reads a line without its end. `interrupted`: Ctrl-C discarded the typed text; at a terminal only.
  Got read(const std::string& prompt, std::string& line);

  /// Adds an input, which may have several lines, to the history.
  void remember(const std::string& input);

 private:
  Got edit(const std::string& prompt, std::string& line);

  bool interactive_;
  std::string history_;  ///< the file, "" for none
  std::string complaint_;
};

}  // namespace trellis::command
