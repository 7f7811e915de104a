// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/version.hpp>
#include <trellis/experiment/facts.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/quantities.hpp>
#include <trellis/report/records.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/run_json.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

using json::number;

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double x : values) out.push_back(number(x));
  return out;
}

Json spent_json(const SpentSummary& spent) {
  return {{"validity_checks", number(spent.validity_checks)}, {"proposals", number(spent.proposals)}};
}

Json spent_json(const LevelSummary& level) {
  if (!level.guided) return nullptr;
  return {{"guided", spent_json(level.by_guided)},
          {"unguided", spent_json(level.by_unguided)},
          {"below", spent_json(level.by_below)}};
}

Json interval_json(const Interval& interval) {
  return {{"value", number(interval.value)}, {"lo", number(interval.lo)},
          {"hi", number(interval.hi)},       {"n", interval.n},
          {"infinite", interval.infinite},   {"statistic", interval.infinite > 0 ? "median" : "mean"}};
}

/// The names of a run's measure, each with an interval over the runs.
/// \param profile  whether to write the profile along the path
Json measure_json(const Figure& f, bool profile = false) {
  Json flags = Json::object();
  for (const auto& [flag, runs] : f.flags) flags[flag] = runs;
  Json check = nullptr;
  if (!f.check.empty()) {
    check = {{"estimator", f.check}, {"difference", interval_json(f.check_difference.difference)}};
  }
  Json out = Json::object();
  for (const MeasureQuantity& quantity : measure_quantities) {
    if (quantity.in_runs) json::place_of(quantity, out) = interval_json(f[MeasureIndex(quantity)]);
  }
  if (profile) {
    Json shares = Json::array();
    for (const Interval& share : f.profile) shares.push_back(interval_json(share));
    out["along"].update({{"target", numbers(f.profile_target)}, {"samples", std::move(shares)}});
  }
  out.update({{"N_median", number(f.samples)},
              {"n_median", number(f.in_target)},
              {"runs", f.scored},
              {"estimators", f.estimators},
              {"reasons", f.reasons},
              {"check", std::move(check)},
              {"flags", std::move(flags)}});
  return out;
}

/// \param profile  whether the figures on the own path have the profile along it
Json roles_json(const FigurePair& self, const FigurePair& cross, bool profile) {
  return {{"tree", {{"self", measure_json(self.tree, profile)}, {"cross", measure_json(cross.tree)}}},
          {"expansion", {{"self", measure_json(self.expansion, profile)}, {"cross", measure_json(cross.expansion)}}}};
}

/// The figure that reports print first.
Json headline_json(const LevelSummary& level, SampleRole role) {
  const Headline found = headline(level, role);
  return {{"lo", number(found.above.lo)},
          {"hi", number(found.above.hi)},
          {"exact", found.above.exact},
          {"seeds", found.seeds > 0 ? Json(found.seeds) : Json(nullptr)},
          {"blank", found.above.blank.empty() ? Json(nullptr) : Json(found.above.blank)}};
}

/// The samples of all seeds together; null without.
Json pooled_json(const LevelSummary& level) {
  if (!level.pooled) return nullptr;
  const auto differs = [&](SampleRole role) {
    return disagree(headline(level, role).above, over_runs(level, role).above);
  };
  return {{"seeds", level.pooled->seeds},
          {"targets", level.pooled->targets},
          {"headline", level.pooled->seeds + 1 >= least_for_interval},
          {"disagrees", {{"tree", differs(SampleRole::tree)}, {"expansion", differs(SampleRole::expansion)}}},
          {"tree", json::measured_set(&level.pooled->tree)},
          {"expansion", json::measured_set(&level.pooled->expansion)}};
}

