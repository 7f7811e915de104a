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
#include <trellis/experiment/experiment.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/measures.hpp>
#include <trellis/report/records.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/resolves.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/report/words.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

/// JSON has neither NaN nor infinity: a missing value is null.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

/// As number(), but distinguishes an infinite value from a missing one.
Json number_or_inf(double x) { return std::isinf(x) ? Json(x > 0 ? "inf" : "-inf") : number(x); }

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json array(View q) {
  Json out = Json::array();
  for (const double x : q) out.push_back(number(x));
  return out;
}

Json array(const Configurations& path) {
  Json out = Json::array();
  for (std::size_t i = 0; i < path.size(); ++i) out.push_back(array(path[i]));
  return out;
}

/// Names for programs: docs/formats.md fixes them, independent of the printed report.
std::string_view status_name(Status status) {
  switch (status) {
    case Status::untried: return "untried";
    case Status::solved: return "solved";
    case Status::budget_spent: return "budget_spent";
    case Status::no_path: return "no_path";
    case Status::invalid_start: return "invalid_start";
    case Status::invalid_goal: return "invalid_goal";
    case Status::interrupted: return "interrupted";
    case Status::paused: return "paused";
  }
  throw Fault("unknown status");
}

/// Has the same fields with or without a score, so that readers need only one schema.
Json efficiency_json(const Efficiency* estimated) {
  if (estimated == nullptr) {
    return {{"value", nullptr},      {"estimator", nullptr},     {"n", nullptr},
            {"in_target", nullptr},  {"unregularised", nullptr}, {"uniform", nullptr},
            {"gain", nullptr},       {"coverage", nullptr},      {"uniform_coverage", nullptr},
            {"flags", Json::array()}};
  }
  const Efficiency bounded = shown(*estimated);
  const Efficiency* const e = &bounded;
  const bool exists = !std::isnan(e->value);
  return {{"value", number(e->value)},
          {"estimator", exists ? Json(e->estimator) : Json(nullptr)},
          {"n", e->samples},
          {"in_target", exists ? Json(e->in_target) : Json(nullptr)},
          {"unregularised", number_or_inf(e->unregularised)},
          {"uniform", number(e->uniform)},
          {"gain", number(e->gain)},
          {"coverage", number(e->coverage)},
          {"uniform_coverage", number(e->uniform_coverage)},
          {"flags", e->flags}};
}

Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double x : values) out.push_back(number(x));
  return out;
}

/// The quantities of a run's measure, by group.
Json quantities_json(const Efficiency& e) {
  Json out = Json::object();
  for (const MeasureQuantity& quantity : measure_quantities()) {
    const double x = quantity.of_run(e);
    Json& to = quantity.group == nullptr ? out : out[quantity.group];
    to[quantity.name] = quantity.infinite ? number_or_inf(x) : number(x);
  }
  return out;
}

/// The chain rule: the parts sum to the divergence.
Json parts_json(const ChainRule& parts) {
  return {{"mass", number_or_inf(parts.mass)},
          {"spread", number_or_inf(parts.spread)},
          {"along", number(parts.along)},
          {"across", number_or_inf(parts.across)}};
}

Json estimate_json(const Estimate& e) {
  return {{"D", number_or_inf(e.unregularised)},
          {"D_parts", parts_json(e.unregularised_parts)},
          {"D_eps", number(e.value)},
          {"D_eps_parts", parts_json(e.parts)},
          {"D_eps0.01", number(e.light_value)},
          {"gain", number(e.gain)},
          {"JS", number(e.js)}};
}

/// Why reports print no interval of D_eps; null where they print one, and where there is no value.
Json blank_json(const Efficiency& e) {
  if (std::isnan(e.value)) return nullptr;
  const std::string reason = blank_reason(e.value_lo, e.value_hi, e.uniform);
  return reason.empty() ? Json(nullptr) : Json(reason);
}

