// SPDX-License-Identifier: GPL-3.0-or-later
// Scenarios of FibrationTrees: teams of discs on a floor.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/yaml_entry.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

/// A number greater than 0.
double size_of(const YamlEntry& entry, double size, const char* name) {
  if (size <= 0.0) throw entry.error(fmt::format("'{}' is {}, expected a number greater than 0", name, size));
  return size;
}

/// Adds the outline of an obstacle on the floor; a floor has none.
void add_obstacle(const std::string& key, const YamlEntry& obstacle, std::vector<Obstacle>& obstacles) {
  const std::string type = obstacle.at("type").word();
  obstacle.know({"name"});
  if (type == "floor") return obstacle.know();
  if (type != "box" && type != "cylinder") {
    throw obstacle.at("type").error(
        fmt::format("the obstacle's type '{}' is not known, expected one of floor, box, cylinder", type));
  }
  const auto position = obstacle.at("position").numbers(3, "x, y, z");
  const Vec2 centre{position[0], position[1]};
  const YamlEntry size = obstacle.at("size");
  if (type == "cylinder") {
    const auto of = size.numbers(2, "radius, height");
    const double radius = size_of(size, of[0], "size");
    obstacles.push_back({fmt::format("obstacle {} ({}: disc at {} {}, radius {})", obstacles.size() + 1, key, centre.x,
                                     centre.y, radius),
                         Disc{centre, radius}});
    return;
  }
  const auto of = size.numbers(3, "width, depth, height");
  const Vec2 extents{size_of(size, of[0], "size"), size_of(size, of[1], "size")};
  obstacles.push_back({fmt::format("obstacle {} ({}: box at {} {}, size {} {})", obstacles.size() + 1, key, centre.x,
                                   centre.y, extents.x, extents.y),
                       Box2{centre - 0.5 * extents, centre + 0.5 * extents}});
}

/// A disc, and where its centre may be.
struct LimitedDisc {
  double radius = 1.0;
  Box2 limits;
};

LimitedDisc disc_of(const YamlEntry& robot) {
  const YamlEntry name = robot.at("name");
  if (name.word() != "DiskRobot") {
    throw name.error(fmt::format(
        "the robot '{}' is not read, expected DiskRobot: of FibrationTrees Trellis reads teams of discs", name.word()));
  }
  LimitedDisc disc;
  if (robot.has("radius")) disc.radius = size_of(robot.at("radius"), robot.at("radius").number(), "radius");
  const auto lower = robot.at("lower_limits").numbers(2, "x, y");
  const auto upper = robot.at("upper_limits").numbers(2, "x, y");
  disc.limits = {{lower[0], lower[1]}, {upper[0], upper[1]}};
  if (lower[0] >= upper[0] || lower[1] >= upper[1]) {
    throw robot.at("upper_limits")
        .error(fmt::format("'upper_limits' is [{}, {}], expected more than 'lower_limits', [{}, {}]", upper[0],
                           upper[1], lower[0], lower[1]));
  }
  return disc;
}

/// The discs of the scenario, those that the root lists in its order.
std::vector<LimitedDisc> discs_of(const YamlEntry& robots) {
  for (const std::string& key : robots.keys()) {
    const YamlEntry robot = robots.at(key);
    if (!robot.has("root") || robot.at("root").word() != "True") continue;
    robot.know({"name"});
    if (!robot.has("robots")) return {disc_of(robot)};
    std::vector<LimitedDisc> discs;
    for (const YamlEntry& member : robot.at("robots").list()) discs.push_back(disc_of(robots.at(member.word())));
    if (discs.empty()) throw robot.at("robots").error("'robots' is empty, expected at least one robot");
    return discs;
  }
  throw robots.error("no robot has 'root: True'");
}

}  // namespace

bool is_fibration_trees(const SourceText& text) {
  return has_key(text, "robots") && has_key(text, "problem") && !has_key(text, "environment");
}

SceneFile read_fibration_trees(const SourceText& text, const ReadOptions& options) {
  const YamlEntry file = YamlEntry::root(text, "a scenario of FibrationTrees as a YAML map");
  ErrorList errors;
  std::vector<Obstacle> obstacles;
  if (file.has("obstacles")) {
    const YamlEntry all = file.at("obstacles");
    for (const std::string& key : all.keys()) {
      errors.attempt([&] { add_obstacle(key, all.at(key), obstacles); });
    }
  }
  std::vector<LimitedDisc> discs;
  Configuration start, goal;
  errors.attempt([&] {
    discs = discs_of(file.at("robots"));
    const std::size_t count = 2 * discs.size();
    const YamlEntry problem = file.at("problem");
    const auto read_end = [&](const char* name, Configuration& end) {
      errors.attempt([&] {
        const YamlEntry given = problem.at(name);
        given.at("type").require("joint");
        end = given.at("config").numbers(count, "x, y of each robot");
      });
    };
    read_end("start", start);
    read_end("goal", goal);
  });
  errors.raise();

  SceneFile scene{"FibrationTrees", "metres", "as in the file", {}};
  // Their limits are those of centres, the bounds of a world those of whole robots.
  Box2 bounds{discs.front().limits.lo, discs.front().limits.hi};
  std::vector<Robot> robots;
  for (const LimitedDisc& disc : discs) {
    const Vec2 margin{disc.radius, disc.radius};
    bounds = united(bounds, {disc.limits.lo - margin, disc.limits.hi + margin});
    robots.push_back(Robot::disc(disc.radius));
  }
  const auto wider = [&](const LimitedDisc& disc) {
    const Vec2 margin{disc.radius, disc.radius};
    return disc.limits.lo - margin != bounds.lo || disc.limits.hi + margin != bounds.hi;
  };
  if (std::any_of(discs.begin(), discs.end(), wider)) {
    scene.warnings.emplace_back("robots have limits of their own; the bounds of the world hold them all");
  }
  const YamlEntry ends = file.at("problem");
  if (ends.at("goal").has("threshold")) {
    scene.warnings.emplace_back("the goal has a threshold; here it is the configuration itself");
  }
  file.know({"name"});
  for (std::string& warning : unused_warnings(text, file.unused())) scene.warnings.push_back(std::move(warning));
  Problem problem = problem_in(stem_of(text.path),
                               std::make_shared<PlanarScene>(World(bounds, std::move(obstacles)),
                                                             robots.size() == 1 ? robots.front() : Robot::team(robots)),
                               options);
  problem.start = std::move(start);
  problem.goals = {std::move(goal)};
  scene.problems.push_back(std::move(problem));
  return scene;
}

}  // namespace trellis
