// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::command {

/// What the command line answers with. The last one is the shell's convention for a Ctrl-C.
enum Exit : int { success = 0, our_fault = 1, their_fault = 2, was_interrupted = 130 };

struct RunOptions {
  std::string script;
  std::string seeds;  ///< as typed, "" without
  std::string seed;
  std::string jobs;
  std::string json;     ///< a file, "" without
  std::string samples;  ///< a folder, "" without
  bool quiet = false;
};

// Each command returns the exit status, and throws Error for what the user can mend.

/// Runs a script's experiment, prints the report and writes the files that were asked for.
int run(const RunOptions& options);
/// Loads scripts without planning and prints their strategies as trees.
int check(const std::vector<std::string>& scripts);
/// Prints what is known about a word of the language; `usage` and all words where it is "".
int help(const std::string& topic, const std::string& usage);
int version();

}  // namespace trellis::command
