// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
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

constexpr const char* expected = "another known format, or dynobench as a YAML map";

Vec2 point_of(const YamlEntry& entry) {
  const auto values = entry.numbers(2, "x, y");
  return {values[0], values[1]};
}

Vec2 extents_of(const YamlEntry& entry, const char* name) {
  const Vec2 size = point_of(entry);
  if (size.x <= 0.0 || size.y <= 0.0) {
    throw entry.error(fmt::format("'{}' is [{}, {}], expected numbers greater than 0", name, size.x, size.y));
  }
  return size;
}

Box2 box_about(Vec2 centre, Vec2 size) { return {centre - 0.5 * size, centre + 0.5 * size}; }

Polygon rectangle_about(Vec2 centre, Vec2 size) { return {rectangle_vertices(box_about(centre, size))}; }

/// A robot of the format. Without a motion model in Trellis, only the first coordinates of its state are read.
struct Kind {
  const char* type;
  const char* motion;  // nullptr: none
  std::size_t state;   // length of the state in the file
  const char* meaning;

  [[nodiscard]] bool trailer() const { return motion != nullptr && motion == std::string_view("car_with_trailer"); }
};

constexpr std::array<Kind, 5> kinds = {{{"unicycle1_v0", "unicycle1", 3, "x, y, theta"},
                                        {"unicycle1_v1", "unicycle1", 3, "x, y, theta"},
                                        {"unicycle2_v0", "unicycle2", 5, "x, y, theta, speed, angular speed"},
                                        {"car1_v0", "car_with_trailer", 4, "x, y, theta, theta of the trailer"},
                                        {"quad2d_v0", nullptr, 6, "x, y, theta and three velocities"}}};

const Kind& kind_of(const YamlEntry& type) {
  const std::string word = type.word();
  for (const Kind& kind : kinds) {
    if (word == kind.type) return kind;
  }
  std::vector<std::string> known;
  std::string all;
  for (const Kind& k : kinds) {
    known.emplace_back(k.type);
    all += (all.empty() ? "" : ", ") + known.back();
  }
  throw type.error(
      fmt::format("the robot's type '{}' is not known{}, expected one of {}", word, did_you_mean(word, known), all));
}

SourceText model_of(const Kind& kind, const std::string& scene_path) {
  const auto folder = std::filesystem::path(scene_path).parent_path();
  const auto path = (folder / ".." / "shared" / "models" / (std::string(kind.type) + ".yaml")).lexically_normal();
  return SourceText::load(path.string());
}

Robot robot_of(const Kind& kind, const YamlEntry& model) {
  model.at("shape").require("box");
  Body body;
  body.parts = {rectangle_about({}, extents_of(model.at("size"), "size"))};
  body.angle_axis = 2;
  std::vector<Body> bodies = {body};
  if (kind.trailer()) {
    model.at("shape_trailer").require("box");
    const double hitch = model.at("hitch_lengths").numbers(1, "from the car's centre to the trailer's")[0];
    // The trailer's joint is at the car's centre, and the trailer has its own heading.
    Body trailer;
    trailer.parts = {rectangle_about({-hitch, 0.0}, extents_of(model.at("size_trailer"), "size_trailer"))};
    trailer.parent = 0;
    trailer.angle_axis = 3;
    trailer.absolute = true;
    bodies.push_back(std::move(trailer));
  }
  return {kind.type, std::move(bodies)};
}

/// Returns Trellis' motion model with the numbers of the file; nullptr where Trellis has none.
std::shared_ptr<const MotionModel> motion_of(const Kind& kind, const YamlEntry& model) {
  if (kind.motion == nullptr) return nullptr;
  std::vector<Options::Entry> given;
  const auto give = [&](const char* option, const char* key) { given.emplace_back(option, model.at(key).number()); };
  give("min_speed", "min_vel");
  give("max_speed", "max_vel");
  give("dt", "dt");
  if (kind.trailer()) {
    give("wheelbase", "l");
    give("max_steering", "max_steering_abs");
    given.emplace_back("hitch", model.at("hitch_lengths").numbers(1, "from the car's centre to the trailer's")[0]);
  } else {
    give("max_angular_speed", "max_angular_vel");
    const YamlEntry least = model.at("min_angular_vel");
    if (least.number() != -model.at("max_angular_vel").number()) {
      throw least.error(
          fmt::format("'min_angular_vel' is {}, expected the negative of 'max_angular_vel'", least.number()));
    }
  }
  if (kind.motion == std::string_view("unicycle2")) {
    give("max_acceleration", "max_acc_abs");
    give("max_angular_acceleration", "max_angular_acc");
    const auto weights = model.at("distance_weights").numbers(4, "of position, angle, speed and angular speed");
    given.emplace_back("speed_weight", weights[2]);
    given.emplace_back("angular_speed_weight", weights[3]);
  }
  const MotionKind& motion = *find_motion(kind.motion);
  return motion.make(Options::validate(*motion.component, given));
}

