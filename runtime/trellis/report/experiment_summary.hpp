// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <trellis/report/answer.hpp>
#include <trellis/report/couplings.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/verdict.hpp>

namespace trellis {

/// The runs of a strategy on a problem or on all problems together.
struct StrategySummary {
  std::string strategy;
  RunsSummary runs;
  std::vector<Verdict> verdicts;      ///< on its levels; empty for an ablation
  std::vector<GuideVerdict> parts;    ///< on its guides without a level
  std::optional<WholeVerdict> whole;  ///< on all of its guides together
  /// Of an ablation: the verdict on the guide that it is without.
  std::optional<Verdict> left_out;
  std::string unsolved;                    ///< why runs found no path, "" where all did
  std::vector<CouplingSummary> couplings;  ///< of a guide that divides a team; none on all problems together
};

/// All strategies on a problem, or on all problems together.
struct ProblemSummary {
  std::string problem;                      ///< "": all problems together
  std::vector<StrategySummary> strategies;  ///< in the order of ExperimentSummary::strategies
  std::vector<Comparison> comparisons;
  std::vector<std::string> warnings;  ///< of guides that perform worse than none
  /// Why no run can find a path, or hardly one. Of the first problem with a strategy that solves fewer than half of its
  /// runs; "" for others and where nothing is known.
  std::string obstruction;
};

/// All that reports state of an experiment: computed once from its runs, which may be those of a document.
struct ExperimentSummary {
  using Strategy = StrategyFacts;
  std::string script;   ///< the path as given on the command line, "" for none
  std::string version;  ///< of the program that ran it
  std::vector<Strategy> strategies;
  std::vector<std::uint64_t> seeds;
  std::string baseline;   ///< the strategy that the others are compared with, "" for none
  double ablation = 0.0;  ///< Experiment::ablation
  bool spatial = false;   ///< whether the first problem's world has three dimensions
  bool measured = false;  ///< whether sampling efficiency was computed
  /// Of the measure: the target in words, the estimators with a value, a sentence that compares the guides' tubes with
  /// the target, and the values that are omitted to save time.
  std::string target;
  std::vector<std::string> estimators;
  std::string tubes;
  std::string omitted;
  std::vector<ProblemSummary> problems;
  std::optional<ProblemSummary> together;  ///< none for a single problem
  Answer answer;                           ///< what reports say first

  /// The problems that printed reports list: one by one up to `most_single_problems`, else all together.
  [[nodiscard]] std::vector<const ProblemSummary*> listed() const;
};

/// Summarises the runs of an experiment, or of a document.
ExperimentSummary summarise(const ExperimentFacts& experiment);

/// Returns why runs of a strategy found no path, a clause for each reason with the number of runs: "2 unsolved: 50000
/// proposals spent at level 0; shrink(0.8) reached its limit of 10 re-solves". "" where all were solved.
std::string unsolved_text(const std::vector<const RunFacts*>& runs);

/// Whether fewer than half of the runs found a path, or the only one did not.
bool mostly_unsolved(const RunsSummary& summary);

/// Returns the verdicts on a part of a level's guide that has no level itself.
/// \param level  index into RunsSummary::levels
std::vector<Verdict> verdicts_on(const StrategySummary& strategy, std::size_t level, const PartSummary& part);

/// Returns a sentence, with its evidence, for each strategy whose guide performs worse than no guide: it solves fewer
/// runs than an unguided baseline, beyond the interval, or its verdict is that it costs more validity checks, or its
/// root's nodes are less efficient than uniform samples, beyond the interval. Omits strategies with too few runs for an
/// interval.
std::vector<std::string> guide_warnings(const ExperimentFacts& experiment, const ProblemSummary& problem);

}  // namespace trellis
