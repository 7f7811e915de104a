// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/manipulator.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <dsl/language/core/types.hpp>
#include <dsl/language/core/word.hpp>
#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/problem.hpp>
#include <dsl/language/words/robot_queries.hpp>
#include <dsl/language/words/spatial_world.hpp>
#include <dsl/language/words/world.hpp>
#include <trellis/base/error.hpp>
#include <trellis/reader/robot_files.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

struct UrdfSettings {
  bool self_collision = true;
  bool soft_limits = false;
  bool leave_out_missing = false;
};

const Settings<UrdfSettings>& urdf_settings() {
  static const auto settings =
      Settings<UrdfSettings>(Component::Kind::scene, "robot", "a robot of a URDF file", "")
          .boolean(
              "self_collision", &UrdfSettings::self_collision,
              "links that are no neighbours must not touch, but for the pairs that the SRDF file disables, and those "
              "that touch in nearly every configuration, which a warning names")
          .boolean("soft_limits", &UrdfSettings::soft_limits,
                   "joints stay within the soft limits of <safety_controller>, too")
          .choice("missing_meshes", &UrdfSettings::leave_out_missing, {{"error", false}, {"leave_out", true}},
                  R"(where a mesh is not found: "error", or "leave_out", the link lacks it, by a warning)");
  return settings;
}

const Construct& urdf_construct() {
  static const Construct construct = {
      .name = "robot.urdf",
      .usage = R"(robot.urdf("fetch.urdf", { srdf = "fetch.srdf", group = "arm_with_torso" }))",
      .summary =
          "a robot of links and joints from a URDF file; spheres are taken as they are, other shapes are covered by "
          "balls",
      .list = "",
      .element = "",
      .fields =
          {{"srdf", "string", "the name of a file",
            "a SRDF file: groups of joints, named configurations, pairs of links that may touch"},
           {"group", "string|string[]", "the name of a group, or a list of names of joints",
            "what moves; the other joints stay where `values` say. None: all joints that can move"},
           {"values", "table<string, number>", "a table, as { torso_lift_joint = 0.2 }",
            "where joints stay that do not move, in radians or metres; others at 0 or at the nearest limit"},
           {"base", "trellis.Pose|string", R"(a pose, "planar" or "floating")",
            "where the robot's base is in the world; \"planar\": it moves in the plane z = 0, by three coordinates "
            "before those of the joints; \"floating\": it moves freely, by a position and a quaternion x, y, z, w"},
           {"packages", "table<string, string>", "a table, as { ur_description = \"robots/ur\" }",
            "the folders of packages that the file names in package://NAME/PATH; of others those above or beside the "
            "file, by name or package.xml, and in ROS_PACKAGE_PATH"},
           {"cover", "number", "a number > 0",
            "how far the balls that cover shapes other than spheres may protrude, in metres; not given: 0.008, and up "
            "to 0.03 for links that would need more than 200 balls"}},
      .options = urdf_settings().component(),
      .returns = "trellis.Manipulator",
      .arguments = {{"file", "string", "the name of a file",
                     "looked for in the script's folder, then in the folder of scenes (TRELLIS_SCENES)", true}}};
  return construct;
}

const Construct& attach_construct() {
  static const Construct construct = {
      .name = "attach",
      .usage = R"(arm:attach(cylinder { radius = 0.03, length = 0.14, name = "can" }, { link = "panda_hand" }))",
      .summary = "the robot with a shape that a link carries",
      .list = "",
      .element = "",
      .fields = {{"link", "string", "the name of a link", "that carries the shape", true},
                 {"touch", "string[]", "a list of names of links",
                  "that may touch the shape, beside the link that carries it and links that fixed joints connect to "
                  "that one"}},
      .options = {},
      .returns = "trellis.Manipulator",
      .arguments = {{"shape", "trellis.Shape", "a shape of space", "in the frame of the link", true}}};
  return construct;
}

