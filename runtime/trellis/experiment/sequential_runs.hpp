// SPDX-License-Identifier: GPL-3.0-or-later
// Runs strategies without a part, seed by seed, until a sequential test decides or a budget of work is spent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/sequential_test.hpp>

namespace trellis {

/// A strategy on a problem against a variant. The tests of one strategy are a family, see `decide`.
struct SequentialTest {
  std::size_t strategy = 0;  ///< its index in the experiment
  StrategySpec without;
  Problem problem;  ///< of the runs without
  /// The strategy of the experiment that searches as the variant does, on the same problem: its runs cost nothing.
  std::optional<std::size_t> equal = {};
  std::vector<TestedPair> pairs = {};  ///< those from the runs of the experiment included
  std::size_t free_pairs = 0;          ///< the first ones, both from the runs of the experiment
  SequentialDecision decision = SequentialDecision::open;
  double work = 0.0;               ///< of the runs that the experiment does not have
  bool ended = false;              ///< no further run is possible: the variant cannot be set up
  std::vector<double> works = {};  ///< of each pair, the run without
};

/// What a kind of test takes from its runs.
struct SequentialHooks {
  /// Returns the cost of a run without the part. Called from the threads of the runs; at most one for each test.
  std::function<CensoredCost(std::size_t test, const RunRecord& run)> cost;
  std::function<RatioBracket(const TestedPair& pair)> ratio;
  std::function<void(std::size_t rounds)> progress = {};  ///< after each round: the rounds that are done
  /// Whether the cut-off runs of a test that pays are repeated with a higher limit, for a narrower interval.
  bool narrows = false;
};

/// The runs of the sequential tests on one problem. They take the seeds of the experiment, then the next ones. A run
/// without the part ends at twice the checks of the run with it. The result does not depend on the number of threads.
class SequentialRuns {
 public:
  /// \param result  has the runs of the experiment
  /// \param budget  of work; no run begins after so much, and none takes more
  SequentialRuns(const Experiment& experiment, const ExperimentResult& result, std::size_t problem,
                 const ExperimentOptions& options, double budget);

  /// Runs a round of all open tests after another, until each is decided or the budget is spent. May be called for
  /// further tests: these have what is left of the budget.
  /// \throws Interrupted
  void run(std::vector<SequentialTest>& tests, const SequentialHooks& hooks);

  [[nodiscard]] bool spent() const { return spent_ >= budget_; }

 private:
  /// A run of a complete strategy.
  struct Complete {
    CensoredCost cost;
    double checks = 0.0;  ///< until its first path or its end
    bool failed = false;
  };
  struct Group;

  [[nodiscard]] std::optional<std::uint64_t> seed(std::size_t round) const;
  [[nodiscard]] const Complete* complete(std::size_t strategy, std::size_t round) const;
  bool run_round(std::size_t round, std::vector<SequentialTest>& tests, const SequentialHooks& hooks);
  void run_complete(std::size_t round, const std::vector<std::size_t>& strategies, std::vector<SequentialTest>& tests);
  void narrow(std::size_t index, std::vector<SequentialTest>& tests, const SequentialHooks& hooks);
  RunRecord execute_one(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                        double check_limit) const;

  const Experiment& experiment_;
  const ExperimentOptions& options_;
  const Problem& problem_;
  double budget_;
  double spent_ = 0.0;
  double narrowed_ = 0.0;  ///< part of `spent_`
  std::uint64_t last_seed_ = 0;
  std::vector<std::vector<std::optional<Complete>>> complete_;  ///< by strategy and round
};

/// The cost of a run until its first path: an anytime planner that was cut off has one all the same.
CensoredCost first_path_cost(const RunRecord& run);

/// Returns the decisions of all tests; those of a strategy are adjacent.
void decide_families(std::vector<SequentialTest>& tests,
                     const std::function<RatioBracket(const TestedPair& pair)>& ratio);

}  // namespace trellis
