// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>

#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

/// JSON has neither NaN nor infinity: a figure that does not exist is null.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

/// As number(), but an infinite value is told apart from a missing one.
Json number_or_inf(double x) { return std::isinf(x) ? Json(x > 0 ? "inf" : "-inf") : number(x); }

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

/// Names for programs: they stay what docs/formats.md says, whatever the printed report calls them.
std::string_view status_name(Status status) {
  switch (status) {
    case Status::untried: return "untried";
    case Status::solved: return "solved";
    case Status::budget_spent: return "budget_spent";
    case Status::no_path: return "no_path";
    case Status::invalid_start: return "invalid_start";
    case Status::invalid_goal: return "invalid_goal";
    case Status::interrupted: return "interrupted";
  }
  throw Fault("unknown status");
}

/// The same fields whether there is a score or not, so that readers need no second shape.
Json efficiency_json(const Efficiency* e) {
  if (e == nullptr) {
    return {{"value", nullptr},      {"estimator", nullptr},  {"n", nullptr},
            {"in_target", nullptr},  {"undefended", nullptr}, {"uniform", nullptr},
            {"gain", nullptr},       {"coverage", nullptr},   {"uniform_coverage", nullptr},
            {"flags", Json::array()}};
  }
  const bool exists = !std::isnan(e->value);
  return {{"value", number(e->value)},
          {"estimator", exists ? Json(e->estimator) : Json(nullptr)},
          {"n", e->samples},
          {"in_target", exists ? Json(e->in_target) : Json(nullptr)},
          {"undefended", number_or_inf(e->undefended)},
          {"uniform", number(e->uniform)},
          {"gain", number(e->gain)},
          {"coverage", number(e->coverage)},
          {"uniform_coverage", number(e->uniform_coverage)},
          {"flags", e->flags}};
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
          {"proposals", r.search.proposals.size()},
          {"accepted", accepted},
          {"sources", sources_json(r.search)},
          {"nodes", r.search.nodes.size()},
          {"validity_checks", r.search.checks.validity},
          {"motion_checks", r.search.checks.motion},
          {"time_s", number(r.search.seconds)},
          {"status", status_name(r.solution.status)},
          {"solved", r.solution.solved()},
          {"efficiency", scores_json(level.own)},
          {"root_efficiency", scores_json(level.root)},
          {"coverage", level.own ? number(level.own->tree.coverage) : Json(nullptr)}};
}

Json run_json(const RunResult& run) {
  Json levels = Json::array();
  for (const auto& level : run.levels) levels.push_back(level_json(level));
  return {{"problem", run.problem},
          {"strategy", run.strategy},
          {"seed", run.seed},
          {"status", status_name(run.run.status)},
          {"solved", run.run.solved},
          {"time_s", number(run.run.seconds)},
          {"path", run.run.solved ? array(run.run.path) : Json::array()},
          {"length", run.run.solved ? number(run.run.length) : Json(nullptr)},
          {"validity_checks", run.run.validity_checks},
          {"motion_checks", run.run.motion_checks},
          {"shortcut_checks", run.run.shortcut_checks},
          {"levels", std::move(levels)}};
}

Json interval_json(const Interval& interval) {
  return {{"value", number_or_inf(interval.value)},
          {"lo", number(interval.lo)},
          {"hi", number(interval.hi)},
          {"n", interval.n},
          {"infinite", interval.infinite},
          {"statistic", interval.infinite > 0 ? "median" : "mean"}};
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

Json pair_json(const FigurePair& pair) {
  return {{"tree", figure_json(pair.tree)}, {"expansion", figure_json(pair.expansion)}};
}

Json summary_json(const RunsSummary& summary, const Json& problem, const std::string& strategy) {
  Json levels = Json::array();
  for (std::size_t i = 0; i < summary.levels.size(); ++i) {
    const LevelSummary& level = summary.levels[i];
    levels.push_back({{"level", i},
                      {"key", level.key},
                      {"name", level.name},
                      {"runs", level.runs},
                      {"solved", level.solved},
                      {"resolves_median", number(level.resolves)},
                      {"proposals_median", number(level.proposals)},
                      {"nodes_median", number(level.nodes)},
                      {"validity_checks_median", number(level.validity_checks)},
                      {"motion_checks_median", number(level.motion_checks)},
                      {"time_s_median", number(level.seconds)},
                      {"efficiency", pair_json(level.own)},
                      {"root_efficiency", pair_json(level.root)}});
  }
  return {{"problem", problem},
          {"strategy", strategy},
          {"runs", summary.runs},
          {"solved", summary.solved},
          {"success",
           {{"value", number(summary.success.value)},
            {"lo", number(summary.success.lo)},
            {"hi", number(summary.success.hi)}}},
          {"validity_checks_median", number(summary.validity_checks)},
          {"motion_checks_median", number(summary.motion_checks)},
          {"time_s_median", number(summary.seconds)},
          {"length", interval_json(summary.length)},
          {"levels", std::move(levels)}};
}

Json experiment_json(const Experiment& experiment) {
  Json problems = Json::array();
  for (const auto& p : experiment.problems) {
    problems.push_back({{"name", p.name},
                        {"space", p.space.name()},
                        {"dimension", p.space.dimension()},
                        {"start", array(View(p.start))},
                        {"goal", array(View(p.goal))},
                        {"goal_tolerance", number(p.goal_tolerance)},
                        {"resolution", number(p.resolution)},
                        {"collision", p.collision}});
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
    const TubeSettings& m = *experiment.measure;
    measure = {{"target", "tube"},     {"delta", number(m.delta)},     {"distance", m.distance},
               {"support", m.support}, {"epsilon", number(m.epsilon)}, {"points", m.points},
               {"pool", m.pool}};
  }
  return {{"measure", std::move(measure)},
          {"shortcut", experiment.shortcut},
          {"seeds", experiment.seeds},
          {"problems", std::move(problems)},
          {"strategies", std::move(strategies)}};
}

/// Names and paths come from users and need not be UTF-8; what is not becomes U+FFFD.
std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// One entry per line: readable, and line tools can pick single runs.
std::string lines(const std::vector<Json>& entries) {
  std::string out = "[";
  for (std::size_t i = 0; i < entries.size(); ++i) out += (i == 0 ? "\n  " : ",\n  ") + dump(entries[i]);
  return out + (entries.empty() ? "]" : "\n ]");
}

}  // namespace

std::string report_json(const Experiment& experiment, const ExperimentResult& result, const std::string& script) {
  std::vector<Json> runs;
  runs.reserve(result.runs.size());
  for (const auto& run : result.runs) runs.push_back(run_json(run));

  std::vector<Json> summary;
  const auto add = [&](const std::string& problem) {
    for (const auto& [strategy, spec] : experiment.strategies) {
      summary.push_back(summary_json(summarise(select_runs(result, problem, strategy)),
                                     problem.empty() ? Json(nullptr) : Json(problem), strategy));
    }
  };
  for (const auto& problem : experiment.problems) add(problem.name);
  if (experiment.problems.size() > 1) add("");  // all problems taken together

  std::string out = "{\n";
  out += " \"trellis\": " + dump({{"version", version()}}) + ",\n";
  out += " \"script\": " + dump(script) + ",\n";
  out += " \"experiment\": " + dump(experiment_json(experiment)) + ",\n";
  out += " \"runs\": " + lines(runs) + ",\n";
  out += " \"summary\": " + lines(summary) + "\n";
  return out + "}\n";
}

}  // namespace trellis
