// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/progress.hpp>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <trellis/base/printable.hpp>
#include <trellis/results/files.hpp>

namespace trellis::command {

Progress::Progress(bool wanted) : shown_(wanted && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void Progress::show(const std::string& phase, std::size_t done, std::size_t all) {
  if (phase != phase_) phase_start_ = Clock::now();
  phase_ = phase;
  done_ = done;
  all_ = all;
  draw(phase);
}

void Progress::show_experiment(std::size_t done, std::size_t all, std::size_t cells) {
  if (done < cells || all == cells) {
    show("planning", done, cells);
  } else {
    show("scoring", done - cells, all - cells);
  }
}

void Progress::show(const std::string& what) { draw(what); }

void Progress::draw(const std::string& what) {
  if (!shown_ || all_ == 0) return;
  constexpr std::size_t width = 40;
  const std::size_t filled = width * done_ / all_;
  const auto clock = [](double seconds) {
    const auto whole = static_cast<std::int64_t>(seconds);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
  };
  const Clock::time_point now = Clock::now();
  const double in_phase = std::chrono::duration<double>(now - phase_start_).count();
  constexpr double soon = 2.0;  // seconds after which an estimate means something
  const bool estimated = in_phase > soon && done_ > 0 && done_ < all_;
  const double left =
      in_phase * static_cast<double>(all_ - done_) / static_cast<double>(std::max<std::size_t>(1, done_));
  // Not fmt::print, which fails where a Ctrl-C interrupts it.
  const std::string line =
      fmt::format("\r\x1b[K[{}{}] {} {}/{}  {}{}", std::string(filled, '#'), std::string(width - filled, '.'),
                  printable(what), done_, all_, clock(std::chrono::duration<double>(now - start_).count()),
                  estimated ? fmt::format(", about {} left", clock(left)) : "");
  static_cast<void>(write_all(STDERR_FILENO, line));
  drawn_ = true;
}

int report_width(int otherwise) {
  constexpr int least = 80;  // a narrower table is not readable
  constexpr int most = 1000;
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    const char* columns = std::getenv("COLUMNS");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
    const int given = columns != nullptr ? std::atoi(columns) : 0;  // NOLINT(cert-err34-c): 0 where it is no number
    constexpr int least_given = 60;                                 // as --width
    return given > 0 ? std::clamp(given, least_given, most) : otherwise;
  }
  return size.ws_col < least ? least : size.ws_col;
}

}  // namespace trellis::command
