// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/spatial_world.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include <dsl/language/core/word.hpp>
#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/ends.hpp>
#include <dsl/language/words/problem.hpp>
#include <trellis/base/error.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/point_cloud_file.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

const Field name_field = {"name", "string", "a string", "how messages call it"};

const Construct pose_construct = {
    .name = "pose",
    .usage = "pose { 2, 1, 1, axis = {0, 0, 1}, angle = math.pi / 2 }",
    .summary = "a position in space with an orientation: of a body, or of a shape",
    .list = "x, y and z in metres; none: the origin",
    .element = "number",
    .fields = {{"axis", "number[]", "a list of 3 numbers", "what it is turned about, with `angle`"},
               {"angle", "number", "a number", "how far it is turned about `axis`, in radians"},
               {"rpy", "number[]", "a list of 3 numbers: roll, pitch, yaw",
                "turns about the fixed axes x, then y, then z, in radians, as in URDF"},
               {"quaternion", "number[]", "a list of 4 numbers: x, y, z, w", "a quaternion of norm 1, w last"}},
    .options = {},
    .returns = "trellis.Pose"};

const Construct& sphere_construct() {
  static const Construct construct = {.name = "sphere",
                                      .usage = "sphere { x, y, z, radius, name = \"ball\" }",
                                      .summary = "a ball in space, in metres",
                                      .list = "its centre and its radius",
                                      .element = "number",
                                      .fields = {name_field},
                                      .options = {},
                                      .returns = "trellis.Shape"};
  return construct;
}

Construct round_construct(const std::string& name, std::string summary) {
  return {.name = name,
          .usage = name + " { radius = 0.2, length = 1, pose = pose {2, 1, 0.5} }",
          .summary = std::move(summary),
          .list = "",
          .element = "",
          .fields = {{"radius", "number", "a number greater than 0", "its radius, in metres", true},
                     {"length", "number", "a number greater than 0",
                      "along its axis, in metres; of a capsule that of the segment, without the round ends", true},
                     pose_field(),
                     name_field},
          .options = {},
          .returns = "trellis.Shape"};
}

const Construct& cylinder_construct() {
  static const Construct construct =
      round_construct("cylinder", "a cylinder in space about the z axis of its pose, centred there");
  return construct;
}

const Construct& capsule_construct() {
  static const Construct construct = round_construct(
      "capsule", "all points within a radius of a segment along the z axis of its pose, which is centred there");
  return construct;
}

const Construct& convex_construct() {
  static const Construct construct = {.name = "convex",
                                      .usage = "convex { {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1} }",
                                      .summary = "the convex hull of points in space",
                                      .list = "its points, not all in a plane",
                                      .element = "number[]",
                                      .fields = {pose_field(), name_field},
                                      .options = {},
                                      .returns = "trellis.Shape"};
  return construct;
}

struct MeshSettings {
  bool convex = false;
};

const Settings<MeshSettings>& mesh_settings() {
  static const auto settings =
      Settings<MeshSettings>(Component::Kind::scene, "mesh", "a mesh from a file", "")
          .boolean("convex", &MeshSettings::convex, "the convex hull of its vertices instead of the mesh itself");
  return settings;
}

const Construct& mesh_construct() {
  static const Construct construct = {
      .name = "mesh",
      .usage = "mesh \"rl/obj/maze.obj\"",
      .summary = "a triangle mesh in space from a file: STL, OBJ, PLY, OFF or BYU (.g)",
      .list = "the file, looked for in the script's folder, then in the folder of scenes (TRELLIS_SCENES)",
      .element = "string",
      .fields = {{"unit", "string|number", R"("m", "mm", "cm", "inch", or a number of metres)",
                  "the unit of the file's coordinates, which its format does not state", false, "\"m\""},
                 pose_field(),
                 name_field},
      .options = mesh_settings().component(),
      .returns = "trellis.Shape"};
  return construct;
}

struct CloudSettings {
  double thin = 0.0;
  bool skip_nan = false;
};