/// All values of samples relative to a target.
Json measure_json(const Efficiency* estimated) {
  const bool scored = estimated != nullptr;
  const Efficiency bounded = scored ? shown(*estimated) : Efficiency();
  const Efficiency* const e = &bounded;
  Json others = Json::object();
  for (const Estimate& other : e->others) others[other.estimator] = estimate_json(other);
  Json out = quantities_json(*e);
  out["along"].update({{"length", number(e->along.length)},
                       {"target", numbers(e->along.target)},
                       {"samples", numbers(e->along.samples)}});
  out.update({{"N", scored ? Json(e->samples) : Json(nullptr)},
              {"n", scored && !std::isnan(e->mass) ? Json(e->in_target) : Json(nullptr)},
              {"repeated", scored ? Json(e->repeated) : Json(nullptr)},
              {"estimator", std::isnan(e->value) ? Json(nullptr) : Json(e->estimator)},
              {"others", std::move(others)},
              {"flags", e->flags},
              {"blank", blank_json(*e)},
              {"reason", e->reason.empty() ? Json(nullptr) : Json(e->reason)}});
  return out;
}

const Efficiency* role_of(const std::optional<Scores>& scores, Efficiency Scores::*role) {
  return scores ? &((*scores).*role) : nullptr;
}

Json roles_json(const std::optional<Scores>& self, const std::optional<Scores>& cross) {
  Json out = Json::object();
  for (const auto& [name, role] : {std::pair{"tree", &Scores::tree}, std::pair{"expansion", &Scores::expansion}}) {
    out[name] = {{"self", measure_json(role_of(self, role))}, {"cross", measure_json(role_of(cross, role))}};
  }
  return out;
}

/// In the level's own space, and lifted to the root's space.
Json measures_json(const LevelResult& level) {
  Json out = roles_json(level.own, level.own_cross);
  out["root"] = roles_json(level.root, level.root_cross);
  if (level.oracle) {
    out["oracle"] = {{"tree", measure_json(&level.oracle->tree)},
                     {"expansion", measure_json(&level.oracle->expansion)}};
  }
  if (level.uniform) {
    out["uniform"] = {{"tree", measure_json(&level.uniform->tree)},
                      {"expansion", measure_json(&level.uniform->expansion)}};
  }
  if (level.equal) {
    out["equal_samples"] = {{"tree", measure_json(&level.equal->tree)},
                            {"expansion", measure_json(&level.equal->expansion)}};
  }
  return out;
}

Json metrics_json(const std::optional<SearchMetrics>& metrics) {
  if (!metrics) return nullptr;
  Json nodes = Json::object();
  for (std::size_t c = 0; c < metrics->nodes.size(); ++c) {
    nodes[std::string(to_string(static_cast<NodeClass>(c)))] = metrics->nodes[c];
  }
  return {{"nodes", std::move(nodes)},
          {"components", metrics->components},
          {"coverage", number(metrics->coverage)},
          {"connectivity", number(metrics->connectivity)},
          {"information", number(metrics->information)},
          {"information_per_sample", number(metrics->information_per_sample)},
          {"proposals",
           {{"invalid", number(metrics->invalid)},
            {"trapped", number(metrics->trapped)},
            {"redundant", number(metrics->redundant)},
            {"useful", number(metrics->useful)}}}};
}

Json scores_json(const std::optional<Scores>& scores) {
  return {{"tree", efficiency_json(scores ? &scores->tree : nullptr)},
          {"expansion", efficiency_json(scores ? &scores->expansion : nullptr)}};
}

Json sources_json(const Search& search) {
  std::vector<std::size_t> drawn(search.sources.size(), 0);
  for (const auto source : search.proposal_sources) {
    if (source < drawn.size()) ++drawn[source];
  }
  Json out = Json::array();
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    out.push_back({{"name", search.sources[i]}, {"proposals", drawn[i]}});
  }
  return out;
}

