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

  void show(std::size_t done, std::size_t all) { show("steps", done, all); }
  /// Shows a phase, "planning" or "scoring", with its own count, and an estimate of the time that it has left.
  void show(const std::string& phase, std::size_t done, std::size_t all);
  /// Shows the steps of an experiment as its two phases.
  /// \param cells  the number of its runs; further steps are their scoring
  void show_experiment(std::size_t done, std::size_t all, std::size_t cells);
  /// Shows the current activity beside the bar: "drawing trap".
  void show(const std::string& what);

 private:
  void draw(const std::string& what);

  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool drawn_ = false;
  std::size_t done_ = 0;
  std::size_t all_ = 0;
  std::string phase_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point phase_start_ = Clock::now();
};

/// Returns the width of the terminal at stdout in columns. If stdout is no terminal: the environment variable COLUMNS
/// if it is set, else `otherwise`.
int report_width(int otherwise);

}  // namespace trellis::command
