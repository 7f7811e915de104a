// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/input_file.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <system_error>

namespace trellis {

namespace {

std::string reason_of(int error) { return std::generic_category().message(error); }

/// Names what is no regular file.
const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "it is a folder";
  if (S_ISFIFO(mode)) return "it is a pipe; expected a regular file";
  if (S_ISSOCK(mode)) return "it is a socket; expected a regular file";
  return "it is a device; expected a regular file";
}

std::string too_large(std::uintmax_t bytes, std::uintmax_t most) {
  return fmt::format("it has {} bytes, at most {} are read", bytes, most);
}

}  // namespace

InputFile::InputFile(const std::string& path, std::uintmax_t most) : most_(most), left_(most) {
  // Opening a device may already do something, and opening a pipe waits for its writer.
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    fault_ = reason_of(errno);
    return;
  }
  if (S_ISREG(status.st_mode)) {
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file_ < 0 || ::fstat(file_, &status) != 0) fault_ = reason_of(errno);
  }
  if (fault_.empty() && !S_ISREG(status.st_mode)) fault_ = kind_of(status.st_mode);
  if (!fault_.empty()) return;
  size_ = static_cast<std::uintmax_t>(status.st_size);
  if (size_ > most_) fault_ = too_large(size_, most_);
}

InputFile::~InputFile() {
  if (file_ >= 0) ::close(file_);
}

bool InputFile::next(std::string& block) {
  constexpr std::size_t length = std::size_t{64} << 10U;
  block.resize(fault_.empty() ? length : 0);
  if (!fault_.empty()) return false;
  ssize_t read = 0;
  do {
    read = ::read(file_, block.data(), block.size());
  } while (read < 0 && errno == EINTR);
  if (read < 0) fault_ = reason_of(errno);
  if (read > 0 && static_cast<std::uintmax_t>(read) > left_)
    fault_ = too_large(most_ - left_ + static_cast<std::uintmax_t>(read), most_);
  block.resize(fault_.empty() ? static_cast<std::size_t>(read) : 0);
  left_ -= block.size();
  return fault_.empty();
}

std::string InputFile::rest() {
  std::string all;
  if (!fault_.empty()) return all;
  all.reserve(static_cast<std::size_t>(size_));
  for (std::string block; next(block) && !block.empty();) all += block;
  return all;
}

std::string input_fault(const std::string& path, std::uintmax_t most) { return InputFile(path, most).fault(); }

}  // namespace trellis
