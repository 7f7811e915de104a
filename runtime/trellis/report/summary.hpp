// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/censored_cost.hpp>
#include <trellis/measure/statistics.hpp>

namespace trellis {

/// The figures of one role over the runs of a group, each with its interval. Means are taken of the estimates as they
/// are; those of divergences that come out below what is possible, and their intervals, end at their bounds. A run that
/// was not scored leaves no trace in the intervals; `scored` says how many were.
struct Figure {
  Interval value;                                               ///< D_eps, the headline: SE, defended, nats
  Interval light_value;                                         ///< the same with 1 % uniform
  Interval undefended;                                          ///< D
  Interval gain;                                                ///< nats above uniform: uniform - SE
  Interval uniform;                                             ///< the divergence of uniform sampling
  Interval perfect;                                             ///< D_eps of samples of T itself
  Interval mass;                                                ///< -log Q(A)
  Interval spread;                                              ///< D - mass
  Interval mass_part, spread_part, along_part, across_part;     ///< of D_eps, by the chain rule
  Interval mass_lower95;                                        ///< its lower end
  Interval js;                                                  ///< Jensen-Shannon divergence
  Interval coverage;                                            ///< share of the target within delta of a sample
  Interval uniform_coverage;                                    ///< what as many uniform samples reach
  Interval coverage_half;                                       ///< within delta / 2
  Interval along;                                               ///< divergence of arc length
  Interval empty_share;                                         ///< share of the target in bins without a sample
  std::vector<Interval> profile;                                ///< share of the samples in each part of the path
  std::vector<double> profile_target;                           ///< share of the target there
  double samples = std::numeric_limits<double>::quiet_NaN();    ///< N, median over the runs
  double in_target = std::numeric_limits<double>::quiet_NaN();  ///< n
  Interval free_share;                                          ///< valid share of the tube
  std::size_t scored = 0;                                       ///< runs that have a value
  std::vector<std::string> reasons;                             ///< why others have none, each once
  std::vector<std::string> estimators;                          ///< of those runs, each once
  std::vector<std::pair<std::string, std::size_t>> flags;       ///< each flag raised, and in how many runs
  /// The headline estimator against the first one beside it, where there is one: its name, and the paired difference.
  std::string check;
  Paired check_difference;
};

/// Tree and expansion of a level, in one space.
struct FigurePair {
  Figure tree;
  Figure expansion;
};

/// The other measures of a level's search over the runs.
struct MetricsSummary {
  std::size_t measured = 0;         ///< runs that have them
  std::array<Interval, 5> classes;  ///< share of the nodes of each NodeClass
  Interval components, coverage, connectivity;
  Interval information, information_per_sample;
  Interval invalid, trapped, redundant, useful;
};

/// What one side of bounded loss spent: medians over the runs in which the level had a guide.
struct SpentSummary {
  double validity_checks = std::numeric_limits<double>::quiet_NaN();
  double proposals = std::numeric_limits<double>::quiet_NaN();
};

/// Why a level was solved again, over the runs of a group.
struct ResolvesSummary {
  Resolves total;             ///< sums over the runs
  std::size_t exhausted = 0;  ///< runs in which a further search found no other path
  std::size_t limited = 0;    ///< runs in which its path was refuted and it might not be solved again
};

/// One level of a hierarchy over the runs of a group. Medians are over all the runs that reached the level.
struct LevelSummary {
  std::string key;
  std::string name;
  int parent = -1;    ///< index into RunsSummary::levels
  std::string space;  ///< "" where it differs between the runs
  std::size_t dimension = 0;
  std::string planner;
  std::size_t runs = 0;    ///< that reached the level
  std::size_t solved = 0;  ///< whose level found a path of its own
  double resolves = std::numeric_limits<double>::quiet_NaN();
  ResolvesSummary resolved_for;
  double proposals = std::numeric_limits<double>::quiet_NaN();
  double nodes = std::numeric_limits<double>::quiet_NaN();
  double validity_checks = std::numeric_limits<double>::quiet_NaN();
  double motion_checks = std::numeric_limits<double>::quiet_NaN();
  double seconds = std::numeric_limits<double>::quiet_NaN();
  /// Of what all runs spent in all levels, the part of this one: shares of totals, which sum to 1 over the levels.
  double check_share = std::numeric_limits<double>::quiet_NaN();
  double time_share = std::numeric_limits<double>::quiet_NaN();
  bool guided = false;     ///< in some run
  SpentSummary by_guided;  ///< by guided proposals, the validation of guiding paths included
  SpentSummary by_unguided;
  SpentSummary by_below;  ///< by the levels that guide it
  FigurePair own;
  FigurePair root;
  FigurePair own_cross;
  FigurePair root_cross;
  FigurePair oracle;   ///< of the root level, on its own path: samples of T itself
  FigurePair uniform;  ///< and of uniform sampling
  FigurePair equal;    ///< of the root level: with as many samples as the strategy with the fewest
  MetricsSummary metrics;
};

/// What a level added to what the levels that guide it knew: the nats that its samples, lifted to the root, lie nearer
/// to the root's target than theirs. Negative: it lost some.
struct WaterfallStep {
  int level = 0;    ///< index into RunsSummary::levels
  int from = -1;    ///< the level that guides it; -1: none, so uniform sampling
  Interval before;  ///< gain of that level, lifted; 0 for uniform sampling
  Interval after;   ///< gain of this level, lifted
  Interval added;   ///< their difference, paired by run
};
struct Waterfall {
  Interval uniform;                  ///< where it begins
  std::vector<WaterfallStep> steps;  ///< the deepest level first; a level with several guides has a step from each
};

/// The runs of one strategy on one problem, or on all problems taken together.
struct RunsSummary {
  std::size_t runs = 0;
  Interval success;  ///< Wilson
  std::size_t solved = 0;
  /// What a path costs, all levels together: medians over all runs, an unsolved one infinite, with 99 % intervals.
  Interval validity_checks;
  Interval motion_checks;
  Interval seconds;
  /// What all runs spent, solved or not, all levels together: medians, as those of the levels are.
  double spent_validity_checks = std::numeric_limits<double>::quiet_NaN();
  double spent_motion_checks = std::numeric_limits<double>::quiet_NaN();
  double spent_seconds = std::numeric_limits<double>::quiet_NaN();
  Interval length;                   ///< mean over the solved runs, metres of the metric
  std::vector<LevelSummary> levels;  ///< depth first, the root first
  Waterfall tree_waterfall;
  Waterfall expansion_waterfall;
};

/// Two strategies on the same problem and seeds; differences are the second's less the baseline's.
struct Comparison {
  std::string problem;  ///< "": all problems taken together
  std::string strategy;
  std::string baseline;
  std::string text;  ///< of an ablation: "without shrink(0.5)"
  Paired solved;     ///< 1 or 0; the difference of the shares has Newcombe's interval
  PairedCosts validity_checks;
  bool cross = false;  ///< efficiency on the paths of other seeds, else on each run's own
  Paired tree_above;   ///< nats above uniform, of the root's nodes; more is better
  Paired expansion_above;
  Paired tree;  ///< SE of the root's nodes; less is better
  Paired expansion;
};

/// A level's key, "0.1.10", as numbers, so that levels sort depth first and 10 comes after 9.
std::vector<std::uint64_t> parse_key(const std::string& key);

RunsSummary summarise(std::span<const RunResult* const> runs);

/// All strategies against the baseline (ablations against the whole strategy), on a problem or, "", on all. p values of
/// a quantity are corrected over the comparisons that are shown together: those of all problems one by one, or those on
/// all problems taken together.
std::vector<Comparison> compare(const Experiment& experiment, const ExperimentResult& result,
                                const std::string& problem);

/// What levels are called in tables, as a tree: "0 root", "1 └ lazy()", "2   └ shrink(0.5)".
std::vector<std::string> level_labels(const std::vector<LevelSummary>& levels);

/// A sentence for each strategy whose guide does worse than none on a problem (or, "", on all), with what shows it: it
/// solves fewer runs or costs more validity checks than an unguided baseline, or its root's nodes lie below uniform
/// samples, beyond the interval in each case. Strategies with too few runs for an interval have none.
/// \param comparisons  those of compare() on the same problem
std::vector<std::string> guide_warnings(const Experiment& experiment, const ExperimentResult& result,
                                        const std::string& problem, const std::vector<Comparison>& comparisons);
std::vector<std::string> guide_warnings(const Experiment& experiment, const ExperimentResult& result,
                                        const std::string& problem);

/// The runs of a strategy on a problem, in the order of the result; an empty `problem`: on all of them.
std::vector<const RunResult*> select_runs(const ExperimentResult& result, const std::string& problem,
                                          const std::string& strategy);

}  // namespace trellis
