// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/world.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <dsl/language/core/nested_lists.hpp>
#include <dsl/language/core/word.hpp>
#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/robot_queries.hpp>
#include <dsl/language/words/scene_values.hpp>
#include <dsl/language/words/spatial_world.hpp>
#include <trellis/scene/planar/shapes.hpp>
#include <trellis/scene/planar/valid_shapes.hpp>
#include <trellis/scene/recentred.hpp>
#include <trellis/scene/spatial/linked_robot.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

const Field name_field = {"name", "string", "a string", "how messages call it"};

const Construct& box_construct() {
  static const Construct construct = {
      .name = "box",
      .usage = "box { xmin, ymin, xmax, ymax, name = \"left wall\" }",
      .summary = "an axis-aligned rectangle, or with six numbers a box in space, in metres",
      .list = "its numbers: xmin, ymin, xmax, ymax; in space xmin, ymin, zmin, xmax, ymax, zmax",
      .element = "number",
      .fields = {name_field, pose_field()},
      .options = {},
      .returns = "trellis.Shape"};
  return construct;
}
const Construct disc_construct = {.name = "disc",
                                  .usage = "disc { x, y, radius, name = \"pillar\" }",
                                  .summary = "a disc, in metres",
                                  .list = "its three numbers",
                                  .element = "number",
                                  .fields = {name_field},
                                  .options = {},
                                  .returns = "trellis.Shape"};
const Construct polygon_construct = {.name = "polygon",
                                     .usage = "polygon { {x, y}, {x, y}, {x, y}, name = \"rock\" }",
                                     .summary = "a simple polygon, convex or not, in metres",
                                     .list = "its vertices in order",
                                     .element = "number[]",
                                     .fields = {name_field},
                                     .options = {},
                                     .returns = "trellis.Shape"};
struct WorldSettings {
  Contain contain = Contain::robot;
  bool surface = false;
};

const Settings<WorldSettings>& world_settings() {
  static const auto settings =
      Settings<WorldSettings>(Component::Kind::scene, "world", "a workspace", "")
          .choice(
              "contain", &WorldSettings::contain,
              {{"robot", Contain::robot}, {"reference", Contain::reference}, {"none", Contain::none}},
              "what the bounds of a world of space contain: every point of the robot, its reference point, or "
              "nothing, so that they only limit where configurations are drawn; in the plane \"robot\". If this is not "
              "given, the bounds contain nothing of a robot of a URDF file with a fixed base")
          .boolean("surface", &WorldSettings::surface,
                   "in space, a closed mesh is only its surface, so that a body inside it is not in collision, as in "
                   "planners that use FCL directly");
  return settings;
}

const Construct& world_construct() {
  static const Construct construct = {
      .name = "world",
      .usage = "world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 4.75}, ... }",
      .summary =
          "a workspace of the plane, or with six bounds of space: a boundary box that the whole robot stays in, "
          "and obstacles",
      .list =
          "obstacles: box, disc, polygon; in space box, sphere, cylinder, capsule, convex, mesh, point_cloud; and "
          "lists of "
          "these",
      .element = "trellis.Shape|trellis.Shape[]",
      .fields = {{"bounds", "number[]",
                  "a list of 4 numbers: xmin, ymin, xmax, ymax, or of 6: xmin, ymin, zmin, xmax, ymax, zmax",
                  "the boundary box, in metres", true}},
      .options = world_settings().component(),
      .returns = "trellis.World"};
  return construct;
}
struct PointSettings {
  std::int64_t dimension = 2;
};

const Settings<PointSettings>& point_settings() {
  static const auto settings = Settings<PointSettings>(Component::Kind::scene, "robot", "a point", "")
                                   .integer("dimension", &PointSettings::dimension, "coordinates", {.lo = 2, .hi = 3},
                                            "2 in the plane, 3 in space");
  return settings;
}

const Construct& point_construct() {
  static const Construct construct = {.name = "robot.point",
                                      .usage = "robot.point()",
                                      .summary = "a point that moves in the plane, or in space",
                                      .list = "",
                                      .element = "",
                                      .fields = {},
                                      .options = point_settings().component(),
                                      .returns = "trellis.Robot"};
  return construct;
}
const Construct disc_robot_construct = {.name = "robot.disc",
                                        .usage = "robot.disc(0.2)",
                                        .summary = "a disc that moves in the plane",
                                        .list = "its radius, in metres",
                                        .element = "number",
                                        .fields = {},
                                        .options = {},
                                        .returns = "trellis.Robot"};