const Construct& reach_construct() {
  static const Construct construct = {
      .name = "reach",
      .usage = "reach { link = \"panda_hand\", pose = pose {0.5, 0, 0.4, rpy = {math.pi, 0, 0}} }",
      .summary =
          "a start or goal of a robot of a URDF file: a link at a pose of the world; inverse kinematics finds up to "
          "ten "
          "valid configurations for a goal, each of which is one. Of a team the link is named with the robot's number, "
          "as '2/panda_hand', or a list has an element for each robot",
      .list = "",
      .element = "",
      .fields = target_fields(),
      .options = {},
      .returns = "trellis.Reach"};
  return construct;
}

int make_reach(Stack& call) {
  const Arguments arguments(reach_construct(), call);
  LinkGoal goal;
  goal.link = arguments.string("link").value_or("");
  goal.pose = pose_of(arguments);
  goal.hint = pose_hint(call, goal.pose);
  if (arguments["within"].given()) {
    const auto within = read_numbers(arguments["within"], "reach: field 'within'");
    if (within.size() != 2 || !(within[0] > 0.0) || !(within[1] > 0.0)) arguments.reject("within");
    goal.near = within[0];
    goal.turn = within[1];
  }
  return call.result(goal);
}

int print_reach(Stack& call) {
  const auto* goal = call[1].get<LinkGoal>();
  if (goal == nullptr) return call.result(call[1].describe());
  return call.result(fmt::format("link '{}' at {}", goal->link, pose_text(goal->pose)));
}

/// The members of a robot that a script may read.
const std::vector<Field>& members() {
  static const std::vector<Field> list = {
      {"name", "string", "", "of the robot in its URDF file"},
      {"joints", "string[]|fun(self: trellis.Manipulator): trellis.Joint[]", "",
       "the names of its coordinates, in order; as a method robot:joints() what is known of each"},
      {"links", "string[]", "", "the names of its links, with those that `attach` added"},
      {"states", "table<string, number[]>", "", "its named configurations, which `start` and `goal` may name"},
      {"base", "trellis.Pose", "", "where its base is in the world"},
      {"bounding_radius", "number", "", "no point of it is ever farther than this from its base, in metres"},
      {"pose", "fun(self: trellis.Manipulator, q: number[], link: string): trellis.Pose", "",
       "where a link is in the world at a configuration (forward kinematics)"},
      valid_member_of("trellis.Manipulator"),
      {"ik", "fun(self: trellis.Manipulator, options: table): number[][], string?", "",
       ik_construct().summary + ": " + ik_construct().usage},
      {"attach", "fun(self: trellis.Manipulator, shape: trellis.Shape, options: table): trellis.Manipulator", "",
       R"(the robot with a shape that a link carries: arm:attach(shape, { link = "hand", touch = {"finger"} }))"}};
  return list;
}

/// The names of a robot's coordinates.
std::vector<std::string> coordinates(const SphereModel& robot) {
  std::vector<std::string> names;
  for (const Axis& axis : joint_axes(robot.robot(), {}, 1.0)) names.push_back(axis.name);
  return names;
}

std::vector<std::string> link_names(const SphereModel& robot) {
  std::vector<std::string> names;
  for (const Link& link : robot.robot().tree().links()) names.push_back(link.name);
  return names;
}

/// \param what  names the value in messages: "attach: field 'link'"
std::size_t link_of(const SphereModel& robot, Value value, const std::string& what) {
  const auto name = value.string();
  if (name) {
    if (const auto found = robot.robot().tree().find_link(*name)) return *found;
  }
  const std::vector<std::string> known = link_names(robot);
  throw Error(fmt::format("{} must be the name of a link, got {}{}; there are: {}", what, describe(value),
                          name ? did_you_mean(*name, known) : "", fmt::join(known, ", ")));
}

void push_names(Stack& stack, const std::vector<std::string>& names) {
  const Value list = stack.push_table();
  for (const std::string& name : names) {
    stack.push(name);
    stack.append(list);
  }
}

