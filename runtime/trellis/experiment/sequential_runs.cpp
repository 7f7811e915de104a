// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/sequential_runs.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/experiment/left_out.hpp>

namespace trellis {

namespace {

/// A run without the part ends at so many times the checks of the run with it: then it costs more, whatever follows.
constexpr double first_limit = 2.0;
/// The limits of the runs that are repeated, and their share of the budget.
constexpr std::array<double, 2> narrowing_limits = {4.0, 20.0};
constexpr double narrowing_share = 0.25;

}  // namespace

/// Tests with the same run without their parts.
struct SequentialRuns::Group {
  std::vector<std::size_t> tests;
  double check_limit = 0.0;
  double work = 0.0;
  bool failed = false;
};

CensoredCost first_path_cost(const RunRecord& run) {
  const bool solved = run.solved || (run.status == Status::interrupted && run.improvement_checks > 0);
  return {static_cast<double>(run.validity_checks - run.improvement_checks), solved,
          !solved && run.status == Status::interrupted};
}

void decide_families(std::vector<SequentialTest>& tests,
                     const std::function<RatioBracket(const TestedPair& pair)>& ratio) {
  for (std::size_t begin = 0, end = 0; begin < tests.size(); begin = end) {
    while (end < tests.size() && tests[end].strategy == tests[begin].strategy) ++end;
    std::vector<PairCounts> counts(end - begin);
    std::vector<SequentialDecision> decisions;
    for (std::size_t i = begin; i < end; ++i) {
      for (const TestedPair& pair : tests[i].pairs) counts[i - begin].add(ratio(pair));
      decisions.push_back(tests[i].decision);
    }
    decide(counts, decisions);
    for (std::size_t i = begin; i < end; ++i) tests[i].decision = decisions[i - begin];
  }
}

SequentialRuns::SequentialRuns(const Experiment& experiment, const ExperimentResult& result, std::size_t problem,
                               const ExperimentOptions& options, double budget)
    : experiment_(experiment),
      options_(options),
      problem_(experiment.problems[problem]),
      budget_(budget),
      last_seed_(*std::max_element(experiment.seeds.begin(), experiment.seeds.end())) {
  const std::size_t seeds = experiment.seeds.size();
  const RunResult* run = &result.runs[problem * experiment.strategies.size() * seeds];
  complete_.resize(experiment.strategies.size());
  for (auto& runs : complete_) {
    runs.resize(most_tested_pairs(seeds));
    for (std::size_t i = 0; i < seeds; ++i, ++run) {
      const CensoredCost cost = first_path_cost(run->run);
      runs[i] = Complete{cost, cost.spent, false};
    }
  }
}

std::optional<std::uint64_t> SequentialRuns::seed(std::size_t round) const {
  const std::size_t seeds = experiment_.seeds.size();
  if (round < seeds) return experiment_.seeds[round];
  const std::uint64_t further = round - seeds + 1;
  if (further > std::numeric_limits<std::uint64_t>::max() - last_seed_) return std::nullopt;
  return last_seed_ + further;
}

const SequentialRuns::Complete* SequentialRuns::complete(std::size_t strategy, std::size_t round) const {
  const auto& found = complete_[strategy][round];
  return found && !found->failed ? &*found : nullptr;
}

RunRecord SequentialRuns::execute_one(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                                      double check_limit) const {
  const auto interrupted = [this] { return options_.interrupted && options_.interrupted(); };
  if (interrupted()) throw Interrupted();
  RunRecord run = execute(strategy, problem, seed,
                          {.interrupted = options_.interrupted,
                           .measured = false,
                           .threads = options_.threads,
                           .work_limit = budget_,
                           .check_limit = static_cast<std::uint64_t>(std::ceil(check_limit))});
  if (interrupted()) throw Interrupted();
  return run;
}

void SequentialRuns::run_complete(std::size_t round, const std::vector<std::size_t>& strategies,
                                  std::vector<SequentialTest>& tests) {
  std::vector<double> work(strategies.size(), 0.0);
  in_parallel(strategies.size(), options_.jobs, [&](std::size_t i) {
    Complete& found = complete_[strategies[i]][round].emplace();
    try {
      const RunRecord run = execute_one(experiment_.strategies[strategies[i]].second, problem_, *seed(round), 0.0);
      found.cost = first_path_cost(run);
      found.checks = found.cost.spent;
      work[i] = run.work;
    } catch (const Error&) {
      found.failed = true;
    }
  });
  for (std::size_t i = 0; i < strategies.size(); ++i) {
    spent_ += work[i];
    const auto first = std::find_if(tests.begin(), tests.end(), [&](const SequentialTest& test) {
      return test.strategy == strategies[i] && test.pairs.size() == round && !test.ended;
    });
    if (first != tests.end()) first->work += work[i];
  }
}

bool SequentialRuns::run_round(std::size_t round, std::vector<SequentialTest>& tests, const SequentialHooks& hooks) {
  const bool further = round >= experiment_.seeds.size();
  const bool may_run = !spent() && seed(round).has_value();
  if (further && !may_run) return false;
  std::vector<std::size_t> open;
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const SequentialTest& test = tests[i];
    if (test.decision != SequentialDecision::open || test.ended || test.pairs.size() != round) continue;
    if (!may_run && !(test.equal && !further)) continue;
    open.push_back(i);
    const bool known = complete_[test.strategy][round].has_value();
    if (!known && std::find(missing.begin(), missing.end(), test.strategy) == missing.end()) {
      missing.push_back(test.strategy);
    }
  }
  if (open.empty()) return false;
  if (!missing.empty()) run_complete(round, missing, tests);