Json metrics_json(const MetricsSummary& m) {
  if (m.measured == 0) return nullptr;
  Json nodes = Json::object();
  for (std::size_t c = 0; c < m.classes.size(); ++c) {
    nodes[std::string(to_string(static_cast<NodeClass>(c)))] = interval_json(m.classes[c]);
  }
  return {{"runs", m.measured},
          {"node_shares", std::move(nodes)},
          {"components", interval_json(m.components)},
          {"coverage", interval_json(m.coverage)},
          {"connectivity", interval_json(m.connectivity)},
          {"information", interval_json(m.information)},
          {"information_per_sample", interval_json(m.information_per_sample)},
          {"proposals",
           {{"invalid", interval_json(m.invalid)},
            {"trapped", interval_json(m.trapped)},
            {"redundant", interval_json(m.redundant)},
            {"useful", interval_json(m.useful)}}}};
}

Json waterfall_json(const Waterfall& waterfall) {
  Json steps = Json::array();
  for (const WaterfallStep& step : waterfall.steps) {
    steps.push_back({{"level", step.level},
                     {"from", step.from < 0 ? Json("uniform") : Json(step.from)},
                     {"gain_before", interval_json(step.before)},
                     {"gain_after", interval_json(step.after)},
                     {"added", interval_json(step.added)}});
  }
  return {{"D_uniform", interval_json(waterfall.uniform)}, {"steps", std::move(steps)}};
}

Json paired_json(const Paired& paired) {
  return {{"difference", interval_json(paired.difference)},
          {"less", paired.less},
          {"greater", paired.greater},
          {"equal", paired.equal},
          {"sign_p", number(paired.sign_p)},
          {"holm_p", number(paired.holm_p)}};
}

/// An infinite bound is not a missing one.
Json median_json(const Interval& interval) {
  return {{"value", number(interval.value)}, {"lo", number(interval.lo)},
          {"hi", number(interval.hi)},       {"n", interval.n},
          {"infinite", interval.infinite},   {"statistic", "median"}};
}

Json paired_json(const PairedCosts& paired) {
  return {{"ratio", median_json(paired.ratio)},
          {"difference", median_json(paired.difference)},
          {"pairs", paired.pairs},
          {"solved", paired.solved},
          {"baseline_solved", paired.reference_solved},
          {"both_solved", paired.both_solved},
          {"less", paired.less},
          {"greater", paired.greater},
          {"equal", paired.equal},
          {"effect", number(paired.effect)},
          {"sign_p", number(paired.sign_p)},
          {"holm_p", number(paired.holm_p)}};
}

Json comparison_json(const Comparison& c) {
  return {{"problem", c.problem.empty() ? Json(nullptr) : Json(c.problem)},
          {"strategy", c.strategy},
          {"baseline", c.baseline},
          {"ablation", c.text.empty() ? Json(nullptr) : Json(c.text)},
          {"solved", paired_json(c.solved)},
          {"validity_checks", paired_json(c.validity_checks)},
          {"check_ratio_median", number(c.validity_checks.ratio.value)},
          {"paths", c.cross ? "cross" : "self"},
          {"tree_above_uniform", paired_json(c.tree_above)},
          {"expansion_above_uniform", paired_json(c.expansion_above)},
          {"tree_SE", paired_json(c.tree)},
          {"expansion_SE", paired_json(c.expansion)}};
}

Json bracket_json(const RatioBracket& bracket) { return {{"lo", number(bracket.lo)}, {"hi", number(bracket.hi)}}; }
Json ratio_json(const MedianRatio& ratio) {
  return {{"median", bracket_json(ratio.median)}, {"interval", bracket_json(ratio.interval)}};
}

/// null for levels without a verdict: the root, and an ablation's levels.
Json verdict_json(const Verdict& verdict) {
  if (verdict.kind == Verdict::Kind::none) return nullptr;
  const PairCounts& counts = verdict.counts;
  return {{"verdict", verdict_word(verdict)},
          {"text", verdict_text(verdict)},
          {"ratio", counts.pairs > 0 ? ratio_json(verdict.ratio) : Json(nullptr)},
          {"pairs", counts.pairs},
          {"less", counts.less},
          {"greater", counts.greater},
          {"equal", counts.equal},
          {"e_less", e_value(counts.less, counts.greater)},
          {"e_greater", e_value(counts.greater, counts.less)},
          {"tests", verdict.tests},
          {"pairs_needed", verdict.pairs_needed > 0 ? Json(verdict.pairs_needed) : Json(nullptr)},
          {"budget_spent", verdict.more_ablation > 0.0},
          {"together", verdict.together},
          {"explained_by", verdict.reason.empty() ? Json(nullptr) : Json(verdict.reason)}};
}

