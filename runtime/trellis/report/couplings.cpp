// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/couplings.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/words.hpp>
#include <trellis/results/csv.hpp>

namespace trellis {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Whether all of `some` are in a group.
bool holds(const std::vector<std::size_t>& group, const std::vector<std::size_t>& some) {
  return std::all_of(some.begin(), some.end(),
                     [&](std::size_t robot) { return std::find(group.begin(), group.end(), robot) != group.end(); });
}

/// Whether a conflict is one of these robots. Where it is not known which robots touch, it is one of all of it.
bool concerns(const TeamConflict& conflict, const std::vector<std::size_t>& robots) {
  if (conflict.touching.empty()) return holds(conflict.robots, robots);
  return std::any_of(conflict.touching.begin(), conflict.touching.end(),
                     [&](const auto& pair) { return holds(pair, robots); });
}

/// \param all  the runs in which all robots pass through each other
CouplingSummary coupling_of(const std::vector<const RunFacts*>& runs, const Uncoupled& without, const Uncoupled& all) {
  CouplingSummary coupling;
  coupling.robots = without.robots;
  coupling.runs = all.touching.size();
  for (const auto& touching : all.touching) {
    const bool any =
        std::any_of(touching.begin(), touching.end(), [&](const auto& pair) { return holds(pair, without.robots); });
    coupling.conflicts += any ? 1 : 0;
  }
  for (const RunFacts* run : runs) {
    for (const TeamConflict& conflict : run->conflicts) {
      if (!concerns(conflict, without.robots)) continue;
      ++coupling.resolved[static_cast<std::size_t>(conflict.resolved)];
      coupling.checks += conflict.checks;
    }
  }
  std::size_t needed = 0;
  std::vector<RatioBracket> checks;
  for (const TestedPair& pair : without.pairs) {
    coupling.solved += pair.with.solved ? 1 : 0;
    coupling.solved_without += pair.without.solved ? 1 : 0;
    needed += pair.with.solved && !pair.without.solved && !pair.without.cut_off ? 1 : 0;
    checks.push_back(ratio_bracket(pair.with, pair.without));
  }
  coupling.pairs = without.pairs.size();
  if (coupling.pairs == 0) return coupling;
  coupling.needed = wilson_interval(needed, coupling.solved);
  coupling.needed.n = coupling.solved;
  coupling.check_ratio = median_ratio(checks);
  return coupling;
}

}  // namespace

std::string CouplingSummary::name() const {
  if (robots.empty()) return "all robots";
  return fmt::format("robot{} {}", robots.size() == 1 ? "" : "s", fmt::join(robots, ", "));
}

std::string coupling_text(const CouplingSummary& coupling) {
  if (coupling.pairs > 0 && coupling.solved + coupling.solved_without == 0) {
    return fmt::format("not shown: no path on {}", plural(coupling.pairs, "seed"));
  }
  switch (coupling.verdict.kind) {
    case Verdict::Kind::pays: return "needed";
    case Verdict::Kind::costs: return "hinders";
    case Verdict::Kind::no_difference:
    case Verdict::Kind::changes_nothing: return coupling.needed.value > 0.0 ? "mostly not needed" : "not needed";
    default: return verdict_text(coupling.verdict);
  }
}

std::vector<CouplingSummary> couplings_of(const ExperimentFacts& experiment, const std::string& problem,
                                          const std::string& strategy) {
  std::vector<CouplingSummary> found;
  std::vector<const Uncoupled*> tested;
  const std::vector<const RunFacts*> runs = experiment.select(problem, strategy);
  const auto of_strategy = [&](const Uncoupled& one) { return one.problem == problem && one.strategy == strategy; };
  const auto all = std::find_if(experiment.uncoupled.begin(), experiment.uncoupled.end(),
                                [&](const Uncoupled& one) { return of_strategy(one) && one.robots.empty(); });
  if (all == experiment.uncoupled.end()) return found;
  for (const Uncoupled& without : experiment.uncoupled) {
    if (!of_strategy(without)) continue;
    found.push_back(coupling_of(runs, without, *all));
    tested.push_back(&without);
  }
  for (std::size_t robots = 0; robots <= 2; ++robots) {
    std::vector<CouplingSummary*> rows;
    std::vector<std::vector<RatioBracket>> ratios;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i].robots.size() != robots) continue;
      rows.push_back(&found[i]);
      ratios.emplace_back();
      for (const TestedPair& pair : tested[i]->pairs) ratios.back().push_back(solved_bracket(pair.with, pair.without));
    }
    const std::vector<SequentialDecision> decisions = decide_in_rounds(ratios);
    const auto tests = static_cast<std::size_t>(
        std::count_if(ratios.begin(), ratios.end(), [](const auto& of) { return !of.empty(); }));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Verdict& verdict = rows[i]->verdict;
      verdict = verdict_of(decisions[i], ratios[i], tests, tests);
      verdict.ratio = {};
      const bool spent = ratios[i].size() < most_tested_pairs(experiment.seeds.size());
      if (verdict.kind == Verdict::Kind::not_shown && spent) verdict.more_ablation = 2.0 * experiment.ablation;
    }
  }
  return found;
}

std::string couplings_csv(const ExperimentSummary& experiment) {
  const auto number = [](double x) { return std::isnan(x) ? std::string() : fmt::format("{}", x); };
  std::string rows;
  for (const ProblemSummary& problem : experiment.problems) {
    for (const StrategySummary& strategy : problem.strategies) {
      for (const CouplingSummary& one : strategy.couplings) {
        rows += fmt::format("{},{},{},{},{}", csv_text(problem.problem), csv_text(strategy.strategy),
                            fmt::join(one.robots, " "), one.runs, one.conflicts);
        for (const std::size_t count : one.resolved) rows += fmt::format(",{}", count);
        rows += fmt::format(",{}", one.checks);
        rows += one.pairs > 0 ? fmt::format(",{},{},{}", one.pairs, one.solved, one.solved_without) : ",,,";
        for (const double x : {one.needed.value, one.needed.lo, one.needed.hi}) rows += ',' + number(x);
        const RatioBracket median = one.pairs > 0 ? one.check_ratio.median : RatioBracket{nan, nan};
        const RatioBracket interval = one.pairs > 0 ? one.check_ratio.interval : RatioBracket{nan, nan};
        for (const double x : {median.lo, median.hi, interval.lo, interval.hi}) rows += ',' + number(x);
        rows += ',' + csv_text(coupling_text(one)) + '\n';
      }
    }
  }
  if (rows.empty()) return "";
  std::string header = "problem,strategy,robots,runs,conflicts";
  for (const char* name : resolved_names()) header += fmt::format(",{}", name);
  return header +
         ",conflict_checks,seeds,solved,solved_without,needed,needed_lo,needed_hi,median_ratio_lo,"
         "median_ratio_hi,ratio_lo,ratio_hi,verdict\n" +
         rows;
}

}  // namespace trellis
