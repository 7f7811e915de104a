// SPDX-License-Identifier: GPL-3.0-or-later
// Reads documents of results and files of records.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/results/columns.hpp>
#include <trellis/results/quantities.hpp>
#include <trellis/results/records.hpp>
#include <trellis/results/run_json.hpp>

namespace trellis {

namespace {

using json::Json;

/// Calls `body` and replaces the exceptions of the JSON library.
template <class Body>
auto parsed(const std::string& message, Body body) {
  try {
    return body();
  } catch (const Json::exception&) {
    throw Error(message);
  } catch (const std::out_of_range&) {  // of a table that names a run or a level that is not there
    throw Error(message);
  }
}

/// The pooled scores of a level.
PooledScores pooled_of(const Json& json) {
  return {.problem = json.at("problem").get<std::string>(),
          .strategy = json.at("strategy").get<std::string>(),
          .key = json.at("key").get<std::string>(),
          .seeds = json.at("seeds").get<std::size_t>(),
          .targets = json.at("targets").get<std::size_t>(),
          .scores = {json::read_measured_set(json.at("tree")), json::read_measured_set(json.at("expansion"))}};
}

/// A list before format 5, else a table with a row for the nodes and one for the proposals of each level.
void read_pooled(const Json& json, std::vector<PooledScores>& pooled) {
  if (json.is_array()) {
    for (const Json& one : json) pooled.push_back(pooled_of(one));
    return;
  }
  const json::ColumnReader table(json);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const Json row = table.row(i);
    if (row.at("role") != "tree") {
      pooled.at(pooled.size() - 1).scores.expansion = json::read_set(row);
      continue;
    }
    pooled.push_back({.problem = row.at("problem").get<std::string>(),
                      .strategy = row.at("strategy").get<std::string>(),
                      .key = row.at("key").get<std::string>(),
                      .seeds = row.at("seeds").get<std::size_t>(),
                      .targets = row.at("targets").get<std::size_t>(),
                      .scores = {json::read_set(row), {}}});
  }
}

CensoredCost cost_of(const Json& json) {
  return {json.at("validity_checks").get<double>(), json.at("solved").get<bool>(), json.value("cut_off", false)};
}

/// The pairs of a table; before format 5 a list.
std::vector<TestedPair> read_pairs(const Json& json) {
  std::vector<TestedPair> pairs;
  const auto add = [&](const Json& pair) {
    pairs.push_back({pair.at("seed").get<std::uint64_t>(), cost_of(pair.at("with")), cost_of(pair.at("without"))});
  };
  if (json.is_array()) {
    for (const Json& pair : json) add(pair);
  } else {
    const json::ColumnReader table(json);
    for (std::size_t i = 0; i < table.rows(); ++i) add(table.row(i));
  }
  return pairs;
}

/// Documents of before have the runs without alone, by seed, and do not say which of them were cut off.
std::vector<TestedPair> pairs_of(const Json& json, const ExperimentFacts& facts) {
  if (!json.contains("costs")) return read_pairs(json.at("pairs"));
  std::vector<TestedPair> pairs;
  const auto runs = facts.select(json.at("problem").get<std::string>(), json.at("strategy").get<std::string>());
  for (std::size_t i = 0; i < std::min(runs.size(), json.at("costs").size()); ++i) {
    CensoredCost without = cost_of(json.at("costs")[i]);
    without.cut_off = !without.solved;
    pairs.push_back({runs[i]->seed, path_cost(*runs[i]), without});
  }
  return pairs;
}

void read_document(const Json& document, ExperimentFacts& facts) {
  const Json trellis = document.value("trellis", Json::object());
  facts.version = trellis.value("version", "");
  facts.format = trellis.value("format", 1);
  facts.script = document.value("script", "");
  read_experiment(json::dump(document.at("experiment")), facts);
  // Missing in documents of before.
  for (const auto& [name, text] :
       {std::pair{"worlds", &facts.scenery.worlds}, std::pair{"robots", &facts.scenery.robots},
        std::pair{"scenes", &facts.scenery.scenes}}) {
    if (document.contains(name)) *text = json::lines(document.at(name).get_ref<const Json::array_t&>());
  }
  if (const Json samples = document.value("samples", Json()); samples.is_string()) samples.get_to(facts.samples);
  for (const Json& one : document.value("obstructions", Json::array())) {
    for (ProblemFacts& problem : facts.problems) {
      if (problem.name == one.at("problem")) problem.obstruction = one.at("text").get<std::string>();
    }
  }
  // Before format 5, runs have their levels, and levels their scores.
  if (document.contains("levels")) json::read_tables(document.at("levels"), document.at("measure"), facts.runs);
  read_pooled(document.value("pooled", Json::array()), facts.pooled);
  for (const Json& one : document.value("left_out", Json::array())) {
    LeftOut& left = facts.left_out.emplace_back();
    left.problem = one.at("problem").get<std::string>();
    left.strategy = one.at("strategy").get<std::string>();
    left.key = one.at("key").get<std::string>();
    left.work = one.value("work", 0.0);
    left.pairs = pairs_of(one, facts);
  }
  for (const Json& one : document.value("uncoupled", Json::array())) {
    facts.uncoupled.push_back({one.at("problem").get<std::string>(), one.at("strategy").get<std::string>(),
                               one.at("robots").get<std::vector<std::size_t>>(), pairs_of(one, facts),
                               one.value("work", 0.0)});
    if (one.contains("touching")) one.at("touching").get_to(facts.uncoupled.back().touching);
  }
}

}  // namespace

