// SPDX-License-Identifier: GPL-3.0-or-later
// Grid maps of the Moving AI Lab and their queries.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

constexpr const char* map_format = "Moving AI grid map";
constexpr const char* units = "1 cell = 1 m";
constexpr const char* frame = "the origin is the map's lower left corner, y up; row 0 is the uppermost";
constexpr std::size_t most_queries = 100'000;

constexpr std::string_view blocked = "@OTW";
constexpr std::string_view passable = ".GSE";

struct GridMap {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::string> rows;  // from the top
  /// The map has cells E of the MAPF Start-Kit, whose rule is that only @ and T are obstacles.
  bool start_kit = false;
  std::vector<std::string> warnings;

  [[nodiscard]] bool free(std::size_t column, std::size_t row) const {
    const char cell = rows[row][column];
    return start_kit ? cell != '@' && cell != 'T' : blocked.find(cell) == std::string_view::npos;
  }
};

/// Returns the line of the word 'map', counted from 1.
std::size_t read_header(const SourceText& text, GridMap& map) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < text.lines.size(); ++i) {
    const auto words = words_of(text.lines[i]);
    if (words.empty()) continue;
    const std::string& key = words[0];
    if (key != "type" && key != "height" && key != "width" && key != "map") {
      throw text.error(i + 1, fmt::format("'{}' in the header, expected type, height, width or map", key));
    }
    if (!seen.insert(key).second) throw text.error(i + 1, fmt::format("'{}' for the second time", key));
    if (key == "map") {
      for (const char* needed : {"type", "height", "width"}) {
        if (!seen.contains(needed)) throw text.error(i + 1, fmt::format("'{}' is missing above 'map'", needed));
      }
      return i + 1;
    }
    if (words.size() != 2)
      throw text.error(i + 1, fmt::format("'{}' has {} values, expected 1", key, words.size() - 1));
    if (key == "type") {
      if (words[1] != "octile") throw text.error(i + 1, fmt::format("the type is '{}', expected 'octile'", words[1]));
      continue;
    }
    const std::size_t side = count_in(text, i + 1, words[1], key.c_str());
    if (side == 0 || side > most_grid_side) {
      throw text.error(i + 1, fmt::format("the {} is {}, expected 1 to {}", key, side, most_grid_side));
    }
    (key == "height" ? map.height : map.width) = side;
  }
  throw text.error(text.last(), "no 'map', expected it above the rows of the grid");
}

GridMap grid_map(const SourceText& text) {
  GridMap map;
  const std::size_t begin = read_header(text, map);
  std::size_t end = text.lines.size();
  while (end > begin && words_of(text.lines[end - 1]).empty()) --end;
  if (end - begin != map.height) {
    throw text.error(std::max(end, begin), fmt::format("the grid has {} rows, expected {}", end - begin, map.height));
  }
  RowErrors errors;
  std::size_t water = 0;
  std::size_t beyond = 0;
  for (std::size_t i = begin; i < end; ++i) {
    std::string row = text.lines[i];
    row.erase(row.find_last_not_of(" \t") + 1);
    errors.attempt([&] {
      if (row.size() != map.width) {
        throw text.error(i + 1, fmt::format("a row of {} cells, expected {}", row.size(), map.width));
      }
      const auto strange = std::find_if_not(row.begin(), row.end(), [](char cell) {
        return passable.find(cell) != std::string_view::npos || blocked.find(cell) != std::string_view::npos;
      });
      if (strange != row.end()) {
        const auto code = static_cast<unsigned char>(*strange);
        const bool printable = code > ' ' && code < 0x7F;
        throw text.error(i + 1, fmt::format("column {} is {}, expected one of . G S E (passable) or @ O T W (not)",
                                            strange - row.begin() + 1,
                                            printable ? fmt::format("'{}'", *strange) : fmt::format("byte {}", code)));
      }
      water += static_cast<std::size_t>(std::count(row.begin(), row.end(), 'W'));
      beyond += static_cast<std::size_t>(std::count(row.begin(), row.end(), 'O'));
      map.start_kit = map.start_kit || row.find('E') != std::string::npos;
    });
    map.rows.push_back(std::move(row));
  }
  errors.raise();
  if (map.start_kit && water + beyond > 0) {
    map.warnings.push_back(
        fmt::format("{} cells O and W are passable: with cells E the map follows the MAPF Start-Kit", water + beyond));
  } else if (water > 0) {
    map.warnings.push_back(fmt::format("{} cells of water (W) are obstacles", water));
  }
  return map;
}

