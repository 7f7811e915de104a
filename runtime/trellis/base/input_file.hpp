// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace trellis {

/// A file that is open for reading, with a limit of its size that is checked before anything is read. Only regular
/// files are opened: the size of a pipe, a terminal or a device is unknown, and reading one may not terminate. All that
/// Trellis reads by name goes through this class.
class InputFile {
 public:
  /// Opens the file. Where that fails, `fault` says why.
  /// \param path  of the file; a link to a regular file is one
  /// \param most  the limit of its size, bytes
  InputFile(const std::string& path, std::uintmax_t most);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Why the file cannot be read, as "it is a folder" or the system's reason; "" if it can.
  [[nodiscard]] const std::string& fault() const { return fault_; }

  /// Reads the next part of the file into `block`, which becomes empty at its end. Returns false where the disk fails,
  /// or where the file has grown beyond the limit: then `fault` says why.
  bool next(std::string& block);
  /// Reads what remains. What was read is incomplete where `fault` is not "".
  [[nodiscard]] std::string rest();

 private:
  std::string fault_;
  std::uintmax_t most_;
  std::uintmax_t left_ = 0;  // bytes that may follow
  std::uintmax_t size_ = 0;  // as the system gives it
  int file_ = -1;
};

/// Returns why a file cannot be read, "" if it can: InputFile::fault.
std::string input_fault(const std::string& path, std::uintmax_t most);

}  // namespace trellis
