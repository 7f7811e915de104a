// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/progress.hpp>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace trellis::command {

Progress::Progress(bool wanted) : shown_(wanted && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void Progress::show(std::size_t done, std::size_t all) {
  done_ = done;
  all_ = all;
  draw("steps");
}

void Progress::show(const std::string& what) { draw("steps, " + what); }

void Progress::draw(const std::string& what) {
  if (!shown_ || all_ == 0) return;
  constexpr std::size_t width = 40;
  const std::size_t filled = width * done_ / all_;
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - start_).count();
  fmt::print(stderr, "\r\x1b[K[{}{}] {}/{} {}  {}:{:02}", std::string(filled, '#'), std::string(width - filled, '.'),
             done_, all_, what, seconds / 60, seconds % 60);
  std::fflush(stderr);
  drawn_ = true;
}

int report_width(int otherwise) {
  constexpr int least = 80;  // a narrower table is not readable
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    return otherwise;
  }
  return size.ws_col < least ? least : size.ws_col;
}

}  // namespace trellis::command
