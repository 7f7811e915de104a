// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/costs.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/measure/statistics.hpp>

namespace trellis {

namespace {

template <class T>
std::optional<std::size_t> index_of(const std::vector<T>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const T& one) { return one.name == name; });
  if (found == all.end()) return std::nullopt;
  return static_cast<std::size_t>(found - all.begin());
}

/// Adds the nats of the root's samples, with the means over the runs.
void add_nats(CostData& data, std::size_t problem, std::size_t strategy, const LevelSummary& root) {
  for (const bool proposals : {false, true}) {
    for (const bool cross : {false, true}) {
      const FigurePair& pair = cross ? root.root_cross : root.root;
      const Figure& figure = proposals ? pair.expansion : pair.tree;
      const SampleRole role = proposals ? SampleRole::expansion : SampleRole::tree;
      const CostData::Nats nats{problem,
                                strategy,
                                proposals,
                                cross,
                                figure.scored,
                                figure["D_uniform"].value - figure["SE_parts.mass"].value,
                                -figure["SE_parts.spread"].value,
                                figure["above_uniform"].value,
                                cross ? hitting_of(root, role).position.hitting : figure["hitting.nats"].value};
      const bool known = std::isfinite(nats.mass) && std::isfinite(nats.spread) && std::isfinite(nats.above);
      if (known && nats.runs > 0) data.nats.push_back(nats);
    }
  }
}

/// The runs of a strategy on a problem, by seed.
using Cell = std::map<std::uint64_t, const CostData::Run*>;

/// All cells, by problem and strategy.
std::vector<std::vector<Cell>> cells_of(const CostData& data) {
  std::vector<std::vector<Cell>> cells(data.problems.size(), std::vector<Cell>(data.strategies.size()));
  for (const CostData::Run& run : data.runs) cells[run.problem][run.strategy][run.seed] = &run;
  return cells;
}

using CostOf = double CostData::Run::*;

CensoredCost cost(const CostData::Run& run, CostOf quantity) {
  const double later = quantity == &CostData::Run::checks ? run.improvement_checks : 0.0;
  return {run.*quantity - later, run.solved};
}

/// Pairs the runs by seed, where both documents have the quantity.
PairedCosts pairs_of(const Cell& mine, const Cell& theirs, CostOf quantity) {
  std::vector<CensoredCost> left;
  std::vector<CensoredCost> right;
  for (const auto& [seed, run] : mine) {
    const auto other = theirs.find(seed);
    if (other == theirs.end() || std::isnan(run->*quantity) || std::isnan(other->second->*quantity)) continue;
    left.push_back(cost(*run, quantity));
    right.push_back(cost(*other->second, quantity));
  }
  return paired_costs(left, right);
}

std::size_t solved(const Cell& cell) {
  return static_cast<std::size_t>(
      std::count_if(cell.begin(), cell.end(), [](const auto& entry) { return entry.second->solved; }));
}

}  // namespace

void CostData::add(const ExperimentFacts& experiment, const ExperimentSummary& summary, const std::string& file) {
  const auto fail = [&](const std::string& why) { throw Error(fmt::format("{}: {}", file, why)); };
  for (const ProblemFacts& one : experiment.problems) {
    if (!index_of(problems, one.name)) problems.push_back({one.name, one.group, one.tuned});
  }
  for (const StrategyFacts& one : experiment.strategies) {
    const auto known = index_of(strategies, one.name);
    if (known && !by_name && strategies[*known].text != one.text) {
      fail(fmt::format("'{}' is {} here and {} in another file; --by-name compares strategies by their names alone",
                       one.name, one.text, strategies[*known].text));
    }
    if (!known) strategies.push_back({one.name, one.text, !one.ablation.empty()});
  }
  if (baseline.empty()) baseline = experiment.given_baseline;
  std::set<std::tuple<std::size_t, std::size_t, std::uint64_t>> added;
  for (const Run& run : runs) added.emplace(run.problem, run.strategy, run.seed);
  for (const RunFacts& run : experiment.runs) {
    const auto problem = index_of(problems, run.problem);
    const auto strategy = index_of(strategies, run.strategy);
    if (!problem || !strategy) fail("a run is of a problem or a strategy that the experiment does not have");
    if (!added.emplace(*problem, *strategy, run.seed).second) {
      fail(fmt::format("seed {} of '{}' on '{}' is there twice", run.seed, run.strategy, run.problem));
    }
    runs.push_back({*problem, *strategy, run.seed, run.solved, static_cast<double>(run.validity_checks),
                    run.cpu_seconds, run.improvements.empty() ? run.cpu_seconds : run.improvements.front().cpu_seconds,
                    static_cast<double>(run.improvement_checks)});
  }
  for (const ProblemSummary& one : summary.problems) {
    for (const StrategySummary& of : one.strategies) {
      if (of.runs.levels.empty()) continue;
      add_nats(*this, *index_of(problems, one.problem), *index_of(strategies, of.strategy), of.runs.levels.front());
    }
  }
}

