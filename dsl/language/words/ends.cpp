// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/ends.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/manipulator.hpp>
#include <dsl/lua/mistakes.hpp>
#include <trellis/instance/end_fault.hpp>
#include <trellis/instance/link_shapes.hpp>
#include <trellis/motion/team_model.hpp>
#include <trellis/reader/cover_cache.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

namespace trellis::dsl {

namespace {

using lua::Type;
using lua::Value;
using Columns = std::vector<std::size_t>;

constexpr double free_coordinate = std::numeric_limits<double>::quiet_NaN();

/// A configuration, or what inverse kinematics is to find.
struct End {
  Configuration q;                       ///< coordinates that reach { } decides are NaN
  std::vector<LinkTarget> targets = {};  ///< of reach { }
  std::string hint = {};                 ///< about its poses
};

/// A robot, or one of a team, whose coordinates a value gives.
struct Part {
  Columns columns;
  std::vector<std::string> names;  ///< of its coordinates, as the robot itself calls them
  std::string prefix;              ///< of its joints and links in the team's names: "2/"; "" for the whole robot
  std::size_t number = 0;          ///< in the team; 0 for the whole robot
};

bool is_team(const Problem& problem) {
  const ManipulatorScene* scene = problem.scene->manipulator();
  return scene == nullptr ? problem.scene->members().size() > 1
                          : scene->robot.robot().tree().find_joint("1/base of the team").has_value();
}

Part whole(const Problem& problem) {
  Part part;
  for (const Axis& axis : problem.space.coordinates()) {
    part.columns.push_back(part.names.size());
    part.names.push_back(axis.name);
  }
  return part;
}

Part member(const Problem& problem, const Columns& columns, std::size_t number) {
  Part part{columns, {}, {}, number};
  if (problem.scene->manipulator() != nullptr && is_team(problem)) part.prefix = fmt::format("{}/", number);
  const std::vector<Axis> axes = problem.space.coordinates();
  for (const std::size_t column : columns) {
    const std::string& name = axes[column].name;
    part.names.push_back(name.starts_with(part.prefix) ? name.substr(part.prefix.size()) : name);
  }
  return part;
}

/// Whether the name of a link or joint is that of a team: "2/panda_hand".
bool is_numbered(const std::string& name) {
  const std::size_t slash = name.find('/');
  return slash != std::string::npos && slash > 0 &&
         std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(slash),
                     [](char c) { return c >= '0' && c <= '9'; });
}

/// The number of values of a table, with names or without.
std::size_t entries(Value table) {
  const lua::Keys keys = table.keys();
  return keys.length + keys.names.size();
}

/// Whether a list has an element for each robot of a team, and not for the team: a configuration that is shorter than
/// the team's, the pose of a body, or a link that has the robot's own name.
/// \param one  whether the value is one configuration; else it may be a list of them
bool is_of_members(Value value, const Problem& problem, bool one) {
  const std::vector<Columns> members = columns_of(problem);
  if (members.size() < 2 || value.type() != Type::table || !value.keys().names.empty()) return false;
  const bool team = is_team(problem);
  bool fits = true;
  bool shown = false;  // by an element that cannot be a configuration of the whole team
  std::size_t elements = 0;
  value.each([&](std::size_t, Value element) {
    ++elements;
    if (element.get<Pose3>() != nullptr) {
      shown = true;
    } else if (const auto* goal = element.get<LinkGoal>()) {
      shown = shown || one || (team && !is_numbered(goal->link));
    } else if (element.type() == Type::table) {
      bool flat = true;
      element.each([&](std::size_t, Value number) { flat = flat && number.type() != Type::table; });
      const bool shorter = flat && entries(element) < problem.space.dimension();
      fits = fits && shorter;
      shown = shown || shorter;
    } else {
      fits = fits && element.string() && problem.scene->manipulator() != nullptr;
    }
  });
  return elements > 0 && fits && shown;
}

/// Returns a pose as a configuration.
/// \param what  names it in messages: "problem: field 'start'"
Configuration configuration_of(const Pose3& pose, const std::string& what, const Scene& scene, const Space& space) {
  const auto& [x, y, z] = pose.position;
  if (scene.planar() != nullptr) {
    throw Error(
        fmt::format("{} is a pose, which places a body in space, and this world is the plane: give a list of {} "
                    "numbers ({}){}",
                    what, space.dimension(), axis_names(space),
                    scene.translates() && space.dimension() == 3
                        ? fmt::format(", as {{{:g}, {:g}, 0}} with the angle in radians", x, y)
                        : ""));
  }
  const Quaternion& turn = pose.orientation;
  if (space.dimension() == 7 && !space.flat()) return {x, y, z, turn.x, turn.y, turn.z, turn.w};
  if (space.dimension() == 3 && turn == Quaternion{}) return {x, y, z};
  throw Error(
      fmt::format("{} is a pose, which a configuration of this robot is not: it has {} coordinates ({}){}", what,
                  space.dimension(), axis_names(space),
                  scene.manipulator() != nullptr ? "; reach { link = ..., pose = ... } brings a link to a pose" : ""));
}

/// Brings quaternions that were written with few decimals to norm 1.
void normalise_quaternions(MutableView q, const std::string& what, const Space& space) {
  for (const Factor& factor : space.factors()) {
    if (factor.kind != Factor::Kind::rotation) continue;
    const MutableView part = q.subspan(factor.column, factor.width());
    double length = 0.0;
    for (const double x : part) length += x * x;
    if (std::isnan(length)) continue;  // reach { } decides it
    length = std::sqrt(length);
    constexpr double rounding = 1e-3;
    if (!(std::abs(length - 1.0) <= rounding)) {
      const bool alone = factor.column == 3 && space.factors().size() == 4;
      throw Error(
          fmt::format("{}: its {} are the quaternion x, y, z, w of {}, of norm 1; this one has norm {:g}. A "
                      "pose is easier "
                      "to write: pose {{ {:g}, axis = {{0, 0, 1}}, angle = 1.57 }}",
                      what,
                      alone ? "last 4 coordinates"
                            : fmt::format("coordinates {} to {}", factor.column + 1, factor.column + factor.width()),
                      alone ? "the body's orientation" : "an orientation", length,
                      fmt::join(factor.column >= 3 ? q.subspan(factor.column - 3, 3) : q.first(factor.column), ", ")));
    }
  }
  space.normalise(q);
}

/// Moves coordinates that miss a bound by rounding to the bound.
void clamp_to_bounds(MutableView q, const Space& space) {
  constexpr double rounding = 1e-6;
  for (const Factor& factor : space.factors()) {
    if (factor.kind != Factor::Kind::line) continue;
    double& x = q[factor.column];
    const double nearest = std::clamp(x, factor.axis.lo, factor.axis.hi);
    if (std::abs(x - nearest) <= rounding) x = nearest;
  }
}

/// The coordinates that a named state gives to a part.
Configuration state_named(const std::string& name, const std::string& what, const SphereModel& robot,
                          const Part& part) {
  std::vector<std::string> known;
  for (const SphereModel::State& state : robot.states()) {
    if (state.name == name) {
      Configuration q;
      for (const std::size_t column : part.columns) q.push_back(state.q[column]);
      return q;
    }
    known.push_back(state.name);
  }
  throw Error(fmt::format("{}: robot '{}' has no configuration '{}'{}; {}", what, robot.robot().tree().name(), name,
                          did_you_mean(name, known),
                          known.empty() ? "its SRDF file names none for the joints that move"
                                        : fmt::format("there are: {}", fmt::join(known, ", "))));
}

/// Why a configuration has no coordinate of that name: of a joint of the robot that does not move by itself.
std::string unknown_coordinate(const std::string& name, const Part& part, const Problem& problem) {
  const std::string nearest =
      fmt::format("{}; there are: {}", did_you_mean(name, part.names), fmt::join(part.names, ", "));
  const ManipulatorScene* scene = problem.scene->manipulator();
  if (scene == nullptr) return fmt::format("the robot has no coordinate '{}'{}", name, nearest);
  const KinematicTree& tree = scene->robot.robot().tree();
  const auto number = tree.find_joint(part.prefix + name);
  if (!number) return fmt::format("robot '{}' has no joint '{}'{}", tree.name(), name, nearest);
  const Joint& joint = tree.joints()[*number];
  if (joint.mimic) {
    return fmt::format("joint '{}' follows joint '{}': leave it out", name, tree.joints()[joint.mimic->joint].name);
  }
  if (joint.kind == Joint::Kind::fixed) return fmt::format("joint '{}' is fixed: leave it out", name);
  if (joint.kind == Joint::Kind::planar) {
    return fmt::format("joint '{}' is planar: its coordinates are ['{}.x'], ['{}.y'] and ['{}.theta']", name, name,
                       name, name);
  }
  if (joint.width() > 1) {
    return fmt::format("joint '{}' has {} coordinates, from ['{}.x'] on{}", name, joint.width(), name, nearest);
  }
  return fmt::format(
      "joint '{}' does not move, as it is not in the robot's group: robot.urdf takes where it stays, as "
      "values = {{ {} = 0 }}",
      name, name);
}

/// Reads { lift = 0.1, elbow = 1 }.
Configuration read_named(Value value, const std::string& what, const Problem& problem, const Part& part) {
  const lua::Keys keys = value.keys();
  if (keys.length > 0 || !keys.odd.empty()) {
    throw Error(
        fmt::format("{} must be a list of {} numbers ({}), or name each of these, as {{ {} = 0, ... }}; this is "
                    "a mixture: {}",
                    what, part.names.size(), fmt::join(part.names, ", "), part.names.front(),
                    keys.length > 0 ? fmt::format("{} value{} without a name, and '{}'", keys.length,
                                                  keys.length > 1 ? "s" : "", keys.names.front())
                                    : keys.odd));
  }
  lua::Faults faults;
  Configuration q(part.names.size(), free_coordinate);
  for (const std::string& name : keys.names) {
    faults.attempt([&] {
      const auto found = std::find(part.names.begin(), part.names.end(), name);
      if (found == part.names.end()) throw Error(fmt::format("{}: {}", what, unknown_coordinate(name, part, problem)));
      const auto number = value.field(name).number();
      if (!number || !std::isfinite(*number)) {
        throw Error(fmt::format("{}: '{}' must be a finite number, got {}", what, name, describe(value.field(name))));
      }
      q[static_cast<std::size_t>(found - part.names.begin())] = *number;
    });
  }
  std::vector<std::string> missing;
  for (std::size_t j = 0; j < q.size(); ++j) {
    if (!value.field(part.names[j]).given()) missing.push_back(fmt::format("'{}'", part.names[j]));
  }
  if (!missing.empty()) {
    faults.add(fmt::format("{}: {} {} missing; a configuration by names has all of: {}", what, fmt::join(missing, ", "),
                           missing.size() > 1 ? "are" : "is", fmt::join(part.names, ", ")));
  }
  faults.raise();
  return q;
}

/// The target of reach { }.
LinkTarget target_of(const LinkGoal& goal, const std::string& what, const Problem& problem, const Part& part) {
  const ManipulatorScene* scene = problem.scene->manipulator();
  if (scene == nullptr) {
    throw Error(fmt::format("{} is reach {{ ... }}, which is for a robot of a URDF file, and this is '{}'", what,
                            problem.scene->robot_name()));
  }
  const SphereModel& robot = scene->robot;
  const bool team = is_team(problem);
  if (team && part.number == 0 && !is_numbered(goal.link)) {
    throw Error(
        fmt::format("{} is reach {{ link = '{}' }} of a team: name the robot, as link = '1/{}', or give a list "
                    "with a goal for each robot",
                    what, goal.link, goal.link));
  }
  const bool own = part.prefix.empty() || goal.link.starts_with(part.prefix);
  if (!own && is_numbered(goal.link)) {
    throw Error(
        fmt::format("{} is reach {{ link = '{}' }}, a link of another robot: in a list with a goal for each "
                    "robot each reaches with its own links",
                    what, goal.link));
  }
  const std::size_t link = link_named(robot, (own ? "" : part.prefix) + goal.link, what);
  if (part.number != 0) {
    // The joints between the base and the link must be the part's own.
    for (std::size_t body = robot.robot().body_of(link); body != 0; body = robot.robot().bodies()[body].parent) {
      const Manipulator::Body& moved = robot.robot().bodies()[body];
      if (moved.multiplier == 0.0) continue;
      if (std::find(part.columns.begin(), part.columns.end(), moved.column) != part.columns.end()) continue;
      throw Error(fmt::format("{} is reach {{ link = '{}' }}: joints of another robot, or arm, move this link", what,
                              goal.link));
    }
  }
  return {link, goal.pose, goal.near, goal.turn};
}

/// Reads one configuration of a part, or what inverse kinematics is to find, into the part's coordinates of an end.
void read_part(Value value, const std::string& what, const Problem& problem, const Part& part, End& end) {
  const ManipulatorScene* manipulator = problem.scene->manipulator();
  Configuration own;
  if (const auto* goal = value.get<LinkGoal>()) {
    end.targets.push_back(target_of(*goal, what, problem, part));
    if (end.hint.empty()) end.hint = goal->hint;
    return;
  }
  if (const auto name = value.string(); name && manipulator != nullptr) {
    own = state_named(*name, what, manipulator->robot, part);
  } else if (const auto* pose = value.get<Pose3>()) {
    own = configuration_of(
        *pose, what, *problem.scene,
        part.number == 0 ? problem.space : problem.space.part(part.columns, fmt::format("robot {}", part.number)));
  } else if (value.type() == Type::table && !value.keys().names.empty()) {
    own = read_named(value, what, problem, part);
  } else {
    own = read_numbers(value, what);
  }
  if (own.size() != part.columns.size()) {
    if (part.number != 0) {
      throw Error(fmt::format("{}: robot {} has {} coordinates, got {}", what.substr(0, what.find(": robot ")),
                              part.number, part.columns.size(), own.size()));
    }
    throw Error(fmt::format("{} must have {} coordinates ({}), got {}", what, part.columns.size(),
                            fmt::join(part.names, ", "), own.size()));
  }
  for (std::size_t j = 0; j < own.size(); ++j) end.q[part.columns[j]] = own[j];
}

/// Reads one configuration, or what inverse kinematics is to find.
End read_end(Value value, const std::string& what, const Problem& problem) {
  End end{Configuration(problem.space.dimension(), free_coordinate)};
  if (is_of_members(value, problem, true)) {
    const std::vector<Columns> members = columns_of(problem);
    std::size_t count = 0;
    value.each([&](std::size_t i, Value element) {
      if (++count > members.size()) return;
      read_part(element, fmt::format("{}: robot {}", what, i), problem, member(problem, members[i - 1], i), end);
    });
    if (count != members.size()) {
      throw Error(
          fmt::format("{} must have a configuration for each of {} robots, got {}", what, members.size(), count));
    }
  } else {
    read_part(value, what, problem, whole(problem), end);
  }
  if (!problem.space.flat()) normalise_quaternions(end.q, what, problem.space);
  clamp_to_bounds(end.q, problem.space);
  return end;
}

ReachAnswer reach_end(const End& end, const Problem& problem, const std::string& stream, const Configuration& first) {
  ReachQuery query;
  query.targets = end.targets;
  query.given = end.q;
  query.first = first;
  query.name = stream;
  ReachAnswer answer = reach_configurations(problem, query);
  if (!answer.failure.empty()) answer.failure += end.hint;
  return answer;
}

/// The middle of the bounds; 0 of coordinates that wrap, and no turn.
Configuration middle_of(const Space& space) {
  Configuration q;
  for (const Axis& axis : space.coordinates()) q.push_back(axis.periodic ? 0.0 : 0.5 * (axis.lo + axis.hi));
  for (const Factor& factor : space.factors()) {
    if (factor.kind == Factor::Kind::rotation) q[factor.column + 3] = 1.0;
  }
  return q;
}

}  // namespace

