// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/left_out.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <trellis/experiment/sequential_runs.hpp>
#include <trellis/strategy/ablation.hpp>

namespace trellis {

namespace {

constexpr double scoring_work = 20'000.0;  // of a run: scoring takes as long as so many checks, or longer
constexpr double least_work = 200'000.0;   // of an experiment: less takes no time that a user notices

}  // namespace

bool same_search(const StrategySpec& a, const StrategySpec& b) {
  const auto plain = [](const StrategySpec& s) { return s.guide() == nullptr || s.guide()->text() == "uniform()"; };
  return a == b || (plain(a) && plain(b) && a.planner() == b.planner());
}

bool is_ablation(const Experiment& experiment, const std::string& strategy) {
  return std::any_of(experiment.ablations.begin(), experiment.ablations.end(),
                     [&](const AblationLink& link) { return link.strategy == strategy; });
}

const std::pair<std::string, StrategySpec>* equal_strategy(const Experiment& experiment, const std::string& strategy,
                                                           const StrategySpec& spec) {
  for (const auto& entry : experiment.strategies) {
    if (entry.first != strategy && same_search(entry.second, spec)) return &entry;
  }
  return nullptr;
}

double ablation_budget(const Experiment& experiment, const ExperimentResult& result, const std::string& problem) {
  double work = 0.0;
  for (const RunResult& run : result.runs) {
    if (run.problem == problem) work += run.run.work + (experiment.measure ? scoring_work : 0.0);
  }
  return experiment.ablation * std::max(work, least_work);
}

bool never_set_up(const Experiment& experiment, const ExperimentResult& result, std::size_t problem,
                  std::size_t strategy) {
  const std::size_t seeds = experiment.seeds.size();
  const RunResult* first = &result.runs[(problem * experiment.strategies.size() + strategy) * seeds];
  return std::none_of(first, first + seeds, [](const RunResult& run) { return sets_up_guides(run.run); });
}

void run_left_out(const Experiment& experiment, ExperimentResult& result, const ExperimentOptions& options) {
  result.left_out.clear();
  if (experiment.ablation <= 0.0) return;
  std::vector<LeftOut> left_out;
  const std::size_t rounds = most_tested_pairs(experiment.seeds.size());
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    const Problem& problem = experiment.problems[p];
    std::vector<SequentialTest> tests;
    std::vector<std::string> keys;
    for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
      const auto& [name, strategy] = experiment.strategies[s];
      if (is_ablation(experiment, name) || never_set_up(experiment, result, p, s)) continue;
      for (const Ablation& ablation : decisive_ablations(strategy)) {
        tests.push_back({s, ablation.strategy, problem});
        keys.push_back(ablation.key);
        const auto* equal = equal_strategy(experiment, name, ablation.strategy);
        if (equal != nullptr) tests.back().equal = static_cast<std::size_t>(equal - experiment.strategies.data());
      }
    }
    SequentialRuns runs(experiment, result, p, options, ablation_budget(experiment, result, problem.name));
    runs.run(tests, {.cost = [](std::size_t, const RunRecord& run) { return first_path_cost(run); },
                     .ratio = [](const TestedPair& pair) { return ratio_bracket(pair.with, pair.without); },
                     .progress =
                         [&](std::size_t done) {
                           if (!options.ablation_progress) return;
                           options.ablation_progress(p * rounds + done, experiment.problems.size() * rounds);
                         },
                     .narrows = true});
    for (std::size_t i = 0; i < tests.size(); ++i) {
      std::vector<TestedPair>& pairs = tests[i].pairs;
      pairs.erase(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(tests[i].free_pairs));
      if (pairs.empty() && tests[i].equal) continue;
      left_out.push_back(
          {problem.name, experiment.strategies[tests[i].strategy].first, keys[i], std::move(pairs), tests[i].work});
    }
  }
  result.left_out = std::move(left_out);
}

}  // namespace trellis
