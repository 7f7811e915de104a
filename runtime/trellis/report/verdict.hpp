// SPDX-License-Identifier: GPL-3.0-or-later
// Decides from the runs which levels of a hierarchy reduce the cost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <trellis/report/summary.hpp>

namespace trellis {

/// The verdict of the runs on a level that guides another.
struct Verdict {
  enum class Kind : std::uint8_t {
    none,      ///< the root, which guides nothing
    pays,      ///< without it the strategy costs more; or it moves samples nearer to the path and the complete strategy
               ///< pays
    costs,     ///< without it the strategy costs less; or it moves no samples and the complete strategy costs more than
               ///< the baseline
    misleads,  ///< its samples lie in the target less often than uniform samples
    not_shown,     ///< the runs show neither
    too_few_runs,  ///< too few runs for any result to be significant
  };
  Kind kind = Kind::none;
  /// The evidence: "checks", "mass" (the share of samples in the target) or "spread" (how evenly these cover it); ""
  /// without evidence.
  std::string reason = {};
  /// Validity checks of the strategy without the level and of the complete one, paired by seed. None without an
  /// ablation.
  std::optional<PairedCosts> left_out = {};
};

/// "pays", "costs", "misleads", "not shown", "too few runs to say", "" for the root.
std::string verdict_word(const Verdict& verdict);
/// "pays (checks)", "not shown", "" for the root.
std::string verdict_text(const Verdict& verdict);

/// Returns the statistics of a level's nodes on the root's target: on other seeds' paths where there are any, else on
/// its own.
const Figure& lifted_figure(const LevelSummary& level);

/// Whether, in at least half of its runs, the estimate is certainly wrong or has too few samples. The mass is a count
/// and remains valid.
bool estimate_fails(const Figure& figure);

/// Returns, for each level of a strategy, the costs of the strategy without it and of the complete one, paired by seed.
/// The strategy without a level is an ablation, or any equal strategy of the experiment: `skeleton() >> rrt()` is
/// `skeleton() >> lazy() >> rrt()` without `lazy()`. The level's own guides replace it if it has any, else uniform
/// sampling. None for the root, and where no such strategy was run. Holm's correction applies to the p values over the
/// levels.
std::vector<std::optional<PairedCosts>> costs_without_levels(const Experiment& experiment,
                                                             const ExperimentResult& result, const std::string& problem,
                                                             const std::string& strategy,
                                                             const std::vector<LevelSummary>& levels);

/// Returns the verdict on each level of a strategy. If the strategy without the level was run, it decides: a difference
/// counts at p < 0.05. Else the divergence decides: whether the level's samples, lifted to the root, are nearer to the
/// target than those of the level that guides it, with 95 % intervals over the runs (in mass only where the estimate
/// fails), and whether the strategy costs less than the baseline.
/// \param without  of costs_without_levels(), one for each level
/// \param whole    the comparison of the strategy with the baseline; nullptr without one
std::vector<Verdict> verdicts(const RunsSummary& summary, const std::vector<std::optional<PairedCosts>>& without,
                              const PairedCosts* whole);

/// Returns the verdicts on the levels of a strategy of an experiment, on a problem or, with "", on all. None for an
/// ablation.
/// \param summary      of the strategy's runs there
/// \param comparisons  those of compare() there
std::vector<Verdict> verdicts(const Experiment& experiment, const ExperimentResult& result, const std::string& problem,
                              const std::string& strategy, const RunsSummary& summary,
                              const std::vector<Comparison>& comparisons);

/// Whether a strategy of an experiment is an ablation of another one.
bool is_ablation(const Experiment& experiment, const std::string& strategy);

/// Whether a comparison of costs can show a difference at p < 0.05 at all, for the most uneven split of its pairs.
/// \param tests  number of p values under one correction
bool could_show(const PairedCosts& costs, std::size_t tests);

}  // namespace trellis