Json spent_json(std::uint64_t checks, std::uint64_t proposals) {
  return {{"validity_checks", checks}, {"proposals", proposals}};
}

/// The costs of both sides of bounded loss.
Json spent_json(const LevelRecord& r) {
  if (!r.guided) return nullptr;
  return {{"guided", spent_json(r.guided_checks, r.guided_proposals)},
          {"unguided", spent_json(r.unguided_checks, r.search.proposals.size() - r.guided_proposals)},
          {"below", spent_json(r.checks_below, r.proposals_below)}};
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

/// The number of times that a level was solved again, by reason.
Json resolves_json(const Resolves& resolves) {
  Json out = Json::object();
  for (const ResolveReason& reason : resolve_reasons) out[reason.name] = resolves.*reason.count;
  return out;
}

Json level_json(const LevelResult& level) {
  const LevelRecord& r = level.record;
  std::size_t accepted = 0;
  for (const Fate fate : r.search.fates) accepted += fate == Fate::rejected ? 0 : 1;
  return {{"level", r.level},
          {"parent", r.parent < 0 ? Json(nullptr) : Json(r.parent)},
          {"depth", r.depth},
          {"key", r.key},
          {"name", r.name},
          {"space", r.space.name()},
          {"dimension", r.space.dimension()},
          {"planner", r.planner},
          {"solves", r.solves},
          {"resolved_for", resolves_json(r.resolves)},
          {"exhausted", r.resolves.exhausted},
          {"limit_reached", r.resolves.limit_reached},
          {"proposals", r.search.proposals.size()},
          {"accepted", accepted},
          {"sources", sources_json(r.search)},
          {"nodes", r.search.nodes.size()},
          {"validity_checks", r.search.checks.validity},
          {"motion_checks", r.search.checks.motion},
          {"spent", spent_json(r)},
          {"time_s", number(r.search.seconds)},
          {"status", status_name(r.solution.status)},
          {"solved", r.solution.solved()},
          {"efficiency", scores_json(level.own)},
          {"root_efficiency", scores_json(level.root)},
          {"coverage", level.own ? number(level.own->tree.coverage) : Json(nullptr)},
          {"measure", measures_json(level)},
          {"metrics", metrics_json(level.metrics)}};
}

/// A path's trajectory: controls, each constant for a number of steps of dt seconds.
Json trajectory_json(const Trajectory& trajectory) {
  return {{"dt", number(trajectory.dt)},
          {"duration_s", number(trajectory.duration())},
          {"steps", trajectory.steps},
          {"controls", array(trajectory.controls)}};
}

Json improvements_json(const std::vector<Improvement>& improvements) {
  Json out = Json::array();
  for (const Improvement& one : improvements) {
    out.push_back(
        {{"checks", one.validity_checks}, {"cpu_s", number(one.cpu_seconds)}, {"length", number(one.length)}});
  }
  return out;
}

/// The shares of the guided search and of the unguided planner beside it.
Json bounded_json(const RunRecord& run) {
  const BoundedLoss& law = run.bounded;
  if (law.bound == 0.0) return nullptr;
  return {{"bound", law.bound},
          {"constant", law.constant.work},
          {"constant_checks", law.constant.checks},
          {"largest_step", law.largest_step.work},
          {"largest_step_checks", law.largest_step.checks},
          {"guided_work", law.guided.work},
          {"guided_checks", law.guided.checks},
          {"unguided_work", law.unguided.work},
          {"unguided_checks", law.unguided.checks},
          {"set_up_work", law.set_up},
          {"guides_set_up", law.guides_set_up},
          {"unguided_proposals", law.unguided_proposals},
          {"won", !run.solved        ? "none"
                  : law.unguided_won ? "unguided"
                                     : "guided"}};
}

Json run_json(const RunResult& run) {
  Json levels = Json::array();
  for (const auto& level : run.levels) levels.push_back(level_json(level));
  Json json = {{"problem", run.problem},
               {"strategy", run.strategy},
               {"seed", run.seed},
               {"status", status_name(run.run.status)},
               {"solved", run.run.solved},
               {"time_s", number(run.run.seconds)},
               {"cpu_s", number(run.cpu_seconds)},
               {"lua_s", number(run.run.lua_seconds)},
               {"path", run.run.solved ? array(run.run.path) : Json::array()},
               {"length", run.run.solved ? number(run.run.length) : Json(nullptr)},
               {"validity_checks", run.run.validity_checks},
               {"motion_checks", run.run.motion_checks},
               {"shortcut_checks", run.run.shortcut_checks},
               {"certified", run.run.certified},
               {"clearance", run.run.certified ? number(run.run.clearance) : Json(nullptr)},
               {"path_checks", run.run.path_checks},
               {"path_cpu_s", number(run.run.path_seconds)},
               {"improvement_checks", run.run.improvement_checks},
               {"work", run.run.work},
               {"set_up_work", run.run.set_up},
               {"set_up_s", number(run.run.set_up_seconds)},
               {"refuted_paths", run.run.refuted_paths},
               {"bounded_loss", bounded_json(run.run)},
               {"improvements", improvements_json(run.run.improvements)},
               {"levels", std::move(levels)}};
  if (run.run.trajectory.dt > 0.0) json["trajectory"] = trajectory_json(run.run.trajectory);
  if (const auto& times = run.run.times) {
    json["times"] = {{"at", times->at}, {"makespan", times->makespan}, {"sum_of_costs", times->sum_of_costs}};
  }
  return json;
}

Json interval_json(const Interval& interval) {
  return {{"value", number_or_inf(interval.value)}, {"lo", number_or_inf(interval.lo)},
          {"hi", number_or_inf(interval.hi)},       {"n", interval.n},
          {"infinite", interval.infinite},          {"statistic", interval.infinite > 0 ? "median" : "mean"}};
}

Json figure_json(const Figure& figure) {
  Json flags = Json::object();
  for (const auto& [flag, runs] : figure.flags) flags[flag] = runs;
  return {{"value", interval_json(figure.value)},
          {"gain", interval_json(figure.gain)},
          {"uniform", interval_json(figure.uniform)},
          {"coverage", interval_json(figure.coverage)},
          {"uniform_coverage", interval_json(figure.uniform_coverage)},
          {"flags", std::move(flags)}};
}

/// The names of a run's measure, each with an interval over the runs.
Json measure_json(const Figure& f) {
  Json flags = Json::object();
  for (const auto& [flag, runs] : f.flags) flags[flag] = runs;
  Json profile = Json::array();
  for (const Interval& share : f.profile) profile.push_back(interval_json(share));
  Json check = nullptr;
  if (!f.check.empty()) {
    check = {{"estimator", f.check}, {"difference", interval_json(f.check_difference.difference)}};
  }
  Json out = Json::object();
  for (const MeasureQuantity& quantity : measure_quantities()) {
    if (quantity.over_runs == nullptr) continue;
    Json interval = interval_json(f.*quantity.over_runs);
    if (quantity.group == nullptr) {
      out[quantity.name] = std::move(interval);
    } else if (quantity.over_runs == &Figure::along) {
      // The divergence of arc length is the object itself.
      out[quantity.group] = std::move(interval);
    } else {
      out[quantity.group][quantity.name] = std::move(interval);
    }
  }
  out["along"].update({{"target", numbers(f.profile_target)}, {"samples", std::move(profile)}});
  out.update({{"N_median", number(f.samples)},
              {"n_median", number(f.in_target)},
              {"runs", f.scored},
              {"estimators", f.estimators},
              {"reasons", f.reasons},
              {"check", std::move(check)},
              {"flags", std::move(flags)}});
  return out;
}

Json pair_json(const FigurePair& pair) {
  return {{"tree", figure_json(pair.tree)}, {"expansion", figure_json(pair.expansion)}};
}

Json roles_json(const FigurePair& self, const FigurePair& cross) {
  return {{"tree", {{"self", measure_json(self.tree)}, {"cross", measure_json(cross.tree)}}},
          {"expansion", {{"self", measure_json(self.expansion)}, {"cross", measure_json(cross.expansion)}}}};
}

/// The figure that reports print first.
Json headline_json(const LevelSummary& level, SampleRole role) {
  const Headline found = headline(level, role);
  return {{"lo", number(found.above.lo)},
          {"hi", number(found.above.hi)},
          {"scale_lo", number(found.above.scale_lo)},
          {"scale_hi", number(found.above.scale_hi)},
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
          {"tree", measure_json(&level.pooled->tree)},
          {"expansion", measure_json(&level.pooled->expansion)}};
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
  return {{"value", number_or_inf(interval.value)}, {"lo", number_or_inf(interval.lo)},
          {"hi", number_or_inf(interval.hi)},       {"n", interval.n},
          {"infinite", interval.infinite},          {"statistic", "median"}};
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
          {"check_ratio_median", number_or_inf(c.validity_checks.ratio.value)},
          {"paths", c.cross ? "cross" : "self"},
          {"tree_above_uniform", paired_json(c.tree_above)},
          {"expansion_above_uniform", paired_json(c.expansion_above)},
          {"tree_D_eps", paired_json(c.tree)},
          {"expansion_D_eps", paired_json(c.expansion)}};
}