struct RigidSettings {
  bool rotates = true;
};

const Settings<RigidSettings>& rigid_settings() {
  static const auto settings = Settings<RigidSettings>(Component::Kind::scene, "robot", "a rigid robot", "")
                                   .boolean("rotates", &RigidSettings::rotates, "it turns as well as moves");
  return settings;
}

const Construct& rectangle_construct() {
  static const Construct construct = {.name = "robot.rectangle",
                                      .usage = "robot.rectangle(0.6, 0.2)",
                                      .summary = "a rectangle about its reference point, that moves and turns",
                                      .list = "its width and height, in metres",
                                      .element = "number",
                                      .fields = {},
                                      .options = rigid_settings().component(),
                                      .returns = "trellis.Robot"};
  return construct;
}
const Construct& rigid_construct() {
  static const Construct construct = {
      .name = "robot.rigid",
      .usage = "robot.rigid { box {-0.3, -0.1, 0.3, 0.1}, disc {0.3, 0, 0.15} }",
      .summary = "one rigid body of several shapes, its reference point at the origin",
      .list = "its shapes: box, disc, polygon; in space box, sphere, cylinder, capsule, convex, mesh",
      .element = "trellis.Shape|trellis.Shape[]",
      .fields = {},
      .options = rigid_settings().component(),
      .returns = "trellis.Robot"};
  return construct;
}

struct ArmSettings {
  double width = 0.1;
  bool self_collision = true;
};

const Settings<ArmSettings>& arm_settings() {
  static const auto settings =
      Settings<ArmSettings>(Component::Kind::scene, "robot", "a planar arm", "")
          .number("width", &ArmSettings::width, "m", Range::positive(),
                  "the width of all links, where `widths` is not given")
          .boolean("self_collision", &ArmSettings::self_collision, "links that are no neighbours must not meet");
  return settings;
}

const Construct& arm_construct() {
  static const Construct construct = {
      .name = "robot.arm",
      .usage = "robot.arm { links = {2, 1.5}, base = {5, 5}, limits = { {-2, 2} } }",
      .summary =
          "a planar arm of rectangular links; its configuration holds the angle of each joint, relative to the "
          "link before",
      .list = "",
      .element = "",
      .fields =
          {{"links", "number[]", "a list of numbers", "the lengths of the links from the base on, in metres", true},
           {"widths", "number[]", "a list of numbers", "the width of each link, in metres"},
           {"base", "number[]", "a list of 2 numbers: x, y", "where the first joint is fixed, in metres", false,
            "{0, 0}"},
           {"limits", "(number[]|false)[]", "a list with {lo, hi} or false for each joint",
            "the least and the greatest angle of each joint, in radians, up to 20 turns from 0; such an angle does "
            "not wrap, so that two a turn apart differ; false, or beyond the list's end: it wraps"}},
      .options = arm_settings().component(),
      .returns = "trellis.Robot"};
  return construct;
}

struct TeamSettings {
  std::int64_t count = 1;
  double height = 0.0;
};

const Settings<TeamSettings>& team_settings() {
  static const auto settings =
      Settings<TeamSettings>(Component::Kind::scene, "robots", "a team", "")
          .integer("count", &TeamSettings::count, "robots", {.lo = 1, .hi = Robot::most_members},
                   "how many there are of each robot listed")
          .number(
              "height", &TeamSettings::height, "m", Range::non_negative(),
              "of robots of the plane, which stand on the plane z = 0 of space, as prisms; 0: they are in the plane");
  return settings;
}

const Construct& team_construct() {
  static const Construct construct = {
      .name = "robots",
      .usage = "robots { robot.disc(0.3), robot.rectangle(1, 0.2) }",
      .summary =
          "a team: robots in one world that must not touch each other: of the plane, bodies that move freely in space, "
          "robots of URDF files, and all of these together where `height` says how high those of the plane are. Balls "
          "cover the shapes of such a mixed team. A configuration holds theirs one after the other, and may be written "
          "as a list with one configuration, or pose, for each robot",
      .list = "its robots, in order; a team among them joins with all of its robots",
      .element = "trellis.Robot|trellis.Manipulator",
      .fields = {},
      .options = team_settings().component(),
      .returns = "trellis.Robot"};
  return construct;
}