/// What the planner without guides did beside the guided searches; null where it ran beside none.
Json beside_json(const BesideSummary& beside) {
  if (beside.runs == 0) return nullptr;
  return {{"runs", beside.runs},
          {"unguided_share", number(beside.unguided_share)},
          {"unguided_won", beside.unguided_won},
          {"not_set_up", beside.not_set_up},
          {"no_guided_proposal", beside.no_guided}};
}

Json parts_json(const std::vector<PartSummary>& parts) {
  Json out = Json::array();
  for (const PartSummary& part : parts) out.push_back({{"name", part.name}, {"proposal_share", number(part.share)}});
  return out;
}

Json rejections_json(const RejectionsSummary& rejections) {
  Json by = Json::array();
  for (const auto& [obstacle, count] : rejections.by) by.push_back({{"obstacle", obstacle}, {"proposals", count}});
  return {{"proposals", rejections.proposals},
          {"rejected", rejections.rejected},
          {"examined", rejections.examined},
          {"by", std::move(by)}};
}

Json certified_json(const CertifiedSummary& certified) {
  return {{"paths", certified.paths},
          {"clearance", number(certified.clearance)},
          {"seed", certified.paths > 0 ? Json(certified.seed) : Json(nullptr)}};
}

Json coupling_json(const CouplingSummary& coupling) {
  Json resolved = Json::object();
  for (std::size_t i = 0; i < coupling.resolved.size(); ++i) resolved[resolved_names()[i]] = coupling.resolved[i];
  return {{"robots", coupling.robots},
          {"runs", coupling.runs},
          {"conflicts", coupling.conflicts},
          {"resolved", std::move(resolved)},
          {"conflict_checks", coupling.checks},
          {"needed",
           {{"value", number(coupling.needed.value)},
            {"lo", number(coupling.needed.lo)},
            {"hi", number(coupling.needed.hi)},
            {"n", coupling.needed.n}}},
          {"check_ratio", coupling.pairs > 0 ? ratio_json(coupling.check_ratio) : Json(nullptr)},
          {"pairs", coupling.pairs},
          {"solved", coupling.solved},
          {"solved_without", coupling.solved_without},
          {"verdict", coupling_text(coupling)}};
}

