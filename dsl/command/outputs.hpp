// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis::command {

/// Finds out, before anything runs, whether a file can be written. Throws Error that says why not.
void require_writable_file(const std::string& path);

/// The same for a folder that files are put into, which is made where it does not exist. Unless it is kept, what was
/// made goes again with the object.
class OutputFolder {
 public:
  /// \param path  "" for none
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  void keep() { made_.clear(); }

 private:
  std::string made_;  // the folder, where it did not exist before
};

/// Prints to stdout. Throws Error where it cannot be written, as on a full disc.
void print_all(const std::string& text);

}  // namespace trellis::command