const Settings<CloudSettings>& cloud_settings() {
  static const auto settings =
      Settings<CloudSettings>(Component::Kind::scene, "point_cloud", "points of a sensor", "")
          .number("thin", &CloudSettings::thin, "m", Range::at_least(0),
                  "leaves points out that are at most so far from one that stays, and enlarges the radius by the "
                  "largest such distance: the balls that stay contain all others; 0: none")
          .boolean(
              "skip_nan", &CloudSettings::skip_nan,
              "leaves points out whose coordinates are not numbers, as a depth camera writes them where it measured "
              "nothing");
  return settings;
}

const Construct& cloud_construct() {
  static const Construct construct = {
      .name = "point_cloud",
      .usage = "point_cloud { \"scan.pcd\", radius = 0.01 }",
      .summary =
          "an obstacle of points that a sensor measured, each with a ball about it, from a file (PCD, PLY, or text: "
          ".xyz, .pts, .txt, .csv) or a list",
      .list =
          "the file, looked for as by mesh; or the points, as {0.5, 0, 0.2}, {0.5, 0.1, 0.2}: a list in a variable "
          "gets the fields, as points.radius = 0.01, and is passed itself, as point_cloud(points)",
      .element = "string|number[]",
      .fields = {{"radius", "number", "a number greater than 0",
                  "of the ball about each point, in metres; half the points' distance from each other closes the gaps "
                  "between them",
                  true},
                 {"unit", "string|number", R"("m", "mm", "cm", "inch", or a number of metres)",
                  "the unit of the file's coordinates", false, "\"m\""},
                 pose_field(),
                 name_field},
      .options = cloud_settings().component(),
      .returns = "trellis.Shape"};
  return construct;
}

/// Returns the field `unit` as options of files have it.
std::string unit_of(const Arguments& arguments) {
  const Value unit = arguments["unit"];
  if (!unit.given()) return "m";
  if (const auto metres = unit.number()) return fmt::format("{}", *metres);
  const auto name = unit.string();
  if (!name) arguments.reject("unit");
  return *name;
}

std::vector<double> numbers(const Construct& construct, const Arguments& arguments) {
  std::vector<double> all;
  arguments.each([&](std::size_t i, Value value) {
    const auto number = value.number();
    if (!number || !std::isfinite(*number)) {
      throw Error(fmt::format("{}: element {} must be a finite number, got {}", construct.name, i, describe(value)));
    }
    all.push_back(*number);
  });
  return all;
}

std::vector<double> list_field(const Arguments& arguments, const std::string& name, std::size_t count,
                               const std::string& what) {
  auto all = read_numbers(arguments[name], fmt::format("{}: field '{}'", what, name));
  if (all.size() != count) arguments.reject(name);
  return all;
}

Quaternion orientation_of(const Arguments& arguments) {
  const bool turned = arguments["axis"].given() || arguments["angle"].given();
  const bool rpy = arguments["rpy"].given();
  const bool quaternion = arguments["quaternion"].given();
  if (static_cast<int>(turned) + static_cast<int>(rpy) + static_cast<int>(quaternion) > 1) {
    throw Error("pose: an orientation is given once: by axis and angle, by rpy, or by quaternion");
  }
  if (turned) {
    const auto angle = arguments["angle"].number();
    if (!arguments["axis"].given()) throw Error("pose: 'angle' needs the field 'axis', as axis = {0, 0, 1}");
    if (!angle || !std::isfinite(*angle)) throw Error("pose: 'axis' needs the field 'angle', a number in radians");
    const auto v = list_field(arguments, "axis", 3, "pose");
    const Vec3 axis{v[0], v[1], v[2]};
    if (!(norm(axis) > 0.0)) throw Error("pose: the axis must not be 0");
    return normalised(rotation_of((*angle / norm(axis)) * axis));
  }
  if (rpy) {
    const auto v = list_field(arguments, "rpy", 3, "pose");
    return normalised(rotation_of({0, 0, v[2]}) * (rotation_of({0, v[1], 0}) * rotation_of({v[0], 0, 0})));
  }
  if (quaternion) {
    const auto v = list_field(arguments, "quaternion", 4, "pose");
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
    constexpr double rounding = 1e-3;  // of numbers with few decimals
    if (!(std::abs(length - 1.0) <= rounding)) {
      throw Error(fmt::format("pose: a quaternion has norm 1, this one has {:g}", length));
    }
    return normalised({v[0], v[1], v[2], v[3]});
  }
  return {};
}

