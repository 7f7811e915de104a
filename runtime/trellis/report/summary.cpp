// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/summary.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>

namespace trellis {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// "0.1.10" as numbers, so that levels sort depth first and 10 comes after 9.
std::vector<std::uint64_t> parse_key(const std::string& key) {
  std::vector<std::uint64_t> numbers;
  bool inside = false;
  for (const char c : key) {
    const bool digit = c >= '0' && c <= '9';
    if (digit && !inside) numbers.push_back(0);
    if (digit) numbers.back() = 10 * numbers.back() + static_cast<std::uint64_t>(c - '0');
    inside = digit;
  }
  return numbers;
}

using LevelResults = std::vector<const LevelResult*>;

template <class F>
double median_of(const LevelResults& levels, F f) {
  std::vector<double> values;
  for (const auto* level : levels) values.push_back(f(level->record));
  return median(values);
}

Figure figure(const LevelResults& levels, std::optional<Scores> LevelResult::*where, Efficiency Scores::*role) {
  std::vector<double> value;
  std::vector<double> gain;
  std::vector<double> uniform;
  std::vector<double> coverage;
  std::vector<double> uniform_coverage;
  Figure result;
  for (const auto* level : levels) {
    const std::optional<Scores>& scores = level->*where;
    if (!scores) continue;
    const Efficiency& e = (*scores).*role;
    uniform.push_back(e.uniform);
    if (std::isnan(e.value)) continue;
    ++result.scored;
    value.push_back(e.value);
    gain.push_back(e.gain);
    coverage.push_back(e.coverage);
    uniform_coverage.push_back(e.uniform_coverage);
    if (std::find(result.estimators.begin(), result.estimators.end(), e.estimator) == result.estimators.end()) {
      result.estimators.push_back(e.estimator);
    }
    for (const auto& flag : e.flags) {
      const auto same = [&](const auto& entry) { return entry.first == flag; };
      const auto it = std::find_if(result.flags.begin(), result.flags.end(), same);
      if (it == result.flags.end()) {
        result.flags.emplace_back(flag, 1);
      } else {
        ++it->second;
      }
    }
  }
  result.value = student_interval(value);
  result.gain = student_interval(gain);
  result.uniform = student_interval(uniform);
  result.coverage = student_interval(coverage);
  result.uniform_coverage = student_interval(uniform_coverage);
  return result;
}

FigurePair figures(const LevelResults& levels, std::optional<Scores> LevelResult::*where) {
  return {figure(levels, where, &Scores::tree), figure(levels, where, &Scores::expansion)};
}

LevelSummary summarise_level(const LevelResults& levels) {
  const LevelRecord& first = levels.front()->record;
  LevelSummary result;
  result.key = first.key;
  result.name = first.name;
  result.space = first.space.name();
  result.dimension = first.space.dimension();
  result.planner = first.planner;
  result.runs = levels.size();
  for (const auto* level : levels) {
    const LevelRecord& record = level->record;
    if (record.solution.solved()) ++result.solved;
    if (record.space.name() != result.space || record.space.dimension() != result.dimension) result.space.clear();
  }
  using R = const LevelRecord&;
  const auto count = [](auto n) { return static_cast<double>(n); };
  result.resolves = median_of(levels, [&](R r) { return r.solves > 0 ? count(r.solves - 1) : nan; });
  result.proposals = median_of(levels, [&](R r) { return count(r.search.proposals.size()); });
  result.nodes = median_of(levels, [&](R r) { return count(r.search.nodes.size()); });
  result.validity_checks = median_of(levels, [&](R r) { return count(r.search.checks.validity); });
  result.motion_checks = median_of(levels, [&](R r) { return count(r.search.checks.motion); });
  result.seconds = median_of(levels, [&](R r) { return r.search.seconds; });
  result.own = figures(levels, &LevelResult::own);
  result.root = figures(levels, &LevelResult::root);
  return result;
}

}  // namespace

RunsSummary summarise(std::span<const RunResult* const> runs) {
  RunsSummary result;
  result.runs = runs.size();
  std::vector<double> validity;
  std::vector<double> motion;
  std::vector<double> seconds;
  std::vector<double> length;
  // By key: a run that ended early may lack the deeper levels.
  std::map<std::vector<std::uint64_t>, LevelResults> levels;
  for (const auto* run : runs) {
    validity.push_back(static_cast<double>(run->run.validity_checks));
    motion.push_back(static_cast<double>(run->run.motion_checks));
    seconds.push_back(run->run.seconds);
    if (run->run.solved) {
      ++result.solved;
      length.push_back(run->run.length);
    }
    for (const auto& level : run->levels) levels[parse_key(level.record.key)].push_back(&level);
  }
  result.success = wilson_interval(result.solved, result.runs);
  result.validity_checks = median(validity);
  result.motion_checks = median(motion);
  result.seconds = median(seconds);
  result.length = student_interval(length);

  std::map<std::vector<std::uint64_t>, int> index;
  for (const auto& [key, group] : levels) {
    index.emplace(key, static_cast<int>(result.levels.size()));
    result.levels.push_back(summarise_level(group));
    std::vector<std::uint64_t> parent = key;
    while (!parent.empty() && result.levels.back().parent < 0) {
      parent.pop_back();
      const auto above = index.find(parent);
      if (above != index.end()) result.levels.back().parent = above->second;
    }
  }
  return result;
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
