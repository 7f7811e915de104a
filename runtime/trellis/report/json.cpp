// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/report/words.hpp>
#include <trellis/results/quantities.hpp>
#include <trellis/results/run_json.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

using json::number;

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

/// Without the ends where there are none.
Json interval_json(const Interval& interval) {
  Json out = {{"value", number(interval.value)}};
  if (std::isnan(interval.lo) && std::isnan(interval.hi)) return out;
  out["lo"] = number(interval.lo);
  out["hi"] = number(interval.hi);
  return out;
}

/// What figures over several strategies show of the samples of the root; null where no run is scored.
Json means_json(const Figure& f) {
  if (f.scored == 0) return nullptr;
  Json out = {{"runs", f.scored}};
  for (const MeasureIndex quantity :
       {MeasureIndex("D_uniform"), MeasureIndex("SE_parts.mass"), MeasureIndex("SE_parts.spread"),
        MeasureIndex("above_uniform"), MeasureIndex("hitting.nats")}) {
    json::place_of(measure_quantities.at(quantity.at()), out) = number(f[quantity].value);
  }
  return out;
}

Json means_json(const FigurePair& self, const FigurePair& cross) {
  if (self.tree.scored + self.expansion.scored + cross.tree.scored + cross.expansion.scored == 0) return nullptr;
  return {{"tree", {{"self", means_json(self.tree)}, {"cross", means_json(cross.tree)}}},
          {"expansion", {{"self", means_json(self.expansion)}, {"cross", means_json(cross.expansion)}}}};
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
  return steps;
}

Json comparison_json(const Comparison& c) {
  const PairedCosts& checks = c.validity_checks;
  return {{"problem", c.problem.empty() ? Json(nullptr) : Json(c.problem)},
          {"strategy", c.strategy},
          {"baseline", c.baseline},
          {"ablation", text_or_null(c.text)},
          {"ratio", interval_json(checks.ratio)},
          {"pairs", checks.pairs},
          {"less", checks.less},
          {"greater", checks.greater},
          {"holm_p", number(checks.holm_p)}};
}

Json bracket_json(const RatioBracket& bracket) { return {{"lo", number(bracket.lo)}, {"hi", number(bracket.hi)}}; }
Json ratio_json(const MedianRatio& ratio) {
  return {{"median", bracket_json(ratio.median)}, {"interval", bracket_json(ratio.interval)}};
}

/// null for levels without a verdict: the root, and an ablation's levels.
Json verdict_json(const Verdict& verdict) {
  if (verdict.kind == Verdict::Kind::none) return nullptr;
  const PairCounts& counts = verdict.counts;
  Json out = {{"verdict", verdict_word(verdict)},
              {"ratio", counts.pairs > 0 ? ratio_json(verdict.ratio) : Json(nullptr)},
              {"pairs", counts.pairs}};
  if (verdict.pairs_needed > 0) out["pairs_needed"] = verdict.pairs_needed;
  if (verdict.more_ablation > 0.0) out["budget_spent"] = true;
  if (verdict.together) out["together"] = true;
  if (!verdict.reason.empty()) out["explained_by"] = verdict.reason;
  return out;
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
    levels.push_back({{"key", level.key},
                      {"name", level.name},
                      {"planner", level.planner},
                      {"verdict", i < of.verdicts.size() ? verdict_json(of.verdicts[i]) : Json(nullptr)}});
  }
  Json json = {{"problem", problem},
               {"strategy", of.strategy},
               {"runs", summary.runs},
               {"solved", summary.solved},
               {"success", interval_json(summary.success)},
               {"validity_checks", interval_json(summary.validity_checks)},
               {"motion_checks", interval_json(summary.motion_checks)},
               {"time_s", interval_json(summary.seconds)},
               {"length", interval_json(summary.length)},
               {"levels", std::move(levels)}};
  if (!of.unsolved.empty()) json["unsolved_reasons"] = of.unsolved;
  if (!guides.empty()) json["guides_without_level"] = std::move(guides);
  if (!summary.levels.empty()) {
    const LevelSummary& root = summary.levels.front();
    if (Json means = means_json(root.own, root.root_cross); !means.is_null()) json["means"] = std::move(means);
  }
  if (!summary.tree_waterfall.steps.empty() || !summary.expansion_waterfall.steps.empty()) {
    json["waterfall"] = {{"tree", waterfall_json(summary.tree_waterfall)},
                         {"expansion", waterfall_json(summary.expansion_waterfall)}};
  }
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

using json::lines;

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
  return json::document(experiment) + " \"summary\": " + lines(summaries) +
         ",\n \"comparisons\": " + lines(comparisons) + ",\n \"warnings\": " + lines(warnings) + "\n}\n";
}

}  // namespace trellis