std::vector<Columns> columns_of(const Problem& problem) {
  std::vector<Columns> columns;
  if (const TeamModel* team = problem.motion_model ? team_model(*problem.motion_model) : nullptr) {
    for (const TeamModel::Part& part : team->parts()) columns.push_back(part.columns);
    return columns;
  }
  for (const TeamMember& one : problem.scene->members()) columns.push_back(one.axes);
  return columns;
}

Configuration read_place(Value value, const std::string& what, const Problem& problem) {
  const End end = read_end(value, what, problem);
  if (end.targets.empty()) return end.q;
  throw Error(fmt::format("{} must be a configuration, got reach {{ ... }}: robot:ik finds configurations", what));
}

Configuration read_start(Value value, const Problem& problem) {
  const End end = read_end(value, "problem: field 'start'", problem);
  if (end.targets.empty()) return end.q;
  ReachAnswer answer = reach_end(end, problem, "start", middle_of(problem.space));
  if (answer.configurations.empty()) {
    throw InvalidEnd(fmt::format("problem '{}': start: {}", problem.name, answer.failure));
  }
  return std::move(answer.configurations.front());
}

std::vector<Configuration> read_goals(Value value, const Problem& problem, std::vector<std::string>& warnings) {
  bool several = false;
  if (value.type() == Type::table && value.keys().names.empty() && !is_of_members(value, problem, false)) {
    value.each([&](std::size_t i, Value element) {
      const bool is_whole = element.type() == Type::table || element.get<Pose3>() != nullptr || element.string() ||
                            element.get<LinkGoal>() != nullptr;
      several = several || (i == 1 && is_whole);
    });
  }
  std::vector<End> ends;
  if (several) {
    lua::Faults faults;
    value.each([&](std::size_t i, Value element) {
      faults.attempt(
          [&] { ends.push_back(read_end(element, fmt::format("problem: goal {} of field 'goal'", i), problem)); });
    });
    faults.raise();
  } else {
    ends.push_back(read_end(value, "problem: field 'goal'", problem));
  }
  std::vector<Configuration> goals;
  std::vector<std::string> failures;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i].targets.empty()) {
      goals.push_back(ends[i].q);
      continue;
    }
    ReachAnswer answer =
        reach_end(ends[i], problem, i == 0 ? std::string("goal") : fmt::format("goal {}", i + 1), problem.start);
    goals.insert(goals.end(), answer.configurations.begin(), answer.configurations.end());
    if (answer.configurations.empty()) {
      failures.push_back(several ? fmt::format("goal {}: {}", i + 1, answer.failure) : answer.failure);
    }
  }
  if (goals.empty()) {
    throw InvalidEnd(fmt::format("problem '{}': {}", problem.name, fmt::join(failures, "; ")));
  }
  for (const std::string& failure : failures) {
    warnings.push_back(fmt::format("problem '{}': {}; it is left out", problem.name, failure));
  }
  return goals;
}

