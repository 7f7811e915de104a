// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/base/error.hpp>

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

/// Prints the message to stderr; of several mistakes of a script one line for each, and their number.
void print_error(const Error& error);

/// Prints to stdout. \throws Error if that fails, as on a full disk.
void print_all(const std::string& text);

/// Checks at the end that all of stdout was written, also what scripts print. \throws Error if not, once.
void finish_output();

/// Whether the reader of stdout closed its end, as head does.
bool output_closed();

}  // namespace trellis::command