World world_of(const YamlEntry& environment) {
  const YamlEntry min = environment.at("min"), max = environment.at("max");
  const Box2 bounds{point_of(min), point_of(max)};
  if (bounds.lo.x >= bounds.hi.x || bounds.lo.y >= bounds.hi.y) {
    throw max.error(fmt::format("'max' is [{}, {}], expected more than 'min', [{}, {}]", bounds.hi.x, bounds.hi.y,
                                bounds.lo.x, bounds.lo.y));
  }
  ErrorList errors;
  std::vector<Obstacle> obstacles;
  for (const YamlEntry& obstacle : environment.at("obstacles").list()) {
    Vec2 centre, size;
    errors.attempt([&] { obstacle.at("type").require("box"); });
    errors.attempt([&] { centre = point_of(obstacle.at("center")); });
    errors.attempt([&] { size = extents_of(obstacle.at("size"), "size"); });
    obstacles.push_back({fmt::format("obstacle {} (box at {} {}, size {} {})", obstacles.size() + 1, centre.x, centre.y,
                                     size.x, size.y),
                         box_about(centre, size)});
  }
  errors.raise();
  return {bounds, std::move(obstacles)};
}

}  // namespace

bool is_dynobench(const SourceText& text) { return has_key(text, "environment") && has_key(text, "robots"); }

SceneFile read_dynobench(const SourceText& text, const ReadOptions& options) {
  const YamlEntry file = YamlEntry::root(text, expected);
  if (!file.has("environment") && !file.has("robots")) {
    throw text.error(
        1,
        "no scene that can be read: it is YAML of no known format; of YAML Trellis reads maps of ROS, with "
        "'image' and 'resolution', scenes of dynobench, with 'environment' and 'robots', and scenarios of "
        "FibrationTrees, "
        "with 'robots' and 'problem'");
  }
  ErrorList errors;
  std::optional<World> world;
  errors.attempt([&] { world = world_of(file.at("environment")); });
  const Kind* known = nullptr;
  Configuration start, goal;
  errors.attempt([&] {
    const YamlEntry robots = file.at("robots");
    if (robots.list().empty()) throw robots.error("'robots' is empty, expected at least one robot");
    const YamlEntry robot = robots.list().front();
    known = &kind_of(robot.at("type"));
    errors.attempt([&] { start = robot.at("start").numbers(known->state, known->meaning); });
    errors.attempt([&] { goal = robot.at("goal").numbers(known->state, known->meaning); });
  });
  errors.raise();
  const Kind& kind = *known;

  const SourceText model_text = model_of(kind, text.path);
  const YamlEntry model = YamlEntry::root(model_text, expected);
  const auto scene = std::make_shared<const PlanarScene>(std::move(*world), robot_of(kind, model));
  const auto motion = options.motion ? motion_of(kind, model) : nullptr;
  const std::size_t dimension = motion ? motion->dimension() : scene->robot_dimension();
  start.resize(dimension);
  goal.resize(dimension);
  std::string name = file.has("name") ? file.at("name").word() : std::filesystem::path(text.path).stem().string();
  Problem problem = problem_in(std::move(name), scene, options);
  if (motion) {
    problem.motion_model = motion;
    problem.space = state_space(problem.space, *motion);
    problem.goal_tolerance = options.goal_tolerance;
  }
  problem.space.normalise(start);
  problem.space.normalise(goal);
  problem.start = std::move(start);
  problem.goals = {std::move(goal)};
  SceneFile scene_file{"dynobench", "metres, radians", "as in the file", {std::move(problem)}};
  const auto robots = file.at("robots").list();
  if (robots.size() > 1) scene_file.warnings.push_back(fmt::format("the first of {} robots is read", robots.size()));
  for (std::size_t i = 1; i < robots.size(); ++i) robots[i].know();
  file.know({"name"});
  for (std::string& warning : unused_warnings(text, file.unused())) scene_file.warnings.push_back(std::move(warning));
  return scene_file;
}

}  // namespace trellis
