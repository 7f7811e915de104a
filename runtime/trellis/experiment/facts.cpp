// SPDX-License-Identifier: GPL-3.0-or-later

#include <fmt/format.h>

#include <algorithm>

#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/planner/planner.hpp>

namespace trellis {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

LevelScores rounded(LevelScores scores) {
  for (auto* of : {&scores.own, &scores.root, &scores.own_cross, &scores.root_cross, &scores.equal, &scores.oracle,
                   &scores.uniform}) {
    if (*of) *of = Scores{rounded((*of)->tree), rounded((*of)->expansion)};
  }
  return scores;
}

LevelFacts facts_of(const LevelResult& level) {
  const LevelRecord& record = level.record;
  const Search& search = record.search;
  LevelFacts facts;
  static_cast<LevelAccounts&>(facts) = record;
  facts.space = record.space.name();
  facts.dimension = record.space.dimension();
  facts.degrees = record.space.degrees();
  facts.proposals = search.proposals.size();
  facts.accepted = static_cast<std::size_t>(
      std::count_if(search.fates.begin(), search.fates.end(), [](Fate fate) { return fate != Fate::rejected; }));
  for (const std::string& name : search.sources) facts.sources.emplace_back(name, 0);
  for (const auto source : search.proposal_sources) {
    if (source < facts.sources.size()) ++facts.sources[source].second;
  }
  facts.nodes = search.nodes.size();
  facts.validity_checks = search.checks.validity;
  facts.motion_checks = search.checks.motion;
  facts.seconds = search.seconds;
  facts.status = record.solution.status;
  facts.rejections = level.rejections;
  const LevelScores& scores = level;
  const bool scored = scores.own || scores.root || scores.own_cross || scores.root_cross || scores.equal ||
                      scores.oracle || scores.uniform || scores.metrics;
  if (scored) facts.scores = std::make_shared<const LevelScores>(rounded(scores));
  return facts;
}

/// Returns the guide whose space a level searches; nullptr where no guide has its name.
const GuideSpec* component_of(const GuideSpec& guide, const std::string& level) {
  if (guide.kind() != GuideSpec::Kind::component) {
    for (const auto& term : guide.terms()) {
      if (const GuideSpec* found = component_of(term.guide, level)) return found;
    }
    return nullptr;
  }
  if (guide.text_alone() == level) return &guide;
  return guide.below() != nullptr ? component_of(*guide.below(), level) : nullptr;
}

/// Returns the limit of re-solves of a level; none without a limit.
std::optional<std::int64_t> resolves_of(const StrategySpec& strategy, const std::string& level) {
  const GuideSpec* component = strategy.guide() != nullptr ? component_of(*strategy.guide(), level) : nullptr;
  if (component == nullptr || component->custom()) return std::nullopt;
  const GuideKind* kind = find_guide(component->name());
  if (kind == nullptr || kind->resolves == nullptr) return std::nullopt;
  return kind->resolves(component->options());
}

/// Names the budget of the root's planner that a run spent.
std::string spent_text(const LevelRecord& root, const StrategySpec& strategy) {
  const PlannerKind* kind = find_planner(strategy.planner().name());
  const Budget budget = kind->common(strategy.planner().options()).budget;
  const auto proposals = static_cast<double>(root.search.proposals.size());
  const auto checks = static_cast<double>(root.search.checks.validity);
  if (proposals >= budget.proposals) return fmt::format("{:.0f} proposals spent at level 0", budget.proposals);
  if (checks >= budget.checks) return fmt::format("{:.0f} validity checks spent at level 0", budget.checks);
  if (budget.seconds < Budget::unlimited) return fmt::format("{:g} s spent at level 0", budget.seconds);
  return std::string(to_string(Status::budget_spent));
}

}  // namespace

RunFacts facts_of(const RunResult& run) {
  RunFacts facts;
  static_cast<RunTotals&>(facts) = run.run;
  facts.problem = run.problem;
  facts.strategy = run.strategy;
  facts.seed = run.seed;
  facts.cpu_seconds = run.cpu_seconds;
  if (!facts.solved) facts.path = Configurations();
  if (!facts.solved) facts.length = nan;
  if (!facts.certified) facts.clearance = nan;
  facts.reasons = run.reasons;
  facts.levels.reserve(run.levels.size());
  for (const LevelResult& level : run.levels) facts.levels.push_back(facts_of(level));
  return facts;
}

std::vector<std::string> unsolved_reasons(const RunResult& run, const StrategySpec& strategy) {
  if (run.run.solved) return {};
  if (run.levels.empty()) return {std::string(to_string(run.run.status))};
  const LevelRecord& root = run.levels.front().record;
  std::vector<std::string> reasons = {run.run.status == Status::budget_spent ? spent_text(root, strategy)
                                                                             : std::string(to_string(run.run.status))};
  for (std::size_t i = 1; i < run.levels.size(); ++i) {
    const LevelRecord& level = run.levels[i].record;
    const auto limit = resolves_of(strategy, level.name);
    if (limit && level.solves > 1 && static_cast<std::int64_t>(level.solves) - 1 >= *limit) {
      reasons.push_back(
          fmt::format("{} reached its limit of {} re-solve{}", level.name, *limit, *limit == 1 ? "" : "s"));
    } else if (!level.solution.solved()) {
      reasons.push_back(level.name + " found no path");
    }
  }
  return reasons;
}

std::vector<const RunResult*> select_runs(const ExperimentResult& result, const std::string& problem,
                                          const std::string& strategy) {
  std::vector<const RunResult*> runs;
  for (const auto& run : result.runs) {
    if ((problem.empty() || run.problem == problem) && run.strategy == strategy) runs.push_back(&run);
  }
  return runs;
}

}  // namespace trellis
