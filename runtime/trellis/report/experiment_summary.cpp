// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/experiment_summary.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <variant>

#include <trellis/base/version.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/input_warnings.hpp>
#include <trellis/experiment/left_out.hpp>
#include <trellis/experiment/scoring.hpp>
#include <trellis/report/unsolved.hpp>
#include <trellis/report/words.hpp>
#include <trellis/strategy/ablation.hpp>

namespace trellis {

namespace {

struct UniformShare {
  std::string level;
  double share;
};

void collect_shares(const GuideSpec* guide, const PlannerSpec& planner, const std::string& name,
                    std::vector<UniformShare>& out);

/// Collects the levels that search the spaces of a guide's parts.
void collect_parts(const GuideSpec& guide, std::vector<UniformShare>& out) {
  if (guide.kind() != GuideSpec::Kind::component) {
    for (const auto& term : guide.terms()) collect_parts(term.guide, out);
  } else if (guide.planner()) {
    collect_shares(guide.below(), *guide.planner(), guide.name(), out);
  }
}

void collect_shares(const GuideSpec* guide, const PlannerSpec& planner, const std::string& name,
                    std::vector<UniformShare>& out) {
  if (guide == nullptr) return;  // an unguided search samples from no other level
  for (const auto& [option, value] : planner.options().entries()) {
    const auto* share = std::get_if<double>(&value);
    if (option == "uniform" && share != nullptr) out.push_back({name, *share});
  }
  collect_parts(*guide, out);
}

/// "uniform share of proposals 0.05 at each guided level".
std::string shares_text(const StrategySpec& spec) {
  std::vector<UniformShare> shares;
  collect_shares(spec.guide(), spec.planner(), "root", shares);
  if (shares.empty()) return "no guide";
  const bool same =
      std::all_of(shares.begin(), shares.end(), [&](const UniformShare& s) { return s.share == shares.front().share; });
  if (same) {
    return fmt::format("uniform share of proposals {:g}{}", shares.front().share,
                       shares.size() > 1 ? " at each guided level" : "");
  }
  std::string text = "uniform share of proposals: ";
  for (std::size_t i = 0; i < shares.size(); ++i) {
    text += fmt::format("{}{} {:g}", i == 0 ? "" : ", ", shares[i].level, shares[i].share);
  }
  return text;
}

/// Collects the radii of the tubes of guides' proposals, 0 for the default.
/// \param whole  set to false where a guide proposes in a part of its tube only: `follow` is not "tube"
void collect_radii(const GuideSpec& guide, std::set<double>& radii, bool& whole) {
  if (guide.kind() != GuideSpec::Kind::component) {
    for (const auto& term : guide.terms()) collect_radii(term.guide, radii, whole);
    return;
  }
  if (guide.custom()) return;
  for (const auto& [option, value] : guide.options().entries()) {
    const auto* radius = std::get_if<double>(&value);
    if (option == "radius" && radius != nullptr) radii.insert(*radius);
    const auto* follow = std::get_if<std::string>(&value);
    if (option == "follow" && follow != nullptr && *follow != "tube") whole = false;
  }
}

/// Compares the tubes of the root's guides with the target. "" where one of them is no tube.
std::string tubes_text(const Experiment& experiment) {
  const auto* target = std::get_if<TubeSettings>(&experiment.measure->target);
  std::set<double> radii;
  bool whole = true;
  for (const auto& [name, spec] : experiment.strategies) {
    if (spec.guide() != nullptr) collect_radii(*spec.guide(), radii, whole);
  }
  if (target == nullptr || radii.empty()) return "";
  const bool full = target->distance == TubeSettings::Distance::full;
  if (full && whole && radii == std::set{target->delta}) return "Guides propose in the same set, their tubes.";
  std::string text;
  for (const double radius : radii) {
    text += (text.empty() ? "" : ", ") +
            (radius > 0.0 ? fmt::format("{:g} m", radius) : std::string("half the robot's bounding radius"));
  }
  return fmt::format(
      "Guides with a tube propose within {} of their path, headings included: another set than the target, and what of "
      "the target lies outside of it counts as spread; tube {{ delta = r, distance = \"full\" }} and "
      "the guide's follow = \"tube\", radius = r make them one.",
      text);
}

/// States the scores that the measure omits to save time, with the options that request them. "" if none.
std::string omitted_text(const Experiment& experiment) {
  const Measure& m = *experiment.measure;
  std::string text;
  if (m.estimators == default_estimators()) text = "other estimators (estimators = { ... })";
  const bool guided = std::any_of(experiment.strategies.begin(), experiment.strategies.end(),
                                  [](const auto& strategy) { return strategy.second.guide() != nullptr; });
  const bool crosses = m.cross > 0 && experiment.seeds.size() > 1 && std::holds_alternative<TubeSettings>(m.target);
  if (guided && crosses && !m.cross_levels) {
    text += (text.empty() ? "" : "; ");
    text += "the paths of other seeds in the lower levels' own spaces (cross_levels = true)";
  }
  return text.empty() ? "" : "Omitted: " + text + ".";
}

/// Returns the estimators that have a value.
std::vector<std::string> estimators_of(const ExperimentResult& result) {
  std::vector<std::string> estimators;
  const auto see = [&](const std::optional<Scores>& scores) {
    if (!scores) return;
    for (const Efficiency* e : {&scores->tree, &scores->expansion}) {
      if (std::isnan(e->value)) continue;
      if (std::find(estimators.begin(), estimators.end(), e->estimator) == estimators.end()) {
        estimators.push_back(e->estimator);
      }
    }
  };
  for (const auto& run : result.runs) {
    for (const auto& level : run.levels) {
      for (const auto* scores : {&level.own, &level.root, &level.own_cross, &level.root_cross}) see(*scores);
    }
  }
  return estimators;
}

std::vector<ExperimentSummary::Strategy> strategies_of(const Experiment& experiment) {
  std::vector<ExperimentSummary::Strategy> strategies;
  for (const auto& [name, spec] : experiment.strategies) {
    strategies.push_back({.name = name,
                          .text = spec.text(),
                          .shares = shares_text(spec),
                          .ablation = {},
                          .guided = spec.guide() != nullptr});
    for (const AblationLink& link : experiment.ablations) {
      if (link.strategy == name) strategies.back().ablation = link.text;
    }
  }
  return strategies;
}

/// Summarises the strategies on a problem or, with "", on all.
/// \param verdicts     of all guides
/// \param comparisons  of all problems
ProblemSummary summarise_problem(const Experiment& experiment, const ExperimentResult& result,
                                 const std::vector<ExperimentSummary::Strategy>& strategies, const std::string& problem,
                                 const std::vector<GuideVerdict>& verdicts,
                                 const std::vector<Comparison>& comparisons) {
  ProblemSummary summary;
  summary.problem = problem;
  for (const auto& [name, spec] : experiment.strategies) {
    StrategySummary one{name, summarise(experiment, result, problem, name), {}, {}, {}};
    one.verdicts = level_verdicts(verdicts, problem, name, one.runs);
    one.parts = part_verdicts(verdicts, problem, name, one.runs);
    one.unsolved = unsolved_text(select_runs(result, problem, name), spec);
    summary.strategies.push_back(std::move(one));
  }
  std::copy_if(comparisons.begin(), comparisons.end(), std::back_inserter(summary.comparisons),
               [&](const Comparison& c) { return c.problem == problem; });
  summary.warnings = guide_warnings(strategies, summary);
  return summary;
}

/// Whether a strategy of the script solves fewer than half of its runs, or not its only one.
bool fails(const ProblemSummary& problem, const std::vector<ExperimentSummary::Strategy>& strategies) {
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    if (strategies[s].ablation.empty() && mostly_unsolved(problem.strategies[s].runs)) return true;
  }
  return false;
}

}  // namespace