/// Exactly `count` finite numbers.
std::vector<double> elements(const Construct& construct, const Arguments& arguments, std::size_t count) {
  std::vector<double> numbers;
  arguments.each([&](std::size_t i, Value value) {
    const auto number = value.number();
    if (!number) {
      throw Error(fmt::format("{}: element {} must be a number, got {}", construct.name, i, describe(value)));
    }
    numbers.push_back(*number);
  });
  if (numbers.size() != count) {
    throw Error(fmt::format("{} takes {} number{}, as in {}; got {}", construct.name, count, count == 1 ? "" : "s",
                            construct.usage, numbers.size()));
  }
  return numbers;
}

Polygon vertices(const Construct& construct, const Arguments& arguments) {
  Polygon polygon;
  arguments.each([&](std::size_t i, Value value) {
    const auto xy = read_numbers(value, fmt::format("{}: vertex {}", construct.name, i));
    if (xy.size() != 2) {
      throw Error(fmt::format("{}: vertex {} must be two numbers {{x, y}}, got {}", construct.name, i, xy.size()));
    }
    polygon.vertices.push_back({xy[0], xy[1]});
  });
  return polygon;
}

/// Converts a shape to a value; uses the same checks as obstacles.
int shape(Stack& call, const Arguments& arguments, std::string text, Shape shape) {
  Shape checked = shape;
  std::vector<ConvexShape> parts;
  validate(checked, text, false, parts);
  NamedShape named{arguments.string("name").value_or(""), std::move(text), std::move(shape)};
  return call.result(std::move(named));
}

int make_cuboid(Stack& call, const Arguments& arguments) {
  const auto n = elements(box_construct(), arguments, 6);
  const Vec3 lo{n[0], n[1], n[2]}, hi{n[3], n[4], n[5]};
  std::string text = fmt::format("box {:g}", fmt::join(n, " "));
  if (!(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z)) {
    throw Error(fmt::format("{}: a box needs xmin < xmax, ymin < ymax and zmin < zmax", text));
  }
  const Pose3 centre{0.5 * (lo + hi), {}};
  NamedShape named{arguments.string("name").value_or(""), std::move(text),
                   Solid{Cuboid{hi - lo}, pose_of(arguments) * centre}};
  check_solid(std::get<Solid>(named.shape), named.text);
  return call.result(std::move(named));
}

int make_box(Stack& call) {
  const Arguments arguments(box_construct(), call);
  if (arguments.count() == 6) return make_cuboid(call, arguments);
  if (arguments.count() == 5) throw Error("box takes 4 numbers in the plane and 6 in space, got 5");
  const auto n = elements(box_construct(), arguments, 4);
  if (arguments["pose"].given()) throw Error("box: a pose is for boxes of space, which have 6 numbers");
  return shape(call, arguments, fmt::format("box {:g} {:g} {:g} {:g}", n[0], n[1], n[2], n[3]),
               Box2{{n[0], n[1]}, {n[2], n[3]}});
}

int make_disc(Stack& call) {
  const Arguments arguments(disc_construct, call);
  const auto n = elements(disc_construct, arguments, 3);
  return shape(call, arguments, fmt::format("disc {:g} {:g} {:g}", n[0], n[1], n[2]), Disc{{n[0], n[1]}, n[2]});
}

int make_polygon(Stack& call) {
  const Arguments arguments(polygon_construct, call);
  Polygon polygon = vertices(polygon_construct, arguments);
  std::string text = fmt::format("polygon of {} vertices", polygon.vertices.size());
  return shape(call, arguments, std::move(text), std::move(polygon));
}

/// Reads the shapes of a list, and of nested lists, in order.
class ShapeReader {
 public:
  explicit ShapeReader(const std::string& owner) : owner_(owner), lists_(owner + ": ", most_values) {}

  void read(std::size_t i, Value value) {
    if (!lists_.count()) return;
    if (const auto* shape = value.get<NamedShape>()) {
      shapes_.push_back(*shape);
      return;
    }
    if (value.type() != Type::table) {
      throw Error(fmt::format("{}: element {} must be a box, disc or polygon, got {}", owner_, i, describe(value)));
    }
    const auto within = lists_.enter(value, fmt::format("element {}", i));
    const lua::Keys keys = value.keys();
    if (!keys.names.empty() || !keys.odd.empty()) {
      throw Error(fmt::format("{}: element {} must be a box, disc or polygon or a list of these, got a table with {}",
                              owner_, i, keys.names.empty() ? keys.odd : "the field '" + keys.names.front() + "'"));
    }
    value.each([this](std::size_t k, Value element) { read(k, element); });
  }

  [[nodiscard]] const std::vector<NamedShape>& shapes() const { return shapes_; }