Json summary_json(const StrategySummary& of, const Json& problem) {
  const RunsSummary& summary = of.runs;
  Json guides = Json::array();
  for (const GuideVerdict& part : of.parts) {
    guides.push_back({{"guide", part.guide}, {"key", part.key}, {"verdict", verdict_json(part.verdict)}});
  }
  Json levels = Json::array();
  for (std::size_t i = 0; i < summary.levels.size(); ++i) {
    const LevelSummary& level = summary.levels[i];
    levels.push_back({{"level", i},
                      {"key", level.key},
                      {"name", level.name},
                      {"parent", level.parent < 0 ? Json(nullptr) : Json(level.parent)},
                      {"space", level.space},
                      {"dimension", level.dimension},
                      {"planner", level.planner},
                      {"runs", level.runs},
                      {"solved", level.solved},
                      {"verdict", i < of.verdicts.size() ? verdict_json(of.verdicts[i]) : Json(nullptr)},
                      {"resolves_median", number(level.resolves)},
                      {"resolved_for", json::resolves(level.resolved_for.total)},
                      {"exhausted_runs", level.resolved_for.exhausted},
                      {"limit_reached_runs", level.resolved_for.limited},
                      {"proposals_median", number(level.proposals)},
                      {"nodes_median", number(level.nodes)},
                      {"validity_checks_median", number(level.validity_checks)},
                      {"motion_checks_median", number(level.motion_checks)},
                      {"spent_median", spent_json(level)},
                      {"time_s_median", number(level.seconds)},
                      {"check_share", number(level.check_share)},
                      {"time_share", number(level.time_share)},
                      {"measure", roles_json(level.own, i == 0 ? level.root_cross : level.own_cross, true)},
                      {"metrics", metrics_json(level.metrics)},
                      {"guides_without_level", parts_json(level.parts)},
                      {"rejections", rejections_json(level.rejections)}});
    Json& measure = levels.back()["measure"];
    if (i > 0) measure["root"] = roles_json(level.root, level.root_cross, false);
    for (const auto& [name, pair] : {std::pair{"oracle", &level.oracle}, std::pair{"uniform", &level.uniform}}) {
      if (pair->tree.scored + pair->expansion.scored == 0) continue;
      measure[name] = {{"tree", measure_json(pair->tree)}, {"expansion", measure_json(pair->expansion)}};
    }
    measure["headline"] = {{"tree", headline_json(level, SampleRole::tree)},
                           {"expansion", headline_json(level, SampleRole::expansion)}};
    measure["pooled"] = pooled_json(level);
    if (level.equal.tree.scored + level.equal.expansion.scored > 0) {
      measure["equal_samples"] = {{"tree", measure_json(level.equal.tree)},
                                  {"expansion", measure_json(level.equal.expansion)}};
    }
  }
  Json json = {
      {"problem", problem},
      {"strategy", of.strategy},
      {"runs", summary.runs},
      {"solved", summary.solved},
      {"unsolved_reasons", text_or_null(of.unsolved)},
      {"success",
       {{"value", number(summary.success.value)},
        {"lo", number(summary.success.lo)},
        {"hi", number(summary.success.hi)}}},
      {"validity_checks_median", number(summary.validity_checks.value)},
      {"motion_checks_median", number(summary.motion_checks.value)},
      {"time_s_median", number(summary.seconds.value)},
      {"validity_checks", median_json(summary.validity_checks)},
      {"motion_checks", median_json(summary.motion_checks)},
      {"time_s", median_json(summary.seconds)},
      {"spent_median",
       {{"validity_checks", number(summary.spent_validity_checks)},
        {"motion_checks", number(summary.spent_motion_checks)},
        {"time_s", number(summary.spent_seconds)}}},
      {"improvement_checks_median", number(summary.improvement_checks)},
      {"set_up_median", number(summary.set_up)},
      {"set_up_share", number(summary.set_up_share)},
      {"lua_share", number(summary.lua_share)},
      {"length", interval_json(summary.length)},
      {"bounded_loss", beside_json(summary.beside)},
      {"certified", certified_json(summary.certified)},
      {"levels", std::move(levels)},
      {"guides_without_level", std::move(guides)},
      {"waterfall",
       {{"tree", waterfall_json(summary.tree_waterfall)}, {"expansion", waterfall_json(summary.expansion_waterfall)}}}};
  if (summary.makespan.n > 0) {
    json["makespan"] = interval_json(summary.makespan);
    json["sum_of_costs"] = interval_json(summary.sum_of_costs);
  }
  if (!of.couplings.empty()) {
    Json& couplings = json["couplings"] = Json::array();
    for (const CouplingSummary& coupling : of.couplings) couplings.push_back(coupling_json(coupling));
  }
  return json;
}

using json::dump;
using json::lines;

Json cost_json(const CensoredCost& cost) {
  Json out = {{"validity_checks", cost.spent}, {"solved", cost.solved}};
  if (cost.cut_off) out["cut_off"] = true;
  return out;
}
Json pairs_json(const std::vector<TestedPair>& pairs) {
  Json out = Json::array();
  for (const TestedPair& pair : pairs) {
    out.push_back({{"seed", pair.seed}, {"with", cost_json(pair.with)}, {"without", cost_json(pair.without)}});
  }
  return out;
}

