// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/measure/censored_cost.hpp>

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
    double checks = 0.0;   ///< validity checks, all levels
    double seconds = 0.0;  ///< CPU time; NaN where the document has none
  };
  std::vector<Problem> problems;
  std::vector<Strategy> strategies;
  std::vector<Run> runs;
  std::string baseline;  ///< the strategy that the first document names, "" for none

  /// Adds the runs of a document. Strategies of one name must be the same strategy. Throws Error, naming the file, for
  /// what is no such document and for a run that was added before.
  void add(const std::string& document, const std::string& file);
};

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
/// both_solved, median, reference_median, ratio_of_medians, ratio_of_totals, paired_ratio, lo, hi, sign_p, holm_p, effect.
std::string costs_csv(const CostData& data, const std::string& baseline);
/// Draws FOLDER/baseline, own_planner and parts as .svg, .png and .pdf: a dot for each problem and strategy. Throws
/// Error where a file cannot be written.
void write_cost_figures(const CostData& data, const std::string& baseline, const std::string& folder);

}  // namespace trellis
