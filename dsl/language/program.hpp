// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/trial/trial.hpp>

namespace trellis::dsl {

/// A function that a script gave and nobody called.
struct Uncalled {
  std::string function;  ///< "script.lua:3: 'observe' of the guiding space 'half'"
  bool guides = false;   ///< of a guide; else of a target
};

/// What a script returns.
struct Program {
  Experiment experiment;
  std::uint64_t seed = 1;  ///< the first of consecutive seeds
  /// Asked after the experiment was run: what the script gave that nobody called.
  std::function<std::vector<Uncalled>()> uncalled;
};

inline constexpr std::uint64_t most_seeds = trial::most_seeds;
/// Lua's largest integer.
inline constexpr auto largest_seed = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

/// `count` consecutive seeds from `first`. Throws Error for none, too many, or seeds that a script cannot write (over
/// 2^63 - 1).
std::vector<std::uint64_t> consecutive_seeds(std::uint64_t first, std::uint64_t count);

/// Replaces the seeds by consecutive ones: `count` of them (none: as many as there are) from `first` (none: the
/// program's own). Without either the program stays as it is.
void override_seeds(Program& program, std::optional<std::uint64_t> count, std::optional<std::uint64_t> first);

/// Adds every strategy that has a guide with each guide taken out in turn, but for those to which that was done. `what`
/// asked for it: throws Error where no strategy has a guide.
void ablate_all(Experiment& experiment, const std::string& what);

}  // namespace trellis::dsl
