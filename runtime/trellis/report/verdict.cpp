// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/verdict.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace trellis {

namespace {

constexpr double level_of_significance = 0.05;

enum class Sign : std::uint8_t { unknown, below, above };

/// On which side of `zero` a figure lies with its whole interval.
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

/// a - b of two means over the runs, as if they were independent.
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

/// The comparison of a strategy with the one that it is a part of, or with the baseline.
const Comparison* find(const std::vector<Comparison>& comparisons, const std::string& strategy) {
  const auto it =
      std::find_if(comparisons.begin(), comparisons.end(), [&](const Comparison& c) { return c.strategy == strategy; });
  return it != comparisons.end() ? &*it : nullptr;
}

/// The strategy without one level: what guides it in its place where something does, else uniform sampling.
const Comparison* ablation_of(const Experiment& experiment, const std::string& strategy, const RunsSummary& summary,
                              std::size_t level, const std::vector<Comparison>& comparisons) {
  const std::vector<LevelSummary>& levels = summary.levels;
  const auto called_so = [&](const LevelSummary& other) { return other.name == levels[level].name; };
  const auto among = static_cast<std::size_t>(
      std::count_if(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(level), called_so));
  const AblationLink* found = nullptr;
  for (const AblationLink& link : experiment.ablations) {
    if (link.of != strategy || link.level != levels[level].name || link.among != among) continue;
    if (found == nullptr || link.skipped) found = &link;
  }
  return found != nullptr ? find(comparisons, found->strategy) : nullptr;
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

/// What the level's samples show, where nothing else was run.
Verdict by_samples(const RunsSummary& summary, std::size_t level, Sign whole) {
  Verdict verdict;
  const Figure& figure = lifted_figure(summary.levels[level]);
  verdict.kind = Verdict::Kind::too_few_runs;
  if (figure.scored < least_for_interval) return verdict;
  verdict.kind = Verdict::Kind::not_shown;
  const double uniform = figure.uniform.value;
  // Mass of uniform samples is their divergence: they cover the target evenly.
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
    // Of either part of the divergence, the one that it took more from.
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

std::string verdict_text(const Verdict& verdict) {
  const char* word = "";
  switch (verdict.kind) {
    case Verdict::Kind::none: return "";
    case Verdict::Kind::pays: word = "pays"; break;
    case Verdict::Kind::costs: word = "costs"; break;
    case Verdict::Kind::misleads: word = "misleads"; break;
    case Verdict::Kind::not_shown: word = "not shown"; break;
    case Verdict::Kind::too_few_runs: word = "too few runs to say"; break;
  }
  return verdict.reason.empty() ? word : fmt::format("{} ({})", word, verdict.reason);
}

const Figure& lifted_figure(const LevelSummary& level) {
  return level.root_cross.tree.scored > 0 ? level.root_cross.tree : level.root.tree;
}

bool estimate_fails(const Figure& figure) {
  static const std::vector<std::string> failing = {"below mass bound", "underpowered", "too few samples", "censored"};
  return std::any_of(figure.flags.begin(), figure.flags.end(), [&](const auto& flag) {
    return 2 * flag.second >= figure.scored && std::find(failing.begin(), failing.end(), flag.first) != failing.end();
  });
}

bool could_show(const PairedCosts& costs, std::size_t tests) {
  return sign_test(costs.pairs, 0) * static_cast<double>(std::max<std::size_t>(tests, 1)) < level_of_significance;
}

std::vector<Verdict> verdicts(const Experiment& experiment, const std::string& strategy, const RunsSummary& summary,
                              const std::vector<Comparison>& comparisons) {
  const Comparison* whole = find(comparisons, strategy);
  const Sign costs = whole != nullptr ? costs_of(whole->validity_checks) : Sign::unknown;
  std::vector<Verdict> result;
  result.reserve(summary.levels.size());
  for (std::size_t i = 0; i < summary.levels.size(); ++i) {
    const LevelSummary& level = summary.levels[i];
    if (level.parent < 0) {
      result.emplace_back();
      continue;
    }
    const Comparison* left_out = ablation_of(experiment, strategy, summary, i, comparisons);
    result.push_back(left_out != nullptr ? by_ablation(left_out->validity_checks, comparisons.size())
                                         : by_samples(summary, i, costs));
  }
  return result;
}

}  // namespace trellis
