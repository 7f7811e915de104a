// SPDX-License-Identifier: GPL-3.0-or-later
// Decides whether a guide pays: an experiment, the strategy with and without it on the same seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <trellis/report/summary.hpp>

namespace trellis {

/// The verdict on a guide of a strategy.
struct Verdict {
  enum class Kind : std::uint8_t {
    none,        ///< there is no guide to test: the root, a half of a split search, a level of an ablation
    pays,        ///< the strategy costs less than without it
    costs,       ///< the strategy costs more than without it
    not_shown,   ///< the runs show neither
    not_tested,  ///< the strategy was not run without it
  };
  Kind kind = Kind::none;
  /// Validity checks until the first path of the complete strategy and of the one without the guide, paired by seed:
  /// the ratio is below 1 where the guide pays. `holm_p` is corrected over all verdicts of a report. None without such
  /// runs.
  std::optional<PairedCosts> costs = {};
  /// Of a verdict that is not shown: the pairs with which the observed difference would be shown with a probability of
  /// 80 %; 0 where that takes more than `most_pairs`.
  std::size_t pairs_needed = 0;
  bool together = false;  ///< the pairs are those of several problems
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

/// "0.31", "1.6"; "0" where most runs without the guide found no path, "inf" where most runs with it found none.
std::string ratio_word(double ratio);
/// "pays", "costs", "not shown", "not tested"; "" for none.
std::string verdict_word(const Verdict& verdict);
/// "pays ×0.31 [0.25, 0.40] (mass)", "costs ×1.6", "not shown (15 seeds; ~40 would show it)".
std::string verdict_text(const Verdict& verdict);

/// Returns the verdicts on all guides of all strategies that are no ablations: on each problem, or on all together. A
/// difference counts at p < 0.05 in the sign test with Holm's correction over all these verdicts. The runs without a
/// guide are those of a strategy of the experiment that searches so, or of ExperimentFacts::left_out. The guide's own
/// guides take its place.
std::vector<GuideVerdict> guide_verdicts(const ExperimentFacts& experiment, bool together);

/// Returns the verdicts on the levels of a strategy, with the reasons; none for an ablation.
/// \param found  the verdicts of a report
std::vector<Verdict> level_verdicts(const std::vector<GuideVerdict>& found, const std::string& problem,
                                    const std::string& strategy, const RunsSummary& summary);

/// Returns the verdicts on the guides of a strategy that have no level, such as goal_bias().
std::vector<GuideVerdict> part_verdicts(const std::vector<GuideVerdict>& found, const std::string& problem,
                                        const std::string& strategy, const RunsSummary& summary);

/// The verdict from costs with and without a guide.
/// \param costs  with Holm's p value
/// \param tests  number of verdicts that the p value is corrected for
Verdict verdict_of(const PairedCosts& costs, std::size_t tests);

inline constexpr std::size_t most_pairs = 1000;
/// Returns the number of pairs with which a sign test at 5 %, corrected for `tests` tests, shows a difference with a
/// probability of 80 %, if it is as large as in these pairs (Laplace's estimate, ties in proportion); at least one more
/// than there are. 0: more than `most_pairs`.
std::size_t pairs_needed(const PairedCosts& costs, std::size_t tests);

/// Returns the statistics of a level's nodes on the root's target: on other seeds' paths where there are any, else on
/// its own.
const Figure& lifted_figure(const LevelSummary& level);

/// Whether, in at least half of its runs, the estimate is certainly wrong or has too few samples. The mass is a count
/// and remains valid.
bool estimate_fails(const Figure& figure);

}  // namespace trellis