 private:
  static constexpr std::size_t most_values = 1'500'000;

  std::string owner_;
  std::vector<NamedShape> shapes_;
  NestedLists lists_;
};

/// Returns the obstacles of a world, numbered in their names.
/// \throws Error for a shape of the other kind of world
template <class Obstacle, class Kind>
std::vector<Obstacle> obstacles_of(const std::vector<NamedShape>& shapes) {
  constexpr bool space = std::is_same_v<Kind, Solid>;
  std::vector<Obstacle> obstacles;
  obstacles.reserve(shapes.size());
  for (const auto& [name, text, shape] : shapes) {
    const auto* fitting = std::get_if<Kind>(&shape);
    if (fitting == nullptr) {
      throw Error(fmt::format("world: obstacle {} ({}) is {}, and the bounds are {}", obstacles.size() + 1,
                              name.empty() ? text : name, space ? "planar" : "of space",
                              space ? "6 numbers: give it in space, as box {0, 0, 0, 1, 1, 1}"
                                    : "4 numbers: a world of space has 6, as bounds = {0, 0, 0, 10, 10, 10}"));
    }
    obstacles.push_back({fmt::format("obstacle {} ({})", obstacles.size() + 1, name.empty() ? text : name), *fitting});
  }
  return obstacles;
}

int make_world(Stack& call) {
  lua::Faults faults;
  const Arguments arguments(world_construct(), call, faults);
  if (!arguments.readable()) faults.raise();
  std::array<double, 6> bounds{};
  bool planar = false;
  if (const Value given = arguments["bounds"]; given.given()) {
    faults.attempt([&] {
      const std::vector<double> numbers = read_numbers(given, "world: field 'bounds'");
      planar = numbers.size() == 4;
      if (!planar && numbers.size() != bounds.size()) {
        throw Error(fmt::format("world: field 'bounds' must be {}, got {} numbers", world_construct().fields[0].expects,
                                numbers.size()));
      }
      std::copy(numbers.begin(), numbers.end(), bounds.begin());
    });
  }
  WorldSettings settings;
  faults.attempt([&] { settings = world_settings().read(arguments.options()); });
  ShapeReader reader(world_construct().name);
  arguments.each([&](std::size_t i, Value value) { faults.attempt([&] { reader.read(i, value); }); });
  faults.raise();
  if (planar) {
    if (settings.contain != Contain::robot || settings.surface) {
      throw Error("world: 'contain' and 'surface' are for worlds of space, whose bounds have 6 numbers");
    }
    return call.result(
        World({{bounds[0], bounds[1]}, {bounds[2], bounds[3]}}, obstacles_of<Obstacle, Shape>(reader.shapes())));
  }
  return call.result(World3({{bounds[0], bounds[1], bounds[2]}, {bounds[3], bounds[4], bounds[5]}},
                            obstacles_of<Obstacle3, Solid>(reader.shapes()), settings.contain, settings.surface,
                            arguments["contain"].given()));
}

bool rotates(const Arguments& arguments) { return rigid_settings().read(arguments.options()).rotates; }

int make_point(Stack& call) {
  const Arguments arguments(point_construct(), call);
  if (point_settings().read(arguments.options()).dimension == 3) return call.result(Robot3::point());
  return call.result(Robot::point());
}

int make_disc_robot(Stack& call) {
  const Arguments arguments(disc_robot_construct, call);
  return call.result(Robot::disc(elements(disc_robot_construct, arguments, 1)[0]));
}

int make_rectangle(Stack& call) {
  const Arguments arguments(rectangle_construct(), call);
  const auto size = elements(rectangle_construct(), arguments, 2);
  if (!(size[0] > 0) || !(size[1] > 0)) {
    throw Error(
        fmt::format("robot.rectangle: width and height must be greater than 0, got {:g} and {:g}", size[0], size[1]));
  }
  const Vec2 half{size[0] / 2, size[1] / 2};
  return call.result(Robot::rigid({Box2{-1.0 * half, half}}, rotates(arguments)));
}

