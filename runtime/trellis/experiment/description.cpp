// SPDX-License-Identifier: GPL-3.0-or-later
// What was requested of an experiment, as the object `experiment` of the document: written and read here.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <variant>

#include <trellis/base/version.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/input_warnings.hpp>
#include <trellis/experiment/left_out.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/strategy/ablation.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

/// JSON has neither NaN nor infinity: a missing value is null.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json array(View q) {
  Json out = Json::array();
  for (const double x : q) out.push_back(number(x));
  return out;
}

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

/// The guides of a strategy that may be left out to decide whether they pay; none of an ablation.
Json guides_json(const Experiment& experiment, const std::string& name, const StrategySpec& spec) {
  Json guides = Json::array();
  if (is_ablation(experiment, name)) return guides;
  for (const Ablation& ablation : decisive_ablations(spec)) {
    const auto* equal = equal_strategy(experiment, name, ablation.strategy);
    guides.push_back({{"key", ablation.key},
                      {"guide", ablation.guide},
                      {"equal", equal != nullptr ? Json(equal->first) : Json(nullptr)}});
  }
  return guides;
}

/// The names of the coordinates: of an arm those of its joints.
Json names_of(const Space& space) {
  Json names = Json::array();
  for (const Axis& axis : space.coordinates()) names.push_back(axis.name);
  return names;
}

Json experiment_json(const Experiment& experiment) {
  Json problems = Json::array();
  for (const auto& p : experiment.problems) {
    problems.push_back({{"name", p.name},
                        {"space", p.space.name()},
                        {"dimension", p.space.dimension()},
                        {"coordinates", names_of(p.space)},
                        {"start", array(View(p.start))},
                        {"goal", p.goals.empty() ? Json(nullptr) : array(View(p.goal()))},
                        {"goal_tolerance", number(p.goal_tolerance)},
                        {"resolution", number(p.resolution)},
                        {"contact_tolerance", number(certificate_tolerance(p))},
                        {"collision", p.collision},
                        {"world_dimension", p.scene ? Json(p.scene->world_dimension()) : Json(nullptr)}});
    const auto group = std::find_if(experiment.groups.begin(), experiment.groups.end(), [&](const ProblemGroup& g) {
      return std::find(g.problems.begin(), g.problems.end(), p.name) != g.problems.end();
    });
    if (group != experiment.groups.end()) {
      problems.back()["group"] = group->name;
      problems.back()["tuned"] = group->tuned;
    }
    for (std::size_t i = 1; i < p.goals.size(); ++i)
      problems.back()["further_goals"].push_back(array(View(p.goals[i])));
    if (p.motion_model) problems.back()["motion"] = p.motion_model->text();
  }
  Json strategies = Json::array();
  for (const auto& [name, spec] : experiment.strategies) {
    strategies.push_back({{"name", name},
                          {"text", spec.text()},
                          {"hash", fmt::format("{:016x}", spec.hash())},
                          {"guided", spec.guide() != nullptr},
                          {"shares", shares_text(spec)},
                          {"guides", guides_json(experiment, name, spec)},
                          {"spec", Json::parse(spec.json())}});
  }
  Json measure = nullptr;
  if (experiment.measure) {
    const Measure& m = *experiment.measure;
    const TargetSettings& common = common_settings(m.target);
    measure = {{"target", target_name(m.target)},
               {"delta", number(common.delta)},
               {"points", common.points},
               {"pool", common.pool}};
    if (const auto* tube = std::get_if<TubeSettings>(&m.target)) {
      measure["distance"] = to_string(tube->distance);
      measure["support"] = to_string(tube->support);
    } else if (const auto* near = std::get_if<NearOptimalSettings>(&m.target)) {
      measure["epsilon"] = number(near->epsilon);
      measure["nodes"] = near->nodes;
    } else if (const auto* progress = std::get_if<ProgressSettings>(&m.target)) {
      measure["step"] = number(progress->step);
      measure["controls"] = progress->controls;
    }
    Json estimators = Json::array();
    for (const auto& estimator : m.estimators) estimators.push_back(estimator.text());
    measure["estimators"] = std::move(estimators);
    measure["uniform_mix"] = uniform_mix;
    measure["cross"] = m.cross;
    measure["cross_levels"] = m.cross_levels;
    measure["metrics"] = m.metrics;
    measure["text"] = target_text(m.target);
    measure["tubes"] = tubes_text(experiment);
    measure["omitted"] = omitted_text(experiment);
  }
  Json ablations = Json::array();
  for (const auto& link : experiment.ablations) {
    ablations.push_back({{"strategy", link.strategy}, {"of", link.of}, {"text", link.text}});
  }
  return {{"measure", std::move(measure)},
          {"shortcut", experiment.shortcut},
          {"seeds", experiment.seeds},
          {"problems", std::move(problems)},
          {"strategies", std::move(strategies)},
          {"baseline", experiment.baseline.empty() ? Json(nullptr) : Json(experiment.baseline)},
          {"ablations", std::move(ablations)},
          {"ablation", experiment.ablation}};
}

/// Whether a strategy of the script solves fewer than half of its runs on a problem, or not its only one.
bool fails(const ExperimentFacts& facts, const std::string& problem) {
  return std::any_of(facts.strategies.begin(), facts.strategies.end(), [&](const StrategyFacts& strategy) {
    if (!strategy.ablation.empty()) return false;
    const auto runs = facts.select(problem, strategy.name);
    const auto solved = static_cast<std::size_t>(
        std::count_if(runs.begin(), runs.end(), [](const RunFacts* run) { return run->solved; }));
    return mostly_unsolved(solved, runs.size());
  });
}

/// Explains the first problem that most runs of a strategy do not solve.
void add_obstruction(const Experiment& experiment, ExperimentFacts& facts) {
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    const Problem& problem = experiment.problems[p];
    if (!problem.scene || !fails(facts, problem.name)) continue;
    facts.problems[p].obstruction =
        separated(problem) ? fmt::format("no run on {} can succeed: obstacles separate start and goal", problem.name)
                           : narrow_warning(problem);
    return;
  }
}

}  // namespace

std::string experiment_line(const Experiment& experiment) {
  // Names come from users and may be invalid UTF-8; invalid bytes become U+FFFD.
  return experiment_json(experiment).dump(-1, ' ', false, Json::error_handler_t::replace);
}

ExperimentFacts facts_of(const Experiment& experiment, const ExperimentResult& result, const std::string& script) {
  ExperimentFacts facts;
  facts.format = document_format;
  facts.script = script;
  facts.version = version();
  read_experiment(experiment_line(experiment), facts);
  // With the bytes of the names.
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) facts.problems[p].name = experiment.problems[p].name;
  for (std::size_t s = 0; s < experiment.strategies.size(); ++s) {
    facts.strategies[s].name = experiment.strategies[s].first;
  }
  facts.given_baseline = experiment.baseline;
  facts.runs.reserve(result.runs.size());
  for (const RunResult& run : result.runs) facts.runs.push_back(facts_of(run));
  facts.pooled = result.pooled;
  for (PooledScores& one : facts.pooled) {
    one.scores = {rounded(one.scores.tree), rounded(one.scores.expansion)};
  }
  facts.left_out = result.left_out;
  facts.uncoupled = result.uncoupled;
  add_obstruction(experiment, facts);
  return facts;
}

}  // namespace trellis
