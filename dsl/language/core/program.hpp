// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/tuning.hpp>
#include <trellis/trial/trial.hpp>

namespace trellis::dsl {

/// A function of a script that was never called.
struct Uncalled {
  std::string function;  ///< "script.lua:3: 'observe' of the guiding space 'half'"
  bool guides = false;   ///< of a guide; else of a target
};

/// The result of a script.
struct Program {
  Experiment experiment;
  std::uint64_t seed = 1;  ///< the first of consecutive seeds
  /// Of a tuning, whose strategies are the experiment's; the first one is the start.
  std::optional<TuneSettings> tuning = {};
  /// Call it after the experiment: returns the functions of the script that were never called.
  std::function<std::vector<Uncalled>()> uncalled;
  /// Parts of the script that do something else than they seem to, with their lines.
  std::vector<std::string> warnings;
};

/// Experiment::ablation of scripts that do not set it.
inline constexpr double default_ablation = 2.0;
inline constexpr std::uint64_t most_seeds = trial::most_seeds;
/// Lua's largest integer.
inline constexpr auto largest_seed = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

/// Returns `count` consecutive seeds from `first`. \throws Error for none, too many, or seeds that a script cannot
/// write (over 2^63 - 1).
std::vector<std::uint64_t> consecutive_seeds(std::uint64_t first, std::uint64_t count);

/// Replaces the seeds by consecutive ones: `count` of them (none: the same number) from `first` (none: the program's
/// own). Without either the program does not change.
void override_seeds(Program& program, std::optional<std::uint64_t> count, std::optional<std::uint64_t> first);

/// Adds, for every strategy with a guide, copies with one guide removed; skips strategies that already have ablations.
/// `what` names the requester in messages. \throws Error if no strategy has a guide.
void ablate_all(Experiment& experiment, const std::string& what);

}  // namespace trellis::dsl