int make_rigid(Stack& call) {
  const Arguments arguments(rigid_construct(), call);
  ShapeReader reader(rigid_construct().name);
  arguments.each([&](std::size_t i, Value value) { reader.read(i, value); });
  const auto& given = reader.shapes();
  const bool space = !given.empty() && std::holds_alternative<Solid>(given.front().shape);
  for (const NamedShape& named : given) {
    if (std::holds_alternative<Solid>(named.shape) == space) continue;
    throw Error(fmt::format("robot.rigid: {} is {} and {} is {}; a robot is of the plane or of space",
                            given.front().text, space ? "of space" : "planar", named.text,
                            space ? "planar" : "of space"));
  }
  if (space) {
    std::vector<Solid> solids;
    solids.reserve(given.size());
    for (const auto& named : given) solids.push_back(std::get<Solid>(named.shape));
    return call.result(Robot3("rigid", std::move(solids), rotates(arguments)));
  }
  std::vector<Shape> shapes;
  shapes.reserve(given.size());
  for (const auto& named : given) shapes.push_back(std::get<Shape>(named.shape));
  if (shapes.empty()) throw Error(fmt::format("robot.rigid: it needs a shape, as in {}", rigid_construct().usage));
  return call.result(Robot::rigid(shapes, rotates(arguments)));
}

/// The robots of a team, `count` of each listed, where all are of one class.
template <class R>
std::optional<std::vector<R>> all_of(const std::vector<AnyRobot>& listed, std::size_t count) {
  std::vector<R> all;
  for (const AnyRobot& robot : listed) {
    const R* one = std::get_if<R>(&robot);
    if (one == nullptr) return std::nullopt;
    all.insert(all.end(), count, *one);
  }
  return all;
}

/// \param height  of a robot of the plane in space
std::vector<SphereModel> linked_robots(const AnyRobot& robot, double height) {
  if (const auto* planar = std::get_if<Robot>(&robot)) return upright(*planar, height);
  if (const auto* body = std::get_if<Robot3>(&robot)) return linked(*body);
  return {std::get<SphereModel>(robot)};
}

int make_team(Stack& call) {
  const Arguments arguments(team_construct(), call);
  const auto count = static_cast<std::size_t>(team_settings().read(arguments.options()).count);
  const double height = team_settings().read(arguments.options()).height;
  std::vector<AnyRobot> listed;
  arguments.each([&](std::size_t i, Value value) {
    if ((listed.size() + 1) * count > 2 * Robot::most_members) {
      throw Error(fmt::format("robots: at most {} robots in a team", Robot::most_members));
    }
    auto robot = robot_in(value);
    if (!robot) {
      throw Error(fmt::format("robots: element {} must be a robot, as robot.disc(0.3), got {}", i, describe(value)));
    }
    listed.push_back(std::move(*robot));
    const bool planar = std::holds_alternative<Robot>(listed.back());
    if (height > 0.0 || planar == std::holds_alternative<Robot>(listed.front())) return;
    throw Error(
        fmt::format("robots: element {} is of {}, and element 1 of {}: give the height of the robots of the plane, "
                    "which stand on z = 0, as robots {{ ..., height = 0.5 }}",
                    i, planar ? "the plane" : "space", planar ? "space" : "the plane"));
  });
  if (height == 0.0) {
    if (const auto robots = all_of<Robot>(listed, count)) return call.result(Robot::team(*robots));
  }
  const bool planar =
      std::any_of(listed.begin(), listed.end(), [](const AnyRobot& one) { return std::holds_alternative<Robot>(one); });
  if (height > 0.0 && !planar && !listed.empty()) {
    throw Error("robots: 'height' is that of robots of the plane, and none of these is one: leave it out");
  }
  if (const auto bodies = all_of<Robot3>(listed, count)) return call.result(Robot3::team(*bodies));
  std::vector<SphereModel> robots;
  for (const AnyRobot& robot : listed) {
    const std::vector<SphereModel> own = linked_robots(robot, height);
    for (std::size_t k = 0; k < count; ++k) robots.insert(robots.end(), own.begin(), own.end());
  }
  if (robots.size() > Robot::most_members) {
    throw Error(fmt::format("robots: at most {} robots in a team, got {}", Robot::most_members, robots.size()));
  }
  return call.result(SphereModel::team(robots));
}

/// The members of a world that a script may read.
const std::vector<Field>& world_members() {
  static const std::vector<Field> members = {
      {"bounds", "number[]", "", "xmin, ymin, xmax, ymax of the boundary box, in metres; in space with z"},
      {"obstacles", "trellis.Shape[]", "", "its obstacles, as world { ... } takes them"}};
  return members;
}

