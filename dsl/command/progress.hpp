// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace trellis::command {

/// A progress bar on stderr if that is a terminal; otherwise prints nothing. The destructor erases it.
class Progress {
 public:
  explicit Progress(bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::size_t done, std::size_t all);
  /// Shows the current activity beside the bar: "drawing trap".
  void show(const std::string& what);

 private:
  void draw(const std::string& what);

  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool drawn_ = false;
  std::size_t done_ = 0;
  std::size_t all_ = 0;
  Clock::time_point start_ = Clock::now();
};

/// Returns the width of the terminal at stdout in columns, `otherwise` if stdout is no terminal.
int report_width(int otherwise);

}  // namespace trellis::command
