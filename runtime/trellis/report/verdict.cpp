// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/verdict.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>
#include <trellis/strategy/ablation.hpp>

namespace trellis {

namespace {

constexpr double level_of_significance = 0.05;

enum class Sign : std::uint8_t { unknown, below, above };

/// Returns the side of `zero` on which the whole interval lies.
Sign sign_of(const Interval& figure, double zero) {
  if (figure.lo > zero) return Sign::above;
  if (figure.hi < zero) return Sign::below;
  return Sign::unknown;
}

Interval point(double value) {
  Interval interval;
  interval.value = interval.lo = interval.hi = value;
  return interval;
}

/// Returns a - b of two means over the runs, with the interval for independent means.
Interval difference(const Interval& a, const Interval& b) {
  const double half = std::hypot(0.5 * (a.hi - a.lo), 0.5 * (b.hi - b.lo));
  Interval interval;
  interval.value = a.value - b.value;
  interval.lo = interval.value - half;
  interval.hi = interval.value + half;
  return interval;
}

/// Whether a strategy costs less than its reference, or more.
Sign costs_of(const PairedCosts& costs) {
  if (costs.pairs == 0 || costs.holm_p >= level_of_significance) return Sign::unknown;
  return costs.less > costs.greater ? Sign::below : Sign::above;
}

/// A guide's strategy without it, and whether the guide's own guides remain.
struct Without {
  StrategySpec strategy;
  bool skipped = false;
};

/// With uniform sampling in place of its guide, the strategy samples as its planner alone does.
bool same_search(const StrategySpec& a, const StrategySpec& b) {
  const auto plain = [](const StrategySpec& s) { return s.guide() == nullptr || s.guide()->text() == "uniform()"; };
  return a == b || (plain(a) && plain(b) && a.planner() == b.planner());
}

/// Returns the strategy without the guide whose space `level` searches, if there is one.
std::optional<Without> without(const StrategySpec& strategy, const std::vector<LevelSummary>& levels,
                               std::size_t level) {
  const auto called_so = [&](const LevelSummary& other) { return other.name == levels[level].name; };
  const auto among = static_cast<std::size_t>(
      std::count_if(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(level), called_so));
  std::optional<Without> found;
  for (const Ablation& ablation : ablations(strategy)) {
    if (ablation.level != levels[level].name || ablation.among != among) continue;
    if (!found || ablation.skipped) found = Without{ablation.strategy, ablation.skipped};
  }
  return found;
}

Verdict by_ablation(const PairedCosts& left_out, std::size_t tests) {
  Verdict verdict;
  verdict.left_out = left_out;
  switch (costs_of(left_out)) {
    case Sign::above:
      verdict.kind = Verdict::Kind::pays;
      verdict.reason = "checks";
      break;
    case Sign::below:
      verdict.kind = Verdict::Kind::costs;
      verdict.reason = "checks";
      break;
    case Sign::unknown:
      verdict.kind = could_show(left_out, tests) ? Verdict::Kind::not_shown : Verdict::Kind::too_few_runs;
      break;
  }
  return verdict;
}

/// The verdict from the level's samples, where no ablation was run.
Verdict by_samples(const RunsSummary& summary, std::size_t level, Sign whole) {
  Verdict verdict;
  const Figure& figure = lifted_figure(summary.levels[level]);
  const std::size_t runs = figure.scored > 0 ? figure.scored : summary.levels[level].runs;
  verdict.kind = runs < least_for_interval ? Verdict::Kind::too_few_runs : Verdict::Kind::not_shown;
  if (figure.scored < least_for_interval) return verdict;
  const double uniform = figure.uniform.value;
  // The mass of uniform samples equals their divergence, because they cover the target evenly.
  if (sign_of(figure.mass_part, uniform) == Sign::above) {
    verdict.kind = Verdict::Kind::misleads;
    verdict.reason = "mass";
    return verdict;
  }
  const auto& steps = summary.tree_waterfall.steps;
  const auto step = std::find_if(steps.begin(), steps.end(),
                                 [&](const WaterfallStep& s) { return s.level == static_cast<int>(level); });
  if (step == steps.end()) return verdict;
  const Figure* before =
      step->from < 0 ? nullptr : &lifted_figure(summary.levels[static_cast<std::size_t>(step->from)]);
  const Interval mass_before = before != nullptr ? before->mass_part : point(uniform);
  const bool by_mass = estimate_fails(figure) || (before != nullptr && estimate_fails(*before));
  const Sign added = by_mass ? sign_of(difference(mass_before, figure.mass_part), 0.0) : sign_of(step->added, 0.0);
  if (added == Sign::above && whole == Sign::below) {
    verdict.kind = Verdict::Kind::pays;
    // Name the part of the divergence that the level reduces more.
    const double mass = mass_before.value - figure.mass_part.value;
    const double spread = (before != nullptr ? before->spread_part.value : 0.0) - figure.spread_part.value;
    if (!std::isnan(mass)) verdict.reason = !by_mass && spread > mass ? "spread" : "mass";
  } else if (added != Sign::above && whole == Sign::above) {
    verdict.kind = Verdict::Kind::costs;
    verdict.reason = "checks";
  }
  return verdict;
}

}  // namespace

std::string verdict_word(const Verdict& verdict) {
  switch (verdict.kind) {
    case Verdict::Kind::none: return "";
    case Verdict::Kind::pays: return "pays";
    case Verdict::Kind::costs: return "costs";
    case Verdict::Kind::misleads: return "misleads";
    case Verdict::Kind::not_shown: return "not shown";
    case Verdict::Kind::too_few_runs: return "too few runs to say";
  }
  throw Fault("unknown verdict");
}

std::string verdict_text(const Verdict& verdict) {
  const std::string word = verdict_word(verdict);
  return verdict.reason.empty() ? word : fmt::format("{} ({})", word, verdict.reason);
}

const Figure& lifted_figure(const LevelSummary& level) {
  return level.root_cross.tree.scored > 0 ? level.root_cross.tree : level.root.tree;
}

bool estimate_fails(const Figure& figure) {
  static const std::vector<std::string> failing = {"below mass bound", "underpowered", "few in target",
                                                   "too few samples", "censored"};
  return std::any_of(figure.flags.begin(), figure.flags.end(), [&](const auto& flag) {
    return 2 * flag.second >= figure.scored && std::find(failing.begin(), failing.end(), flag.first) != failing.end();
  });
}

bool could_show(const PairedCosts& costs, std::size_t tests) {
  return sign_test(costs.pairs, 0) * static_cast<double>(std::max<std::size_t>(tests, 1)) < level_of_significance;
}

std::vector<std::optional<PairedCosts>> costs_without_levels(const Experiment& experiment,
                                                             const ExperimentResult& result, const std::string& problem,
                                                             const std::string& strategy,
                                                             const std::vector<LevelSummary>& levels) {
  std::vector<std::optional<PairedCosts>> found(levels.size());
  const auto& all = experiment.strategies;
  const auto whole = std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.first == strategy; });
  if (whole == all.end()) return found;
  const auto costs_of = [&](const std::string& name) {
    std::vector<CensoredCost> costs;
    for (const RunResult* run : select_runs(result, problem, name)) {
      costs.push_back({static_cast<double>(run->run.validity_checks), run->run.solved});
    }
    return costs;
  };
  const std::vector<CensoredCost> reference = costs_of(strategy);
  std::vector<double> p(levels.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (levels[i].parent < 0) continue;
    const auto rest = without(whole->second, levels, i);
    if (!rest) continue;
    const auto other = std::find_if(all.begin(), all.end(), [&](const auto& entry) {
      return entry.first != strategy && same_search(entry.second, rest->strategy);
    });
    if (other == all.end()) continue;
    const std::vector<CensoredCost> mine = costs_of(other->first);
    if (mine.size() != reference.size()) continue;
    found[i] = paired_costs(mine, reference);
    p[i] = found[i]->sign_p;
  }
  p = holm(p);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (found[i]) found[i]->holm_p = p[i];
  }
  return found;
}