std::vector<std::string> names_in(Value list, const std::string& what) {
  std::vector<std::string> names;
  list.each([&](std::size_t i, Value value) {
    const auto name = value.string();
    if (!name) throw Error(fmt::format("{}: entry {} must be a name, got {}", what, i, describe(value)));
    names.push_back(*name);
  });
  return names;
}

void read_group(Value value, ManipulatorFiles& files) {
  if (!value.given()) return;
  if (const auto name = value.string()) {
    files.group = *name;
    return;
  }
  if (value.type() != Type::table) {
    throw Error(fmt::format("robot.urdf: field 'group' must be {}, got {}", urdf_construct().fields[1].expects,
                            describe(value)));
  }
  files.joints = names_in(value, "robot.urdf: field 'group'");
  if (files.joints.empty()) throw Error("robot.urdf: field 'group' names no joint; leave it out for all that can move");
}

/// \throws Error where a field of robot.urdf is no table of names
void check_names(const std::string& field, Value value) {
  const bool table = value.type() == Type::table;
  if (table && value.keys().length == 0 && value.keys().odd.empty()) return;
  const std::vector<Field>& fields = urdf_construct().fields;
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& one) { return one.name == field; });
  throw Error(fmt::format("robot.urdf: field '{}' must be {}, got {}", field, found->expects,
                          table ? "a list" : describe(value)));
}

void read_values(Value value, ManipulatorFiles& files) {
  if (!value.given()) return;
  check_names("values", value);
  for (const std::string& name : value.keys().names) {
    const auto number = value.field(name).number();
    if (!number || !std::isfinite(*number)) {
      throw Error(fmt::format("robot.urdf: field 'values': joint '{}' must be a finite number, got {}", name,
                              describe(value.field(name))));
    }
    files.values.emplace(name, *number);
  }
}

void read_packages(Value value, ManipulatorFiles& files, const ScriptPlace& place) {
  if (!value.given()) return;
  check_names("packages", value);
  for (const std::string& name : value.keys().names) {
    const auto folder = value.field(name).string();
    if (!folder || folder->empty()) {
      throw Error(fmt::format("robot.urdf: field 'packages': '{}' must be the name of a folder, got {}", name,
                              describe(value.field(name))));
    }
    files.reading.packages.emplace(name, scene_folder("robot.urdf", *folder, place));
  }
}

void read_cover(Value value, ManipulatorFiles& files) {
  if (!value.given()) return;
  const auto number = value.number();
  if (!number || !std::isfinite(*number) || *number <= 0.0) {
    throw Error(fmt::format("robot.urdf: field 'cover' must be a number > 0, in metres, as 0.01, got {}",
                            number ? fmt::format("{}", *number) : describe(value)));
  }
  files.cover = *number;
}