/// null for levels without a verdict: the root, and an ablation's levels.
Json verdict_json(const Verdict& verdict) {
  if (verdict.kind == Verdict::Kind::none) return nullptr;
  return {{"verdict", verdict_word(verdict)},
          {"costs", verdict.costs ? paired_json(*verdict.costs) : Json(nullptr)},
          {"pairs_needed", verdict.pairs_needed > 0 ? Json(verdict.pairs_needed) : Json(nullptr)},
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
          {"clearance", number_or_inf(certified.clearance)},
          {"seed", certified.paths > 0 ? Json(certified.seed) : Json(nullptr)}};
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
                      {"resolved_for", resolves_json(level.resolved_for.total)},
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
                      {"efficiency", pair_json(level.own)},
                      {"root_efficiency", pair_json(level.root)},
                      {"measure", roles_json(level.own, level.own_cross)},
                      {"metrics", metrics_json(level.metrics)},
                      {"guides_without_level", parts_json(level.parts)},
                      {"rejections", rejections_json(level.rejections)}});
    Json& measure = levels.back()["measure"];
    measure["root"] = roles_json(level.root, level.root_cross);
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
      {"validity_checks_median", number_or_inf(summary.validity_checks.value)},
      {"motion_checks_median", number_or_inf(summary.motion_checks.value)},
      {"time_s_median", number_or_inf(summary.seconds.value)},
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
  return json;
}

