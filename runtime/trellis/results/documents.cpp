// SPDX-License-Identifier: GPL-3.0-or-later
// Writes documents of results, whole or run by run.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include <trellis/base/version.hpp>
#include <trellis/results/columns.hpp>
#include <trellis/results/records.hpp>
#include <trellis/results/run_json.hpp>

namespace trellis {

namespace {

using json::dump;
using json::Json;

Json cost_json(const CensoredCost& cost) {
  const bool whole = cost.spent == std::floor(cost.spent);
  Json out = {{"validity_checks", whole ? Json(static_cast<std::uint64_t>(cost.spent)) : Json(cost.spent)},
              {"solved", cost.solved}};
  if (cost.cut_off) out["cut_off"] = true;
  return out;
}

/// The pairs of tested runs as a table.
Json pairs_json(const std::vector<TestedPair>& pairs) {
  json::ColumnWriter table;
  for (const TestedPair& pair : pairs) {
    table.add({{"seed", pair.seed}, {"with", cost_json(pair.with)}, {"without", cost_json(pair.without)}});
  }
  return Json::parse(table.text());
}

std::string begin_document(const std::string& version, const std::string& script, const std::string& experiment,
                           const Scenery& scenery, const std::string& samples) {
  return "{\n \"trellis\": " + dump({{"version", version}, {"format", document_format}}) +
         ",\n \"script\": " + dump(script) + ",\n \"experiment\": " + experiment + ",\n \"worlds\": " + scenery.worlds +
         ",\n \"robots\": " + scenery.robots + ",\n \"scenes\": " + scenery.scenes +
         ",\n \"samples\": " + dump(samples.empty() ? Json(nullptr) : Json(samples)) + ",\n";
}

}  // namespace

std::string json::document(const ExperimentFacts& experiment) {
  ColumnWriter pooled;
  for (const PooledScores& one : experiment.pooled) {
    for (const auto& [role, set] :
         {std::pair{"tree", &one.scores.tree}, std::pair{"expansion", &one.scores.expansion}}) {
      Json row = {{"problem", one.problem}, {"strategy", one.strategy}, {"key", one.key},
                  {"seeds", one.seeds},     {"targets", one.targets},   {"role", role}};
      add_set(*set, false, row);
      pooled.add(row);
    }
  }
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
  std::string out = begin_document(experiment.version, experiment.script, experiment.description, experiment.scenery,
                                   experiment.samples);
  RunTables tables;
  out += " \"runs\": [";
  for (std::size_t i = 0; i < experiment.runs.size(); ++i) {
    out += (i == 0 ? "\n  " : ",\n  ") + tables.add(experiment.runs[i]);
  }
  out += (experiment.runs.empty() ? "],\n" : "\n ],\n") + tables.text();
  out += " \"pooled\": " + pooled.text() + ",\n";
  out += " \"left_out\": " + lines(left_out) + ",\n";
  if (!uncoupled.empty()) out += " \"uncoupled\": " + lines(uncoupled) + ",\n";
  return out + " \"obstructions\": " + lines(obstructions) + ",\n";
}

std::string measured_set(const Efficiency& efficiency) {
  return dump(json::measured_set(&efficiency, json::Contents::all));
}
std::string estimate_line(const Estimate& estimate, const Efficiency& of) { return dump(json::estimate(estimate, of)); }

std::string run_line(const RunFacts& run) { return dump(json::run(run)); }

struct RunsDocument::Tables : json::RunTables {};

RunsDocument::RunsDocument() : tables_(std::make_unique<Tables>()) {}
RunsDocument::~RunsDocument() = default;

std::string RunsDocument::begin(const std::string& script, const std::string& experiment,
                                const Scenery& scenery) const {
  return begin_document(std::string(version()), script, experiment, scenery, "") + " \"runs\": [";
}

std::string RunsDocument::add(const RunFacts& run) {
  const std::string separator = any_ ? ",\n  " : "\n  ";
  any_ = true;
  return separator + tables_->add(run);
}

std::string RunsDocument::end() const {
  return (any_ ? "\n ],\n" : "],\n") + tables_->text() +
         " \"summary\": [],\n \"comparisons\": [],\n \"warnings\": []\n}\n";
}

}  // namespace trellis