std::vector<Verdict> verdicts(const RunsSummary& summary, const std::vector<std::optional<PairedCosts>>& without,
                              const PairedCosts* whole) {
  const Sign costs = whole != nullptr ? costs_of(*whole) : Sign::unknown;
  const auto tests = static_cast<std::size_t>(
      std::count_if(without.begin(), without.end(), [](const auto& one) { return one.has_value(); }));
  std::vector<Verdict> result;
  result.reserve(summary.levels.size());
  for (std::size_t i = 0; i < summary.levels.size(); ++i) {
    if (summary.levels[i].parent < 0) {
      result.emplace_back();
    } else {
      result.push_back(without[i] ? by_ablation(*without[i], tests) : by_samples(summary, i, costs));
    }
  }
  return result;
}

std::vector<Verdict> verdicts(const Experiment& experiment, const ExperimentResult& result, const std::string& problem,
                              const std::string& strategy, const RunsSummary& summary,
                              const std::vector<Comparison>& comparisons) {
  if (is_ablation(experiment, strategy)) return {};
  const auto beside =
      std::find_if(comparisons.begin(), comparisons.end(), [&](const Comparison& c) { return c.strategy == strategy; });
  return verdicts(summary, costs_without_levels(experiment, result, problem, strategy, summary.levels),
                  beside != comparisons.end() ? &beside->validity_checks : nullptr);
}

bool is_ablation(const Experiment& experiment, const std::string& strategy) {
  return std::any_of(experiment.ablations.begin(), experiment.ablations.end(),
                     [&](const AblationLink& link) { return link.strategy == strategy; });
}

}  // namespace trellis
