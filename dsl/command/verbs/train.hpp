// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <dsl/command/command_line.hpp>

namespace trellis::command {

/// The training of a heuristic on worlds drawn as images.
struct TrainOptions {
  std::string data;                   ///< a folder of families
  std::string out;                    ///< a file
  std::vector<std::string> families;  ///< none: all
  std::optional<std::uint64_t> seed;
  std::optional<std::uint64_t> samples;
  std::optional<std::uint64_t> cells;
  std::optional<std::uint64_t> rounds;
  bool search = false;  ///< a search heuristic instead of a classifier of cells
  bool quiet = false;
};

void add_training_options(Subcommand& verb, TrainOptions& options);

/// Trains a heuristic to imitate exact search, and prints how it does on the validation worlds. Returns the exit
/// status. \throws Error for missing and damaged worlds, and for options that do not belong together
int train(const TrainOptions& options);

}  // namespace trellis::command
