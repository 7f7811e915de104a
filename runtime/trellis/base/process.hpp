// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace trellis {

/// Another program to run.
struct Process {
  std::vector<std::string> words;        ///< its name, found as a shell finds it, or its path; then its arguments
  std::vector<std::string> environment;  ///< NAME=VALUE; none beside these
  std::string input = "/dev/null";       ///< the file that it reads
  std::size_t most_output = std::numeric_limits<std::size_t>::max();  ///< bytes after which it is killed
};

/// What a program printed, and how it ended.
struct ProcessEnd {
  int fault = 0;   ///< the system's error number where it was not started
  int status = 0;  ///< as of waitpid
  std::string output;
  std::string errors;
  bool too_long = false;  ///< whether it printed more than it may

  /// Whether it was started and ended by itself, without a fault.
  [[nodiscard]] bool succeeded() const;
  /// The status of its exit; -1 where it was not started, or a signal ended it.
  [[nodiscard]] int exit_status() const;
};

/// Runs a program and waits for its end.
ProcessEnd run_process(const Process& process);

}  // namespace trellis