int make_urdf(Stack& call, const ScriptPlace& place, std::vector<std::string>& warnings) {
  const Construct& construct = urdf_construct();
  const auto file = call[1].string();
  if (!file || file->empty()) {
    throw Error(
        fmt::format("robot.urdf: the file must be a string, as in {}, got {}", construct.usage, describe(call[1])));
  }
  ManipulatorFiles files;
  files.urdf = scene_path("robot.urdf", *file, place);
  Pose3 base;
  if (call.count() > 1) {
    check_fields(construct, call[2]);
    lua::Faults faults;
    const Value table = call[2];
    std::vector<Options::Entry> given;
    for (const Option& option : urdf_settings().component().options) {
      const Value value = table.field(option.name);
      if (value.given()) {
        faults.attempt([&] { read_option(urdf_settings().component(), option.name, value, given); });
      }
    }
    faults.attempt([&] {
      const UrdfSettings settings = urdf_settings().read(validated(urdf_settings().component(), given));
      files.self_collision = settings.self_collision;
      files.reading.soft_limits = settings.soft_limits;
      files.reading.leave_out_missing = settings.leave_out_missing;
    });
    if (const Value srdf = table.field("srdf"); srdf.given()) {
      faults.attempt([&] {
        const auto name = srdf.string();
        if (!name || name->empty()) {
          throw Error(fmt::format("robot.urdf: field 'srdf' must be the name of a file, got {}", describe(srdf)));
        }
        files.srdf = scene_path("robot.urdf", *name, place);
      });
    }
    faults.attempt([&] { read_group(table.field("group"), files); });
    faults.attempt([&] { read_values(table.field("values"), files); });
    faults.attempt([&] { read_packages(table.field("packages"), files, place); });
    faults.attempt([&] { read_cover(table.field("cover"), files); });
    if (const Value at = table.field("base"); at.given()) {
      faults.attempt([&] {
        if (const auto* pose = at.get<Pose3>()) {
          base = *pose;
        } else if (at.string() == std::optional<std::string>("planar")) {
          files.base = Joint::Kind::planar;
        } else if (at.string() == std::optional<std::string>("floating")) {
          files.base = Joint::Kind::floating;
        } else {
          throw Error(
              fmt::format("robot.urdf: field 'base' must be {}, got {}", construct.fields[3].expects, describe(at)));
        }
      });
    }
    faults.raise();
  }
  std::vector<std::string> found;
  SphereModel robot = read_manipulator(files, found);
  for (std::string& warning : found) {
    std::string text = fmt::format("robot.urdf: {}", warning);
    if (std::find(warnings.begin(), warnings.end(), text) == warnings.end()) warnings.push_back(std::move(text));
  }
  return call.result(robot.based_at(base));
}

int attach(Stack& call) {
  const Construct& construct = attach_construct();
  const auto* robot = call[1].get<SphereModel>();
  if (robot == nullptr) throw Error(fmt::format("attach is called with a colon: {}", construct.usage));
  const auto* shape = call[2].get<NamedShape>();
  const auto* solid = shape != nullptr ? std::get_if<Solid>(&shape->shape) : nullptr;
  if (solid == nullptr) {
    throw Error(fmt::format("attach: the first argument must be a shape of space, as in {}, got {}", construct.usage,
                            shape != nullptr ? shape->text + ", which is planar" : describe(call[2])));
  }
  check_fields(construct, call[3]);
  const std::size_t link = link_of(*robot, call[3].field("link"), "attach: field 'link'");
  std::vector<std::size_t> touch;
  if (const Value list = call[3].field("touch"); list.given()) {
    if (list.type() != Type::table) {
      throw Error(fmt::format("attach: field 'touch' must be {}, got {}", construct.fields[1].expects, describe(list)));
    }
    list.each([&](std::size_t i, Value value) {
      touch.push_back(link_of(*robot, value, fmt::format("attach: entry {} of field 'touch'", i)));
    });
  }
  return call.result(robot->attached(shape->name.empty() ? shape->text : shape->name, *solid, link, touch));
}

int pose_of_link(Stack& call) {
  const auto* robot = call[1].get<SphereModel>();
  if (robot == nullptr) throw Error("pose is called with a colon: arm:pose(q, \"hand\")");
  const std::vector<double> q = read_numbers(call[2], "pose: the configuration");
  if (q.size() != robot->robot().dimension()) {
    throw Error(fmt::format("pose: the configuration must have {} numbers ({}), got {}", robot->robot().dimension(),
                            fmt::join(coordinates(*robot), ", "), q.size()));
  }
  const std::size_t link = link_of(*robot, call[3], "pose: the link");
  return call.result(robot->base() * robot->robot().pose_of(link, q));
}

int read_member(Stack& call, const std::shared_ptr<RobotChecks>& checks) {
  const SphereModel& robot = *call[1].get<SphereModel>();
  const auto name = call[2].string();
  if (name == "name") return call.result(robot.robot().tree().name());
  if (name == "bounding_radius") return call.result(robot.bounding_radius());
  if (name == "base") return call.result(robot.base());
  if (name == "joints") {
    push_joints(call, robot);
    return 1;
  }
  if (name == "valid") {
    push_valid(call, checks);
    return 1;
  }
  if (name == "ik") {
    push_ik(call);
    return 1;
  }
  if (name == "links") {
    push_names(call, link_names(robot));
    return 1;
  }
  if (name == "states") {
    const Value table = call.push_table();
    for (const SphereModel::State& state : robot.states()) {
      push_numbers(call, state.q);
      call.set_field(table, state.name);
    }
    return 1;
  }
  if (name == "pose") {
    call.push_function(pose_of_link);
    return 1;
  }
  if (name == "attach") {
    call.push_function(attach);
    return 1;
  }
  throw no_member(call[2], members(), "a robot of a URDF file");
}

