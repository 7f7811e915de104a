// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/verdict.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

constexpr double level_of_significance = 0.05;
constexpr double power = 0.8;

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

/// The costs of a strategy on a problem or, with "", on all, by problem and seed.
std::vector<std::vector<CensoredCost>> costs_of(const ExperimentFacts& experiment, const std::string& problem,
                                                const std::string& strategy) {
  std::vector<std::vector<CensoredCost>> costs;
  for (const ProblemFacts& one : experiment.problems) {
    if (!problem.empty() && one.name != problem) continue;
    costs.emplace_back();
    for (const RunFacts* run : experiment.select(one.name, strategy)) costs.back().push_back(path_cost(*run));
  }
  return costs;
}

/// The costs of a strategy without a guide, by problem and seed.
std::vector<std::vector<CensoredCost>> costs_without(const ExperimentFacts& experiment, const std::string& problem,
                                                     const std::string& strategy, const GuideFacts& guide) {
  if (!guide.equal.empty()) return costs_of(experiment, problem, guide.equal);
  std::vector<std::vector<CensoredCost>> costs;
  for (const ProblemFacts& one : experiment.problems) {
    if (!problem.empty() && one.name != problem) continue;
    costs.emplace_back();
    for (const LeftOut& left_out : experiment.left_out) {
      if (left_out.problem == one.name && left_out.strategy == strategy && left_out.key == guide.key) {
        costs.back() = left_out.costs;
      }
    }
  }
  return costs;
}

/// Pairs the costs of the first seeds of each problem, as many as both have.
std::optional<PairedCosts> pairs_of(const std::vector<std::vector<CensoredCost>>& with,
                                    const std::vector<std::vector<CensoredCost>>& without) {
  std::vector<CensoredCost> mine;
  std::vector<CensoredCost> reference;
  for (std::size_t p = 0; p < with.size(); ++p) {
    const std::size_t n = std::min(with[p].size(), without[p].size());
    for (std::size_t i = 0; i < n; ++i) {
      mine.push_back(with[p][i]);
      reference.push_back(without[p][i]);
    }
  }
  if (mine.empty()) return std::nullopt;
  return paired_costs(mine, reference);
}

/// Log of the probability of k successes in n.
double log_binomial(std::size_t n, std::size_t k, double p) {
  const auto lg = [](std::size_t x) { return std::lgamma(static_cast<double>(x) + 1.0); };
  const auto times = [](std::size_t x, double log) { return x == 0 ? 0.0 : static_cast<double>(x) * log; };
  return lg(n) - lg(k) - lg(n - k) + times(k, std::log(p)) + times(n - k, std::log1p(-p));
}

/// Returns the probability that a two-sided sign test of n signs, each `p` likely, falls below `alpha` on their side.
double power_of(std::size_t n, double p, double alpha) {
  double tail = 0.0;     // of equally likely signs
  double reached = 0.0;  // of these
  for (std::size_t k = n; 2 * k > n; --k) {
    tail += std::exp(log_binomial(n, k, 0.5));
    if (2.0 * tail >= alpha) break;
    reached += std::exp(log_binomial(n, k, p));
  }
  return reached;
}

/// What of the divergence of a level's samples, lifted to the root, explains the effect of its guide: the part that the
/// level reduces (`less`) or increases more than the level that guides it, if its interval over the runs shows it.
std::string reason_of(const RunsSummary& summary, std::size_t level, bool less) {
  const Figure& figure = lifted_figure(summary.levels[level]);
  if (figure.scored < least_for_interval) return "";
  const auto& steps = summary.tree_waterfall.steps;
  const auto step = std::find_if(steps.begin(), steps.end(),
                                 [&](const WaterfallStep& s) { return s.level == static_cast<int>(level); });
  if (step == steps.end()) return "";
  const Figure* before =
      step->from < 0 ? nullptr : &lifted_figure(summary.levels[static_cast<std::size_t>(step->from)]);
  // The mass of uniform samples equals their divergence, because they cover the target evenly.
  const Interval mass =
      difference(before != nullptr ? before->mass_part : point(figure.uniform.value), figure.mass_part);
  const auto shown = [&](const Interval& reduced) { return less ? reduced.lo > 0.0 : reduced.hi < 0.0; };
  const auto fails = [](const Figure& one) { return estimate_fails(one) || !above_uniform(one).blank.empty(); };
  const bool by_mass = fails(figure) || (before != nullptr && fails(*before));
  if (by_mass) return shown(mass) ? "mass" : "";
  const Interval spread = difference(before != nullptr ? before->spread_part : point(0.0), figure.spread_part);
  const bool spread_more = less ? spread.value > mass.value : spread.value < mass.value;
  if (spread_more && shown(spread)) return "spread";
  return shown(mass) ? "mass" : shown(spread) ? "spread" : "";
}

bool has_level(const RunsSummary& summary, const std::string& key) {
  return std::any_of(summary.levels.begin(), summary.levels.end(),
                     [&](const LevelSummary& level) { return guide_key(level.key) == key; });
}

}  // namespace

std::string ratio_word(double ratio) { return std::isfinite(ratio) ? fmt::format("{:.2g}", ratio) : "inf"; }