/// The members of a robot that a script may read.
const std::vector<Field>& robot_members() {
  static const std::vector<Field> members = {
      {"scaled", "fun(self: trellis.Robot, factor: number): trellis.Robot", "",
       "the same robot, scaled about its reference point; of a team each robot about its own"},
      {"recentred", "fun(self: trellis.Robot): trellis.Robot, fun(q: number[]): number[]", "",
       "the same rigid body about the centre of the largest disc or ball inside of it, and a function that converts "
       "configurations: start = moved {1, 1, 0}"},
      valid_member_of("trellis.Robot"),
      {"bounding_radius", "number", "", "no point of it is ever farther than this from its reference point, in metres"},
      {"inscribed_radius", "number", "",
       "of the largest disc, or ball, about the reference point inside of it, in metres"}};
  return members;
}

/// The members of a shape that a script may read.
const std::vector<Field>& shape_members() {
  static const std::vector<Field> members = {
      {"kind", "string", "",
       "\"box\", \"disc\" or \"polygon\"; in space \"box\", \"sphere\", \"cylinder\", \"capsule\", \"convex\" (any "
       "convex "
       "mesh), \"mesh\" or \"point_cloud\""},
      {"name", "string", "", "how messages call it: its name, or what it is"},
      {"bounds", "number[]", "", "the smallest box about it: xmin, ymin, xmax, ymax in metres; in space with z"},
      {"vertices", "number[][]", "",
       "of a box, polygon, convex or mesh: its corners, those of a planar one in order; of a point_cloud its points; "
       "an "
       "error of another kind"}};
  return members;
}

/// Returns the requested name, one of the members'.
std::string member(Stack& call, const std::vector<Field>& members, const char* what) {
  const auto name = call[2].string();
  const bool known =
      name && std::any_of(members.begin(), members.end(), [&](const Field& f) { return f.name == *name; });
  if (!known) throw no_member(call[2], members, what);
  return *name;
}

/// Returns the name before the number was added: "left wall" of "obstacle 3 (left wall)".
std::string given_name(const std::string& obstacle) {
  const auto open = obstacle.find('(');
  const bool numbered = obstacle.starts_with("obstacle ") && open != std::string::npos;
  return numbered ? obstacle.substr(open + 1, obstacle.size() - open - 2) : obstacle;
}

std::vector<double> numbers_of(const Box2& box) { return {box.lo.x, box.lo.y, box.hi.x, box.hi.y}; }
std::vector<double> numbers_of(const Box3& box) { return {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z}; }
const Shape& shape_of(const Obstacle& obstacle) { return obstacle.shape; }
const Solid& shape_of(const Obstacle3& obstacle) { return obstacle.solid; }

template <class Any>
NamedShape as_shape(const Any& obstacle) {
  const std::string name = given_name(obstacle.name);
  return {name, name, shape_of(obstacle)};
}

Box2 bounds_of(const Shape& shape) {
  if (const auto* box = std::get_if<Box2>(&shape)) return *box;
  if (const auto* disc = std::get_if<Disc>(&shape)) return bounding_box(*disc);
  return bounding_box(std::get<Polygon>(shape));
}
Box3 bounds_of(const Solid& solid) { return bounding_box(solid); }

std::string kind_of(const Shape& shape) {
  if (std::holds_alternative<Box2>(shape)) return "box";
  return std::holds_alternative<Disc>(shape) ? "disc" : "polygon";
}

std::string kind_of(const Solid& solid) {
  if (std::holds_alternative<Sphere>(solid.shape)) return "sphere";
  if (std::holds_alternative<Cuboid>(solid.shape)) return "box";
  if (std::holds_alternative<Cylinder>(solid.shape)) return "cylinder";
  if (std::holds_alternative<Capsule>(solid.shape)) return "capsule";
  if (std::holds_alternative<std::shared_ptr<const PointCloud>>(solid.shape)) return "point_cloud";
  return std::get<std::shared_ptr<const Mesh>>(solid.shape)->convex() ? "convex" : "mesh";
}

/// Returns the corners of a shape, the points of a cloud; none of one that is round.
std::vector<Vec2> corners_of(const Shape& shape) {
  if (const auto* box = std::get_if<Box2>(&shape)) return rectangle_vertices(*box);
  if (const auto* polygon = std::get_if<Polygon>(&shape)) return polygon->vertices;
  return {};
}

std::vector<Vec3> corners_of(const Solid& solid) {
  std::vector<Vec3> corners;
  if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
    const Vec3 half = 0.5 * box->size;
    for (const double x : {-half.x, half.x}) {
      for (const double y : {-half.y, half.y}) {
        for (const double z : {-half.z, half.z}) corners.push_back({x, y, z});
      }
    }
  } else if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape)) {
    corners = (*mesh)->vertices();
  } else if (const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&solid.shape)) {
    corners = (*cloud)->points();
  }
  for (Vec3& corner : corners) corner = solid.pose(corner);
  return corners;
}