void add_once(const std::string& warning, std::vector<std::string>& warnings) {
  if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
}

/// The hidden table of hints, by the numbers of the poses.
constexpr const char* hints = "pose hints";

std::string hint_key(const Pose3& pose) {
  const auto& [position, turn] = pose;
  return fmt::format("{} {} {} {} {} {} {}", position.x, position.y, position.z, turn.x, turn.y, turn.z, turn.w);
}

/// Notes a pose whose angles are probably degrees.
void note_degrees(Stack& call, const Arguments& arguments, const Pose3& pose, std::vector<std::string>& warnings) {
  std::string given;
  double angle = 0.0;
  const auto examine = [&](double x) { angle = std::abs(x) > 2.0 * std::numbers::pi && angle == 0.0 ? x : angle; };
  if (arguments["rpy"].given()) {
    const auto v = list_field(arguments, "rpy", 3, "pose");
    for (const double x : v) examine(x);
    given = fmt::format("rpy = {{{:g}}}", fmt::join(v, ", "));
  } else if (const auto turn = arguments["angle"].number()) {
    examine(*turn);
    given = fmt::format("angle = {:g}", *turn);
  }
  if (angle == 0.0) return;
  const std::string text = fmt::format("has {}: {}", given, radians_sentence(angle));
  const Value table = call.push_hidden(hints);
  call.push("; the pose " + text);
  call.set_field(table, hint_key(pose));
  const auto position = call.where();
  add_once(fmt::format("{}the pose {}", position ? position->prefix() : "", text), warnings);
}

int make_pose(Stack& call, std::vector<std::string>& warnings) {
  const Arguments arguments(pose_construct, call);
  const auto at = numbers(pose_construct, arguments);
  if (!at.empty() && at.size() != 3) {
    throw Error(fmt::format("pose takes 3 numbers, x, y and z, as in {}; got {}", pose_construct.usage, at.size()));
  }
  Pose3 pose;
  if (!at.empty()) pose.position = {at[0], at[1], at[2]};
  pose.orientation = orientation_of(arguments);
  note_degrees(call, arguments, pose, warnings);
  return call.result(pose);
}

/// Converts a solid to a value; uses the same checks as obstacles.
int solid(Stack& call, const Arguments& arguments, std::string text, Solid solid) {
  NamedShape named{arguments.string("name").value_or(""), std::move(text), std::move(solid)};
  check_solid(std::get<Solid>(named.shape), named.text);
  return call.result(std::move(named));
}

int make_sphere(Stack& call) {
  const Arguments arguments(sphere_construct(), call);
  const auto n = numbers(sphere_construct(), arguments);
  if (n.size() != 4) {
    throw Error(fmt::format("sphere takes 4 numbers, as in {}; got {}", sphere_construct().usage, n.size()));
  }
  return solid(call, arguments, fmt::format("sphere {:g} {:g} {:g} {:g}", n[0], n[1], n[2], n[3]),
               {Sphere{n[3]}, {{n[0], n[1], n[2]}, {}}});
}

double positive(const Arguments& arguments, const std::string& name) {
  const auto number = arguments[name].number();
  if (!number || !(*number > 0.0) || !std::isfinite(*number)) arguments.reject(name);
  return *number;
}

int make_cylinder(Stack& call) {
  const Arguments arguments(cylinder_construct(), call);
  const double radius = positive(arguments, "radius"), length = positive(arguments, "length");
  return solid(call, arguments, fmt::format("cylinder of radius {:g} and length {:g}", radius, length),
               {Cylinder{radius, length}, pose_of(arguments)});
}

