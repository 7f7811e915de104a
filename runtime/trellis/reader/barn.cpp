// SPDX-License-Identifier: GPL-3.0-or-later
// The cylinder fields of BARN, the benchmark of autonomous robot navigation.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

constexpr const char* heading = "world,x,y,radius";
constexpr const char* path_heading = "world,i,x,y";
constexpr const char* length_heading = "world,path_length_m,waypoints";
/// Half the width of the Jackal, the benchmark's robot, in metres: the reference paths are clear by more.
constexpr double robot_radius = 0.215;
/// Around start and goal, metres.
constexpr double margin = 1.0;
constexpr std::size_t most_worlds = 10'000;

/// A table with a known heading.
template <class Read>
void each_row(const SourceText& text, const char* expected, const Read& read) {
  const auto names = cells_of(expected);
  if (text.lines.empty() || text.lines[0] != expected) throw text.error(1, fmt::format("expected '{}'", expected));
  RowErrors errors;
  for (std::size_t i = 1; i < text.lines.size(); ++i) {
    if (text.lines[i].empty()) continue;
    errors.attempt([&] {
      const auto cells = cells_of(text.lines[i]);
      if (cells.size() != names.size()) {
        throw text.error(i + 1,
                         fmt::format("a row of {} cells, expected {}: {}", cells.size(), names.size(), expected));
      }
      read(i + 1, cells);
    });
  }
  errors.raise();
}

struct Field {
  std::vector<Obstacle> obstacles;
  std::optional<std::pair<Vec2, Vec2>> ends;
  double length = 0.0;
};

std::map<std::size_t, Field> fields_of(const SourceText& text) {
  std::map<std::size_t, Field> fields;
  each_row(text, heading, [&](std::size_t line, const std::vector<std::string>& cells) {
    Field& field = fields[count_in(text, line, cells[0], "the world")];
    if (fields.size() > most_worlds) throw text.error(line, fmt::format("more than {} worlds", most_worlds));
    const Disc disc{{number_in(text, line, cells[1], "x"), number_in(text, line, cells[2], "y")},
                    number_in(text, line, cells[3], "the radius")};
    if (disc.radius <= 0.0) {
      throw text.error(line, fmt::format("the radius is {}, expected a number greater than 0", disc.radius));
    }
    if (!in_range(disc.centre) || disc.radius > most_distant) {
      throw text.error(line, fmt::format("a cylinder farther than {:g} m from the origin", most_distant));
    }
    field.obstacles.push_back({fmt::format("cylinder {}", field.obstacles.size() + 1), disc});
  });
  if (fields.empty()) throw text.error(text.last(), fmt::format("no cylinders, expected rows of {}", heading));
  return fields;
}

/// Reads the first and the last point of each world's reference path, and where there is the file its length.
void read_references(const std::filesystem::path& folder, std::map<std::size_t, Field>& fields) {
  const SourceText paths = SourceText::load((folder / "reference_path.csv").string());
  each_row(paths, path_heading, [&](std::size_t line, const std::vector<std::string>& cells) {
    const auto field = fields.find(count_in(paths, line, cells[0], "the world"));
    const Vec2 at{number_in(paths, line, cells[2], "x"), number_in(paths, line, cells[3], "y")};
    if (!in_range(at))
      throw paths.error(line, fmt::format("a point farther than {:g} m from the origin", most_distant));
    if (field == fields.end()) return;
    auto& ends = field->second.ends;
    ends = {ends ? ends->first : at, at};
  });
  const auto file = folder / "reference_length.csv";
  if (!std::filesystem::exists(file)) return;
  const SourceText lengths = SourceText::load(file.string());
  each_row(lengths, length_heading, [&](std::size_t line, const std::vector<std::string>& cells) {
    const auto field = fields.find(count_in(lengths, line, cells[0], "the world"));
    const double length = number_in(lengths, line, cells[1], "the length");
    if (field != fields.end()) field->second.length = length;
  });
}

/// The box of the cylinders and, with room around them, of the ends.
Box2 bounds_of(const Field& field) {
  Box2 bounds = bounding_box(std::get<Disc>(field.obstacles.front().shape));
  const auto add = [&](const Box2& box) { bounds = united(bounds, box); };
  for (const Obstacle& obstacle : field.obstacles) add(bounding_box(std::get<Disc>(obstacle.shape)));
  if (!field.ends) return bounds;
  for (const Vec2 end : {field.ends->first, field.ends->second}) {
    add({end - Vec2{margin, margin}, end + Vec2{margin, margin}});
  }
  return bounds;
}

}  // namespace

bool is_barn(const SourceText& text) { return !text.lines.empty() && text.lines[0] == heading; }

SceneFile read_barn(const SourceText& text, const ReadOptions& options) {
  auto fields = fields_of(text);
  if (options.start.empty() || options.goal.empty()) {
    read_references(std::filesystem::path(text.path).parent_path(), fields);
  }
  SceneFile file{"BARN cylinder fields", "metres", "as in the file", {}};
  const Robot robot = options.robot.value_or(Robot::disc(robot_radius));
  for (auto& [number, field] : fields) {
    const Box2 bounds = bounds_of(field);
    auto scene = std::make_shared<const PlanarScene>(World(bounds, std::move(field.obstacles)), robot);
    Problem problem = problem_in(fmt::format("barn/{}", number), std::move(scene), options);
    if (field.ends) {
      problem.start.assign(problem.space.dimension(), 0.0);
      Configuration goal = problem.start;
      std::tie(problem.start[0], problem.start[1]) = std::pair(field.ends->first.x, field.ends->first.y);
      std::tie(goal[0], goal[1]) = std::pair(field.ends->second.x, field.ends->second.y);
      problem.goals = {std::move(goal)};
    } else {
      file.warnings.push_back(fmt::format("world {} has no reference path", number));
    }
    file.problems.push_back(std::move(problem));
    file.lengths.push_back(field.length);
  }
  // Only where all are known.
  if (std::count(file.lengths.begin(), file.lengths.end(), 0.0) > 0) file.lengths.clear();
  return file;
}

}  // namespace trellis
