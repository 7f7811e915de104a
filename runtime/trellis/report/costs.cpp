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

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

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

std::vector<CensoredCost> costs(const Cell& cell, CostOf quantity) {
  std::vector<CensoredCost> values;
  values.reserve(cell.size());
  for (const auto& [seed, run] : cell) values.push_back(cost(*run, quantity));
  return values;
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

/// Corrects the p values of one quantity over all comparisons.
void correct(std::vector<CostComparison>& comparisons, CostRatio CostComparison::*quantity) {
  std::vector<double> p;
  p.reserve(comparisons.size());
  for (const CostComparison& c : comparisons) p.push_back((c.*quantity).pairs > 0 ? (c.*quantity).sign_p : nan);
  p = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isnan(p[i])) (comparisons[i].*quantity).holm_p = p[i];
  }
}

std::size_t solved(const Cell& cell) {
  return static_cast<std::size_t>(
      std::count_if(cell.begin(), cell.end(), [](const auto& entry) { return entry.second->solved; }));
}

std::string joined(const std::vector<std::string>& levels, std::size_t first, std::size_t last) {
  std::string text;
  for (std::size_t i = first; i < last; ++i) text += levels[i] + " >> ";
  return text + levels.back();
}

std::optional<std::size_t> with_text(const CostData& data, const std::string& text) {
  const auto found = std::find_if(data.strategies.begin(), data.strategies.end(),
                                  [&](const CostData::Strategy& s) { return s.text == text; });
  if (found == data.strategies.end()) return std::nullopt;
  return static_cast<std::size_t>(found - data.strategies.begin());
}

/// Returns the strategies to compare a strategy with.
std::vector<std::size_t> references_of(const CostData& data, std::size_t strategy, CostReference reference,
                                       std::size_t baseline) {
  if (reference == CostReference::baseline) {
    return strategy == baseline ? std::vector<std::size_t>{} : std::vector{baseline};
  }
  const std::vector<std::string> levels = cost_levels(data.strategies[strategy].text);
  const std::size_t guides = levels.size() - 1;
  std::vector<std::size_t> found;
  const auto add = [&](std::size_t first, std::size_t last) {
    const auto one = with_text(data, joined(levels, first, last));
    if (one && std::find(found.begin(), found.end(), *one) == found.end()) found.push_back(*one);
  };
  if (reference == CostReference::own_planner) {
    if (guides > 0) add(guides, guides);
  } else {
    for (std::size_t split = 1; split < guides; ++split) {
      add(0, split);
      add(split, guides);
    }
  }
  return found;
}

/// Returns the strategy with the least median cost.
std::size_t cheapest(const std::vector<Cell>& row, const std::vector<std::size_t>& references, CostOf quantity) {
  std::size_t best = references.front();
  double least = infinity;
  for (const std::size_t reference : references) {
    const double value = median_cost(costs(row[reference], quantity)).value;
    if (value < least) {
      least = value;
      best = reference;
    }
  }
  return best;
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
    if (!known) strategies.push_back({one.name, one.text, !one.ablation.empty(), one.spec});
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

CostData CostData::on(std::size_t problem) const {
  CostData one{{problems[problem]}, strategies, {}, baseline};
  for (const Run& run : runs) {
    if (run.problem != problem) continue;
    one.runs.push_back(run);
    one.runs.back().problem = 0;
  }
  for (const Nats& some : nats) {
    if (some.problem != problem) continue;
    one.nats.push_back(some);
    one.nats.back().problem = 0;
  }
  return one;
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

std::vector<CostComparison> compare_costs(const CostData& data, CostReference reference, const std::string& baseline) {
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
      std::vector<std::size_t> references = references_of(data, s, reference, *base);
      std::erase_if(references, [&](std::size_t r) { return cells[p][r].empty(); });
      if (mine.empty() || references.empty()) continue;
      const auto against = [&](CostOf quantity) {
        const std::size_t other = cheapest(cells[p], references, quantity);
        return CostRatio{pairs_of(mine, cells[p][other], quantity), data.strategies[other].name};
      };
      comparisons.push_back(
          {p, s, mine.size(), solved(mine), against(&CostData::Run::checks), against(&CostData::Run::seconds)});
    }
  }
  correct(comparisons, &CostComparison::checks);
  correct(comparisons, &CostComparison::seconds);
  return comparisons;
}

CostSummary summarise_costs(const CostData& data, const std::vector<CostComparison>& comparisons, std::size_t strategy,
                            CostRatio CostComparison::*quantity, std::optional<bool> tuned) {
  CostSummary summary;
  std::vector<double> ratios;
  for (const CostComparison& c : comparisons) {
    const CostData::Problem& problem = data.problems[c.problem];
    if (c.strategy != strategy || (tuned && problem.tuned != *tuned)) continue;
    ++summary.problems;
    summary.runs += c.runs;
    summary.solved += c.solved;
    const double value = (c.*quantity).ratio.value;
    if (std::isnan(value)) continue;
    ratios.push_back(value);
    if (!(value <= summary.worst)) {
      summary.worst = value;
      summary.worst_problem = problem.name;
    }
  }
  summary.median = median(ratios);
  return summary;
}

}  // namespace trellis