std::vector<double> numbers_of(Vec2 p) { return {p.x, p.y}; }
std::vector<double> numbers_of(const Vec3& p) { return {p.x, p.y, p.z}; }

int read_shape(Stack& call) {
  const auto* named = call[1].get<NamedShape>();
  const std::string field = member(call, shape_members(), "a shape");
  if (field == "name") return call.result(named->name.empty() ? named->text : named->name);
  return std::visit(
      [&](const auto& shape) {
        if (field == "kind") return call.result(kind_of(shape));
        if (field == "bounds") {
          push_numbers(call, numbers_of(bounds_of(shape)));
          return 1;
        }
        const auto corners = corners_of(shape);
        if (corners.empty()) {
          throw Error(fmt::format("a {} has no vertices; it has kind, name and bounds", kind_of(shape)));
        }
        const Value list = call.push_table();
        for (const auto& corner : corners) {
          push_numbers(call, numbers_of(corner));
          call.append(list);
        }
        return 1;
      },
      named->shape);
}

template <class W>
int read_world(Stack& call) {
  const W world = *call[1].get<W>();
  if (member(call, world_members(), "a world") == "bounds") {
    push_numbers(call, numbers_of(world.bounds()));
    return 1;
  }
  const Value result = call.push_table();
  for (const auto& obstacle : world.obstacles()) {
    call.push_object(as_shape(obstacle));
    call.append(result);
  }
  return 1;
}

template <class R>
int scale_robot(Stack& call) {
  const auto* robot = call[1].get<R>();
  if (robot == nullptr) throw Error("scaled is called with a colon: robot:scaled(0.5)");
  const auto factor = call[2].number();
  if (!factor || !(*factor > 0.0) || !std::isfinite(*factor)) {
    throw Error(fmt::format("scaled: its factor must be a number greater than 0, got {}", call[2].describe()));
  }
  return call.result(robot->scaled(*factor));
}

/// Pushes the recentred robot, and the function that converts configurations.
template <class R>
int recentre_robot(Stack& call) {
  const auto* robot = call[1].get<R>();
  if (robot == nullptr) throw Error("recentred is called with a colon: local r, moved = robot:recentred()");
  auto result = recentred(*robot);
  call.push_object(std::move(result.robot));
  call.push_function([before = *robot, offset = result.offset](Stack& use) {
    std::vector<double> q;
    if (use[1].type() == Type::table) {
      q = read_numbers(use[1], "recentred: the configuration to convert");
    } else {
      for (int i = 1; i <= use.count(); ++i) q.push_back(use[i].number().value_or(std::nan("")));
    }
    const bool numbers = std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); });
    if (q.size() != before.dimension() || !numbers) {
      throw Error(fmt::format("recentred: a configuration of the robot has {} coordinates, got {}", before.dimension(),
                              use.count() == 1 ? describe(use[1]) : fmt::format("{} values", use.count())));
    }
    push_numbers(use, recentred_configuration(before, offset, q));
    return 1;
  });
  return 2;
}

template <class R>
int read_robot(Stack& call, const std::shared_ptr<RobotChecks>& checks) {
  const R robot = *call[1].get<R>();
  const std::string name = member(call, robot_members(), "a robot");
  if (name == "valid") {
    push_valid(call, checks);
    return 1;
  }
  if (name == "bounding_radius") return call.result(robot.bounding_radius());
  if (name == "inscribed_radius") return call.result(robot.inscribed_radius());
  call.push_function(name == "recentred" ? recentre_robot<R> : scale_robot<R>);
  return 1;
}

template <class W>
std::string world_text(const W& world) {
  return fmt::format("world of {} obstacles in {:g}", world.obstacles().size(),
                     fmt::join(numbers_of(world.bounds()), " "));
}

template <class R>
std::string robot_text(const R& robot) {
  return fmt::format("robot '{}'", robot.name());
}