int make_capsule(Stack& call) {
  const Arguments arguments(capsule_construct(), call);
  const double radius = positive(arguments, "radius"), length = positive(arguments, "length");
  return solid(call, arguments, fmt::format("capsule of radius {:g} and length {:g}", radius, length),
               {Capsule{radius, length}, pose_of(arguments)});
}

int make_convex(Stack& call) {
  const Arguments arguments(convex_construct(), call);
  std::vector<Vec3> points;
  arguments.each([&](std::size_t i, Value value) {
    const auto p = read_numbers(value, fmt::format("convex: point {}", i));
    if (p.size() != 3) {
      throw Error(fmt::format("convex: point {} must be three numbers {{x, y, z}}, got {}", i, p.size()));
    }
    points.push_back({p[0], p[1], p[2]});
  });
  auto hull = std::make_shared<const Mesh>(Mesh::hull(points, "convex"));
  return solid(call, arguments, fmt::format("convex of {} points", points.size()),
               {std::move(hull), pose_of(arguments)});
}

int make_mesh(Stack& call, const ScriptPlace& place, std::vector<std::string>& warnings) {
  const Arguments arguments(mesh_construct(), call);
  std::optional<std::string> file;
  arguments.each([&](std::size_t i, Value value) {
    file = i == 1 ? value.string() : std::nullopt;
    if (!file)
      throw Error(
          fmt::format("mesh takes the name of one file, as in {}; got {}", mesh_construct().usage, describe(value)));
  });
  if (!file) throw Error(fmt::format("mesh: the file is missing, as in {}", mesh_construct().usage));
  const auto settings = mesh_settings().read(arguments.options());
  MeshOptions options;
  options.unit = unit_of(arguments);
  MeshFile read = read_mesh(scene_path("mesh", *file, place), options);
  // A pose that turns the mesh shows that its author knows its axes.
  if (!read.up_warning.empty() && pose_of(arguments).orientation == Quaternion{}) {
    read.warnings.push_back(read.up_warning);
  }
  for (const std::string& warning : read.warnings) add_once(warning, warnings);
  if (settings.convex) read.mesh = std::make_shared<const Mesh>(Mesh::hull(read.mesh->vertices(), *file));
  return solid(call, arguments, fmt::format("mesh {}", std::filesystem::path(*file).filename().string()),
               {std::move(read.mesh), pose_of(arguments)});
}

int make_cloud(Stack& call, const ScriptPlace& place, std::vector<std::string>& warnings) {
  const Arguments arguments(cloud_construct(), call);
  const double radius = positive(arguments, "radius");
  const auto settings = cloud_settings().read(arguments.options());
  std::optional<std::string> file;
  std::vector<Vec3> points;
  arguments.each([&](std::size_t i, Value value) {
    if (const auto name = value.type() == lua::Type::string ? value.string() : std::nullopt) {
      if (i > 1) throw Error("point_cloud takes one file, or points");
      file = name;
      return;
    }
    if (file) throw Error("point_cloud takes one file, or points");
    const auto p = read_numbers(value, fmt::format("point_cloud: point {}", i));
    if (p.size() != 3) {
      throw Error(fmt::format("point_cloud: point {} must be three numbers {{x, y, z}}, got {}", i, p.size()));
    }
    points.push_back({p[0], p[1], p[2]});
  });
  std::string text = fmt::format("point_cloud of {} points", points.size());
  if (file) {
    PointCloudFile read =
        read_point_cloud(scene_path("point_cloud", *file, place), {unit_of(arguments), settings.skip_nan});
    for (const std::string& warning : read.warnings) add_once(warning, warnings);
    points = std::move(read.points);
    text = fmt::format("point_cloud {}", std::filesystem::path(*file).filename().string());
  } else if (arguments["unit"].given()) {
    throw Error("point_cloud: 'unit' is of a file's coordinates; those of a list are metres");
  }
  PointCloud cloud(std::move(points), radius, text);
  if (settings.thin > 0.0) {
    const std::size_t before = cloud.points().size();
    cloud = cloud.thinned(settings.thin);
    text +=
        fmt::format(", thinned from {} points to {} of radius {:.4g} m", before, cloud.points().size(), cloud.radius());
  }
  return solid(call, arguments, std::move(text),
               {std::make_shared<const PointCloud>(std::move(cloud)), pose_of(arguments)});
}

