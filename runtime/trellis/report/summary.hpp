// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <trellis/measure/statistics.hpp>
#include <trellis/results/facts.hpp>
#include <trellis/results/quantities.hpp>

namespace trellis {

/// The statistics of one role over the runs of a group, each with its interval. Means use the estimates themselves;
/// means of divergences that fall below their bound, and their intervals, are clipped at the bound. A run without a
/// score does not enter the intervals; `scored` is the number of scored runs.
struct Figure {
  std::array<Interval, measure_quantities.size()> intervals = {};  ///< of each quantity that summaries have
  std::vector<Interval> profile;                                   ///< share of the samples in each part of the path
  std::vector<double> profile_target;                              ///< share of the target there
  double samples = std::numeric_limits<double>::quiet_NaN();       ///< N, median over the runs
  double in_target = std::numeric_limits<double>::quiet_NaN();     ///< n
  std::size_t scored = 0;                                          ///< runs with a value
  std::vector<std::string> reasons;                                ///< why other runs have none, without duplicates
  std::vector<std::string> estimators;                             ///< of those runs, without duplicates
  std::vector<std::pair<std::string, std::size_t>> flags;          ///< each raised flag, and its number of runs
  /// The comparison of the headline estimator with the first other one, if any: its name, and the paired difference.
  std::string check;
  Paired check_difference;

  /// Returns the interval of a quantity: figure["SE"].
  [[nodiscard]] Interval& operator[](MeasureIndex quantity) { return intervals.at(quantity.at()); }
  [[nodiscard]] const Interval& operator[](MeasureIndex quantity) const { return intervals.at(quantity.at()); }
};

/// Tree and expansion of a level, in one space.
struct FigurePair {
  Figure tree;
  Figure expansion;
};

/// The nats above uniform that the samples of the runs support: counting certifies the upper end, and the lower end
/// allows for what so many samples cannot show. Each end is the bound of Student's interval of the runs' ends, with
/// five runs or more, else their mean; with recorded densities in all runs it is Student's interval of their values.
/// NaN without any.
struct AboveUniform {
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
  bool exact = false;      ///< by recorded densities, without estimation
  std::string blank = {};  ///< why reports print none; "" where they do