int make_arm(Stack& call) {
  const Arguments arguments(arm_construct(), call);
  const auto settings = arm_settings().read(arguments.options());
  Arm arm;
  arm.links = read_numbers(arguments["links"], "robot.arm: field 'links'");
  arm.widths.assign(arm.links.size(), settings.width);
  if (arguments["widths"].type() != Type::nil) {
    arm.widths = read_numbers(arguments["widths"], "robot.arm: field 'widths'");
  }
  if (arguments["base"].type() != Type::nil) {
    const auto base = read_numbers(arguments["base"], "robot.arm: field 'base'");
    if (base.size() != 2) arguments.reject("base");
    arm.base = {base[0], base[1]};
  }
  const Value limits = arguments["limits"];
  if (limits.type() != Type::nil) {
    if (limits.type() != Type::table) arguments.reject("limits");
    limits.each([&](std::size_t i, Value value) {
      if (value.boolean() == std::optional(false)) {
        arm.limits.emplace_back();
        return;
      }
      const auto bounds = read_numbers(value, fmt::format("robot.arm: limits of joint {}", i));
      if (bounds.size() != 2) arguments.reject("limits");
      arm.limits.emplace_back(std::pair(bounds[0], bounds[1]));
    });
  }
  arm.self_collision = settings.self_collision;
  return call.result(Robot::arm(arm));
}

template <class T>
lua::Callback text_of(std::string (*text)(const T&)) {
  return [text](Stack& call) {
    const auto* object = call[1].get<T>();
    return call.result(object != nullptr ? text(*object) : call[1].describe());
  };
}

}  // namespace

Error no_member(Value key, const std::vector<Field>& members, const char* what) {
  std::vector<std::string> known;
  known.reserve(members.size());
  for (const Field& field : members) known.push_back(field.name);
  const auto name = key.string();
  return Error(fmt::format("{} has no field {}{}; it has: {}", what, key.describe(),
                           name ? did_you_mean(*name, known) : "", fmt::join(known, ", ")));
}

std::string obstacle_name(const Scene& scene, std::size_t obstacle) {
  return given_name(scene.obstacle_name(obstacle));
}

void push_obstacle(Stack& stack, const Scene& scene, std::size_t obstacle) {
  if (obstacle >= scene.obstacle_count()) {
    throw Error(fmt::format("the collision backend has an obstacle {}, and the world of the instance has {}",
                            obstacle + 1, scene.obstacle_count()));
  }
  visit(scene, [&](const auto& kind) { stack.push_object(as_shape(kind.world.obstacles()[obstacle])); });
}

std::vector<const Construct*> world_constructs() {
  return {&box_construct(),      &disc_construct,        &polygon_construct, &world_construct(), &point_construct(),
          &disc_robot_construct, &rectangle_construct(), &rigid_construct(), &arm_construct(),   &team_construct()};
}

std::vector<ObjectType> world_types() {
  return {{"trellis.Shape", "an obstacle or a robot's part", "", shape_members(), {}},
          {"trellis.World", "a workspace of the plane or of space", "", world_members(), {}},
          {"trellis.Robot", "what moves", "", robot_members(), {}}};
}

void open_world(Stack& stack) {
  const auto checks = make_robot_checks();
  stack.declare<NamedShape>({{"__tostring", text_of<NamedShape>([](const NamedShape& shape) { return shape.text; })},
                             {"__index", read_shape}});
  stack.declare<World>({{"__tostring", text_of<World>(world_text<World>)}, {"__index", read_world<World>}});
  stack.declare<World3>({{"__tostring", text_of<World3>(world_text<World3>)}, {"__index", read_world<World3>}});
  stack.declare<Robot>({{"__tostring", text_of<Robot>(robot_text<Robot>)},
                        {"__index", [checks](Stack& call) { return read_robot<Robot>(call, checks); }}});
  stack.declare<Robot3>({{"__tostring", text_of<Robot3>(robot_text<Robot3>)},
                         {"__index", [checks](Stack& call) { return read_robot<Robot3>(call, checks); }}});

  for (const auto& [construct, make] :
       std::vector<std::pair<const Construct*, int (*)(Stack&)>>{{&box_construct(), make_box},
                                                                 {&disc_construct, make_disc},
                                                                 {&polygon_construct, make_polygon},
                                                                 {&world_construct(), make_world},
                                                                 {&team_construct(), make_team}}) {
    stack.push_function(make);
    stack.set_global(construct->name);
  }
  const Value robots = stack.push_table();
  for (const auto& [name, make] : std::vector<std::pair<std::string, int (*)(Stack&)>>{{"point", make_point},
                                                                                       {"disc", make_disc_robot},
                                                                                       {"rectangle", make_rectangle},
                                                                                       {"rigid", make_rigid},
                                                                                       {"arm", make_arm}}) {
    stack.push_function(make);
    stack.set_field(robots, name);
  }
  stack.on_missing(robots, missing_field("robot"));
  stack.set_global("robot");
}

}  // namespace trellis::dsl