/// The members of a pose that a script may read.
const std::vector<Field>& pose_members() {
  static const std::vector<Field> members = {{"position", "number[]", "", "x, y, z in metres"},
                                             {"quaternion", "number[]", "", "its orientation: x, y, z, w, of norm 1"}};
  return members;
}

int read_pose(Stack& call) {
  const Pose3 pose = *call[1].get<Pose3>();
  const auto name = call[2].string();
  if (name == "position") {
    push_numbers(call, std::vector{pose.position.x, pose.position.y, pose.position.z});
    return 1;
  }
  if (name == "quaternion") {
    const Quaternion& q = pose.orientation;
    push_numbers(call, std::vector{q.x, q.y, q.z, q.w});
    return 1;
  }
  const std::vector<std::string> known = {"position", "quaternion"};
  throw Error(fmt::format("a pose has no field {}{}; it has: {}", call[2].describe(),
                          name ? did_you_mean(*name, known) : "", fmt::join(known, ", ")));
}

int print_pose(Stack& call) {
  const auto* pose = call[1].get<Pose3>();
  return call.result(pose != nullptr ? "pose " + pose_text(*pose) : call[1].describe());
}

}  // namespace

const Field& pose_field() {
  static const Field field = {"pose", "trellis.Pose", "a pose, as pose {2, 1, 0.5}",
                              "where it is; none: at the origin"};
  return field;
}

Pose3 pose_of(const Arguments& arguments) {
  const Value given = arguments["pose"];
  if (!given.given()) return {};
  const auto* pose = given.get<Pose3>();
  if (pose == nullptr) arguments.reject("pose");
  return *pose;
}

std::string pose_hint(Stack& stack, const Pose3& pose) {
  const int before = stack.size();
  const Value hint = stack.push_hidden(hints).field(hint_key(pose));
  std::string text = hint.string().value_or("");
  stack.resize(before);
  return text;
}

std::string pose_text(const Pose3& pose) {
  const auto& [x, y, z] = pose.position;
  std::string text = fmt::format("({:g}, {:g}, {:g})", x, y, z);
  const Vec3 turn = rotation_vector(pose.orientation);
  const double angle = norm(turn);
  if (angle == 0.0) return text;
  return fmt::format("{} turned by {:g} rad about ({:g}, {:g}, {:g})", text, angle, turn.x / angle, turn.y / angle,
                     turn.z / angle);
}

std::vector<const Construct*> spatial_world_constructs() {
  return {&pose_construct,     &sphere_construct(), &cylinder_construct(), &capsule_construct(),
          &convex_construct(), &mesh_construct(),   &cloud_construct()};
}

std::vector<ObjectType> spatial_world_types() {
  return {{"trellis.Pose", "a position in space with an orientation", "", pose_members(), {}}};
}

void open_spatial_world(Stack& stack, const ScriptPlace& place,
                        const std::shared_ptr<std::vector<std::string>>& warnings) {
  stack.declare<Pose3>({{"__tostring", print_pose}, {"__index", read_pose}});
  for (const auto& [construct, make] :
       std::vector<std::pair<const Construct*, int (*)(Stack&)>>{{&sphere_construct(), make_sphere},
                                                                 {&cylinder_construct(), make_cylinder},
                                                                 {&capsule_construct(), make_capsule},
                                                                 {&convex_construct(), make_convex}}) {
    stack.push_function(make);
    stack.set_global(construct->name);
  }
  stack.push_function([warnings](Stack& call) { return make_pose(call, *warnings); });
  stack.set_global(pose_construct.name);
  stack.push_function([place, warnings](Stack& call) { return make_mesh(call, place, *warnings); });
  stack.set_global(mesh_construct().name);
  stack.push_function([place, warnings](Stack& call) { return make_cloud(call, place, *warnings); });
  stack.set_global(cloud_construct().name);
}

}  // namespace trellis::dsl
