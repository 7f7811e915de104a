// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/experiment_summary.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <trellis/report/words.hpp>

namespace trellis {

namespace {

/// Returns the estimators that have a value.
std::vector<std::string> estimators_of(const ExperimentFacts& experiment) {
  std::vector<std::string> estimators;
  for (const RunFacts& run : experiment.runs) {
    for (const LevelFacts& level : run.levels) {
      for (const auto where :
           {&LevelScores::own, &LevelScores::root, &LevelScores::own_cross, &LevelScores::root_cross}) {
        for (const auto role : {&Scores::tree, &Scores::expansion}) {
          const Efficiency* e = level.score(where, role);
          if (e == nullptr || std::isnan(e->value)) continue;
          if (std::find(estimators.begin(), estimators.end(), e->estimator) == estimators.end()) {
            estimators.push_back(e->estimator);
          }
        }
      }
    }
  }
  return estimators;
}

/// Returns the verdict on the guide that an ablation is without. None where the guide's own guides are left out too.
std::optional<Verdict> left_out_verdict(const ExperimentFacts& experiment, const std::vector<GuideVerdict>& verdicts,
                                        const std::string& problem, const StrategyFacts& ablation) {
  for (const StrategyFacts& whole : experiment.strategies) {
    if (whole.name != ablation.of) continue;
    for (const GuideFacts& guide : whole.guides) {
      if (guide.equal != ablation.name) continue;
      for (const GuideVerdict& one : verdicts) {
        if (one.problem == problem && one.strategy == whole.name && one.key == guide.key) return one.verdict;
      }
    }
  }
  return std::nullopt;
}

/// Summarises the strategies on a problem or, with "", on all.
/// \param verdicts     of all guides
/// \param comparisons  of all problems
ProblemSummary summarise_problem(const ExperimentFacts& experiment, const std::string& problem,
                                 const std::vector<GuideVerdict>& verdicts,
                                 const std::vector<Comparison>& comparisons) {
  ProblemSummary summary;
  summary.problem = problem;
  for (const StrategyFacts& strategy : experiment.strategies) {
    StrategySummary one;
    one.strategy = strategy.name;
    one.runs = summarise(experiment, problem, strategy.name);
    one.verdicts = level_verdicts(verdicts, problem, strategy.name, one.runs);
    one.parts = part_verdicts(verdicts, problem, strategy.name, one.runs);
    one.whole = whole_verdict(experiment, problem, strategy.name);
    one.left_out = left_out_verdict(experiment, verdicts, problem, strategy);
    one.unsolved = unsolved_text(experiment.select(problem, strategy.name));
    one.couplings = couplings_of(experiment, problem, strategy.name);
    summary.strategies.push_back(std::move(one));
  }
  std::copy_if(comparisons.begin(), comparisons.end(), std::back_inserter(summary.comparisons),
               [&](const Comparison& c) { return c.problem == problem; });
  summary.warnings = guide_warnings(experiment, summary);
  return summary;
}

}  // namespace

std::string unsolved_text(const std::vector<const RunFacts*>& runs) {
  std::vector<std::pair<std::string, std::size_t>> found;
  std::size_t unsolved = 0;
  for (const RunFacts* run : runs) {
    if (run->solved) continue;
    ++unsolved;
    // Documents of before have no reasons.
    const std::vector<std::string> status = {std::string(to_string(run->status))};
    for (const std::string& reason : run->reasons.empty() ? status : run->reasons) {
      const auto same = [&](const auto& entry) { return entry.first == reason; };
      const auto it = std::find_if(found.begin(), found.end(), same);
      if (it == found.end()) {
        found.emplace_back(reason, 1);
      } else {
        ++it->second;
      }
    }
  }
  if (unsolved == 0) return "";
  std::string text = fmt::format("{} unsolved: ", unsolved);
  for (std::size_t i = 0; i < found.size(); ++i) {
    text += (i == 0 ? "" : "; ") + found[i].first;
    if (found[i].second < unsolved) text += fmt::format(" (in {})", found[i].second);
  }
  return text;
}

bool mostly_unsolved(const RunsSummary& summary) { return mostly_unsolved(summary.solved, summary.runs); }

std::vector<const ProblemSummary*> ExperimentSummary::listed() const {
  if (problems.size() > most_single_problems && together) return {&*together};
  std::vector<const ProblemSummary*> all;
  for (const ProblemSummary& one : problems) all.push_back(&one);
  return all;
}

std::vector<Verdict> verdicts_on(const StrategySummary& strategy, std::size_t level, const PartSummary& part) {
  std::vector<Verdict> verdicts;
  for (const GuideVerdict& one : strategy.parts) {
    const std::string key = one.key.substr(0, one.key.rfind('/'));
    const bool here = key == (level == 0 ? "0" : guide_key(strategy.runs.levels[level].key));
    // Guides of one name are numbered: "goal_bias(0.2) #2".
    if (here && one.guide.substr(0, one.guide.find(" #")) == part.name) verdicts.push_back(one.verdict);
  }
  return verdicts;
}

ExperimentSummary summarise(const ExperimentFacts& experiment) {
  ExperimentSummary summary;
  summary.script = experiment.script;
  summary.version = experiment.version;
  summary.strategies = experiment.strategies;
  summary.seeds = experiment.seeds;
  summary.baseline = experiment.baseline();
  summary.ablation = experiment.ablation;
  summary.spatial = experiment.spatial;
  summary.measured = experiment.measured;
  summary.target = experiment.target;
  summary.tubes = experiment.tubes;
  summary.omitted = experiment.omitted;
  if (experiment.measured) summary.estimators = estimators_of(experiment);
  const std::vector<GuideVerdict> verdicts = guide_verdicts(experiment, false);
  const std::vector<Comparison> comparisons = compare(experiment, false);
  for (const ProblemFacts& problem : experiment.problems) {
    summary.problems.push_back(summarise_problem(experiment, problem.name, verdicts, comparisons));
    summary.problems.back().obstruction = problem.obstruction;
  }
  if (experiment.problems.size() > 1) {
    summary.together = summarise_problem(experiment, "", guide_verdicts(experiment, true), compare(experiment, true));
  }
  summary.answer = answer_of(experiment, summary);
  return summary;
}

std::vector<std::string> guide_warnings(const ExperimentFacts& experiment, const ProblemSummary& problem) {
  const std::vector<StrategyFacts>& strategies = experiment.strategies;
  const auto guided = [&](const std::string& name) {
    const auto it =
        std::find_if(strategies.begin(), strategies.end(), [&](const auto& one) { return one.name == name; });
    return it != strategies.end() && it->guided;
  };
  std::vector<std::string> warnings;
  for (const Comparison& c : problem.comparisons) {
    // Ablations remove one of several guides: their tables show the effect of each guide.
    if (!c.text.empty() || !guided(c.strategy) || guided(c.baseline)) continue;
    const PairedCosts& checks = c.validity_checks;
    if (c.solved.difference.n >= least_for_interval && c.solved.difference.hi < 0.0) {
      warnings.push_back(fmt::format("{} solves fewer runs than {}, which has no guide: {} of {} against {}",
                                     c.strategy, c.baseline, checks.solved, checks.pairs, checks.reference_solved));
    }
    // By the test of the table, which says the same.
    const auto verdict = strategy_verdict(experiment, problem.problem, c.strategy, c.baseline);
    if (verdict && verdict->kind == Verdict::Kind::costs && verdict->ratio.median.lo >= least_effect) {
      warnings.push_back(fmt::format("{} costs more validity checks than {}, which has no guide: {}", c.strategy,
                                     c.baseline, verdict_text(*verdict).substr(verdict_word(*verdict).size() + 1)));
    }
  }
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const std::string& name = strategies[s].name;
    // Thin guidance may lie far from the target and still save checks.
    const bool saves = std::any_of(problem.comparisons.begin(), problem.comparisons.end(), [&](const Comparison& c) {
      return c.strategy == name && c.text.empty() && c.validity_checks.ratio.hi < 1.0;
    });
    const std::vector<LevelSummary>& levels = problem.strategies[s].runs.levels;
    if (!strategies[s].ablation.empty() || saves || !strategies[s].guided || levels.empty()) continue;
    // Proposals in a thin tube may have less spread than uniform ones and still save most checks: judge by the nodes.
    if (const AboveUniform above = headline(levels.front(), SampleRole::tree).above; above.hi < 0.0) {
      warnings.push_back(
          fmt::format("{}'s nodes cover the target less well than uniform samples: --report efficiency", name));
    }
  }
  return warnings;
}

}  // namespace trellis
