// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/robot_queries.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include <dsl/language/core/types.hpp>
#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/ends.hpp>
#include <dsl/language/words/manipulator.hpp>
#include <dsl/language/words/scene_values.hpp>
#include <dsl/language/words/spatial_world.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/instance/end_fault.hpp>
#include <trellis/instance/resolve_goal.hpp>

namespace trellis::dsl {

using lua::Stack;
using lua::Type;
using lua::Value;

class RobotChecks {
 public:
  struct Entry {
    std::unique_ptr<lua::Reference> robot;  ///< keep the values alive, so that no other one has their addresses
    std::unique_ptr<lua::Reference> world;
    const void* robot_identity = nullptr;
    const void* world_identity = nullptr;
    std::unique_ptr<EndChecker> checker;
  };

  Entry& of(const Stack& stack, Value robot, Value world) {
    const void* robot_identity = robot.identity();
    const void* world_identity = world.given() ? world.identity() : nullptr;
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->robot_identity != robot_identity || entry->world_identity != world_identity) continue;
      std::rotate(entries_.begin(), entry, entry + 1);
      return entries_.front();
    }
    Entry made;
    made.checker = std::make_unique<EndChecker>(problem_of(robot, world, "valid"));
    made.robot = std::make_unique<lua::Reference>(stack, robot);
    if (world_identity != nullptr) made.world = std::make_unique<lua::Reference>(stack, world);
    made.robot_identity = robot_identity;
    made.world_identity = world_identity;
    constexpr std::size_t most = 4;
    if (entries_.size() == most) entries_.pop_back();
    entries_.insert(entries_.begin(), std::move(made));
    return entries_.front();
  }

 private:
  std::vector<Entry> entries_;  ///< the last one that was asked first
};

std::shared_ptr<RobotChecks> make_robot_checks() { return std::make_shared<RobotChecks>(); }

Problem problem_of(Value robot, Value world, const std::string& what) {
  auto moves = robot_in(robot);
  if (!moves) throw Error(fmt::format("{} is called with a colon: robot:{}(q, world)", what, what));
  std::optional<AnyWorld> around = world_in(world);
  if (world.given() && !around)
    throw Error(fmt::format("{}: the world must be a world, got {}", what, describe(world)));
  if (!around) {
    const auto* arm = std::get_if<SphereModel>(&*moves);
    const auto* planar = std::get_if<Robot>(&*moves);
    if (arm != nullptr && arm->robot().has_fixed_base()) {
      const double reach = std::max(1.0, norm(arm->base().position) + arm->bounding_radius());
      around = World3({{-reach, -reach, -reach}, {reach, reach, reach}}, {}, Contain::none);
    } else if (planar != nullptr && !planar->translates()) {
      const double reach = 2.0 * std::max(1.0, planar->bounding_radius());
      const Vec2 base = planar->base();
      around = World({{base.x - reach, base.y - reach}, {base.x + reach, base.y + reach}}, {});
    } else {
      throw Error(fmt::format("{}: the world is missing: its bounds limit where this robot is", what));
    }
  }
  Problem problem;
  problem.name = what;
  problem.scene = make_scene(std::move(*around), std::move(*moves));
  problem.space = problem.scene->spatial() != nullptr       ? problem.scene->spatial()->own_space()
                  : problem.scene->manipulator() != nullptr ? problem.scene->manipulator()->own_space()
                                                            : problem.scene->default_space(1.0);
  problem.collision = collision_backends(*problem.scene).front();
  return problem;
}

void push_valid(Stack& stack, const std::shared_ptr<RobotChecks>& checks) {
  stack.push_function([checks](Stack& call) {
    if (!robot_in(call[1])) throw Error("valid is called with a colon: robot:valid(q, world)");
    if (call.count() < 2 || call.count() > 3) {
      throw Error(fmt::format("valid takes a configuration, and a world: robot:valid(q, world); got {} values",
                              call.count() - 1));
    }
    EndChecker& checker = *checks->of(call, call[1], call[3]).checker;
    const Configuration q = read_place(call[2], "valid: the configuration", checker.problem());
    const EndFault fault = checker.fault(q);
    const bool valid = fault.text.empty() || fault.fits;
    call.push(valid);
    if (valid) return 1;
    call.push(fault.text + degrees_hint(checker.problem(), {q}));
    return 2;
  });
}

Field valid_member_of(const std::string& type) {
  return {"valid",
          fmt::format(
              "fun(self: {}, q: number[]|table<string, number>|string, world?: trellis.World): boolean, string?", type),
          "",
          "whether a configuration is within the joints' limits and touches neither the world nor itself, and else why "
          "not: robot:valid({0, 0.3, 1}, world). The shapes of a manipulator's links decide, not the balls that cover "
          "them, as for start and goal of a problem. Robots that are fixed to their base need no world"};
}

