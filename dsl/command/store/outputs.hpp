// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/results/facts.hpp>

namespace trellis::command {

/// Checks before a run that a file is writable. \throws Error that states why it is not.
void require_writable_file(const std::string& path);

/// The same for an output folder, which it creates if necessary. The destructor removes a created folder unless the
/// caller keeps it.
class OutputFolder {
 public:
  /// \param path  "" for none
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  void keep() { made_.clear(); }

 private:
  std::string made_;  // the created folder, "" if it existed before
};

/// Replaces the name of each folder of --out by that of the document of results in it.
void name_documents(std::vector<std::string>& paths);

/// Reads a document of results. \throws Error that names the file
ExperimentFacts read_document(const std::string& file);

// All text leaves for the terminal here. What a terminal would obey is printed as its code (trellis::printable).

/// Breaks lines that are longer than a terminal is wide between words, where the file is a terminal.
/// \param file  a file descriptor
std::string broken_at_words(std::string_view text, int file);

/// Prints to stderr. Where that fails, as on a full disk or where the caller closed stderr, the text is lost and the
/// command continues.
void print_stderr(std::string_view text);

/// Prints the line `trellis: MESSAGE` to stderr.
void print_message(std::string_view message);

/// Prints the message to stderr; of several mistakes of a script one line for each, and their number.
void print_error(const Error& error);

/// Prints to stdout. \throws Error if that fails, as on a full disk.
void print_all(std::string_view text);

/// Prints a drawing with its colours, whose other text is printable. \throws Error as print_all.
void print_drawing(std::string_view text);

/// Checks at the end that all of stdout was written, also what scripts print. \throws Error if not, once.
void finish_output();

/// Whether the reader of stdout closed its end, as head does.
bool output_closed();

}  // namespace trellis::command
