// SPDX-License-Identifier: GPL-3.0-or-later
// Decides which robots of a team need coordination: an experiment, the strategy with and without each coupling.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <trellis/report/verdict.hpp>
#include <trellis/results/facts.hpp>

namespace trellis {

/// Robots of a team that are coupled: two, that must not touch each other; one, which must not touch the others; all.
/// Runs in which they pass through each other decide whether they need coordination (Uncoupled).
struct CouplingSummary {
  std::vector<std::size_t> robots;  ///< their numbers; none: all
  /// The seeds whose paths touch where all robots pass through each other, of those that were run so.
  std::size_t conflicts = 0;
  std::size_t runs = 0;
  std::array<std::size_t, 5> resolved = {};  ///< conflicts in all runs, by what became of them (TeamConflict)
  std::uint64_t checks = 0;                  ///< of these conflicts
  /// The share of the seeds that are solved where the robots must not touch, and not where they pass through each
  /// other, among those that are solved at all where they must not touch; Wilson's interval. `n` is the latter's
  /// number.
  Interval needed;
  std::size_t pairs = 0;           ///< seeds with both runs
  std::size_t solved = 0;          ///< of these, with the coupling
  std::size_t solved_without = 0;  ///< of these, where the robots pass through each other
  /// The ratio of the validity checks with the coupling to those without it; a path that touches counts as none.
  MedianRatio check_ratio;
  /// Of a sequential test of solved seeds, a family with the couplings of as many robots: `pays` where coordination is
  /// needed, `costs` where more seeds are solved without it. It has no ratio.
  Verdict verdict;

  /// "robots 1, 2", "robot 3", "all robots".
  [[nodiscard]] std::string name() const;
};

/// "needed", "not needed" (in no seed), "mostly not needed", "hinders", "not shown (11 seeds); ~14 seeds would probably
/// show it", "not tested".
std::string coupling_text(const CouplingSummary& coupling);

/// Returns the couplings of a strategy on a problem: all robots, each robot, then the pairs; those that were not tested
/// because the robots need no coordination at all are left out. None for a strategy that divides no team.
std::vector<CouplingSummary> couplings_of(const ExperimentFacts& experiment, const std::string& problem,
                                          const std::string& strategy);

struct ExperimentSummary;

/// Returns the couplings of all strategies as a table in CSV, "" where there is none.
std::string couplings_csv(const ExperimentSummary& experiment);

}  // namespace trellis