void fit_covers_to_ends(Problem& problem, std::vector<std::string>& warnings) {
  const CoverCache cache(user_cover_folder());
  const CoverMaker cover = [&](std::span<const Solid> solids, const CoverOptions& options) {
    return cache.cover(solids, options);
  };
  for (std::string& text : fit_covers(problem, cover)) warnings.push_back(std::move(text));
}

std::string radians_sentence(double degrees) {
  return fmt::format("angles are radians: write math.rad({:g})", degrees);
}

std::string degrees_hint(const Problem& problem, const std::vector<Configuration>& ends) {
  const ManipulatorScene* scene = problem.scene->manipulator();
  const std::vector<Axis> axes = problem.space.coordinates();
  for (const Configuration& q : ends) {
    for (std::size_t j = 0; j < std::min({q.size(), axes.size(), problem.scene->robot_dimension()}); ++j) {
      bool angle = scene == nullptr && !problem.scene->translates();
      if (scene != nullptr) {
        const KinematicTree& tree = scene->robot.robot().tree();
        const auto joint = tree.find_joint(axes[j].name);
        angle = joint && tree.joints()[*joint].kind == Joint::Kind::revolute;
      }
      if (!angle || axes[j].periodic || !(std::abs(q[j]) > 2.0 * std::numbers::pi)) continue;
      if (q[j] < axes[j].lo || q[j] > axes[j].hi) return "; " + radians_sentence(q[j]);
    }
  }
  return "";
}

std::size_t link_named(const SphereModel& robot, const std::string& name, const std::string& what) {
  const KinematicTree& tree = robot.robot().tree();
  if (const auto link = tree.find_link(name)) return *link;
  std::vector<std::string> known;
  for (const Link& one : tree.links()) known.push_back(one.name);
  throw Error(fmt::format("{}: robot '{}' has no link '{}'{}; there are: {}", what, tree.name(), name,
                          did_you_mean(name, known), fmt::join(known, ", ")));
}

}  // namespace trellis::dsl