/// The facts beside the summaries that printed reports state.
Json report_facts_json(const ExperimentSummary& summary) {
  Json strategies = Json::array();
  for (const ExperimentSummary::Strategy& one : summary.strategies) {
    strategies.push_back({{"name", one.name}, {"guided", one.guided}, {"shares", one.shares}});
  }
  Json obstructions = Json::array();
  for (const ProblemSummary& one : summary.problems) {
    if (!one.obstruction.empty()) obstructions.push_back({{"problem", one.problem}, {"text", one.obstruction}});
  }
  return {{"baseline", text_or_null(summary.baseline)}, {"strategies", std::move(strategies)},
          {"world_dimension", summary.spatial ? 3 : 2}, {"estimators", summary.estimators},
          {"tubes", text_or_null(summary.tubes)},       {"omitted", text_or_null(summary.omitted)},
          {"obstructions", std::move(obstructions)}};
}

Json experiment_json(const Experiment& experiment) {
  Json problems = Json::array();
  for (const auto& p : experiment.problems) {
    problems.push_back({{"name", p.name},
                        {"space", p.space.name()},
                        {"dimension", p.space.dimension()},
                        {"start", array(View(p.start))},
                        {"goal", array(View(p.goal()))},
                        {"goal_tolerance", number(p.goal_tolerance)},
                        {"resolution", number(p.resolution)},
                        {"contact_tolerance", number(certificate_tolerance(p))},
                        {"collision", p.collision}});
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
    measure["uniform_mix"] = {uniform_mix, light_uniform_mix};
    measure["cross"] = m.cross;
    measure["cross_levels"] = m.cross_levels;
    measure["metrics"] = m.metrics;
    measure["text"] = target_text(m.target);
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

/// Names and paths come from users and may be invalid UTF-8; invalid bytes become U+FFFD.
std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// One entry per line: readable, and line tools can select single runs.
std::string lines(const std::vector<Json>& entries) {
  std::string out = "[";
  for (std::size_t i = 0; i < entries.size(); ++i) out += (i == 0 ? "\n  " : ",\n  ") + dump(entries[i]);
  return out + (entries.empty() ? "]" : "\n ]");
}

}  // namespace

std::string report_json(const Experiment& experiment, const ExperimentResult& result,
                        const ExperimentSummary& summary) {
  std::vector<Json> runs;
  runs.reserve(result.runs.size());
  for (const auto& run : result.runs) runs.push_back(run_json(run));

  std::vector<Json> summaries;
  std::vector<Json> comparisons;
  std::vector<Json> warnings;
  const auto add = [&](const ProblemSummary& problem) {
    const Json name = text_or_null(problem.problem);
    for (const Comparison& c : problem.comparisons) comparisons.push_back(comparison_json(c));
    for (const std::string& warning : problem.warnings) warnings.push_back({{"problem", name}, {"text", warning}});
    for (const StrategySummary& one : problem.strategies) {
      summaries.push_back(summary_json(one, name));
      const std::vector<LevelSummary>& levels = one.runs.levels;
      summaries.back()["pooled"] = levels.empty() ? Json(nullptr) : pooled_json(levels.front());
    }
  };
  for (const ProblemSummary& problem : summary.problems) add(problem);
  if (summary.together) add(*summary.together);

  std::string out = "{\n";
  out += " \"trellis\": " + dump({{"version", summary.version}}) + ",\n";
  out += " \"script\": " + dump(summary.script) + ",\n";
  out += " \"experiment\": " + dump(experiment_json(experiment)) + ",\n";
  out += " \"report\": " + dump(report_facts_json(summary)) + ",\n";
  out += " \"runs\": " + lines(runs) + ",\n";
  out += " \"summary\": " + lines(summaries) + ",\n";
  out += " \"comparisons\": " + lines(comparisons) + ",\n";
  out += " \"warnings\": " + lines(warnings) + "\n";
  return out + "}\n";
}

std::string run_line(const RunResult& run) { return dump(run_json(run)); }

std::string experiment_line(const Experiment& experiment) { return dump(experiment_json(experiment)); }

std::string runs_document_begin(const std::string& script, const std::string& experiment) {
  std::string out = "{\n";
  out += " \"trellis\": " + dump({{"version", version()}}) + ",\n";
  out += " \"script\": " + dump(script) + ",\n";
  out += " \"experiment\": " + experiment + ",\n";
  return out + " \"runs\": [";
}

std::string runs_document_run(const std::string& line, bool first) { return (first ? "\n  " : ",\n  ") + line; }

std::string runs_document_end(bool any) {
  const std::string end = any ? "\n ],\n" : "],\n";
  return end + " \"summary\": [],\n \"comparisons\": [],\n \"warnings\": []\n}\n";
}

}  // namespace trellis