  [[nodiscard]] bool printed() const { return blank.empty() && std::isfinite(lo); }
};
AboveUniform above_uniform(const Figure& figure);
AboveUniform above_uniform(const Efficiency& efficiency);

/// The other metrics of a level's search over the runs.
struct MetricsSummary {
  std::size_t measured = 0;         ///< runs with metrics
  std::array<Interval, 5> classes;  ///< share of the nodes of each NodeClass
  Interval components, coverage, connectivity;
  Interval information, information_per_sample;
  Interval invalid, trapped, redundant, useful;
};

/// The cost of one side of bounded loss: medians over the runs in which the level had a guide.
struct SpentSummary {
  double validity_checks = std::numeric_limits<double>::quiet_NaN();
  double proposals = std::numeric_limits<double>::quiet_NaN();
};

/// Why a level was solved again, over the runs of a group.
struct ResolvesSummary {
  Resolves total;             ///< sums over the runs
  std::size_t exhausted = 0;  ///< runs in which another search found no other path
  std::size_t limited = 0;    ///< runs in which its path was refuted at the limit of re-solves
};

/// The obstacles that rejected a level's proposals, over the runs (Rejections).
struct RejectionsSummary {
  std::size_t proposals = 0;  ///< of all runs
  std::size_t rejected = 0;
  std::size_t examined = 0;
  std::vector<std::pair<std::string, std::size_t>> by;  ///< the contacts, with their numbers, the most frequent first
};

/// A part of a guide that searches no space and so has no level, such as goal_bias(0.2).
struct PartSummary {
  std::string name;
  double share = 0.0;  ///< of its level's proposals, over all runs
};

/// The samples of a level of all seeds together, lifted to the root's space, on the paths of seeds left out.
struct PooledSummary {
  std::size_t seeds = 0;    ///< in the pool of a path
  std::size_t targets = 0;  ///< paths (of all problems, for a summary of several)
  Efficiency tree;
  Efficiency expansion;
};

/// One level of a hierarchy over the runs of a group. Medians are over all the runs that reached the level.
struct LevelSummary {
  std::string key;
  std::string name;
  int parent = -1;    ///< index into RunsSummary::levels
  std::string space;  ///< "" where it differs between the runs
  std::size_t dimension = 0;
  std::string planner;
  std::size_t runs = 0;    ///< runs that reached the level
  std::size_t solved = 0;  ///< runs whose level found its own path
  double resolves = std::numeric_limits<double>::quiet_NaN();
  ResolvesSummary resolved_for;
  double proposals = std::numeric_limits<double>::quiet_NaN();
  double nodes = std::numeric_limits<double>::quiet_NaN();
  double validity_checks = std::numeric_limits<double>::quiet_NaN();
  double motion_checks = std::numeric_limits<double>::quiet_NaN();
  double seconds = std::numeric_limits<double>::quiet_NaN();
  /// This level's share of the total cost of all levels and runs; the shares sum to 1 over the levels.
  double check_share = std::numeric_limits<double>::quiet_NaN();
  double time_share = std::numeric_limits<double>::quiet_NaN();
  bool guided = false;     ///< in some run
  SpentSummary by_guided;  ///< by guided proposals, including the validation of guiding paths
  SpentSummary by_unguided;
  SpentSummary by_below;  ///< by the levels that guide it
  FigurePair own;
  FigurePair root;
  FigurePair own_cross;
  FigurePair root_cross;
  std::optional<PooledSummary> pooled;
  FigurePair oracle;   ///< of the root level, on its own path: samples of T itself
  FigurePair uniform;  ///< and of uniform sampling
  FigurePair equal;    ///< of the root level: with as many samples as the strategy with the fewest
  MetricsSummary metrics;
  std::vector<PartSummary> parts;  ///< of its guide
  RejectionsSummary rejections;
};

/// The figure of a level that reports print first, in the root's space: of all seeds together where there are five or
/// more, else over the runs, on the paths of other seeds or, without those, on each run's own path.
struct Headline {
  AboveUniform above;
  double uniform = std::numeric_limits<double>::quiet_NaN();
  double perfect = std::numeric_limits<double>::quiet_NaN();
  /// -log of the share of the samples in the target, with the 5 % uniform ones.
  double mass = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> flags = {};
  std::size_t seeds = 0;  ///< of all seeds together: their number; 0: over the runs
  std::size_t runs = 0;   ///< scored ones
};
struct LevelSummary;
enum class SampleRole : std::uint8_t { tree, expansion };
Headline headline(const LevelSummary& level, SampleRole role);
/// Returns the same over the runs, also where `headline` is of all seeds together.
Headline over_runs(const LevelSummary& level, SampleRole role);
/// Returns hitting and the bottleneck of a level's samples, lifted to the root, with the intervals that reports print:
/// of all seeds together where there are several, else over the runs on each run's own path. NaN without any.
/// \param own  receives whether it is on each run's own path
Hitting hitting_of(const LevelSummary& level, SampleRole role, bool* own = nullptr);
/// Whether no value lies in both intervals; false where one of them is blank.
bool disagree(const AboveUniform& a, const AboveUniform& b);

/// The contribution of a level beyond the levels that guide it: the nats by which its samples, lifted to the root, are
/// nearer to the root's target than theirs. Negative: a loss. The values are the middles of the headlines' intervals,
/// the ends theirs; NaN where one is blank.
struct WaterfallStep {
  int level = 0;    ///< index into RunsSummary::levels
  int from = -1;    ///< the level that guides it; -1: uniform sampling
  Interval before;  ///< gain of that level, lifted; 0 for uniform sampling
  Interval after;   ///< gain of this level, lifted
  Interval added;   ///< their difference; between all values of the two
};
struct Waterfall {
  Interval uniform;                  ///< the start of the waterfall: the divergence of uniform sampling
  std::vector<WaterfallStep> steps;  ///< the deepest level first; one step from each of a level's guides
};

/// The runs of a guided strategy in which its planner ran beside the guided search, without guides.
struct BesideSummary {
  std::size_t runs = 0;
  double unguided_share = std::numeric_limits<double>::quiet_NaN();  ///< of the work; median
  std::size_t unguided_won = 0;                                      ///< runs whose path it found
  std::size_t not_set_up = 0;  ///< runs that it ended before the guides were set up
  std::size_t no_guided = 0;   ///< other runs in which the guides of the root drew no proposal
  RunCost largest_step;        ///< of all runs
  double certificate_checks = std::numeric_limits<double>::quiet_NaN();  ///< of the paths found; median
};

/// The certified paths of runs, and the one of the smallest clearance.
struct CertifiedSummary {
  std::size_t paths = 0;
  double clearance = std::numeric_limits<double>::quiet_NaN();  ///< m; infinite where nothing is near
  std::uint64_t seed = 0;                                       ///< of that path
};

/// The set-up of guides has a column in tables where it is more than this share of the work.
inline constexpr double least_set_up_share = 0.1;

/// The runs of one strategy on one problem, or on all problems together.
struct RunsSummary {
  std::size_t runs = 0;
  Interval success;  ///< Wilson
  std::size_t solved = 0;
  /// The cost of a path over all levels: medians over all runs, an unsolved one infinite, with 95 % intervals. Validity
  /// checks are those until the first path.
  Interval validity_checks;
  Interval motion_checks;
  Interval seconds;
  /// The cost of all runs, solved or not, over all levels: medians, as for the levels.
  double spent_validity_checks = std::numeric_limits<double>::quiet_NaN();
  double spent_motion_checks = std::numeric_limits<double>::quiet_NaN();
  double spent_seconds = std::numeric_limits<double>::quiet_NaN();
  /// Validity checks that an anytime planner spent on shorter paths after its first: the median over the solved runs;
  /// NaN for other planners.
  double improvement_checks = std::numeric_limits<double>::quiet_NaN();
  /// Work to set up the guides for a run alone (RunRecord::set_up): the median over the runs.
  double set_up = std::numeric_limits<double>::quiet_NaN();
  double set_up_share = 0.0;                                  ///< the same relative to the median work of a run
  double set_up_seconds = 0.0;                                ///< the longest of a run, with what it shares with others
  double queries = std::numeric_limits<double>::quiet_NaN();  ///< RunTotals::queries; NaN without guides
  double lua_share = 0.0;                                     ///< of the CPU time of all runs, in functions in Lua
  Interval length;                                            ///< mean over the solved runs, metres of the metric
  Interval makespan, sum_of_costs;   ///< of teams: means over the solved runs, seconds (TeamTimes)
  std::vector<LevelSummary> levels;  ///< depth first, the root first
  Waterfall tree_waterfall;
  Waterfall expansion_waterfall;
  BesideSummary beside;
  CertifiedSummary certified;
};

/// Two strategies on the same problem and seeds; differences are the second's minus the baseline's.
struct Comparison {
  std::string problem;  ///< "": all problems together
  std::string strategy;
  std::string baseline;
  std::string text;  ///< of an ablation: "without shrink(0.5)"
  Paired solved;     ///< 1 or 0; the difference of the shares has Newcombe's interval
  PairedCosts validity_checks;
  bool cross = false;  ///< efficiency on the paths of other seeds, else on each run's own path
  Paired tree_above;   ///< nats above uniform, of the root's nodes; more is better
  Paired expansion_above;
  Paired tree;  ///< SE of the root's nodes; less is better
  Paired expansion;
};

/// Parses a level's key, "0.1.10", into numbers, so that levels sort depth first and 10 comes after 9.
std::vector<std::uint64_t> parse_key(const std::string& key);

RunsSummary summarise(std::span<const RunFacts* const> runs);
RunsSummary summarise(const RunFacts& run);
/// The runs of a strategy on a problem or, with "", on all, with their samples of all seeds together and the obstacles
/// that rejected proposals.
RunsSummary summarise(const ExperimentFacts& experiment, const std::string& problem, const std::string& strategy);

/// Compares all strategies with the baseline (ablations with the complete strategy) on each problem or, if `together`,
/// on all problems together. The p values of a quantity are corrected over the returned comparisons.
std::vector<Comparison> compare(const ExperimentFacts& experiment, bool together);

/// Returns a sentence on the largest set-up that depends on the world, where it is more than `least_set_up_share`: its
/// cost, and the assumption by which runs share it. Else empty.
/// \param strategies  of one problem
std::string set_up_text(const std::vector<const RunsSummary*>& strategies);

/// Returns the names of levels in tables, as a tree: "0 root", "1 └ lazy()", "2   └ shrink(0.5)".
std::vector<std::string> level_labels(const std::vector<LevelSummary>& levels);

/// Returns a sentence on what the planner beside the guided search did: its share of the work, in how many runs it
/// found the path, and where the guides never drew. Empty where there was none.
std::string beside_text(const RunsSummary& summary);

}  // namespace trellis