namespace {

std::vector<Field> ik_fields() {
  std::vector<Field> fields = target_fields();
  const std::vector<Field> more = {
      {"world", "trellis.World", "a world of space", "whose obstacles the robot must not touch; none: no obstacles"},
      {"seed", "integer|number[]|table<string, number>|string", "a configuration, or a whole number of at least 0",
       "a configuration: the first attempt starts there, and the solutions nearest to it come first; a "
       "number: that of the random starts",
       false, "0"},
      {"count", "integer", "a whole number from 1 to 1000", "at most so many configurations", false, "10"}};
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

}  // namespace

const Construct& ik_construct() {
  static const Construct construct = {
      .name = "ik",
      .usage = R"(arm:ik { link = "panda_hand", pose = pose {0.5, 0, 0.4, rpy = {math.pi, 0, 0}}, world = w })",
      .summary =
          "valid configurations that bring a link to a pose of the world, by inverse kinematics; and, where there are "
          "none, why",
      .list = "",
      .element = "",
      .fields = ik_fields(),
      .options = {},
      .returns = "number[][]"};
  return construct;
}

namespace {

int solve(Stack& call) {
  const Construct& construct = ik_construct();
  const auto* robot = call[1].get<SphereModel>();
  if (robot == nullptr) throw Error(fmt::format("ik is called with a colon: {}", construct.usage));
  const Value table = call[2];
  if (call.count() != 2 || table.type() != Type::table) {
    throw Error(fmt::format("ik takes a table, as in {}", construct.usage));
  }
  check_fields(construct, table);
  const auto reject = [&](const char* name) -> Error {
    const auto field = std::find_if(construct.fields.begin(), construct.fields.end(),
                                    [&](const Field& one) { return one.name == name; });
    return Error(fmt::format("ik: field '{}' must be {}, got {}", name, field->expects, describe(table.field(name))));
  };
  const Problem problem = problem_of(call[1], table.field("world"), "ik");
  ReachQuery query;
  LinkTarget target;
  const auto link = table.field("link").string();
  if (!link) throw reject("link");
  target.link = link_named(*robot, *link, "ik: field 'link'");
  const auto* pose = table.field("pose").get<Pose3>();
  if (pose == nullptr) throw reject("pose");
  target.pose = *pose;
  if (const Value within = table.field("within"); within.given()) {
    const auto numbers = read_numbers(within, "ik: field 'within'");
    if (numbers.size() != 2 || !(numbers[0] > 0.0) || !(numbers[1] > 0.0)) throw reject("within");
    target.near = numbers[0];
    target.turn = numbers[1];
  }
  query.targets = {target};
  if (const Value seed = table.field("seed"); seed.given()) {
    if (seed.type() == Type::number) {
      const auto number = seed.integer();
      if (!number || *number < 0) throw reject("seed");
      query.seed = static_cast<std::uint64_t>(*number);
    } else {
      query.first = read_place(seed, "ik: field 'seed'", problem);
    }
  }
  if (const Value count = table.field("count"); count.given()) {
    constexpr std::int64_t most = 1000;
    const auto number = count.integer();
    if (!number || *number < 1 || *number > most) throw reject("count");
    query.most = static_cast<std::size_t>(*number);
  }
  const ReachAnswer answer = reach_configurations(problem, query);
  const Value list = call.push_table();
  for (const Configuration& q : answer.configurations) {
    push_numbers(call, q);
    call.append(list);
  }
  if (answer.failure.empty()) return 1;
  call.push(answer.failure + pose_hint(call, *pose));
  return 2;
}

}  // namespace

void push_ik(Stack& stack) { stack.push_function(solve); }

std::vector<JointInfo> joint_infos(const SphereModel& robot) {
  const Manipulator& manipulator = robot.robot();
  std::vector<JointInfo> infos;
  const std::vector<Axis> axes = joint_axes(manipulator, {{-1, -1, -1}, {1, 1, 1}}, 1.0);
  for (const std::size_t j : manipulator.moving()) {
    const Joint& joint = manipulator.tree().joints()[j];
    for (std::size_t k = 0; k < joint.width(); ++k) {
      const Axis& axis = axes[infos.size()];
      JointInfo info{axis.name, to_string(joint.kind)};
      info.limited = joint.kind == Joint::Kind::revolute || joint.kind == Joint::Kind::prismatic;
      info.lower = joint.lo;
      info.upper = joint.hi;
      info.velocity = joint.velocity;
      infos.push_back(std::move(info));
    }
  }
  return infos;
}

void push_joints(Stack& stack, const SphereModel& robot) {
  const std::vector<JointInfo> infos = joint_infos(robot);
  const Value names = stack.push_table();
  for (const JointInfo& info : infos) {
    stack.push(info.name);
    stack.append(names);
  }
  stack.on_call(names, [infos](Stack& call) {
    const Value list = call.push_table();
    for (const JointInfo& info : infos) {
      const Value joint = call.push_table();
      call.push(info.name);
      call.set_field(joint, "name");
      call.push(info.kind);
      call.set_field(joint, "kind");
      if (info.limited) {
        call.push(info.lower);
        call.set_field(joint, "lower");
        call.push(info.upper);
        call.set_field(joint, "upper");
      }
      if (info.velocity > 0.0) {
        call.push(info.velocity);
        call.set_field(joint, "velocity");
      }
      call.append(list);
    }
    return 1;
  });
}

}  // namespace trellis::dsl
