// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int reason) {
  throw Error(fmt::format("cannot write '{}': {}", path, std::strerror(reason)));  // NOLINT(concurrency-mt-unsafe)
}

struct Part {
  int file = -1;  ///< a file descriptor, -1 with errno on failure
  std::string name;
};

/// Creates a new file with a unique name beside `path`.
Part open_beside(const std::string& path) {
  Part part;
  for (int attempt = 0; attempt < 100; ++attempt) {
    part.name = fmt::format("{}.part-{}-{}", path, ::getpid(), attempt);
    part.file = ::open(part.name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (part.file >= 0 || errno != EEXIST) break;
  }
  return part;
}

/// Returns 0 or the error code. Closes the file in any case.
int write_all(int file, std::string_view content) {
  int reason = 0;
  while (!content.empty() && reason == 0) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written >= 0) {
      content.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      reason = errno;
    }
  }
  // A full disc or a quota may only fail here.
  if (::close(file) != 0 && reason == 0 && errno != EINTR) reason = errno;
  return reason;
}

/// Terminals, pipes and devices accept a stream of bytes; renaming a file over them would replace the device itself.
bool is_stream(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return false;
  return S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) || S_ISBLK(status.st_mode) ||
         path.starts_with("/dev/") || path.starts_with("/proc/");
}

}  // namespace

void write_file(const std::string& path, const std::string& content) {
  if (is_stream(path)) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) fail(path, errno);
    if (const int reason = write_all(file, content); reason != 0) fail(path, reason);
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

  const Part part = open_beside(target);
  if (part.file < 0) fail(path, errno);
  int reason = write_all(part.file, content);
  if (reason == 0 && std::rename(part.name.c_str(), target.c_str()) != 0) reason = errno;
  if (reason != 0) {
    ::unlink(part.name.c_str());
    fail(path, reason);
  }
}

}  // namespace trellis
