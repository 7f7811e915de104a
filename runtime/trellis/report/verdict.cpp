// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/verdict.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

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

using Ratios = std::vector<RatioBracket>;

/// The ratios with to without a guide on a problem.
Ratios ratios_of_guide(const ExperimentFacts& experiment, const std::string& problem, const std::string& strategy,
                       const GuideFacts& guide) {
  Ratios ratios;
  for (const TestedPair& pair : pairs_of_guide(experiment, problem, strategy, guide)) {
    ratios.push_back(ratio_bracket(pair.with, pair.without));
  }
  return ratios;
}

bool directed(SequentialDecision decision) {
  return decision == SequentialDecision::less || decision == SequentialDecision::greater;
}

/// "[0.25, 0.40]" with a space before; "" where nothing is known.
std::string interval_words(const RatioBracket& interval) {
  if (interval.lo == 0.0 && std::isinf(interval.hi)) return "";
  return fmt::format(" [{}, {}]", ratio_word(interval.lo), ratio_word(interval.hi));
}

/// Decides the guides of a strategy on a problem or, with "", on all problems together.
void decide_guides(const ExperimentFacts& experiment, const std::string& problem, const StrategyFacts& strategy,
                   std::vector<GuideVerdict>& found) {
  const bool together = problem.empty();
  std::vector<Ratios> ratios(strategy.guides.size());
  std::size_t runs = 0;
  std::size_t set_up = 0;
  bool unsolved = true;
  for (const ProblemFacts& one : experiment.problems) {
    if (!together && one.name != problem) continue;
    const auto of_strategy = experiment.select(one.name, strategy.name);
    runs += of_strategy.size();
    set_up += static_cast<std::size_t>(std::count_if(of_strategy.begin(), of_strategy.end(),
                                                     [](const RunFacts* run) { return sets_up_guides(*run); }));
    unsolved =
        unsolved && std::none_of(of_strategy.begin(), of_strategy.end(), [](const auto* run) { return run->solved; });
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      const Ratios further = ratios_of_guide(experiment, one.name, strategy.name, strategy.guides[i]);
      ratios[i].insert(ratios[i].end(), further.begin(), further.end());
    }
  }
  std::vector<SequentialDecision> decisions(ratios.size(), SequentialDecision::open);
  if (together) {
    std::vector<PairCounts> counts;
    counts.reserve(ratios.size());
    for (const Ratios& of : ratios) counts.push_back(count_pairs(of));
    decide(counts, decisions);
  } else {
    decisions = decide_in_rounds(ratios);
  }
  std::size_t tests = 0;
  std::size_t undecided = 0;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    if (ratios[i].empty()) continue;
    ++tests;
    undecided += directed(decisions[i]) ? 0 : 1;
  }
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const GuideFacts& guide = strategy.guides[i];
    found.push_back({problem, strategy.name, guide.key, guide.guide, {}});
    Verdict& verdict = found.back().verdict;
    if (runs > 0 && set_up == 0) {
      verdict.kind = Verdict::Kind::never_set_up;
      verdict.runs = runs;
      continue;
    }
    verdict = verdict_of(decisions[i], ratios[i], tests, undecided);
    verdict.unsolved = unsolved;
    verdict.together = together && experiment.problems.size() > 1;
    if (verdict.kind != Verdict::Kind::not_shown) continue;
    if (verdict.together) verdict.pairs_needed = 0;
    if (experiment.ablation > 0.0 && !together && ratios[i].size() < most_tested_pairs(experiment.seeds.size())) {
      verdict.more_ablation = 2.0 * experiment.ablation;
    }
  }
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
  const Interval mass = difference(before != nullptr ? (*before)["SE_parts.mass"] : point(figure["D_uniform"].value),
                                   figure["SE_parts.mass"]);
  const auto shown = [&](const Interval& reduced) { return less ? reduced.lo > 0.0 : reduced.hi < 0.0; };
  const auto fails = [](const Figure& one) { return estimate_fails(one) || !above_uniform(one).blank.empty(); };
  const bool by_mass = fails(figure) || (before != nullptr && fails(*before));
  if (by_mass) return shown(mass) ? "mass" : "";
  const Interval spread =
      difference(before != nullptr ? (*before)["SE_parts.spread"] : point(0.0), figure["SE_parts.spread"]);
  const bool spread_more = less ? spread.value > mass.value : spread.value < mass.value;
  if (spread_more && shown(spread)) return "spread";
  return shown(mass) ? "mass" : shown(spread) ? "spread" : "";
}

