// SPDX-License-Identifier: GPL-3.0-or-later
// Decides whether a guide pays: an experiment, the strategy with and without it on the same seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <trellis/measure/sequential_test.hpp>
#include <trellis/report/summary.hpp>

namespace trellis {

/// The verdict on a part of a strategy: its guide, all of its guides, a coupling of robots.
struct Verdict {
  enum class Kind : std::uint8_t {
    none,             ///< there is nothing to test: the root, a half of a split search, a level of an ablation
    pays,             ///< the strategy costs less with the part
    costs,            ///< the strategy costs more with it
    no_difference,    ///< the ratio is between 1 / least_difference and least_difference
    changes_nothing,  ///< the same, and each run costs as much as the one without
    not_shown,        ///< the runs show neither
    not_tested,       ///< the strategy was not run without the part
    never_set_up,     ///< the planner solved the problem in all runs before the guides were set up
  };
  Kind kind = Kind::none;
  /// Of the costs with the part to those without it: validity checks until the first path, paired by seed.
  PairCounts counts;
  MedianRatio ratio;
  std::size_t tests = 0;  ///< of its family: all parts of the strategy on the problem that were tested
  /// Of a verdict that is not shown: the pairs with which it would probably be shown (forecast_pairs); 0: unknown.
  std::size_t pairs_needed = 0;
  double more_ablation = 0.0;  ///< the budget was spent: the next Experiment::ablation to try; 0: it was not
  std::size_t runs = 0;        ///< of guides that were never set up: the runs of the strategy
  bool unsolved = false;       ///< the strategy found no path in any run of the experiment
  bool together = false;       ///< the pairs are those of several problems
  /// What of the divergence explains a verdict that is shown: "mass" (the share of samples in the target) or "spread"
  /// (how evenly these cover it); "" where neither does.
  std::string reason = {};
};

/// The verdict on one guide on a problem or, with "", on all of them.
struct GuideVerdict {
  std::string problem;
  std::string strategy;
  std::string key;    ///< Ablation::key
  std::string guide;  ///< Ablation::guide
  Verdict verdict;
};

/// The verdict on all guides of a strategy together, against a strategy of the experiment without guides. It is a test
/// of its own, at 5 %.
struct WholeVerdict {
  std::string reference;
  Verdict verdict;
};

/// "0.31", "1.03", "1.6", "120", "inf".
std::string ratio_word(double ratio);
/// "0.31"; of a bracket "0.05 or less", "3 or more".
std::string median_word(const RatioBracket& median);
/// "pays", "costs", "no difference", "changes nothing", "not shown", "not tested", "never set up"; "" for none.
std::string verdict_word(const Verdict& verdict);
/// "pays ×0.31 [0.25, 0.40] (8 seeds; mass)", "no difference above ×1.25 [0.95, 1.1] (8 seeds)", "not shown [0.71, 1.1]
/// (39 seeds); ~80 seeds would probably show it".
std::string verdict_text(const Verdict& verdict);
/// The same for a row that is the strategy without the part, with the inverse ratio: "8.4 [3.4, 14] keep it".
std::string verdict_text_without(const Verdict& verdict);

/// The confidence in all verdicts of a report, in a sentence.
std::string verdicts_note();

/// Returns the verdicts on all guides of all strategies that are no ablations: on each problem, or on all together. The
/// runs without a guide are those of a strategy of the experiment that searches so, and those of
/// ExperimentFacts::left_out. The guide's own guides take its place. The guides of a strategy on a problem are a family
/// of sequential tests, see `decide`; on all problems together their pairs are counted together.
std::vector<GuideVerdict> guide_verdicts(const ExperimentFacts& experiment, bool together);

/// Returns 1 / ratio; 0 becomes infinity.
RatioBracket inverse(const RatioBracket& ratio);

/// Returns the costs of a strategy and of another one of the experiment on a problem, by seed.
std::vector<TestedPair> pairs_of_runs(const ExperimentFacts& experiment, const std::string& problem,
                                      const std::string& strategy, const std::string& reference);
/// Returns the costs of a strategy with and without a guide on a problem: those of runs of the experiment, then the
/// others. None where no run sets up the guides.
std::vector<TestedPair> pairs_of_guide(const ExperimentFacts& experiment, const std::string& problem,
                                       const std::string& strategy, const GuideFacts& guide);

/// Returns the verdict on a strategy against another one on a problem or, with "", on all problems together. It is a
/// test of its own, at 5 %. None without pairs of runs.
std::optional<Verdict> strategy_verdict(const ExperimentFacts& experiment, const std::string& problem,
                                        const std::string& strategy, const std::string& reference);

/// Returns the verdict on all guides of a strategy on a problem or, with "", on all: against its planner alone, else
/// the baseline, where one of these is a strategy of the experiment without guides. None with fewer than two guides.
std::optional<WholeVerdict> whole_verdict(const ExperimentFacts& experiment, const std::string& problem,
                                          const std::string& strategy);

/// Returns the verdicts on the levels of a strategy, with the reasons; none for an ablation.
/// \param found  the verdicts of a report
std::vector<Verdict> level_verdicts(const std::vector<GuideVerdict>& found, const std::string& problem,
                                    const std::string& strategy, const RunsSummary& summary);

/// Returns the verdicts on the guides of a strategy that have no level, such as goal_bias().
std::vector<GuideVerdict> part_verdicts(const std::vector<GuideVerdict>& found, const std::string& problem,
                                        const std::string& strategy, const RunsSummary& summary);

/// Returns the verdict of a test.
/// \param ratios  of its pairs
/// \param tests   number of tests of its family, and of those without a direction
Verdict verdict_of(SequentialDecision decision, std::span<const RatioBracket> ratios, std::size_t tests,
                   std::size_t undecided);

/// Returns the statistics of a level's nodes on the root's target: on other seeds' paths where there are any, else on
/// its own.
const Figure& lifted_figure(const LevelSummary& level);

/// Whether, in at least half of its runs, the estimate is certainly wrong or has too few samples. The mass is a count
/// and remains valid.
bool estimate_fails(const Figure& figure);

}  // namespace trellis