  std::vector<Group> groups;
  for (const std::size_t i : open) {
    SequentialTest& test = tests[i];
    const Complete* with = complete(test.strategy, round);
    if (with == nullptr) {
      test.ended = true;
      continue;
    }
    const Complete* known = test.equal ? complete(*test.equal, round) : nullptr;
    if (known != nullptr) {
      test.pairs.push_back({*seed(round), with->cost, known->cost});
      test.works.push_back(0.0);
      test.free_pairs += further ? 0 : 1;
      continue;
    }
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& one) {
      const SequentialTest& other = tests[one.tests.front()];
      return other.problem.scene == test.problem.scene && same_search(other.without, test.without);
    });
    if (group == groups.end()) group = groups.insert(groups.end(), Group());
    group->tests.push_back(i);
    group->check_limit = std::max(group->check_limit, std::max(1.0, first_limit * with->checks));
  }
  std::vector<std::vector<CensoredCost>> costs(groups.size());
  in_parallel(groups.size(), options_.jobs, [&](std::size_t g) {
    Group& group = groups[g];
    const SequentialTest& first = tests[group.tests.front()];
    try {
      const RunRecord run = execute_one(first.without, first.problem, *seed(round), group.check_limit);
      group.work = run.work;
      for (const std::size_t i : group.tests) costs[g].push_back(hooks.cost(i, run));
    } catch (const Error&) {
      group.failed = true;
    }
  });
  for (std::size_t g = 0; g < groups.size(); ++g) {
    spent_ += groups[g].work;
    tests[groups[g].tests.front()].work += groups[g].work;
    for (std::size_t k = 0; k < groups[g].tests.size(); ++k) {
      SequentialTest& test = tests[groups[g].tests[k]];
      test.ended = groups[g].failed;
      if (test.ended) continue;
      test.pairs.push_back({*seed(round), complete(test.strategy, round)->cost, costs[g][k]});
      test.works.push_back(groups[g].work);
    }
  }
  std::vector<SequentialDecision> before;
  before.reserve(tests.size());
  for (const SequentialTest& test : tests) before.push_back(test.decision);
  decide_families(tests, hooks.ratio);
  for (std::size_t i = 0; i < tests.size() && hooks.narrows; ++i) {
    if (tests[i].decision == SequentialDecision::less && before[i] != tests[i].decision) narrow(i, tests, hooks);
  }
  return true;
}

/// A sign never changes: the run that is repeated begins as it did before.
void SequentialRuns::narrow(std::size_t index, std::vector<SequentialTest>& tests, const SequentialHooks& hooks) {
  SequentialTest& test = tests[index];
  for (const double times : narrowing_limits) {
    const double left = std::min(narrowing_share * budget_ - narrowed_, budget_ - spent_);
    std::vector<std::size_t> again;
    double expected = 0.0;
    bool all = true;
    for (std::size_t i = 0; i < test.pairs.size() && all; ++i) {
      const auto& [seed, with, without] = test.pairs[i];
      const double limit = times * with.spent;
      if (!without.cut_off || !with.solved || without.spent >= limit || !(hooks.ratio(test.pairs[i]).hi < 1.0)) {
        continue;
      }
      expected += test.works[i] * limit / std::max(without.spent, 1.0);
      all = expected <= left;
      if (all) again.push_back(i);
    }
    std::vector<double> work(again.size(), 0.0);
    in_parallel(again.size(), options_.jobs, [&](std::size_t k) {
      TestedPair& pair = test.pairs[again[k]];
      const RunRecord run = execute_one(test.without, test.problem, pair.seed, std::max(1.0, times * pair.with.spent));
      pair.without = hooks.cost(index, run);
      work[k] = test.works[again[k]] = run.work;
    });
    for (const double one : work) {
      spent_ += one;
      narrowed_ += one;
      test.work += one;
    }
    if (!all) return;
  }
}

void SequentialRuns::run(std::vector<SequentialTest>& tests, const SequentialHooks& hooks) {
  const std::size_t rounds = most_tested_pairs(experiment_.seeds.size());
  for (std::size_t round = 0; round < rounds && run_round(round, tests, hooks); ++round) {
    if (hooks.progress) hooks.progress(round + 1);
  }
  if (hooks.progress) hooks.progress(rounds);
}

}  // namespace trellis
