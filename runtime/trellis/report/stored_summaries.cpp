// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/stored_summaries.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include <trellis/base/error.hpp>
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
  const Json& parts = json.at("D_eps_parts");
  const Json& along = json.at("along");
  for (const auto& [to, from] : {std::pair{&Figure::value, &json.at("D_eps")},
                                 std::pair{&Figure::light_value, &json.at("D_eps0.01")},
                                 std::pair{&Figure::unregularised, &json.at("D")},
                                 std::pair{&Figure::gain, &json.at("gain")},
                                 std::pair{&Figure::uniform, &json.at("D_uniform")},
                                 std::pair{&Figure::perfect, &json.at("D_perfect")},
                                 std::pair{&Figure::mass, &json.at("D_mass")},
                                 std::pair{&Figure::spread, &json.at("D_parts").at("spread")},
                                 std::pair{&Figure::mass_part, &parts.at("mass")},
                                 std::pair{&Figure::spread_part, &parts.at("spread")},
                                 std::pair{&Figure::along_part, &parts.at("along")},
                                 std::pair{&Figure::across_part, &parts.at("across")},
                                 std::pair{&Figure::mass_lower95, &json.at("D_mass_lower95")},
                                 std::pair{&Figure::js, &json.at("JS")},
                                 std::pair{&Figure::coverage, &json.at("coverage")},
                                 std::pair{&Figure::uniform_coverage, &json.at("uniform_coverage")},
                                 std::pair{&Figure::coverage_half, &json.at("coverage_half")},
                                 std::pair{&Figure::along, &along},
                                 std::pair{&Figure::empty_share, &along.at("empty_share")},
                                 std::pair{&Figure::free_share, &json.at("free_share")}}) {
    f.*to = interval(*from);
  }
  for (const Json& share : along.at("samples")) f.profile.push_back(interval(share));
  for (const Json& share : along.at("target")) f.profile_target.push_back(number(share));
  // Documents of older programs have no intervals that the samples support.
  if (const Json& lo = field(json, "D_eps_lo"); !lo.is_null()) f.value_lo = interval(lo);
  if (const Json& hi = field(json, "D_eps_hi"); !hi.is_null()) f.value_hi = interval(hi);
  f.samples = number(json.at("N_median"));
  f.in_target = number(json.at("n_median"));
  f.scored = json.at("runs").get<std::size_t>();
  f.estimators = json.at("estimators").get<std::vector<std::string>>();
  if (const Json& check = json.at("check"); !check.is_null()) {
    f.check = check.at("estimator").get<std::string>();
    f.check_difference.difference = interval(check.at("difference"));
  }
  for (const auto& [flag, runs] : json.at("flags").items()) f.flags.emplace_back(flag, runs.get<std::size_t>());
  return f;
}

/// What the page prints of all seeds together.
Efficiency together(const Json& json) {
  Efficiency e;
  e.value = number(json.at("D_eps"));
  e.value_lo = number(json.at("D_eps_lo"));
  e.value_hi = number(json.at("D_eps_hi"));
  e.uniform = number(json.at("D_uniform"));
  e.perfect = number(json.at("D_perfect"));
  e.gain = number(json.at("gain"));
  e.mass_lower95 = number(json.at("D_mass_lower95"));
  e.parts.mass = number(json.at("D_eps_parts").at("mass"));
  e.parts.spread = number(json.at("D_eps_parts").at("spread"));
  e.estimator = string_of(json.at("estimator"));
  e.flags = json.at("flags").get<std::vector<std::string>>();
  if (json.at("N").is_number()) e.samples = json.at("N").get<std::size_t>();
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
                                 .tree = together(pooled.at("tree")),
                                 .expansion = together(pooled.at("expansion"))};
  }
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
  if (const auto law = json.find("bounded_loss"); law != json.end() && law->is_object()) {
    summary.beside = {.runs = law->at("runs").get<std::size_t>(),
                      .unguided_share = number(law->at("unguided_share")),
                      .unguided_won = law->at("unguided_won").get<std::size_t>(),
                      .not_set_up = law->at("not_set_up").get<std::size_t>(),
                      .no_guided = law->at("no_guided_proposal").get<std::size_t>()};
  }
  for (const Json& level : json.at("levels")) summary.levels.push_back(level_of(level));
  summary.tree_waterfall = waterfall(json.at("waterfall").at("tree"));
  summary.expansion_waterfall = waterfall(json.at("waterfall").at("expansion"));
  return summary;
}

PairedCosts costs_of(const Json& json) {
  PairedCosts costs;
  costs.ratio = interval(json.at("ratio"));
  costs.pairs = json.at("pairs").get<std::size_t>();
  costs.less = json.at("less").get<std::size_t>();
  costs.greater = json.at("greater").get<std::size_t>();
  costs.equal = json.at("equal").get<std::size_t>();
  costs.sign_p = number(json.at("sign_p"));
  costs.holm_p = number(json.at("holm_p"));
  return costs;
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

}  // namespace

std::vector<StoredSummary> read_stored_summaries(const std::string& document, const std::string& file) {
  try {
    const Json json = Json::parse(document);
    std::set<std::string> ablations;
    for (const Json& link : field(json.at("experiment"), "ablations")) {
      ablations.insert(link.at("strategy").get<std::string>());
    }
    std::vector<StoredSummary> summaries;
    for (const Json& entry : json.at("summary")) {
      const auto strategy = entry.at("strategy").get<std::string>();
      const bool ablation = ablations.contains(strategy);
      summaries.push_back({string_of(entry.at("problem")), strategy, ablation, summary_of(entry), {}, {}, {}});
      summaries.back().unsolved = string_of(field(entry, "unsolved_reasons"));
      if (ablation) continue;
      for (const Json& level : entry.at("levels")) {
        summaries.back().verdicts.push_back(stored_verdict(field(level, "verdict")));
      }
      for (const Json& part : field(entry, "guides_without_level")) {
        summaries.back().parts.push_back({string_of(entry.at("problem")), strategy, part.at("key").get<std::string>(),
                                          part.at("guide").get<std::string>(), stored_verdict(part.at("verdict"))});
      }
    }
    return summaries;
  } catch (const Json::exception&) {
    throw Error(fmt::format("{}: this is no document that trellis run --json writes", file));
  }
}

}  // namespace trellis
