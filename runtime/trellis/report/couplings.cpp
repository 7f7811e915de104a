// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/couplings.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/report/csv.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

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
  coupling.verdict.kind = Verdict::Kind::not_tested;
  const std::size_t n = std::min(runs.size(), without.costs.size());
  if (n == 0) return coupling;
  std::vector<CensoredCost> with, solved_with, solved_without;
  std::size_t solved = 0, needed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    with.push_back(path_cost(*runs[i]));
    solved_with.push_back({1.0, runs[i]->solved});
    solved_without.push_back({1.0, without.costs[i].solved});
    solved += runs[i]->solved ? 1 : 0;
    needed += runs[i]->solved && !without.costs[i].solved ? 1 : 0;
  }
  coupling.needed = wilson_interval(needed, solved);
  coupling.needed.n = solved;
  coupling.costs = paired_costs(with, std::vector(without.costs.begin(), without.costs.begin() + static_cast<long>(n)));
  coupling.verdict.costs = paired_costs(solved_with, solved_without);
  return coupling;
}

}  // namespace

std::string CouplingSummary::name() const {
  if (robots.empty()) return "all robots";
  return fmt::format("robot{} {}", robots.size() == 1 ? "" : "s", fmt::join(robots, ", "));
}

std::string coupling_text(const CouplingSummary& coupling) {
  switch (coupling.verdict.kind) {
    case Verdict::Kind::pays: return "needed";
    case Verdict::Kind::costs: return "hinders";
    case Verdict::Kind::not_shown:
      if (coupling.needed.value == 0.0 && coupling.needed.n >= least_tested_seeds) return "not needed";
      return verdict_text(coupling.verdict);
    default: return verdict_text(coupling.verdict);
  }
}

const std::array<const char*, 5>& resolved_names() {
  static constexpr std::array<const char*, 5> names = {"none", "schedule", "order", "one_by_one", "together"};
  return names;
}

std::vector<CouplingSummary> couplings_of(const ExperimentFacts& experiment, const std::string& problem,
                                          const std::string& strategy) {
  std::vector<CouplingSummary> found;
  const std::vector<const RunFacts*> runs = experiment.select(problem, strategy);
  const auto of_strategy = [&](const Uncoupled& one) { return one.problem == problem && one.strategy == strategy; };
  const auto all = std::find_if(experiment.uncoupled.begin(), experiment.uncoupled.end(),
                                [&](const Uncoupled& one) { return of_strategy(one) && one.robots.empty(); });
  if (all == experiment.uncoupled.end()) return found;
  for (const Uncoupled& without : experiment.uncoupled) {
    if (of_strategy(without)) found.push_back(coupling_of(runs, without, *all));
  }
  for (std::size_t robots = 0; robots <= 2; ++robots) {
    std::vector<CouplingSummary*> rows;
    std::vector<double> p;
    for (CouplingSummary& one : found) {
      if (one.robots.size() != robots || !one.verdict.costs) continue;
      rows.push_back(&one);
      p.push_back(one.verdict.costs->sign_p);
    }
    p = holm(p);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Verdict& verdict = rows[i]->verdict;
      verdict.costs->holm_p = p[i];
      verdict = verdict_of(*verdict.costs, rows.size());
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
        const auto& solved = one.verdict.costs;
        rows += solved ? fmt::format(",{},{},{}", solved->pairs, solved->solved, solved->reference_solved) : ",,,";
        for (const double x : {one.needed.value, one.needed.lo, one.needed.hi}) rows += ',' + number(x);
        const Interval ratio = one.costs ? one.costs->ratio : Interval();
        for (const double x : {ratio.value, ratio.lo, ratio.hi}) rows += ',' + number(x);
        rows += ',' + csv_text(coupling_text(one)) + '\n';
      }
    }
  }
  if (rows.empty()) return "";
  std::string header = "problem,strategy,robots,runs,conflicts";
  for (const char* name : resolved_names()) header += fmt::format(",{}", name);
  return header +
         ",conflict_checks,seeds,solved,solved_without,needed,needed_lo,needed_hi,check_ratio,check_ratio_lo,"
         "check_ratio_hi,verdict\n" +
         rows;
}

}  // namespace trellis