/// The robot of a query; of agents the team.
Robot robot_of(const ReadOptions& options) {
  if (options.agents == 0) return options.robot.value_or(Robot::point());
  const Robot one = options.robot ? *options.robot : Robot::disc(options.agent_radius);
  if (!one.translates()) throw Error(fmt::format("the robot '{}' of an agent must move along x and y", one.name()));
  return options.agents == 1 ? one : Robot::team(std::vector<Robot>(options.agents, one));
}

std::shared_ptr<const Scene> scene_of(const std::string& path, const GridMap& map, const ReadOptions& options) {
  auto boxes = boxes_of(
      path, map.width, map.height, [&](std::size_t column, std::size_t row) { return !map.free(column, row); }, {},
      1.0);
  const Box2 bounds{{0.0, 0.0}, {static_cast<double>(map.width), static_cast<double>(map.height)}};
  return std::make_shared<const PlanarScene>(World(bounds, std::move(boxes)), robot_of(options));
}

struct Query {
  std::array<std::size_t, 4> cells{};  // start column and row, goal column and row
  double length = 0.0;
};

constexpr std::size_t query_words = 9;

/// Reads a row: bucket, map, width, height, start x, start y, goal x, goal y, length.
Query query_of(const SourceText& text, std::size_t line, const std::vector<std::string>& words, const GridMap& map,
               const std::string& map_name) {
  if (words.size() != query_words) {
    throw text.error(line, fmt::format("a row of {} words, expected 9: bucket map width height start-x start-y goal-x "
                                       "goal-y length",
                                       words.size()));
  }
  if (words[1] != map_name) {
    throw text.error(line, fmt::format("the map is '{}', expected '{}' as in the first row", words[1], map_name));
  }
  static_cast<void>(count_in(text, line, words[0], "the bucket"));
  const std::size_t width = count_in(text, line, words[2], "the width");
  const std::size_t height = count_in(text, line, words[3], "the height");
  if (width != map.width || height != map.height) {
    throw text.error(line, fmt::format("the map's size is {} x {}, expected {} x {} as in the map: scaled queries are "
                                       "not read",
                                       width, height, map.width, map.height));
  }
  Query query;
  constexpr std::array<const char*, 4> names = {"start-x", "start-y", "goal-x", "goal-y"};
  for (std::size_t k = 0; k < names.size(); ++k) {
    query.cells.at(k) = count_in(text, line, words[4 + k], names.at(k));
    const std::size_t end = k % 2 == 0 ? width : height;
    if (query.cells.at(k) >= end) {
      throw text.error(line, fmt::format("{} is {}, expected less than {}", names.at(k), query.cells.at(k), end));
    }
  }
  for (std::size_t k = 0; k < 4; k += 2) {
    if (!map.free(query.cells.at(k), query.cells.at(k + 1))) {
      throw text.error(line, fmt::format("the {} cell ({}, {}) is '{}' in the map, expected a passable one",
                                         k == 0 ? "start" : "goal", query.cells.at(k), query.cells.at(k + 1),
                                         map.rows[query.cells.at(k + 1)][query.cells.at(k)]));
    }
  }
  query.length = number_in(text, line, words[query_words - 1], "the length");
  if (query.length < 0.0) throw text.error(line, fmt::format("the length is {}, expected at least 0", query.length));
  return query;
}

/// Adds the map's warnings, and by which rule its cells are obstacles.
void add_remarks(GridMap map, SceneFile& file) {
  file.warnings = std::move(map.warnings);
  if (map.start_kit) file.notes.emplace_back("by the rule of the MAPF Start-Kit: only cells @ and T are obstacles");
}

Configuration centre(const GridMap& map, std::size_t column, std::size_t row, std::size_t dimension) {
  Configuration q(dimension, 0.0);
  q[0] = static_cast<double>(column) + 0.5;
  q[1] = static_cast<double>(map.height - row) - 0.5;
  return q;
}

/// Queries that are the robots of one team.
class Agents {
 public:
  explicit Agents(const SourceText& text) : text_(text) {}

