// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include <trellis/base/errors.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

Obstacle circle_of(const SourceText& text, std::size_t line, const std::vector<std::string>& words) {
  if (words.size() != 4) {
    throw text.error(line, fmt::format("a row of {} words, expected 4: index x y r", words.size()));
  }
  const std::size_t name = count_in(text, line, words[0], "the index");
  const Disc disc{{number_in(text, line, words[1], "x"), number_in(text, line, words[2], "y")},
                  number_in(text, line, words[3], "the radius")};
  if (disc.radius <= 0.0) {
    throw text.error(line, fmt::format("the radius is {}, expected a number greater than 0", disc.radius));
  }
  return {fmt::format("circle {}", name), disc};
}

World world_of(const SourceText& text) {
  RowErrors errors;
  std::vector<Obstacle> obstacles;
  Box2 bounds;
  for (std::size_t i = 2; i < text.lines.size(); ++i) {
    const auto words = words_of(text.lines[i]);
    if (words.empty()) continue;
    errors.attempt([&] {
      obstacles.push_back(circle_of(text, i + 1, words));
      const Box2 box = bounding_box(std::get<Disc>(obstacles.back().shape));
      bounds = obstacles.size() == 1 ? box : united(bounds, box);
    });
  }
  errors.raise();
  if (obstacles.empty()) throw text.error(text.lines.size(), "no circles, expected at least one row: index x y r");
  return {bounds, std::move(obstacles)};
}

struct Query {
  std::size_t line = 0;  // of its first occurrence
  std::array<std::optional<Configuration>, 2> ends;
};

constexpr std::array<const char*, 2> labels = {"start:", "goal:"};

void read_query(const SourceText& text, std::size_t line, const std::vector<std::string>& words,
                std::map<std::size_t, Query>& queries) {
  if (words.size() != 4) {
    throw text.error(line, fmt::format("a row of {} words, expected 4: index start:|goal: x y", words.size()));
  }
  const std::size_t name = count_in(text, line, words[0], "the index");
  const auto label = static_cast<std::size_t>(std::find(labels.begin(), labels.end(), words[1]) - labels.begin());
  if (label == labels.size()) {
    throw text.error(line, fmt::format("'{}' after the index, expected 'start:' or 'goal:'", words[1]));
  }
  auto& query = queries.try_emplace(name, Query{line, {}}).first->second;
  auto& end = query.ends[label];
  if (end) throw text.error(line, fmt::format("a second '{}' of query {}, expected one", words[1], name));
  end = Configuration{};  // a row with mistakes is there too
  end = Configuration{number_in(text, line, words[2], "x"), number_in(text, line, words[3], "y")};
}

std::map<std::size_t, Query> queries_of(const SourceText& text) {
  RowErrors errors;
  std::map<std::size_t, Query> queries;
  for (std::size_t i = 0; i < text.lines.size(); ++i) {
    const auto words = words_of(text.lines[i]);
    if (words.empty()) continue;
    errors.attempt([&] { read_query(text, i + 1, words, queries); });
  }
  for (const auto& [name, query] : queries) {
    for (std::size_t k = 0; k < labels.size(); ++k) {
      if (!query.ends[k]) errors.add(text.error(query.line, fmt::format("query {} has no '{}' row", name, labels[k])));
    }
  }
  errors.raise();
  if (queries.empty())
    throw text.error(std::max<std::size_t>(text.lines.size(), 1), "no queries, expected at least one");
  return queries;
}

}  // namespace

bool is_circle_world(const SourceText& text) {
  return text.lines.size() >= 2 && words_of(text.lines[1]) == std::vector<std::string>{"x", "y", "r"};
}

SceneFile read_circle_world(const SourceText& text, const ReadOptions& options) {
  ErrorList errors;
  std::shared_ptr<const Scene> scene;
  errors.attempt(
      [&] { scene = std::make_shared<const PlanarScene>(world_of(text), options.robot.value_or(Robot::point())); });
  std::map<std::size_t, Query> queries;
  errors.attempt([&] {
    const std::filesystem::path path(text.path);
    std::string file = path.filename().string();
    const std::string from = "obstacles", to = "queries";
    const auto at = file.rfind(from);
    if (at == std::string::npos) {
      throw text.error(1, fmt::format("a circle world's file name must hold '{}', so that the file of its queries is "
                                      "known, got '{}'",
                                      from, file));
    }
    file.replace(at, from.size(), to);
    queries = queries_of(SourceText::load((path.parent_path() / file).string()));
  });
  errors.raise();
  SceneFile file{"circle world", "metres", "as in the file", {}};
  for (auto& [name, query] : queries) {
    file.problems.push_back(problem_in(fmt::format("circles/{}", name), scene, options));
    file.problems.back().start = *query.ends[0];
    file.problems.back().start.resize(scene->robot_dimension());
    Configuration goal = *query.ends[1];
    goal.resize(scene->robot_dimension());
    file.problems.back().goals = {std::move(goal)};
  }
  return file;
}

}  // namespace trellis