bool has_level(const RunsSummary& summary, const std::string& key) {
  return std::any_of(summary.levels.begin(), summary.levels.end(),
                     [&](const LevelSummary& level) { return guide_key(level.key) == key; });
}

}  // namespace

RatioBracket inverse(const RatioBracket& ratio) {
  const auto of = [](double x) { return x > 0.0 ? 1.0 / x : std::numeric_limits<double>::infinity(); };
  return {of(ratio.hi), of(ratio.lo)};
}

std::vector<TestedPair> pairs_of_runs(const ExperimentFacts& experiment, const std::string& problem,
                                      const std::string& strategy, const std::string& reference) {
  const auto with = experiment.select(problem, strategy);
  const auto without = experiment.select(problem, reference);
  std::vector<TestedPair> pairs;
  for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i) {
    pairs.push_back({with[i]->seed, path_cost(*with[i]), path_cost(*without[i])});
  }
  return pairs;
}

std::vector<TestedPair> pairs_of_guide(const ExperimentFacts& experiment, const std::string& problem,
                                       const std::string& strategy, const GuideFacts& guide) {
  const auto runs = experiment.select(problem, strategy);
  if (std::none_of(runs.begin(), runs.end(), [](const RunFacts* run) { return sets_up_guides(*run); })) return {};
  std::vector<TestedPair> pairs;
  if (!guide.equal.empty()) pairs = pairs_of_runs(experiment, problem, strategy, guide.equal);
  for (const LeftOut& left_out : experiment.left_out) {
    if (left_out.problem != problem || left_out.strategy != strategy || left_out.key != guide.key) continue;
    pairs.insert(pairs.end(), left_out.pairs.begin(), left_out.pairs.end());
  }
  return pairs;
}

std::string ratio_word(double ratio) {
  if (!std::isfinite(ratio)) return "inf";
  if (ratio >= 99.5) return fmt::format("{:.0f}", ratio);
  // "×1" of a level that costs more would contradict itself.
  return fmt::format(fmt::runtime(std::abs(ratio - 1.0) < 0.05 ? "{:.3g}" : "{:.2g}"), ratio);
}

std::string median_word(const RatioBracket& median) {
  if (median.lo == median.hi) return ratio_word(median.lo);
  if (median.lo == 0.0) return ratio_word(median.hi) + " or less";
  if (std::isinf(median.hi)) return ratio_word(median.lo) + " or more";
  return fmt::format("{} to {}", ratio_word(median.lo), ratio_word(median.hi));
}

std::string verdict_word(const Verdict& verdict) {
  switch (verdict.kind) {
    case Verdict::Kind::none: return "";
    case Verdict::Kind::pays: return "pays";
    case Verdict::Kind::costs: return "costs";
    case Verdict::Kind::no_difference: return "no difference";
    case Verdict::Kind::changes_nothing: return "changes nothing";
    case Verdict::Kind::not_shown: return "not shown";
    case Verdict::Kind::not_tested: return "not tested";
    case Verdict::Kind::never_set_up: return "never set up";
  }
  throw Fault("unknown verdict");
}

std::string verdict_text(const Verdict& verdict) {
  const std::string pairs = plural(verdict.counts.pairs, verdict.together ? "pair" : "seed");
  const std::string interval = interval_words(verdict.ratio.interval);
  const std::string reason = verdict.reason.empty() ? "" : "; " + verdict.reason;
  switch (verdict.kind) {
    case Verdict::Kind::pays:
    case Verdict::Kind::costs:
      return fmt::format("{} ×{}{} ({}{})", verdict_word(verdict), median_word(verdict.ratio.median), interval, pairs,
                         reason);
    case Verdict::Kind::no_difference:
      return fmt::format("no difference above ×{}{} ({})", least_difference, interval, pairs);
    case Verdict::Kind::changes_nothing:
      return fmt::format("changes nothing: {} on {}", verdict.unsolved ? "no path" : "the same cost", pairs);
    case Verdict::Kind::not_shown: {
      std::string text = fmt::format("not shown{} ({})", interval, pairs);
      if (verdict.more_ablation > 0.0)
        return text + fmt::format("; budget spent: --ablation {:g}", verdict.more_ablation);
      if (verdict.pairs_needed == 0) return text;
      return text + fmt::format("; ~{} seeds would probably show it", verdict.pairs_needed);
    }
    case Verdict::Kind::never_set_up: return fmt::format("never set up ({})", plural(verdict.runs, "run"));
    default: return verdict_word(verdict);
  }
}