std::string CostData::reference() const {
  if (!baseline.empty()) return baseline;
  std::vector<const Strategy*> whole;
  for (const Strategy& strategy : strategies) {
    if (!strategy.ablation) whole.push_back(&strategy);
  }
  if (whole.size() < 2) return "";
  const auto plain =
      std::find_if(whole.begin(), whole.end(), [](const Strategy* s) { return cost_levels(s->text).size() == 1; });
  return (plain != whole.end() ? *plain : whole.front())->name;
}

CostData CostData::without_ablations() const {
  CostData whole{problems, {}, {}, baseline};
  std::vector<std::size_t> place(strategies.size());
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    place[s] = whole.strategies.size();
    if (!strategies[s].ablation) whole.strategies.push_back(strategies[s]);
  }
  for (const Run& run : runs) {
    if (strategies[run.strategy].ablation) continue;
    whole.runs.push_back(run);
    whole.runs.back().strategy = place[run.strategy];
  }
  for (const Nats& one : nats) {
    if (strategies[one.strategy].ablation) continue;
    whole.nats.push_back(one);
    whole.nats.back().strategy = place[one.strategy];
  }
  return whole;
}

CostData cost_data(const ExperimentFacts& experiment, const ExperimentSummary& summary) {
  CostData data;
  data.add(experiment, summary, experiment.script);
  data = data.without_ablations();
  data.baseline = experiment.baseline();
  return data;
}

std::vector<std::string> cost_levels(const std::string& text) {
  std::vector<std::string> levels(1);
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && (i == 0 || text[i - 1] != '\\')) quoted = !quoted;
    if (!quoted && (c == '(' || c == '{')) ++depth;
    if (!quoted && (c == ')' || c == '}')) --depth;
    if (!quoted && depth == 0 && text.compare(i, 4, " >> ") == 0) {
      levels.emplace_back();
      i += 3;
      continue;
    }
    levels.back() += c;
  }
  return levels;
}

std::vector<CostComparison> compare_costs(const CostData& data, const std::string& baseline) {
  const auto base = index_of(data.strategies, baseline);
  if (!base) {
    std::vector<std::string> known;
    for (const auto& strategy : data.strategies) known.push_back(strategy.name);
    throw Error(fmt::format("there is no strategy '{}'{}; there are: {}", baseline, did_you_mean(baseline, known),
                            fmt::join(known, ", ")));
  }
  const auto cells = cells_of(data);
  std::vector<CostComparison> comparisons;
  for (std::size_t p = 0; p < data.problems.size(); ++p) {
    for (std::size_t s = 0; s < data.strategies.size(); ++s) {
      const Cell& mine = cells[p][s];
      const Cell& reference = cells[p][*base];
      if (s == *base || mine.empty() || reference.empty()) continue;
      comparisons.push_back({p, s, mine.size(), solved(mine), pairs_of(mine, reference, &CostData::Run::checks),
                             pairs_of(mine, reference, &CostData::Run::seconds)});
    }
  }
  return comparisons;
}

CostSummary summarise_costs(const CostData& data, const std::vector<CostComparison>& comparisons, std::size_t strategy,
                            PairedCosts CostComparison::*quantity, std::optional<bool> tuned) {
  CostSummary summary;
  std::vector<double> ratios;
  for (const CostComparison& c : comparisons) {
    const CostData::Problem& problem = data.problems[c.problem];
    if (c.strategy != strategy || (tuned && problem.tuned != *tuned)) continue;
    summary.runs += c.runs;
    summary.solved += c.solved;
    const double value = (c.*quantity).ratio.value;
    if (std::isnan(value)) continue;
    ratios.push_back(value);
    if (!(value <= summary.worst)) summary.worst = value;
  }
  summary.median = median(ratios);
  return summary;
}

}  // namespace trellis
