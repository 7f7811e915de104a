// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/trial/paired_runs.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/measure/censored_cost.hpp>
#include <trellis/measure/median_bound.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/report/words.hpp>

namespace trellis::trial {

namespace {

std::string number_text(double x, int decimals) {
  if (std::isfinite(x)) return fixed(x, decimals);
  return x > 0.0 ? "∞" : "-∞";
}

/// Returns why the check names no run: so few runs are not significant, whatever their results.
std::string too_few(std::size_t n, double confidence) {
  const std::size_t least = least_for_median(confidence);
  if (n >= least) return "";
  return fmt::format("; {} show nothing with {:g} % confidence, however they come out: that takes {}",
                     plural(n, "seed"), 100.0 * confidence, least);
}

std::string what_it_did(const RunResult& run, double figure, const MedianWords& words) {
  const std::string spent = std::isfinite(figure)
                                ? fmt::format("{} {} {}", words.verb, fixed(figure, words.decimals), words.noun)
                                : words.verb + " nothing";
  return run.run.solved ? spent : fmt::format("found no path ({}); {}", to_string(run.run.status), spent);
}

std::size_t unsolved(const std::vector<const RunResult*>& runs) {
  return static_cast<std::size_t>(
      std::count_if(runs.begin(), runs.end(), [](const RunResult* run) { return !run->run.solved; }));
}

}  // namespace

std::vector<Pair> pairs_of(const std::vector<RunResult>& mine, const Trial& trial, const std::vector<RunResult>& others,
                           const Trial& other) {
  const auto fail = [&](const std::string& why) {
    throw Error(fmt::format("{} cannot be compared with {} seed by seed: {}", trial.text(), other.text(), why));
  };
  const Problem& here = trial.setup().problem;
  const Problem& there = other.setup().problem;
  if (here.name != there.name || here.start != there.start || here.goals != there.goals) {
    fail("they are on different problems");
  }
  if (trial.setup().seeds != other.setup().seeds) fail("their seeds differ");
  std::vector<Pair> pairs;
  pairs.reserve(mine.size());
  for (std::size_t i = 0; i < mine.size(); ++i) pairs.push_back({&mine[i], &others[i]});
  return pairs;
}

Verdict judge_median(const Criterion& criterion, const std::vector<RunResult>& runs, const FigureOf& figure,
                     const MedianWords& words) {
  const bool from_above = criterion.from_above();
  std::vector<double> counted;
  std::vector<const RunResult*> all;
  const RunResult* worst = nullptr;
  double most = 0.0;
  for (const RunResult& run : runs) {
    const double spent = figure(run);
    // Where the claim is "more", the cost of an unsolved run is a lower bound of its cost to a path.
    const CensoredCost cost{spent, run.run.solved};
    const double value = from_above ? cost.cost() : cost.spent;
    if (std::isnan(value)) continue;
    counted.push_back(value);
    all.push_back(&run);
    const double bad = from_above ? value : -value;
    if (worst == nullptr || bad > most) {
      worst = &run;
      most = bad;
    }
  }
  Verdict verdict;
  if (counted.empty()) {
    verdict.finding = fmt::format("no run has {}", words.noun);
    return verdict;
  }
  const double bound =
      from_above ? median_upper(counted, criterion.confidence()) : median_lower(counted, criterion.confidence());
  verdict.holds = std::isfinite(bound) && criterion.met_by(bound);
  const std::size_t lost = unsolved(all);
  verdict.finding = fmt::format("{} {} at the median of {}{}, {} {} with {:g} % confidence{}",
                                number_text(median(counted), words.decimals), words.noun, plural(counted.size(), "run"),
                                lost > 0 ? fmt::format(" ({} without a path)", lost) : "",
                                from_above ? "at most" : "at least", number_text(bound, words.decimals),
                                100.0 * criterion.confidence(), too_few(counted.size(), criterion.confidence()));
  if (verdict.holds) return verdict;
  verdict.worst = worst->seed;
  verdict.why_worst = what_it_did(*worst, figure(*worst), words);
  return verdict;
}

Verdict judge_ratio(const Criterion& criterion, const std::vector<Pair>& pairs, const FigureOf& figure,
                    const FigureOf& others, const MedianWords& words) {
  const bool less = criterion.from_above();
  std::vector<double> ratios;     // conservative: they bound the claim
  std::vector<double> unclaimed;  // as reports count
  std::vector<const RunResult*> mine;
  std::vector<const RunResult*> theirs;
  const Pair* worst = nullptr;
  double most = 0.0;
  for (const Pair& pair : pairs) {
    const CensoredCost here{figure(*pair.mine), pair.mine->run.solved};
    const CensoredCost there{others(*pair.others), pair.others->run.solved};
    const double ratio = cost_ratio(here, there, less ? Claim::less : Claim::more);
    if (std::isnan(ratio)) continue;
    if (worst == nullptr || (less ? ratio > most : ratio < most)) {
      worst = &pair;
      most = ratio;
    }
    ratios.push_back(ratio);
    unclaimed.push_back(cost_ratio(here, there));
    mine.push_back(pair.mine);
    theirs.push_back(pair.others);
  }
  Verdict verdict;
  if (ratios.empty()) {
    verdict.finding = fmt::format("{} has no run with {} to compare with", criterion.other()->name(), words.noun);
    return verdict;
  }
  const double bound =
      less ? median_upper(ratios, criterion.confidence()) : median_lower(ratios, criterion.confidence());
  verdict.holds = less ? bound < 1.0 - criterion.margin() : bound > 1.0 + criterion.margin();
  const auto as_claimed =
      std::count_if(ratios.begin(), ratios.end(), [less](double r) { return less ? r < 1.0 : r > 1.0; });
  constexpr int decimals = 2;
  verdict.finding = fmt::format(
      "{} times as {} at the median, at {} {} times with {:g} % confidence; {} on {} of {}{}{}{}",
      number_text(median(unclaimed), decimals), words.decimals == 0 ? "many" : "long", less ? "most" : "least",
      number_text(bound, decimals), 100.0 * criterion.confidence(), less ? "less" : "more", as_claimed,
      plural(ratios.size(), "seed"), unsolved(mine) > 0 ? fmt::format("; {} without a path", unsolved(mine)) : "",
      unsolved(theirs) > 0 ? fmt::format("; {} of {}'s without a path", unsolved(theirs), criterion.other()->name())
                           : "",
      too_few(ratios.size(), criterion.confidence()));
  if (verdict.holds) return verdict;
  verdict.worst = worst->mine->seed;
  verdict.why_worst =
      fmt::format("{}; {} {}", what_it_did(*worst->mine, figure(*worst->mine), words), criterion.other()->name(),
                  what_it_did(*worst->others, others(*worst->others), words));
  return verdict;
}

}  // namespace trellis::trial
