// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>

namespace trellis::command {

/// A progress bar on stderr, where that is a terminal; nothing elsewhere. Gone when the object goes.
class Progress {
 public:
  explicit Progress(bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::size_t done, std::size_t all);

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
};

/// The columns of the terminal that stdout is, `otherwise` where it is none.
int report_width(int otherwise);

}  // namespace trellis::command
