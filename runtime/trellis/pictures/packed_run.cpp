// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/packed_run.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/pictures/axes_json.hpp>
#include <trellis/pictures/base64.hpp>
#include <trellis/pictures/packing.hpp>
#include <trellis/pictures/traces.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/directories.hpp>
#include <trellis/results/run_json.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

/// Returns the coordinates as LevelRows has them.
std::string bytes_of(const Configurations& rows, const Space& space) {
  const std::vector<Axis> axes = space.coordinates();
  std::string bytes;
  bytes.reserve(2 * rows.values().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const View q = rows[i];
    for (std::size_t j = 0; j < q.size(); ++j) {
      const Axis& axis = axes[j];
      const double share = (q[j] - axis.lo) / (axis.hi - axis.lo);
      const auto value =
          static_cast<std::uint32_t>(share > 0.0 ? std::lround(65535.0 * std::min(share, 1.0)) : 0);  // NaN: 0
      bytes += static_cast<char>(value & 255U);
      bytes += static_cast<char>(value >> 8U);
    }
  }
  return bytes;
}

/// Returns what LevelRows::fates has.
std::string fates_of(const LevelRecord& record, const Search& search, const Problem& problem) {
  std::unique_ptr<Checker> checker;
  if (record.scene && record.places_robot && !record.presumed &&
      record.space.dimension() >= record.scene->robot_dimension()) {
    // A space may be that of another kind of robot, as the hand's positions are of an arm.
    const std::vector<std::string> known = collision_backends(*record.scene);
    const bool same = std::find(known.begin(), known.end(), problem.collision) != known.end();
    checker = make_checker(same ? problem.collision : known.front(), record.scene, record.space, problem.resolution);
  }
  std::string bytes;
  bytes.reserve(search.proposals.size());
  for (std::size_t i = 0; i < search.proposals.size(); ++i) {
    const Fate fate = i < search.fates.size() ? search.fates[i] : Fate::rejected;
    unsigned validity = 0;
    if (fate == Fate::reached && !record.presumed) {
      validity = 1;
    } else if (checker) {
      validity = checker->valid(search.proposals[i]) ? 1 : 2;
    }
    bytes += static_cast<char>(static_cast<unsigned>(fate) | (validity << 2U));
  }
  return bytes;
}

/// Returns a row where the search has it.
std::uint32_t row_or_none(const std::vector<std::uint32_t>& rows, std::size_t i, const Search& search) {
  const std::uint32_t row = i < rows.size() ? rows[i] : no_node;
  return row < search.nodes.size() ? row : LevelRows::no_row;
}

LevelRows rows_of(const LevelResult& level, const Problem& problem) {
  const LevelRecord& record = level.record;
  const Search& search = record.search;
  LevelRows rows;
  rows.dimension = record.space.dimension();
  rows.nodes = bytes_of(search.nodes, record.space);
  rows.proposals = bytes_of(search.proposals, record.space);
  rows.fates = fates_of(record, search, problem);
  const bool tree =
      search.parents.size() == search.nodes.size() &&
      std::any_of(search.parents.begin(), search.parents.end(), [](std::uint32_t p) { return p != no_node; });
  for (std::size_t i = 0; tree && i < search.parents.size(); ++i) {
    rows.parents.push_back(search.parents[i] == no_node ? static_cast<std::uint32_t>(i) : search.parents[i]);
  }
  for (const auto& [a, b] : search.edges) rows.edges.emplace_back(a, b);
  if (level.metrics && level.metrics->classes.size() == search.nodes.size()) {
    for (const NodeClass one : level.metrics->classes) rows.classes += static_cast<char>(one);
  }
  for (std::size_t i = 0; i < search.proposals.size(); ++i) {
    rows.sources.push_back(i < search.proposal_sources.size() ? search.proposal_sources[i] : 0);
    rows.near.push_back(row_or_none(search.near, i, search));
    rows.added.push_back(row_or_none(search.added, i, search));
  }
  return rows;
}

