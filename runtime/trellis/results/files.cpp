// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/results/files.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int reason) {
  throw Error(fmt::format("cannot write '{}': {}", path, std::strerror(reason)));  // NOLINT(concurrency-mt-unsafe)
}

/// A file that has no name yet, or a temporary one. What no `publish` took is removed, also where a signal ends the
/// process: the system deletes a file without a name.
class Draft {
 public:
  /// \param path  of the file to write; the draft lies in the same folder
  explicit Draft(const std::string& path) : path_(path) {
    const fs::path parent = fs::path(path).parent_path();
    const std::string folder = parent.empty() ? "." : parent.string();
    // Only the link in /proc can give the file a name.
    if (::access("/proc/self/fd", F_OK) == 0) file_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (file_ < 0) open_named();
  }
  ~Draft() {
    if (file_ >= 0) ::close(file_);
    if (!name_.empty()) ::unlink(name_.c_str());
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  /// A file descriptor, -1 with errno where none could be created.
  [[nodiscard]] int file() const { return file_; }

  /// Gives the file its name, which no file may have. Returns 0 or the error code.
  int publish_new() {
    if (link_to(path_)) return 0;
    const int reason = errno;
    const bool no_links = !name_.empty() && reason != EEXIST;  // as on FAT
    if (!no_links) return reason;
    if (::renameat2(AT_FDCWD, name_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE) != 0) return errno;
    name_.clear();
    return 0;
  }

  /// Gives the file its name; replaces the file that has it. Returns 0 or the error code.
  int publish() {
    if (name_.empty()) {
      if (link_to(path_)) return 0;
      if (errno != EEXIST) return errno;
      if (const int reason = link_to_unique(); reason != 0) return reason;
    }
    if (std::rename(name_.c_str(), path_.c_str()) != 0) return errno;
    name_.clear();
    return 0;
  }

 private:
  static constexpr int attempts = 100;

  [[nodiscard]] std::string unique(int attempt) const {
    return fmt::format("{}.part-{}-{}", path_, ::getpid(), attempt);
  }
  void open_named() {
    for (int attempt = 0; attempt < attempts; ++attempt) {
      const std::string name = unique(attempt);
      file_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (file_ >= 0) name_ = name;
      if (file_ >= 0 || errno != EEXIST) return;
    }
  }
  [[nodiscard]] bool link_to(const std::string& name) const {
    const std::string from = name_.empty() ? fmt::format("/proc/self/fd/{}", file_) : name_;
    return ::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  }
  int link_to_unique() {
    for (int attempt = 0; attempt < attempts; ++attempt) {
      const std::string name = unique(attempt);
      if (link_to(name)) {
        name_ = name;
        return 0;
      }
      if (errno != EEXIST) return errno;
    }
    return EEXIST;
  }

  std::string path_;
  std::string name_;  // temporary; "" for none
  int file_ = -1;
};

/// Waits until the disk has the content: a full disk or a quota may only fail here. Returns 0 or the error code.
int flush(int file) {
  if (::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP) return 0;
  return errno;
}

/// Terminals, pipes and devices accept a stream of bytes; renaming a file over them would replace the device itself.
bool is_stream(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return false;
  return S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) || S_ISBLK(status.st_mode) ||
         path.starts_with("/dev/") || path.starts_with("/proc/");
}

}  // namespace

int write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written >= 0) {
      content.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

/// A stream that is written to at once, or the draft of a file.
struct FileWriter::Target {
  int stream = -1;
  std::optional<Draft> draft;
  [[nodiscard]] int file() const { return draft ? draft->file() : stream; }
  Target() = default;
  ~Target() {
    if (stream >= 0) ::close(stream);
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
};

FileWriter::FileWriter(const std::string& path) : path_(path), target_(std::make_unique<Target>()) {
  if (is_stream(path)) {
    target_->stream = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (target_->stream < 0) fail(path, errno);
    return;
  }
  // Follow a link, so that its target is replaced and not the link.
  std::error_code ignored;
  std::string target = path;
  if (fs::is_symlink(path, ignored)) {
    const fs::path resolved = fs::canonical(path, ignored);
    if (!ignored) target = resolved.string();
  }
  // rename() would fail too, but only after writing everything.
  if (fs::is_directory(target, ignored)) fail(path, EISDIR);
  target_->draft.emplace(target);
  if (target_->draft->file() < 0) fail(path, errno);
  struct stat before {};
  // The permissions are those of the file that it replaces.
  if (::stat(target.c_str(), &before) == 0) {
    static_cast<void>(::fchmod(target_->draft->file(), before.st_mode & 0777U));
  }
}

FileWriter::~FileWriter() = default;

void FileWriter::flush_buffer() {
  const int reason = write_all(target_->file(), buffer_);
  buffer_.clear();
  if (reason != 0) fail(path_, reason);
}

void FileWriter::write(std::string_view text) {
  constexpr std::size_t much = std::size_t{1} << 16U;
  if (buffer_.size() + text.size() < much) {
    buffer_ += text;
    return;
  }
  flush_buffer();
  if (const int reason = write_all(target_->file(), text); reason != 0) fail(path_, reason);
}

void FileWriter::publish(Flush flushed) {
  flush_buffer();
  int reason = 0;
  if (!target_->draft) {
    if (::close(std::exchange(target_->stream, -1)) != 0 && errno != EINTR) reason = errno;
  } else {
    if (flushed == Flush::disk) reason = flush(target_->draft->file());
    if (reason == 0) reason = target_->draft->publish();
  }
  if (reason != 0) fail(path_, reason);
}

void write_file(const std::string& path, const std::string& content, Flush flushed) {
  FileWriter file(path);
  file.write(content);
  file.publish(flushed);
}

void write_new_file(const std::string& path, const std::string& content) {
  Draft draft(path);
  if (draft.file() < 0) fail(path, errno);
  int reason = write_all(draft.file(), content);
  if (reason == 0) reason = flush(draft.file());
  if (reason == 0) reason = draft.publish_new();
  if (reason != 0) fail(path, reason);
}

namespace {

std::string make_temporary_folder() {
  std::error_code fault;
  std::string path = (fs::temp_directory_path(fault) / "trellis-XXXXXX").string();
  if (fault || ::mkdtemp(path.data()) == nullptr) {
    throw Error(fmt::format("no temporary folder '{}' can be made: {}", path,
                            fault ? fault.message() : std::generic_category().message(errno)));
  }
  return path;
}

}  // namespace

TemporaryFolder::TemporaryFolder() : path_(make_temporary_folder()) {}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace trellis
