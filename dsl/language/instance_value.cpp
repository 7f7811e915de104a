// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/instance_value.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <dsl/language/configuration.hpp>
#include <dsl/language/scene_values.hpp>
#include <dsl/language/world.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

const std::vector<Field>& instance_members() {
  static const std::string configuration = "number[]";
  static const std::string query = "fun(self: trellis.Instance, ...: number|number[]): ";
  static const std::vector<Field> members = {
      {"space", "trellis.Space", "", "its configuration space"},
      {"start", configuration, "", "the start"},
      {"goal", configuration, "", "the goal, of several the first"},
      {"goals", configuration + "[]", "", "all goals: a path to any of them solves the instance"},
      {"robot", "trellis.Robot", "", "what moves"},
      {"world", "trellis.World", "", "the workspace"},
      {"goal_tolerance", "number", "", "a configuration this near to the goal in the metric is the goal"},
      {"resolution", "number", "", "how far the robot's fastest point moves between two checked configurations"},
      {"valid", query + "boolean", "",
       "whether a configuration is valid, given as a list or by its coordinates; a check that the level pays for"},
      {"clearance", query + "number", "",
       "metres from the robot at a configuration to the nearest obstacle, to the boundary from inside, and between "
       "bodies that must not meet; 0 where it is invalid, infinite where the space presumes it free; a check that the "
       "level pays for"},
      {"nearest_obstacle", query + "trellis.NearestObstacle", "",
       "the obstacle of the world that is nearest to the robot at a configuration, nil in a world without obstacles; "
       "an error where no collision check decides validity; a check that the level pays for"}};
  return members;
}

/// Reads the configuration that a method receives: after the instance itself, which instance.valid(q) leaves out.
Configuration read_query(Stack& call, const std::string& method, const Space& space) {
  const int first = call[1].get<InstanceValue>() != nullptr ? 2 : 1;
  Configuration q(space.dimension());
  try {
    read_coordinates(call, first, call.count() - first + 1, space, q,
                     fmt::format("instance:{}: its configuration", method));
  } catch (const lua::Located& error) {
    throw Error(error.what());  // so that it has the script's line
  }
  return q;
}

/// Pushes a method that answers with `query`.
/// \param query  called with the call, the instance and the configuration; returns the number of results
template <class Query>
void push_method(Stack& stack, const std::string& name, const std::shared_ptr<InstanceAccess>& access,
                 const Query& query) {
  stack.push_function([access, name, query](Stack& call) {
    if (access->instance == nullptr) {
      throw Error(fmt::format("instance:{}: the call that this instance was given to is over", name));
    }
    const Configuration q = read_query(call, name, access->instance->space);
    try {
      return query(call, *access->instance, q);
    } catch (const Error& error) {
      throw Error(fmt::format("instance:{}: {}", name, error.what()));
    }
  });
}

int push_nearest(Stack& call, Instance& instance, View q) {
  if (!instance.space.contains(q)) {
    throw Error(fmt::format("{} lies outside of the space {}", coordinates_of(q), instance.space.name()));
  }
  const std::optional<Proximity> nearest = instance.nearest_obstacle(q);
  if (!nearest) {
    call.push_nil();
    return 1;
  }
  const Value table = call.push_table();
  push_obstacle(call, *instance.scene, nearest->obstacle);
  call.set_field(table, "shape");
  call.push(obstacle_name(*instance.scene, nearest->obstacle));
  call.set_field(table, "name");
  call.push(static_cast<std::int64_t>(nearest->obstacle + 1));
  call.set_field(table, "number");
  call.push(nearest->distance);
  call.set_field(table, "distance");
  if (nearest->point) {
    Configuration point{nearest->point->x, nearest->point->y, nearest->point->z};
    point.resize(instance.scene->world_dimension());
    push_numbers(call, point);
    call.set_field(table, "point");
  }
  return 1;
}

/// Reads a member of an instance.
int read_instance(Stack& call) {
  const auto* value = call[1].get<InstanceValue>();
  value->members->push(call);
  if (call.get(call.top(), call[2]).given()) return 1;
  throw no_member(call[2], instance_members(), "an instance");
}

}  // namespace

void push_instance(Stack& stack, const Instance& instance, const std::shared_ptr<InstanceAccess>& access) {
  const int before = stack.size();
  const Value table = stack.push_table();
  const auto set = [&](const char* name) { stack.set_field(table, name); };
  push_space(stack, instance.space);
  set("space");
  push_numbers(stack, instance.start);
  set("start");
  push_numbers(stack, instance.goal());
  set("goal");
  const Value goals = stack.push_table();
  for (const Configuration& goal : instance.goals) {
    push_numbers(stack, goal);
    stack.append(goals);
  }
  set("goals");
  push_robot(stack, *instance.scene);
  set("robot");
  push_world(stack, *instance.scene);
  set("world");
  stack.push(instance.goal_tolerance);
  set("goal_tolerance");
  stack.push(instance.resolution);
  set("resolution");
  push_method(stack, "valid", access,
              [](Stack& call, Instance& c, View q) { return call.result(c.space.contains(q) && c.valid(q)); });
  set("valid");
  push_method(stack, "clearance", access,
              [](Stack& call, Instance& c, View q) { return call.result(c.space.contains(q) ? c.clearance(q) : 0.0); });
  set("clearance");
  push_method(stack, "nearest_obstacle", access, push_nearest);
  set("nearest_obstacle");
  InstanceValue value{std::make_shared<const lua::Reference>(stack, table)};
  stack.resize(before);
  stack.push_object(std::move(value));
}

void open_instance(Stack& stack) {
  stack.declare<InstanceValue>(
      {{"__index", read_instance}, {"__tostring", [](Stack& call) { return call.result(call[1].describe()); }}});
}

std::vector<ObjectType> instance_types() {
  return {{"trellis.Instance",
           "a planning instance, as the functions of a guiding space see it",
           "",
           instance_members(),
           {}},
          {"trellis.NearestObstacle",
           "the obstacle nearest to the robot",
           "",
           {{"shape", "trellis.Shape", "", "the obstacle"},
            {"name", "string", "", "its name, as shape.name"},
            {"number", "integer", "", "its place in instance.world.obstacles"},
            {"distance", "number", "", "metres from the robot; 0: the robot touches it"},
            {"point", "number[]?", "",
             "its point that is nearest to the robot; nil where the robot touches it, and where the collision backend "
             "has no such point"}},
           {}}};
}

}  // namespace trellis::dsl
