// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/stored_runs.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/results/quantities.hpp>
#include <trellis/results/records.hpp>
#include <trellis/results/run_json.hpp>

namespace trellis {

namespace {

using json::Json;

const Json& levels_of(const Json& json, const RunResult& run) {
  const Json& levels = json.at("levels");
  if (levels.size() != run.levels.size()) {
    throw Error(fmt::format("the record has {} levels, the run has {}", levels.size(), run.levels.size()));
  }
  return levels;
}

}  // namespace

std::string scores_line(const RunResult& run) {
  const RunFacts facts = facts_of(run);
  Json levels = Json::array();
  for (std::size_t i = 0; i < run.levels.size(); ++i) {
    Json& level = levels.emplace_back(Json::object());
    // Without rounding, as scores over all runs are computed from these.
    json::add_scores(facts.levels[i].scores ? &run.levels[i] : nullptr, i == 0, level);
    if (run.levels[i].metrics) level["classes"] = run.levels[i].metrics->classes;
  }
  Json points = Json::array();
  for (const double x : run.target.values()) points.push_back(x);
  return json::dump({{"problem", run.problem},
                     {"strategy", run.strategy},
                     {"seed", run.seed},
                     {"levels", std::move(levels)},
                     {"target", {{"dimension", run.target.dimension()}, {"points", std::move(points)}}}});
}

void restore_scores(RunResult& run, const std::string& line) {
  try {
    const Json json = Json::parse(line);
    const Json& levels = levels_of(json, run);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const auto scores = json::read_scores(levels[i], i == 0);
      static_cast<LevelScores&>(run.levels[i]) = scores ? *scores : LevelScores();
      if (!levels[i].contains("classes")) continue;
      for (const Json& one : levels[i].at("classes")) {
        const int number = one.get<int>();
        if (number < 0 || number > static_cast<int>(NodeClass::invalid)) {
          throw Error(
              fmt::format("a node has class {}; there are 0 to {}", number, static_cast<int>(NodeClass::invalid)));
        }
        if (auto& metrics = run.levels[i].metrics) metrics->classes.push_back(static_cast<NodeClass>(number));
      }
    }
    const Json& target = json.at("target");
    const auto points = target.at("points").get<std::vector<double>>();
    const auto dimension = target.at("dimension").get<std::size_t>();
    const std::size_t expected = run.levels.empty() ? dimension : run.levels.front().record.space.dimension();
    if (!points.empty() && dimension != expected) {
      throw Error(fmt::format("the target's points have {} coordinates, the run's have {}", dimension, expected));
    }
    run.target = Configurations(dimension);
    for (std::size_t i = 0; dimension > 0 && i + dimension <= points.size(); i += dimension) {
      run.target.push(View(points).subspan(i, dimension));
    }
  } catch (const Json::exception&) {
    throw Error("this is no record of scores");
  }
}

void restore_times(RunResult& run, const std::string& line) {
  const RunFacts stored = read_run(line);
  if (stored.levels.size() != run.levels.size()) {
    throw Error(fmt::format("the record has {} levels, the run has {}", stored.levels.size(), run.levels.size()));
  }
  for (const RunQuantity& quantity : run_quantities()) {
    if (!quantity.clock) continue;
    std::visit([&](auto member) { run.run.*member = stored.*member; }, quantity.field);
  }
  run.cpu_seconds = stored.cpu_seconds;
  for (std::size_t i = 0; i < std::min(stored.improvements.size(), run.run.improvements.size()); ++i) {
    run.run.improvements[i].cpu_seconds = stored.improvements[i].cpu_seconds;
  }
  for (std::size_t i = 0; i < stored.levels.size(); ++i) {
    run.levels[i].record.search.seconds = stored.levels[i].seconds;
  }
}

}  // namespace trellis