bool mostly_unsolved(const RunsSummary& summary) {
  return summary.solved < summary.runs && (2 * summary.solved < summary.runs || summary.runs == 1);
}

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

ExperimentSummary summarise(const Experiment& experiment, const ExperimentResult& result, const std::string& script) {
  ExperimentSummary summary;
  summary.script = script;
  summary.version = version();
  summary.strategies = strategies_of(experiment);
  summary.seeds = experiment.seeds;
  summary.baseline = baseline_of(experiment);
  summary.ablation = experiment.ablation;
  summary.spatial = !experiment.problems.empty() && experiment.problems.front().scene &&
                    experiment.problems.front().scene->world_dimension() == 3;
  summary.measured = experiment.measure.has_value();
  if (experiment.measure) {
    summary.target = target_text(experiment.measure->target);
    summary.estimators = estimators_of(result);
    summary.tubes = tubes_text(experiment);
    summary.omitted = omitted_text(experiment);
  }
  const std::vector<GuideVerdict> verdicts = guide_verdicts(experiment, result, false);
  const std::vector<Comparison> comparisons = compare(experiment, result, false);
  bool explained = false;
  for (const Problem& problem : experiment.problems) {
    summary.problems.push_back(
        summarise_problem(experiment, result, summary.strategies, problem.name, verdicts, comparisons));
    if (explained || !problem.scene || !fails(summary.problems.back(), summary.strategies)) continue;
    explained = true;
    summary.problems.back().obstruction =
        separated(problem) ? fmt::format("no run on {} can succeed: obstacles separate start and goal", problem.name)
                           : narrow_warning(problem);
  }
  if (experiment.problems.size() > 1) {
    summary.together = summarise_problem(experiment, result, summary.strategies, "",
                                         guide_verdicts(experiment, result, true), compare(experiment, result, true));
  }
  return summary;
}

std::vector<std::string> guide_warnings(const std::vector<ExperimentSummary::Strategy>& strategies,
                                        const ProblemSummary& problem) {
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
    if (checks.ratio.lo > 1.0) {
      warnings.push_back(fmt::format("{} costs more validity checks than {}, which has no guide: {} times as many",
                                     c.strategy, c.baseline, ratio_text(checks.ratio)));
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
          fmt::format("{}'s nodes cover the target less well than uniform samples: {} nats above uniform", name,
                      ends_text(above.lo, above.hi)));
    }
  }
  return warnings;
}

}  // namespace trellis
