// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/censored_cost.hpp>
#include <trellis/report/pictures.hpp>
#include <trellis/strategy/executor.hpp>

/// What strategies cost beside one another: validity checks of all levels and CPU time, seed by seed, from the
/// documents that `trellis run --json` writes.
namespace trellis {

/// The costs of the runs of one or several documents.
struct CostData {
  struct Problem {
    std::string name;
    std::string group;   ///< "": in none
    bool tuned = false;  ///< the strategies were tuned on its group
  };
  struct Strategy {
    std::string name;
    std::string text;  ///< in the language
  };
  struct Run {
    std::size_t problem = 0;   ///< index into `problems`
    std::size_t strategy = 0;  ///< index into `strategies`
    std::uint64_t seed = 0;
    bool solved = false;
    double checks = 0.0;                         ///< validity checks, all levels
    double seconds = 0.0;                        ///< CPU time; NaN where the document has none
    std::vector<Improvement> improvements = {};  ///< the paths that it found, each shorter than those before
  };
  std::vector<Problem> problems;
  std::vector<Strategy> strategies;
  std::vector<Run> runs;
  std::string baseline;  ///< the strategy that the first document names, "" for none

  /// Adds the runs of a document. Strategies of one name must be the same strategy. Throws Error, naming the file, for
  /// what is no such document and for a run that was added before.
  void add(const std::string& document, const std::string& file);
  /// The runs on one problem, which is then the only one.
  [[nodiscard]] CostData on(std::size_t problem) const;
};

/// The costs of an experiment's runs; ablations are left out.
CostData cost_data(const Experiment& experiment, const ExperimentResult& result);

/// A cost that figures have on their axis.
enum class CostKind : std::uint8_t { checks, seconds };

/// The share of the runs of a strategy that found a path at no more than a cost, over the costs.
struct SuccessCurve {
  std::size_t runs = 0;
  std::vector<double> at;       ///< costs of the solved runs, ascending, each once
  std::vector<Interval> share;  ///< from each of them on, with its 95 % interval (Wilson)
  double spent = 0.0;           ///< the most that a run spent, solved or not
};
SuccessCurve success_curve(const CostData& data, std::size_t problem, std::size_t strategy, CostKind kind);

/// The length of the shortest path known, over the costs: the median over the runs, a run without a path infinite.
struct LengthCurve {
  std::size_t runs = 0;
  bool improves = false;         ///< some run found a second path
  std::vector<double> at;        ///< costs at which some run found a path, ascending; at most 200 of them
  std::vector<Interval> length;  ///< from each of them on, with its 99 % interval by order statistics
  double spent = 0.0;            ///< the most that a run spent
};
LengthCurve length_curve(const CostData& data, std::size_t problem, std::size_t strategy, CostKind kind);

/// What a strategy is compared with, problem by problem.
enum class CostReference : std::uint8_t {
  baseline,     ///< one strategy for all
  own_planner,  ///< the strategy's planner without its guides
  best_part,    ///< of `a >> b >> planner`: `a >> planner` or `b >> planner`, whichever costs less there
};

/// One quantity of a strategy beside that of its reference, on the seeds that both have.
struct CostRatio : PairedCosts {
  std::string reference;  ///< the strategy's name
};

/// A strategy on a problem beside its reference.
struct CostComparison {
  std::size_t problem = 0;   ///< index into CostData::problems
  std::size_t strategy = 0;  ///< index into CostData::strategies
  std::size_t runs = 0;
  std::size_t solved = 0;
  CostRatio checks;
  CostRatio seconds;
};

/// The levels of a strategy's text from the first guide to the planner: what '>>' joins outside of brackets.
std::vector<std::string> cost_levels(const std::string& text);

/// By problem, then strategy; without those that have no such reference among the strategies, and without the
/// reference. `holm_p` is corrected over all of them, quantity by quantity. Throws Error where no strategy is called
/// `baseline`.
std::vector<CostComparison> compare_costs(const CostData& data, CostReference reference, const std::string& baseline);

/// Over the problems of one kind, a strategy's ratios.
struct CostSummary {
  std::size_t problems = 0;
  std::size_t runs = 0;
  std::size_t solved = 0;
  double median = std::numeric_limits<double>::quiet_NaN();  ///< over the problems, of the median ratio
  double worst = std::numeric_limits<double>::quiet_NaN();
  std::string worst_problem;
};
/// \param tuned  true: over the problems that the strategies were tuned on; false: those held out; none: all
CostSummary summarise_costs(const CostData& data, const std::vector<CostComparison>& comparisons, std::size_t strategy,
                            CostRatio CostComparison::*quantity, std::optional<bool> tuned = {});

/// For a terminal: each strategy over all problems.
std::string costs_text(const CostData& data, const std::string& baseline, std::size_t width);
/// All of it, in Markdown. From "## Every figure" on a row stands for each problem and strategy.
std::string costs_markdown(const CostData& data, const std::string& baseline);
/// One figure a line: group, tuned, problem, strategy, against, reference, quantity, runs, solved, reference_solved,
/// both_solved, median, reference_median, ratio_of_medians, ratio_of_totals, paired_ratio, lo, hi, sign_p, holm_p,
/// effect.
std::string costs_csv(const CostData& data, const std::string& baseline);
/// A strategy's colour in all figures that compare strategies, and on the page. The baseline has its own.
draw::Colour strategy_colour(const CostData& data, const std::string& baseline, std::size_t strategy);

/// Runs that found a path over what they cost, a curve for each strategy with its band: checks and CPU time side by
/// side, rows of at most six strategies and the baseline. None where no run found a path.
std::optional<draw::Figure> success_figure(const CostData& data, const std::string& baseline, std::size_t problem);
/// The length of the path over time and checks, of the strategies that improve their path; none without one.
std::optional<draw::Figure> length_figure(const CostData& data, const std::string& baseline, std::size_t problem);
/// The strategies' costs beside the baseline's, paired by seed, a dot with its interval for each problem. None for a
/// strategy alone, and without a baseline.
std::optional<draw::RatioFigure> ratio_figure(const CostData& data, const std::string& baseline);

/// Draws FOLDER/baseline, own_planner and parts as .svg, .png and .pdf: a dot for each problem and strategy; and for
/// each problem FOLDER/PROBLEM/success and length. Throws Error where a file cannot be written.
void write_cost_figures(const CostData& data, const std::string& baseline, const std::string& folder,
                        const FigureStyle& style = {});
/// Draws success and length of each problem, and ratios of each problem and, where there are several, of all.
void write_comparison_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& folder,
                              const FigureStyle& style = {});

}  // namespace trellis
