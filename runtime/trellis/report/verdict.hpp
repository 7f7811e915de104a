// SPDX-License-Identifier: GPL-3.0-or-later
// Which levels of a hierarchy pay, from what the runs show.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <trellis/report/summary.hpp>

namespace trellis {

/// What the runs show of a level that guides another.
struct Verdict {
  enum class Kind : std::uint8_t {
    none,          ///< the root, which guides nothing
    pays,          ///< the strategy costs more without it, or it brings samples nearer to the path and the whole pays
    costs,         ///< the strategy costs less without it, or it brings nothing and the whole costs more than none
    misleads,      ///< its samples lie in the target less often than uniform samples do
    not_shown,     ///< the runs show neither
    too_few_runs,  ///< so few runs could not show anything
  };
  Kind kind = Kind::none;
  /// What shows it: "checks", "mass" (how often a sample lies in the target) or "spread" (how evenly these cover it);
  /// "" where nothing is shown.
  std::string reason = {};
  /// The strategy without the level beside the whole one: validity checks, paired by seed. None without an ablation.
  std::optional<PairedCosts> left_out = {};
};

/// "pays", "costs", "misleads", "not shown", "too few runs to say", "" for the root.
std::string verdict_word(const Verdict& verdict);
/// "pays (checks)", "not shown", "" for the root.
std::string verdict_text(const Verdict& verdict);

/// The figures of a level's nodes on the root's target: on other seeds' paths where there are any, else on its own.
const Figure& lifted_figure(const LevelSummary& level);

/// Whether the estimate behind a figure is known to be wrong, or rests on too few samples, in at least half of its
/// runs. The mass is counted, and holds all the same.
bool estimate_fails(const Figure& figure);

/// For each level of a strategy, the costs of the strategy without it beside those of the whole one, seed by seed. The
/// strategy without a level is an ablation, or any strategy of the experiment that is the same: `skeleton() >> rrt()`
/// is `skeleton() >> lazy() >> rrt()` without `lazy()`. What guides the level stands in its place where something does,
/// else uniform sampling. None for the root, and where no such strategy was run. p values are corrected by Holm over
/// the levels.
std::vector<std::optional<PairedCosts>> costs_without_levels(const Experiment& experiment,
                                                             const ExperimentResult& result, const std::string& problem,
                                                             const std::string& strategy,
                                                             const std::vector<LevelSummary>& levels);

/// The verdict on each level of a strategy. The strategy without the level decides where it was run: a difference
/// counts at p < 0.05. Else the divergence decides: whether the level's samples, lifted to the root, lie nearer to the
/// target than those of the level that guides it, with 95 % intervals over the runs (in mass alone where the estimate
/// fails), and whether the strategy costs less than the baseline. \param without  of costs_without_levels(), one for
/// each level \param whole    the strategy beside the baseline; nullptr without one
std::vector<Verdict> verdicts(const RunsSummary& summary, const std::vector<std::optional<PairedCosts>>& without,
                              const PairedCosts* whole);

/// The verdicts on the levels of a strategy of an experiment, on a problem or, "", on all. None for an ablation.
/// \param summary      of the strategy's runs there
/// \param comparisons  those of compare() there
std::vector<Verdict> verdicts(const Experiment& experiment, const ExperimentResult& result, const std::string& problem,
                              const std::string& strategy, const RunsSummary& summary,
                              const std::vector<Comparison>& comparisons);

/// Whether a strategy of an experiment is another one with a guide taken out.
bool is_ablation(const Experiment& experiment, const std::string& strategy);

/// Whether a comparison of costs could show a difference at p < 0.05 at all, however lopsided its pairs were.
/// \param tests  p values that are corrected together
bool could_show(const PairedCosts& costs, std::size_t tests);

}  // namespace trellis
