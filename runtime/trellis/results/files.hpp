// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace trellis {

/// Whether `write_file` waits for the disk. Without it, a power failure may leave an empty file.
enum class Flush { disk, none };

/// Writes a file atomically: whatever ends the process, the file has its old content or the new one. Keeps the
/// permissions of a file that it replaces. Writes to terminals, pipes and devices directly.
/// \throws Error that names the path and the reason.
void write_file(const std::string& path, const std::string& content, Flush flushed = Flush::disk);

/// The same for a file that must not exist.
void write_new_file(const std::string& path, const std::string& content);

/// Writes all bytes to an open file, also where a signal interrupts.
/// \param file  a file descriptor
/// \return 0, or the system's error number; then a part of the bytes may have been written
int write_all(int file, std::string_view content);

/// Writes a file part by part, as write_file() writes a whole one: before `publish` the file has its old content. A
/// stream, such as a pipe, receives each part at once. \throws Error that names the path and the reason
class FileWriter {
 public:
  explicit FileWriter(const std::string& path);
  /// Removes what was not published.
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void write(std::string_view text);
  /// Gives the file its name, once everything was written.
  void publish(Flush flushed = Flush::disk);

 private:
  struct Target;
  void flush_buffer();

  std::string path_;
  std::unique_ptr<Target> target_;
  std::string buffer_;
};

/// A folder of its own in the system's temporary one, removed with this object.
class TemporaryFolder {
 public:
  /// \throws Error where none can be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace trellis