ExperimentFacts read_results(const std::string& document, const std::string& file) {
  try {
    return parsed("this is no document that trellis run --json writes", [&] {
      ExperimentFacts facts;
      // Run by run, so that the runs of a large document are not in memory as JSON.
      bool in_runs = false;
      const Json rest = Json::parse(document, [&](int depth, Json::parse_event_t event, Json& value) {
        if (event == Json::parse_event_t::key && depth == 1) in_runs = value == "runs";
        if (!in_runs || depth != 2 || event != Json::parse_event_t::object_end) return true;
        facts.runs.push_back(json::read_run(value));
        return false;
      });
      static_cast<void>(rest.at("runs"));
      read_document(rest, facts);
      return facts;
    });
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", file, error.what()));
  }
}

void require_format(const ExperimentFacts& facts, const std::string& file) {
  if (facts.format >= oldest_reported_format && facts.format <= document_format) return;
  throw Error(
      fmt::format("{}: trellis {} wrote this document in format {}, this version makes reports of {} to {}; `trellis "
                  "compare` and `verify` read it",
                  file, facts.version, facts.format, oldest_reported_format, document_format));
}

RunFacts read_run(const std::string& line) {
  return parsed("this is no record of a run", [&] { return json::read_run(Json::parse(line)); });
}

std::string pooled_line(const std::string& problem, const std::vector<PooledScores>& pooled) {
  Json all = Json::array();
  for (const PooledScores& one : pooled) all.push_back(json::pooled(one));
  return json::dump({{"problem", problem}, {"strategy", ""}, {"seed", 0}, {"pooled", std::move(all)}});
}

void restore_pooled(std::vector<PooledScores>& pooled, const std::string& line) {
  parsed("this is no record of pooled scores", [&] {
    const Json json = Json::parse(line);
    for (const Json& one : json.at("pooled")) pooled.push_back(pooled_of(one));
  });
}

namespace {

void remove_times(Json& json) {
  if (json.is_object()) {
    for (const RunQuantity& quantity : run_quantities()) {
      if (quantity.clock) json.erase(std::string(quantity.key));
    }
  }
  if (json.is_structured()) {
    for (Json& part : json) remove_times(part);
  }
}

/// Removes the fields that scoring sets.
Json without_scores(const std::string& line) {
  Json json = Json::parse(line);
  for (Json& level : json.at("levels")) {
    for (const char* name : {"measure", "metrics"}) level.erase(std::string(name));
  }
  return json;
}

}  // namespace

std::string without_times(const std::string& line) {
  Json json = Json::parse(line);
  remove_times(json);
  return json.dump();
}

bool equal_but_for_scores(const std::string& a, const std::string& b) {
  return a == b || parsed("this is no record of a run", [&] { return without_scores(a) == without_scores(b); });
}

}  // namespace trellis
