// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/report/experiment_summary.hpp>

/// Compares the costs of strategies: validity checks of all levels until the first path, and CPU time, paired by seed,
/// from the documents of `trellis run --json`.
namespace trellis {

/// The costs of the runs of one or several documents.
struct CostData {
  struct Problem {
    std::string name;
    std::string group;   ///< "": no group
    bool tuned = false;  ///< the strategies were tuned on its group
  };
  struct Strategy {
    std::string name;
    std::string text;  ///< in the syntax of a script
    bool ablation = false;
  };
  struct Run {
    std::size_t problem = 0;   ///< index into `problems`
    std::size_t strategy = 0;  ///< index into `strategies`
    std::uint64_t seed = 0;
    bool solved = false;
    double checks = 0.0;              ///< validity checks, all levels
    double seconds = 0.0;             ///< CPU time; NaN where the document has none
    double first_seconds = 0.0;       ///< likewise, until the first path
    double improvement_checks = 0.0;  ///< part of `checks`: of an anytime planner, after its first path
  };
  /// Nats above uniform of the root's samples, the means over a strategy's runs on a problem.
  struct Nats {
    std::size_t problem = 0;   ///< index into `problems`
    std::size_t strategy = 0;  ///< index into `strategies`
    bool proposals = false;    ///< of its proposals, else of its nodes
    bool cross = false;        ///< on the paths of other seeds, else on each run's own
    std::size_t runs = 0;      ///< that have a figure
    double mass = 0.0;         ///< by mass; mass + spread = above
    double spread = 0.0;       ///< by spread
    double above = 0.0;        ///< uniform - SE
    /// Hitting by position; of all seeds together where they are scored on the paths of other seeds.
    double hitting = std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<Problem> problems;
  std::vector<Strategy> strategies;
  std::vector<Run> runs;
  std::string baseline;  ///< that the first document names, "" for none
  /// Whether a strategy may have other options in each document, as steps that follow the size of the world. It then
  /// has the text of the first document.
  bool by_name = false;
  std::vector<Nats> nats = {};  ///< of the scored ones; several of a problem and a strategy that several documents have

  /// Adds the runs of an experiment. Strategies of one name must be equal unless `by_name` is set.
  /// \param summary  of the experiment
  /// \param file     its document, for messages
  /// \throws Error that names the file, for a run that was added before.
  void add(const ExperimentFacts& experiment, const ExperimentSummary& summary, const std::string& file);
  /// Returns the baseline, by default the first strategy without a guide, else the first; "" for a single strategy.
  [[nodiscard]] std::string reference() const;
  /// Returns the runs of the strategies that are no ablations.
  [[nodiscard]] CostData without_ablations() const;
};

/// Returns the costs of an experiment's runs, without ablations.
CostData cost_data(const ExperimentFacts& experiment, const ExperimentSummary& summary);

/// The comparison of a strategy with the baseline on a problem, on their common seeds.
struct CostComparison {
  std::size_t problem = 0;   ///< index into CostData::problems
  std::size_t strategy = 0;  ///< index into CostData::strategies
  std::size_t runs = 0;
  std::size_t solved = 0;
  PairedCosts checks;
  PairedCosts seconds;
};

/// Splits a strategy's text into levels, from the first guide to the planner: at each '>>' outside of brackets.
std::vector<std::string> cost_levels(const std::string& text);

/// Compares all strategies with the baseline, by problem, then strategy.
/// \throws Error where no strategy is named `baseline`.
std::vector<CostComparison> compare_costs(const CostData& data, const std::string& baseline);

/// A strategy's ratios over the problems of one kind.
struct CostSummary {
  std::size_t runs = 0;
  std::size_t solved = 0;
  double median = std::numeric_limits<double>::quiet_NaN();  ///< over the problems, of the median ratio
  double worst = std::numeric_limits<double>::quiet_NaN();
};
/// \param tuned  true: over the problems on which the strategies were tuned; false: those held out; none: all
CostSummary summarise_costs(const CostData& data, const std::vector<CostComparison>& comparisons, std::size_t strategy,
                            PairedCosts CostComparison::*quantity, std::optional<bool> tuned = {});

/// Returns text for a terminal: each strategy over all problems, and cost_correlation() where there is one.
std::string costs_text(const CostData& data, const std::string& baseline, std::size_t width);

}  // namespace trellis