std::string begin_document(const std::string& version, const std::string& script, const std::string& experiment,
                           const Scenery& scenery, const std::string& samples) {
  return "{\n \"trellis\": " + dump({{"version", version}, {"format", document_format}}) +
         ",\n \"script\": " + dump(script) + ",\n \"experiment\": " + experiment + ",\n \"worlds\": " + scenery.worlds +
         ",\n \"robots\": " + scenery.robots + ",\n \"scenes\": " + scenery.scenes +
         ",\n \"samples\": " + dump(text_or_null(samples)) + ",\n";
}

}  // namespace

std::string report_json(const ExperimentFacts& experiment, const ExperimentSummary& summary) {
  std::vector<Json> summaries;
  std::vector<Json> comparisons;
  std::vector<Json> warnings;
  const auto add = [&](const ProblemSummary& problem) {
    const Json name = text_or_null(problem.problem);
    for (const Comparison& c : problem.comparisons) comparisons.push_back(comparison_json(c));
    for (const std::string& warning : problem.warnings) warnings.push_back({{"problem", name}, {"text", warning}});
    for (const StrategySummary& one : problem.strategies) summaries.push_back(summary_json(one, name));
  };
  for (const ProblemSummary& problem : summary.problems) add(problem);
  if (summary.together) add(*summary.together);
  std::vector<Json> runs;
  runs.reserve(experiment.runs.size());
  for (const RunFacts& run : experiment.runs) runs.push_back(json::run(run));
  std::vector<Json> pooled;
  for (const PooledScores& one : experiment.pooled) pooled.push_back(json::pooled(one));
  std::vector<Json> left_out;
  for (const LeftOut& one : experiment.left_out) {
    left_out.push_back({{"problem", one.problem},
                        {"strategy", one.strategy},
                        {"key", one.key},
                        {"work", one.work},
                        {"pairs", pairs_json(one.pairs)}});
  }
  std::vector<Json> uncoupled;
  for (const Uncoupled& one : experiment.uncoupled) {
    uncoupled.push_back({{"problem", one.problem},
                         {"strategy", one.strategy},
                         {"robots", one.robots},
                         {"work", one.work},
                         {"pairs", pairs_json(one.pairs)}});
    if (one.robots.empty()) uncoupled.back()["touching"] = one.touching;
  }
  std::vector<Json> obstructions;
  for (const ProblemFacts& one : experiment.problems) {
    if (!one.obstruction.empty()) obstructions.push_back({{"problem", one.name}, {"text", one.obstruction}});
  }

  std::string out =
      begin_document(summary.version, summary.script, experiment.description, experiment.scenery, experiment.samples);
  out += " \"runs\": " + lines(runs) + ",\n";
  out += " \"pooled\": " + lines(pooled) + ",\n";
  out += " \"left_out\": " + lines(left_out) + ",\n";
  if (!uncoupled.empty()) out += " \"uncoupled\": " + lines(uncoupled) + ",\n";
  out += " \"obstructions\": " + lines(obstructions) + ",\n";
  out += " \"summary\": " + lines(summaries) + ",\n";
  out += " \"comparisons\": " + lines(comparisons) + ",\n";
  out += " \"warnings\": " + lines(warnings) + "\n";
  return out + "}\n";
}

std::string measured_set(const Efficiency& efficiency) {
  return dump(json::measured_set(&efficiency, json::Contents::all));
}
std::string estimate_line(const Estimate& estimate, const Efficiency& of) { return dump(json::estimate(estimate, of)); }

std::string run_line(const RunFacts& run) { return dump(json::run(run)); }

std::string runs_document_begin(const std::string& script, const std::string& experiment, const Scenery& scenery) {
  return begin_document(std::string(version()), script, experiment, scenery, "") + " \"runs\": [";
}

std::string runs_document_run(const std::string& line, bool first) { return (first ? "\n  " : ",\n  ") + line; }

std::string runs_document_end(bool any) {
  const std::string end = any ? "\n ],\n" : "],\n";
  return end + " \"summary\": [],\n \"comparisons\": [],\n \"warnings\": []\n}\n";
}

}  // namespace trellis
