// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/stored_summary.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/experiment/search_metrics.hpp>
#include <trellis/report/measures.hpp>
#include <trellis/report/resolves.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;  // flags keep their order

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double number(const Json& value) {
  if (value.is_string()) return value.get<std::string>() == "-inf" ? -infinity : infinity;
  return value.is_number() ? value.get<double>() : nan;
}

/// Returns a field, null where an older document lacks it.
const Json& field(const Json& object, const char* name) {
  static const Json none;
  if (!object.is_object()) return none;
  const auto found = object.find(name);
  return found != object.end() ? *found : none;
}

std::string string_of(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

Interval interval(const Json& json) {
  if (json.is_null()) return {};
  return {number(json.at("value")), number(json.at("lo")), number(json.at("hi")), json.at("n").get<std::size_t>(),
          json.at("infinite").get<std::size_t>()};
}

Figure figure(const Json& json) {
  Figure f;
  for (const MeasureQuantity& quantity : measure_quantities()) {
    if (quantity.over_runs == nullptr) continue;
    const Json& of = quantity.group == nullptr ? json : field(json, quantity.group);
    // The divergence of arc length is the object itself.
    const bool whole = quantity.over_runs == &Figure::along;
    if (!of.is_object()) continue;
    const Json& value = whole ? of : field(of, quantity.name);
    if (!value.is_null()) f.*quantity.over_runs = interval(value);
  }
  const Json& along = json.at("along");
  for (const Json& share : along.at("samples")) f.profile.push_back(interval(share));
  for (const Json& share : along.at("target")) f.profile_target.push_back(number(share));
  f.samples = number(json.at("N_median"));
  f.in_target = number(json.at("n_median"));
  f.scored = json.at("runs").get<std::size_t>();
  f.estimators = json.at("estimators").get<std::vector<std::string>>();
  for (const Json& reason : field(json, "reasons")) f.reasons.push_back(reason.get<std::string>());
  if (const Json& check = json.at("check"); !check.is_null()) {
    f.check = check.at("estimator").get<std::string>();
    f.check_difference.difference = interval(check.at("difference"));
  }
  for (const auto& [flag, runs] : json.at("flags").items()) f.flags.emplace_back(flag, runs.get<std::size_t>());
  return f;
}

ChainRule parts(const Json& json) {
  return {number(json.at("mass")), number(json.at("spread")), number(json.at("along")), number(json.at("across"))};
}

Estimate estimate(const std::string& estimator, const Json& json) {
  Estimate e;
  e.estimator = estimator;
  e.unregularised = number(json.at("D"));
  e.unregularised_parts = parts(json.at("D_parts"));
  e.value = number(json.at("D_eps"));
  e.parts = parts(json.at("D_eps_parts"));
  e.light_value = number(json.at("D_eps0.01"));
  e.gain = number(json.at("gain"));
  e.js = number(json.at("JS"));
  return e;
}

/// Reads the measure of one set of samples.
Efficiency efficiency(const Json& json) {
  Efficiency e;
  for (const MeasureQuantity& quantity : measure_quantities()) {
    if (quantity.field == nullptr) continue;
    const Json& of = quantity.group == nullptr ? json : field(json, quantity.group);
    quantity.field(e) = number(field(of, quantity.name));
  }
  const Json& along = field(json, "along");
  e.along.length = number(field(along, "length"));
  for (const Json& share : field(along, "target")) e.along.target.push_back(number(share));
  for (const Json& share : field(along, "samples")) e.along.samples.push_back(number(share));
  const auto count = [&](const char* name) {
    const Json& value = field(json, name);
    return value.is_number() ? value.get<std::size_t>() : 0;
  };
  e.samples = count("N");
  e.in_target = count("n");
  e.repeated = count("repeated");
  e.estimator = string_of(field(json, "estimator"));
  e.flags = json.at("flags").get<std::vector<std::string>>();
  e.reason = string_of(field(json, "reason"));
  for (const auto& [name, other] : field(json, "others").items()) e.others.push_back(estimate(name, other));
  return e;
}

/// Tree and expansion, of `self` or of `cross`.
FigurePair pair_of(const Json& roles, const char* paths) {
  return {figure(roles.at("tree").at(paths)), figure(roles.at("expansion").at(paths))};
}
FigurePair pair_of(const Json& roles) {
  if (roles.is_null()) return {};
  return {figure(roles.at("tree")), figure(roles.at("expansion"))};
}

SpentSummary spent(const Json& json) { return {number(json.at("validity_checks")), number(json.at("proposals"))}; }

/// None in documents of older programs.
MetricsSummary metrics(const Json& json) {
  MetricsSummary m;
  if (json.is_null() || !field(json, "runs").is_number()) return m;
  m.measured = json.at("runs").get<std::size_t>();
  const Json& nodes = json.at("node_shares");
  for (std::size_t c = 0; c < m.classes.size(); ++c) {
    m.classes[c] = interval(nodes.at(std::string(to_string(static_cast<NodeClass>(c)))));
  }
  m.components = interval(json.at("components"));
  m.coverage = interval(json.at("coverage"));
  m.connectivity = interval(json.at("connectivity"));
  m.information = interval(json.at("information"));
  m.information_per_sample = interval(json.at("information_per_sample"));
  const Json& proposals = json.at("proposals");
  m.invalid = interval(proposals.at("invalid"));
  m.trapped = interval(proposals.at("trapped"));
  m.redundant = interval(proposals.at("redundant"));
  m.useful = interval(proposals.at("useful"));
  return m;
}

RejectionsSummary rejections_of(const Json& json) {
  RejectionsSummary rejections;
  if (json.is_null()) return rejections;
  rejections.proposals = json.at("proposals").get<std::size_t>();
  rejections.rejected = json.at("rejected").get<std::size_t>();
  rejections.examined = json.at("examined").get<std::size_t>();
  for (const Json& one : json.at("by")) {
    rejections.by.emplace_back(one.at("obstacle").get<std::string>(), one.at("proposals").get<std::size_t>());
  }
  return rejections;
}

LevelSummary level_of(const Json& json) {
  LevelSummary level;
  level.key = json.at("key").get<std::string>();
  level.name = json.at("name").get<std::string>();
  level.parent = field(json, "parent").is_number() ? field(json, "parent").get<int>() : -1;
  level.space = string_of(field(json, "space"));
  level.dimension = field(json, "dimension").is_number() ? field(json, "dimension").get<std::size_t>() : 0;
  level.planner = string_of(field(json, "planner"));
  level.runs = json.at("runs").get<std::size_t>();
  level.solved = json.at("solved").get<std::size_t>();
  level.resolves = number(json.at("resolves_median"));
  for (const ResolveReason& reason : resolve_reasons) {
    level.resolved_for.total.*reason.count = field(json.at("resolved_for"), reason.name).is_number()
                                                 ? json.at("resolved_for").at(reason.name).get<std::uint64_t>()
                                                 : 0;
  }
  level.resolved_for.exhausted = json.at("exhausted_runs").get<std::size_t>();
  level.resolved_for.limited = json.at("limit_reached_runs").get<std::size_t>();
  level.proposals = number(json.at("proposals_median"));
  level.nodes = number(json.at("nodes_median"));
  level.validity_checks = number(json.at("validity_checks_median"));
  level.motion_checks = number(json.at("motion_checks_median"));
  level.seconds = number(json.at("time_s_median"));
  level.check_share = number(json.at("check_share"));
  level.time_share = number(json.at("time_share"));
  if (const Json& sides = json.at("spent_median"); !sides.is_null()) {
    level.guided = true;
    level.by_guided = spent(sides.at("guided"));
    level.by_unguided = spent(sides.at("unguided"));
    level.by_below = spent(sides.at("below"));
  }
  const Json& measure = json.at("measure");
  level.own = pair_of(measure, "self");
  level.own_cross = pair_of(measure, "cross");
  level.root = pair_of(measure.at("root"), "self");
  level.root_cross = pair_of(measure.at("root"), "cross");
  level.oracle = pair_of(field(measure, "oracle"));
  level.uniform = pair_of(field(measure, "uniform"));
  level.equal = pair_of(field(measure, "equal_samples"));
  if (const Json& pooled = field(measure, "pooled"); !pooled.is_null()) {
    level.pooled = PooledSummary{.seeds = pooled.at("seeds").get<std::size_t>(),
                                 .targets = pooled.at("targets").get<std::size_t>(),
                                 .tree = efficiency(pooled.at("tree")),
                                 .expansion = efficiency(pooled.at("expansion"))};
  }
  level.metrics = metrics(field(json, "metrics"));
  for (const Json& part : field(json, "guides_without_level")) {
    level.parts.push_back({part.at("name").get<std::string>(), number(part.at("proposal_share"))});
  }
  level.rejections = rejections_of(field(json, "rejections"));
  return level;
}

Waterfall waterfall(const Json& json) {
  Waterfall result{interval(json.at("D_uniform")), {}};
  for (const Json& step : json.at("steps")) {
    const Json& from = step.at("from");
    result.steps.push_back({step.at("level").get<int>(), from.is_number() ? from.get<int>() : -1,
                            interval(step.at("gain_before")), interval(step.at("gain_after")),
                            interval(step.at("added"))});
  }
  return result;
}

RunsSummary summary_of(const Json& json) {
  RunsSummary summary;
  summary.runs = json.at("runs").get<std::size_t>();
  summary.solved = json.at("solved").get<std::size_t>();
  const Json& success = json.at("success");
  summary.success = {number(success.at("value")), number(success.at("lo")), number(success.at("hi")), summary.runs, 0};
  summary.validity_checks = interval(json.at("validity_checks"));
  summary.motion_checks = interval(json.at("motion_checks"));
  summary.seconds = interval(json.at("time_s"));
  const Json& all = json.at("spent_median");
  summary.spent_validity_checks = number(all.at("validity_checks"));
  summary.spent_motion_checks = number(all.at("motion_checks"));
  summary.spent_seconds = number(all.at("time_s"));
  summary.improvement_checks = number(field(json, "improvement_checks_median"));
  summary.set_up = number(field(json, "set_up_median"));
  if (const Json& share = field(json, "set_up_share"); share.is_number()) summary.set_up_share = number(share);
  if (const Json& share = field(json, "lua_share"); share.is_number()) summary.lua_share = number(share);
  summary.length = interval(json.at("length"));
  // Missing in documents of before.
  if (json.contains("makespan")) summary.makespan = interval(json.at("makespan"));
  if (json.contains("sum_of_costs")) summary.sum_of_costs = interval(json.at("sum_of_costs"));
  // Missing in documents of before.
  if (const auto law = json.find("bounded_loss"); law != json.end() && law->is_object()) {
    summary.beside = {.runs = law->at("runs").get<std::size_t>(),
                      .unguided_share = number(law->at("unguided_share")),
                      .unguided_won = law->at("unguided_won").get<std::size_t>(),
                      .not_set_up = law->at("not_set_up").get<std::size_t>(),
                      .no_guided = law->at("no_guided_proposal").get<std::size_t>()};
  }
  if (const Json& certified = field(json, "certified"); certified.is_object()) {
    summary.certified = {.paths = certified.at("paths").get<std::size_t>(),
                         .clearance = number(certified.at("clearance")),
                         .seed = certified.at("seed").is_number() ? certified.at("seed").get<std::uint64_t>() : 0};
  }
  for (const Json& level : json.at("levels")) summary.levels.push_back(level_of(level));
  summary.tree_waterfall = waterfall(json.at("waterfall").at("tree"));
  summary.expansion_waterfall = waterfall(json.at("waterfall").at("expansion"));
  return summary;
}

PairedCosts costs_of(const Json& json) {
  PairedCosts costs;
  costs.ratio = interval(json.at("ratio"));
  costs.difference = interval(json.at("difference"));
  costs.pairs = json.at("pairs").get<std::size_t>();
  costs.solved = json.at("solved").get<std::size_t>();
  costs.reference_solved = json.at("baseline_solved").get<std::size_t>();
  costs.both_solved = json.at("both_solved").get<std::size_t>();
  costs.less = json.at("less").get<std::size_t>();
  costs.greater = json.at("greater").get<std::size_t>();
  costs.equal = json.at("equal").get<std::size_t>();
  costs.effect = number(json.at("effect"));
  costs.sign_p = number(json.at("sign_p"));
  costs.holm_p = number(json.at("holm_p"));
  return costs;
}

Paired paired_of(const Json& json) {
  Paired paired;
  if (json.is_null()) return paired;
  paired.difference = interval(json.at("difference"));
  paired.less = json.at("less").get<std::size_t>();
  paired.greater = json.at("greater").get<std::size_t>();
  paired.equal = json.at("equal").get<std::size_t>();
  paired.sign_p = number(json.at("sign_p"));
  paired.holm_p = number(json.at("holm_p"));
  return paired;
}

Comparison comparison_of(const Json& json) {
  Comparison c;
  c.problem = string_of(json.at("problem"));
  c.strategy = json.at("strategy").get<std::string>();
  c.baseline = json.at("baseline").get<std::string>();
  c.text = string_of(json.at("ablation"));
  c.solved = paired_of(json.at("solved"));
  c.validity_checks = costs_of(json.at("validity_checks"));
  c.cross = json.at("paths") == "cross";
  c.tree_above = paired_of(field(json, "tree_above_uniform"));
  c.expansion_above = paired_of(field(json, "expansion_above_uniform"));
  c.tree = paired_of(field(json, "tree_D_eps"));
  c.expansion = paired_of(field(json, "expansion_D_eps"));
  return c;
}

Verdict stored_verdict(const Json& json) {
  Verdict verdict;
  if (json.is_null()) return verdict;
  const auto word = json.at("verdict").get<std::string>();
  for (const auto kind :
       {Verdict::Kind::pays, Verdict::Kind::costs, Verdict::Kind::not_shown, Verdict::Kind::not_tested}) {
    verdict.kind = kind;
    if (verdict_word(verdict) == word) break;
  }
  if (const Json& costs = field(json, "costs"); !costs.is_null()) verdict.costs = costs_of(costs);
  if (const Json& pairs = field(json, "pairs_needed"); pairs.is_number()) {
    verdict.pairs_needed = pairs.get<std::size_t>();
  }
  verdict.together = field(json, "together").is_boolean() && json.at("together").get<bool>();
  verdict.reason = string_of(field(json, "explained_by"));
  return verdict;
}

StrategySummary strategy_of(const Json& json, bool ablation) {
  StrategySummary one{json.at("strategy").get<std::string>(), summary_of(json), {}, {}, {}};
  one.unsolved = string_of(field(json, "unsolved_reasons"));
  if (ablation) return one;
  const auto& levels = json.at("levels");
  const auto tested = [](const Json& level) { return !field(level, "verdict").is_null(); };
  const Json& guides = field(json, "guides_without_level");
  if (std::any_of(levels.begin(), levels.end(), tested) || !guides.empty()) {
    for (const Json& level : levels) one.verdicts.push_back(stored_verdict(field(level, "verdict")));
  }
  for (const Json& part : guides) {
    one.parts.push_back({string_of(json.at("problem")), one.strategy, part.at("key").get<std::string>(),
                         part.at("guide").get<std::string>(), stored_verdict(part.at("verdict"))});
  }
  return one;
}

/// Reads all but the problems.
ExperimentSummary facts_of(const Json& json) {
  ExperimentSummary summary;
  const Json& experiment = json.at("experiment");
  summary.script = json.at("script").get<std::string>();
  summary.version = json.at("trellis").at("version").get<std::string>();
  for (const Json& one : experiment.at("strategies")) {
    const auto text = one.at("text").get<std::string>();
    const bool guided = text.find(" >> ") != std::string::npos;
    summary.strategies.push_back({one.at("name").get<std::string>(), text, "", "", guided});
  }
  const auto strategy = [&](const std::string& name) {
    return std::find_if(summary.strategies.begin(), summary.strategies.end(),
                        [&](const auto& one) { return one.name == name; });
  };
  for (const Json& link : field(experiment, "ablations")) {
    const auto found = strategy(link.at("strategy").get<std::string>());
    if (found != summary.strategies.end()) found->ablation = link.at("text").get<std::string>();
  }
  summary.seeds = experiment.at("seeds").get<std::vector<std::uint64_t>>();
  summary.baseline = string_of(field(experiment, "baseline"));
  if (const Json& ablation = field(experiment, "ablation"); ablation.is_number()) summary.ablation = number(ablation);
  const Json& measure = field(experiment, "measure");
  summary.measured = !measure.is_null();
  if (summary.measured) summary.target = string_of(field(measure, "text"));
  // Missing in documents of older programs.
  const Json& report = field(json, "report");
  if (report.is_null()) return summary;
  summary.baseline = string_of(report.at("baseline"));
  summary.spatial = report.at("world_dimension") == 3;
  summary.estimators = report.at("estimators").get<std::vector<std::string>>();
  summary.tubes = string_of(report.at("tubes"));
  summary.omitted = string_of(report.at("omitted"));
  for (const Json& one : report.at("strategies")) {
    const auto found = strategy(one.at("name").get<std::string>());
    if (found == summary.strategies.end()) continue;
    found->guided = one.at("guided").get<bool>();
    found->shares = one.at("shares").get<std::string>();
  }
  return summary;
}

void add_problems(ExperimentSummary& summary, const Json& json) {
  if (json.at("summary").empty()) return;
  for (const Json& problem : json.at("experiment").at("problems")) {
    summary.problems.emplace_back().problem = problem.at("name").get<std::string>();
    summary.problems.back().strategies.resize(summary.strategies.size());
  }
  if (summary.problems.size() > 1) summary.together.emplace().strategies.resize(summary.strategies.size());
  const auto problem = [&](const Json& name) -> ProblemSummary* {
    if (name.is_null()) return summary.together ? &*summary.together : nullptr;
    const auto found = std::find_if(summary.problems.begin(), summary.problems.end(),
                                    [&](const ProblemSummary& one) { return one.problem == name.get<std::string>(); });
    return found != summary.problems.end() ? &*found : nullptr;
  };
  for (const Json& entry : json.at("summary")) {
    const auto name = entry.at("strategy").get<std::string>();
    ProblemSummary* const to = problem(entry.at("problem"));
    for (std::size_t s = 0; to != nullptr && s < summary.strategies.size(); ++s) {
      if (summary.strategies[s].name != name) continue;
      to->strategies[s] = strategy_of(entry, !summary.strategies[s].ablation.empty());
    }
  }
  for (const Json& entry : json.at("comparisons")) {
    if (ProblemSummary* const to = problem(entry.at("problem"))) to->comparisons.push_back(comparison_of(entry));
  }
  for (const Json& entry : json.at("warnings")) {
    ProblemSummary* const to = problem(entry.at("problem"));
    if (to != nullptr) to->warnings.push_back(entry.at("text").get<std::string>());
  }
  for (const Json& entry : field(field(json, "report"), "obstructions")) {
    if (ProblemSummary* const to = problem(entry.at("problem"))) to->obstruction = entry.at("text").get<std::string>();
  }
}

}  // namespace

ExperimentSummary read_summary(const std::string& document, const std::string& file) {
  try {
    const Json json = Json::parse(document);
    ExperimentSummary summary = facts_of(json);
    add_problems(summary, json);
    return summary;
  } catch (const Json::exception&) {
    throw Error(fmt::format("{}: this is no document that trellis run --json writes", file));
  }
}

}  // namespace trellis