std::string verdict_text_without(const Verdict& verdict) {
  if (verdict.kind != Verdict::Kind::pays && verdict.kind != Verdict::Kind::costs) return verdict_text(verdict);
  const RatioBracket median = inverse(verdict.ratio.median);
  return median_word(median) + interval_words(inverse(verdict.ratio.interval)) +
         (verdict.kind == Verdict::Kind::pays ? " keep it" : " drop it");
}

std::string verdicts_note() {
  return fmt::format(
      "verdicts: at most {:g} % wrong verdicts for each strategy, and as many for its guides, in each problem, however "
      "many seeds are added; intervals of {:g} %",
      100.0 * sequential_error, 100.0 * (1.0 - sequential_error));
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

Verdict verdict_of(SequentialDecision decision, std::span<const RatioBracket> ratios, std::size_t tests,
                   std::size_t undecided) {
  Verdict verdict;
  verdict.counts = count_pairs(ratios);
  verdict.ratio = median_ratio(ratios);
  verdict.tests = tests;
  switch (decision) {
    case SequentialDecision::less: verdict.kind = Verdict::Kind::pays; break;
    case SequentialDecision::greater: verdict.kind = Verdict::Kind::costs; break;
    case SequentialDecision::no_difference:
      verdict.kind =
          verdict.counts.equal == verdict.counts.pairs ? Verdict::Kind::changes_nothing : Verdict::Kind::no_difference;
      break;
    case SequentialDecision::open:
      verdict.kind = ratios.empty() ? Verdict::Kind::not_tested : Verdict::Kind::not_shown;
      if (!ratios.empty()) verdict.pairs_needed = forecast_pairs(verdict.counts, decisive_e_value(undecided));
      break;
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
  for (const std::string& problem : problems) {
    for (const StrategyFacts& strategy : experiment.strategies) {
      if (strategy.ablation.empty()) decide_guides(experiment, problem, strategy, found);
    }
  }
  return found;
}

std::optional<Verdict> strategy_verdict(const ExperimentFacts& experiment, const std::string& problem,
                                        const std::string& strategy, const std::string& reference) {
  std::vector<Ratios> ratios(1);
  for (const ProblemFacts& one : experiment.problems) {
    if (!problem.empty() && one.name != problem) continue;
    for (const TestedPair& pair : pairs_of_runs(experiment, one.name, strategy, reference)) {
      ratios[0].push_back(ratio_bracket(pair.with, pair.without));
    }
  }
  if (ratios[0].empty()) return std::nullopt;
  Verdict verdict = verdict_of(decide_in_rounds(ratios)[0], ratios[0], 1, 1);
  verdict.together = problem.empty() && experiment.problems.size() > 1;
  if (verdict.together) verdict.pairs_needed = 0;
  return verdict;
}

std::optional<WholeVerdict> whole_verdict(const ExperimentFacts& experiment, const std::string& problem,
                                          const std::string& strategy) {
  const auto named = [&](const std::string& name) {
    const auto it = std::find_if(experiment.strategies.begin(), experiment.strategies.end(),
                                 [&](const StrategyFacts& one) { return one.name == name; });
    return it == experiment.strategies.end() ? nullptr : &*it;
  };
  const StrategyFacts* whole = named(strategy);
  if (whole == nullptr || !whole->ablation.empty() || whole->guides.size() < 2) return std::nullopt;
  const std::string planner = cost_levels(whole->text).back();
  const auto alone = std::find_if(experiment.strategies.begin(), experiment.strategies.end(),
                                  [&](const StrategyFacts& one) { return one.text == planner; });
  const StrategyFacts* reference = alone != experiment.strategies.end() ? &*alone : named(experiment.baseline());
  if (reference == nullptr || reference->guided) return std::nullopt;
  std::optional<Verdict> verdict = strategy_verdict(experiment, problem, strategy, reference->name);
  if (!verdict) return std::nullopt;
  return WholeVerdict{reference->name, *std::move(verdict)};
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
