// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/instance_value.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/scene_values.hpp>
#include <dsl/language/words/world.hpp>

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
      {"motion", "trellis.InstanceMotion?", "", "the motion model; nil where motions are straight"},
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
       "an error where no collision check decides validity; a check that the level pays for"},
      {"drive", "fun(self: trellis.Instance, q: number[], control: number[], duration: number): number[]", "",
       "the state in which a control of a duration in seconds ends from a state, by the motion model; no check "
       "of validity, so it may be invalid or outside of the space"}};
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

/// Pushes instance:drive(q, control, duration).
void push_drive(Stack& stack, const std::shared_ptr<InstanceAccess>& access) {
  stack.push_function([access](Stack& call) {
    try {
      if (access->instance == nullptr) throw Error("the call that this instance was given to is over");
      const Instance& instance = *access->instance;
      if (!instance.motion_model) throw Error("the instance has no motion model: its motions are straight");
      if (call.count() != 4 || call[1].get<InstanceValue>() == nullptr) {
        throw Error("expected instance:drive(q, control, duration)");
      }
      const MotionModel& model = *instance.motion_model;
      Configuration q = read_configuration(call[2], instance.space, "q");
      const Configuration control = read_control(call[3], model, "control");
      const std::uint32_t steps = read_duration(call[4], model, "duration");
      for (std::uint32_t k = 0; k < steps; ++k) model.step(instance.space, q, control, q);
      push_numbers(call, q);
      return 1;
    } catch (const Error& error) {
      throw Error(fmt::format("instance:drive: {}", error.what()));
    }
  });
}

/// Pushes what scripts see of a motion model; nil if there is none.
void push_motion(Stack& stack, const MotionModel* model) {
  if (model == nullptr) {
    stack.push_nil();
    return;
  }
  const Value table = stack.push_table();
  stack.push(model->name());
  stack.set_field(table, "name");
  stack.push(model->dt());
  stack.set_field(table, "dt");
  const Value controls = stack.push_table();
  for (const ControlAxis& axis : model->controls()) {
    const Value control = stack.push_table();
    stack.push(axis.name);
    stack.set_field(control, "name");
    stack.push(axis.lo);
    stack.set_field(control, "lower");
    stack.push(axis.hi);
    stack.set_field(control, "upper");
    stack.append(controls);
  }
  stack.set_field(table, "controls");
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

Configuration read_control(const Value& value, const MotionModel& model, const std::string& what) {
  Configuration control = read_numbers(value, what);
  const auto& axes = model.controls();
  std::vector<std::string> names;
  names.reserve(axes.size());
  for (const ControlAxis& axis : axes) names.push_back(axis.name);
  if (control.size() != axes.size()) {
    throw Error(fmt::format("{} must be {} numbers ({}), the controls of {}, got {}", what, axes.size(),
                            fmt::join(names, ", "), model.text(), control.size()));
  }
  for (std::size_t j = 0; j < axes.size(); ++j) {
    if (control[j] >= axes[j].lo && control[j] <= axes[j].hi) continue;
    throw Error(fmt::format("{}: {} is {:g}, expected a number from {:g} to {:g}", what, axes[j].name, control[j],
                            axes[j].lo, axes[j].hi));
  }
  return control;
}

std::uint32_t read_duration(const Value& value, const MotionModel& model, const std::string& what) {
  constexpr double most = 10000.0;  // steps
  const auto seconds = value.number();
  const double steps = seconds ? std::round(*seconds / model.dt()) : 0.0;
  if (!seconds || !(*seconds > 0.0) || !(steps <= most)) {
    throw Error(fmt::format("{} must be a number greater than 0 and at most {:g} (s; {:g} steps of the model), got {}",
                            what, most * model.dt(), most, describe(value)));
  }
  return static_cast<std::uint32_t>(std::max(steps, 1.0));
}

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
  push_motion(stack, instance.motion_model.get());
  set("motion");
  push_drive(stack, access);
  set("drive");
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
          {"trellis.InstanceMotion",
           "the motion model of an instance",
           "",
           {{"name", "string", "", "unicycle1, car, ..."},
            {"dt", "number", "", "seconds of one step; durations are whole numbers of steps"},
            {"controls", "{ name: string, lower: number, upper: number }[]", "", "each control and its bounds"}},
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