std::string verdict_word(const Verdict& verdict) {
  switch (verdict.kind) {
    case Verdict::Kind::none: return "";
    case Verdict::Kind::pays: return "pays";
    case Verdict::Kind::costs: return "costs";
    case Verdict::Kind::not_shown: return "not shown";
    case Verdict::Kind::not_tested: return "not tested";
  }
  throw Fault("unknown verdict");
}

std::string verdict_text(const Verdict& verdict) {
  std::string text = verdict_word(verdict);
  if (!verdict.costs) return text;
  if (verdict.kind == Verdict::Kind::not_shown) {
    text += " (" + plural(verdict.costs->pairs, verdict.together ? "pair" : "seed");
    if (verdict.pairs_needed > 0) text += fmt::format("; ~{} would show it", verdict.pairs_needed);
    return text + ")";
  }
  const Interval& ratio = verdict.costs->ratio;
  text += " ×" + ratio_word(ratio.value);
  if (std::isfinite(ratio.lo) && std::isfinite(ratio.hi)) {
    text += fmt::format(" [{:.2g}, {:.2g}]", ratio.lo, ratio.hi);
  }
  return verdict.reason.empty() ? text : fmt::format("{} ({})", text, verdict.reason);
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

std::size_t pairs_needed(const PairedCosts& costs, std::size_t tests) {
  const std::size_t signs = costs.less + costs.greater;
  if (signs == 0) return 0;
  const double share =
      (static_cast<double>(std::max(costs.less, costs.greater)) + 1.0) / (static_cast<double>(signs) + 2.0);
  const double alpha = level_of_significance / static_cast<double>(std::max<std::size_t>(tests, 1));
  const double untied = static_cast<double>(signs) / static_cast<double>(costs.pairs);
  for (std::size_t pairs = costs.pairs + 1; pairs <= most_pairs; pairs += 1 + pairs / 50) {
    const auto n = static_cast<std::size_t>(std::floor(untied * static_cast<double>(pairs)));
    if (power_of(n, share, alpha) >= power) return pairs;
  }
  return 0;
}

Verdict verdict_of(const PairedCosts& costs, std::size_t tests) {
  Verdict verdict;
  verdict.costs = costs;
  if (costs.holm_p < level_of_significance) {
    verdict.kind = costs.less > costs.greater ? Verdict::Kind::pays : Verdict::Kind::costs;
  } else {
    verdict.kind = Verdict::Kind::not_shown;
    verdict.pairs_needed = pairs_needed(costs, tests);
  }
  return verdict;
}

std::vector<GuideVerdict> guide_verdicts(const ExperimentFacts& experiment, bool together) {
  std::vector<GuideVerdict> found;
  std::vector<std::string> problems = {""};
  if (!together) {
    problems.clear();
    for (const ProblemFacts& problem : experiment.problems) problems.push_back(problem.name);
  }
  std::vector<double> p;
  for (const std::string& problem : problems) {
    for (const StrategyFacts& strategy : experiment.strategies) {
      if (!strategy.ablation.empty()) continue;
      const auto with = costs_of(experiment, problem, strategy.name);
      for (const GuideFacts& guide : strategy.guides) {
        found.push_back({problem, strategy.name, guide.key, guide.guide, {}});
        Verdict& verdict = found.back().verdict;
        verdict.kind = Verdict::Kind::not_tested;
        verdict.costs = pairs_of(with, costs_without(experiment, problem, strategy.name, guide));
        p.push_back(verdict.costs ? verdict.costs->sign_p : std::numeric_limits<double>::quiet_NaN());
      }
    }
  }
  const auto tests =
      static_cast<std::size_t>(std::count_if(p.begin(), p.end(), [](double one) { return !std::isnan(one); }));
  p = holm(p);
  for (std::size_t i = 0; i < found.size(); ++i) {
    Verdict& verdict = found[i].verdict;
    if (!verdict.costs) continue;
    verdict.costs->holm_p = p[i];
    verdict = verdict_of(*verdict.costs, tests);
    verdict.together = together && experiment.problems.size() > 1;
  }
  return found;
}

std::vector<Verdict> level_verdicts(const std::vector<GuideVerdict>& found, const std::string& problem,
                                    const std::string& strategy, const RunsSummary& summary) {
  const auto of_strategy = [&](const GuideVerdict& one) { return one.problem == problem && one.strategy == strategy; };
  if (std::none_of(found.begin(), found.end(), of_strategy)) return {};
  std::vector<Verdict> verdicts(summary.levels.size());
  for (std::size_t i = 0; i < summary.levels.size(); ++i) {
    const std::string key = guide_key(summary.levels[i].key);
    for (const GuideVerdict& one : found) {
      if (of_strategy(one) && one.key == key) verdicts[i] = one.verdict;
    }
    if (verdicts[i].kind == Verdict::Kind::pays) verdicts[i].reason = reason_of(summary, i, true);
    if (verdicts[i].kind == Verdict::Kind::costs) verdicts[i].reason = reason_of(summary, i, false);
  }
  return verdicts;
}

std::vector<GuideVerdict> part_verdicts(const std::vector<GuideVerdict>& found, const std::string& problem,
                                        const std::string& strategy, const RunsSummary& summary) {
  std::vector<GuideVerdict> parts;
  for (const GuideVerdict& one : found) {
    if (one.problem == problem && one.strategy == strategy && !has_level(summary, one.key)) parts.push_back(one);
  }
  return parts;
}

}  // namespace trellis
