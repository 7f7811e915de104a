// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/unsolved.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <trellis/guide/guide.hpp>
#include <trellis/planner/kinds.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

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

std::vector<std::string> reasons_of(const RunResult& run, const StrategySpec& strategy) {
  if (run.levels.empty()) return {std::string(to_string(run.run.status))};
  const LevelRecord& root = run.levels.front().record;
  std::vector<std::string> reasons = {run.run.status == Status::budget_spent ? spent_text(root, strategy)
                                                                             : std::string(to_string(run.run.status))};
  for (std::size_t i = 1; i < run.levels.size(); ++i) {
    const LevelRecord& level = run.levels[i].record;
    const auto limit = resolves_of(strategy, level.name);
    if (limit && level.solves > 1 && static_cast<std::int64_t>(level.solves) - 1 >= *limit) {
      reasons.push_back(
          fmt::format("{} reached its limit of {}", level.name, plural(static_cast<std::size_t>(*limit), "re-solve")));
    } else if (!level.solution.solved()) {
      reasons.push_back(level.name + " found no path");
    }
  }
  return reasons;
}

}  // namespace

std::string unsolved_text(const std::vector<const RunResult*>& runs, const StrategySpec& strategy) {
  std::vector<std::pair<std::string, std::size_t>> found;
  std::size_t unsolved = 0;
  for (const RunResult* run : runs) {
    if (run->run.solved) continue;
    ++unsolved;
    for (const std::string& reason : reasons_of(*run, strategy)) {
      const auto same = [&](const auto& entry) { return entry.first == reason; };
      const auto it = std::find_if(found.begin(), found.end(), same);
      if (it == found.end()) {
        found.emplace_back(reason, 1);
      } else {
        ++it->second;
      }
    }
  }
  if (unsolved == 0) return "";
  std::string text = fmt::format("{} unsolved: ", unsolved);
  for (std::size_t i = 0; i < found.size(); ++i) {
    text += (i == 0 ? "" : "; ") + found[i].first;
    if (found[i].second < unsolved) text += fmt::format(" (in {})", found[i].second);
  }
  return text;
}

}  // namespace trellis
