// SPDX-License-Identifier: GPL-3.0-or-later
// Selects the best of several strategies by successive halving over seeds (Jamieson and Talwalkar 2016).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/censored_cost.hpp>

namespace trellis {

/// The cost that a tuning minimises.
enum class TuneBy : std::uint8_t {
  checks,  ///< validity checks, over all levels
  time,    ///< CPU time; the result depends on the machine
  length,  ///< the length of the path
};
/// "validity checks", "CPU time", "path length".
std::string_view to_string(TuneBy by);

struct TuneSettings {
  TuneBy by = TuneBy::checks;
  std::uint64_t budget = 0;  ///< the largest number of runs
  std::uint64_t seed = 1;    ///< the first of consecutive seeds
};

/// The result of a tuning for one strategy.
struct TunedStrategy {
  enum class End : std::uint8_t {
    best,      ///< the winner
    halved,    ///< in the worse half of a round
    rejected,  ///< in the better half, but a paired test shows that it costs more than the best of the round
  };
  End end = End::halved;
  std::size_t rounds = 0;  ///< in which it took part
  std::size_t seeds = 0;   ///< for each problem
  std::size_t runs = 0;
  std::size_t solved = 0;
  PairedCosts to_winner;  ///< on the common runs; `holm_p` is corrected over all strategies
  PairedCosts to_start;   ///< `start`: the experiment's first strategy
};

struct TuneResult {
  std::vector<TunedStrategy> strategies;  ///< in the order of the experiment
  std::size_t winner = 0;                 ///< index into `strategies`
  std::uint64_t runs = 0;                 ///< all runs, those on held-out seeds included
  std::vector<std::uint64_t> seeds;       ///< that strategies were selected on
  std::vector<std::uint64_t> held_out;    ///< for `evaluation`; none where the first strategy is the winner
  PairedCosts evaluation;                 ///< the winner and the first strategy
};

/// Runs all strategies on the first seeds. Each round ranks the strategies by the median of their paired ratios, to the
/// least cost of any strategy in the same problem and seed. It keeps the better half, without those that a paired test
/// rejects (sign test with Holm's correction, p < 0.05), and doubles the seeds. An unsolved run costs infinitely much.
/// The winner and the first strategy then run on new seeds. Ignores the experiment's seeds and measure. For `checks`
/// and `length` the result does not depend on options.jobs. \throws Error for fewer than two strategies and for a
/// budget that is too small (with the least one), Interrupted
TuneResult tune(const Experiment& experiment, const TuneSettings& settings, const ExperimentOptions& options = {});

/// Returns the least budget of an experiment with so many strategies and problems.
std::uint64_t least_tune_budget(std::size_t strategies, std::size_t problems);

}  // namespace trellis