int print(Stack& call) {
  const auto* robot = call[1].get<SphereModel>();
  if (robot == nullptr) return call.result(call[1].describe());
  return call.result(
      fmt::format("robot '{}' with {} coordinates", robot->robot().tree().name(), robot->robot().dimension()));
}

}  // namespace

void check_fields(const Construct& construct, Value table) {
  if (table.type() != Type::table) {
    throw Error(fmt::format("{}: {} a table belongs, as in {}; got {}", construct.name,
                            construct.arguments.empty() ? "here" : "after the " + construct.arguments.front().name,
                            construct.usage, describe(table)));
  }
  std::vector<std::string> known;
  for (const Field& field : construct.fields) known.push_back(field.name);
  for (const Option& option : construct.options.options) known.push_back(option.name);
  const lua::Keys keys = table.keys();
  if (keys.length > 0 || !keys.odd.empty()) {
    throw Error(fmt::format("{}: its options have names, as in {}", construct.name, construct.usage));
  }
  lua::Faults faults;
  for (const std::string& name : keys.names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    faults.add(fmt::format("{}: unknown option '{}'{}; its options are: {}", construct.name, name,
                           did_you_mean(name, known), fmt::join(known, ", ")));
  }
  for (const Field& field : construct.fields) {
    if (field.required && !table.field(field.name).given()) {
      faults.add(fmt::format("{}: field '{}' is missing: {}", construct.name, field.name, field.expects));
    }
  }
  faults.raise();
}

std::vector<Field> target_fields() {
  return {{"link", "string", "the name of a link", "whose frame is to be at the pose", true},
          {"pose", "trellis.Pose", "a pose, as pose {0.5, 0, 0.4}", "where, in the world", true},
          {"within", "number[]", "a list of 2 numbers greater than 0: metres, radians",
           "how near to the pose's position and orientation; of pi or more radians any orientation will do", false,
           "{0.001, 0.01}"}};
}

std::vector<const Construct*> manipulator_constructs() { return {&urdf_construct(), &reach_construct()}; }

std::vector<ObjectType> manipulator_types() {
  return {{"trellis.Manipulator", "a robot of links and joints from a URDF file", "", members(), {}},
          {"trellis.Joint",
           "a coordinate of a robot of a URDF file",
           "",
           {{"name", "string", "", "as in `joints`"},
            {"kind", "string", "", "of its joint: revolute, continuous, prismatic, planar or floating"},
            {"lower", "number?", "", "lower limit, in radians or metres; nil where it has none"},
            {"upper", "number?", "", "upper limit"},
            {"velocity", "number?", "",
             "its greatest speed, in radians or metres a second; nil where the file states none"}},
           {}},
          {"trellis.Reach", "a pose of a link, for start and goal", "", {}, {}}};
}

void open_manipulator(Stack& stack, const ScriptPlace& place,
                      const std::shared_ptr<std::vector<std::string>>& warnings) {
  stack.declare<SphereModel>({{"__tostring", print}, {"__index", [checks = make_robot_checks()](Stack& call) {
                                                        return read_member(call, checks);
                                                      }}});
  stack.declare<LinkGoal>({{"__tostring", print_reach}});
  stack.push_function(make_reach);
  stack.set_global(reach_construct().name);
  const Value robots = stack.push_global("robot");
  stack.push_function([place, warnings](Stack& call) { return make_urdf(call, place, *warnings); });
  stack.set_field(robots, "urdf");
}

}  // namespace trellis::dsl