Json level_json(const std::vector<LevelResult>& levels, std::size_t number, const Problem& problem,
                RobotTable& robots) {
  const LevelResult& level = levels[number];
  const LevelRecord& record = level.record;
  Json position = Json::array();
  for (const std::size_t axis : record.position_axes) position.push_back(axis);
  Json json = {{"name", record.name},
               {"parent", record.parent},
               {"depth", record.depth},
               {"space", record.space.name()},
               {"planner", record.planner},
               {"solves", record.solves},
               {"axes", axes_json(record.space)},
               {"position", std::move(position)},
               {"robot", robots.add(record.scene.get())},
               {"sources", record.search.sources}};
  add_rows(rows_of(level, problem), json);
  json["all"] = {record.search.proposals.size(), record.search.nodes.size()};
  if (!record.space.flat()) json["rotations"] = rotations_json(record.space);
  if (problem.scene && problem.scene->members().size() > 1) {
    json["traces"] = traces_json(traces_of(levels, number));
    json["first"] = first_coordinate(levels, number);
  }
  return json;
}

Json turns_json(const RunResult& run) {
  Json out = Json::array();
  const auto add = [&](const Turn& turn) {
    const LevelRecord& record = run.levels[static_cast<std::size_t>(turn.level)].record;
    const std::string path = bytes_of(turn.path, record.space);
    out.push_back({turn.level, turn.proposals, turn.nodes, turn.solve_ended ? 1 : 0,
                   path.empty() ? Json(nullptr) : Json(base64(path))});
  };
  for (const Turn& turn : run.run.turns) add(turn);
  if (!run.run.turns.empty()) return out;
  // Records of other executors: one turn for each level, the deepest first.
  for (auto level = run.levels.rbegin(); level != run.levels.rend(); ++level) {
    const LevelRecord& record = level->record;
    add({record.level, static_cast<std::uint32_t>(record.search.proposals.size()),
         static_cast<std::uint32_t>(record.search.nodes.size()), true,
         record.solution.solved() ? record.solution.path : Configurations()});
  }
  return out;
}

}  // namespace

Json packed_run(const RunResult& run, const Problem& problem, RobotTable& robots) {
  Json levels = Json::array();
  for (std::size_t i = 0; i < run.levels.size(); ++i) levels.push_back(level_json(run.levels, i, problem, robots));
  Json path = nullptr;
  if (run.run.solved && !run.levels.empty()) {
    path = base64(bytes_of(run.run.path, run.levels.front().record.space));
  }
  return {{"levels", std::move(levels)}, {"turns", turns_json(run)}, {"path", std::move(path)}};
}

PackedRuns::PackedRuns(const Experiment& experiment, const ExperimentResult& result)
    : result_(result), robots_(robots_of(experiment)) {
  for (const Problem& problem : experiment.problems) problems_.emplace(problem.name, &problem);
}

std::string PackedRuns::run(std::size_t run) {
  const RunResult& one = result_.runs.at(run);
  const auto problem = problems_.find(one.problem);
  return problem == problems_.end() ? "" : json::dump(packed_run(one, *problem->second, robots_));
}

std::string PackedRuns::robots() { return json::dump(robots_.list()); }

void write_packed_samples(const Experiment& experiment, const ExperimentResult& result, const std::string& directory) {
  namespace fs = std::filesystem;
  PackedRuns packed(experiment, result);
  Directories of_problem;
  std::map<std::string, Directories> of_strategy;
  Json runs = Json::array();
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    const RunResult& run = result.runs[i];
    const fs::path place =
        fs::path(of_problem(run.problem)) / of_strategy[run.problem](run.strategy) / fmt::format("seed-{}", run.seed);
    make_directory((directory / place).string());
    const fs::path file = place / "run.json";
    write_file((directory / file).string(), packed.run(i) + "\n", Flush::none);
    // Seeds as text: a number in JavaScript has 53 bits.
    runs.push_back({{"problem", run.problem},
                    {"strategy", run.strategy},
                    {"seed", std::to_string(run.seed)},
                    {"file", file.generic_string()}});
  }
  make_directory(directory);
  write_file(
      (fs::path(directory) / "index.json").string(),
      "{\"robots\": " + packed.robots() + ",\n \"runs\": " + json::lines(runs.get_ref<const Json::array_t&>()) + "}\n",
      Flush::none);
}

}  // namespace trellis