  [[nodiscard]] std::size_t size() const { return queries_.size(); }
  void add(const Query& query, std::size_t line) {
    for (std::size_t k = 0; k < query.cells.size(); k += 2) {
      const std::array cell = {query.cells.at(k), query.cells.at(k + 1)};
      const auto [before, fresh] = (k == 0 ? starts_ : goals_).emplace(cell, line);
      if (fresh) continue;
      throw text_.error(line, fmt::format("the {} cell ({}, {}) is that of the agent in line {}",
                                          k == 0 ? "start" : "goal", cell[0], cell[1], before->second));
    }
    queries_.push_back(query);
  }
  void place(const GridMap& map, Problem& problem) const {
    problem.goals.assign(1, {});
    const std::size_t axes = problem.space.dimension() / queries_.size();
    for (const Query& query : queries_) {
      for (std::size_t k = 0; k < query.cells.size(); k += 2) {
        const Configuration q = centre(map, query.cells.at(k), query.cells.at(k + 1), axes);
        Configuration& all = k == 0 ? problem.start : problem.goals.front();
        all.insert(all.end(), q.begin(), q.end());
      }
    }
  }

 private:
  const SourceText& text_;
  std::vector<Query> queries_;
  std::map<std::array<std::size_t, 2>, std::size_t> starts_;  ///< the line of each cell
  std::map<std::array<std::size_t, 2>, std::size_t> goals_;
};

}  // namespace

bool is_moving_ai_map(const SourceText& text) {
  if (text.lines.empty()) return false;
  const auto words = words_of(text.lines[0]);
  return words.size() == 2 && words[0] == "type";
}

SceneFile read_moving_ai_map(const SourceText& text, const ReadOptions& options) {
  GridMap map = grid_map(text);
  SceneFile file{
      map_format, units, frame, {problem_in(stem_of(text.path), scene_of(text.path, map, options), options)}};
  add_remarks(std::move(map), file);
  return file;
}

bool is_moving_ai_queries(const SourceText& text) {
  if (text.lines.empty()) return false;
  const auto words = words_of(text.lines[0]);
  return words.size() == 2 && words[0] == "version";
}

SceneFile read_moving_ai_queries(const SourceText& text, const ReadOptions& options) {
  const auto version = words_of(text.lines[0])[1];
  if (version != "1" && version != "1.0") throw text.error(1, fmt::format("version {}, expected 1", version));
  if (text.lines.size() > most_queries + 2) {
    throw text.error(most_queries + 2, fmt::format("more than {} queries", most_queries));
  }
  SceneFile file{"Moving AI queries", units, frame, {}};
  std::string map_name;
  GridMap map;
  std::shared_ptr<const Scene> scene;
  RowErrors errors;
  Agents agents(text);
  for (std::size_t i = 1; i < text.lines.size() && (options.agents == 0 || agents.size() < options.agents); ++i) {
    const auto words = words_of(text.lines[i]);
    if (words.empty()) continue;
    if (!scene) {
      map_name = words.size() > 1 ? words[1] : "";
      const auto path = std::filesystem::path(text.path).parent_path() / std::filesystem::path(map_name).filename();
      if (map_name.empty()) throw text.error(i + 1, "a row without the name of a map");
      try {
        map = grid_map(SourceText::load(path.string()));
      } catch (const Error& fault) {
        throw text.error(i + 1, fmt::format("its map: {}", fault.what()));
      }
      scene = scene_of(path.string(), map, options);
    }
    errors.attempt([&] {
      const Query query = query_of(text, i + 1, words, map, map_name);
      if (options.agents > 0) {
        agents.add(query, i + 1);
        return;
      }
      Problem problem = problem_in(fmt::format("{}/{}", stem_of(map_name), i), scene, options);
      const std::size_t dimension = problem.space.dimension();
      problem.start = centre(map, query.cells[0], query.cells[1], dimension);
      problem.goals = {centre(map, query.cells[2], query.cells[3], dimension)};
      file.problems.push_back(std::move(problem));
      file.lengths.push_back(query.length);
    });
  }
  errors.raise();
  if (options.agents > 0 && scene) {
    if (agents.size() < options.agents) {
      throw text.error(text.last(), fmt::format("{} agents, expected at least {}: the option 'agents' asks for them",
                                                agents.size(), options.agents));
    }
    Problem& problem = file.problems.emplace_back(
        problem_in(fmt::format("{}/{} agents", stem_of(map_name), options.agents), scene, options));
    agents.place(map, problem);
  }
  if (file.problems.empty()) throw text.error(text.last(), "no queries, expected at least one");
  add_remarks(std::move(map), file);
  return file;
}

}  // namespace trellis
