// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/path_fault.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

std::string place_text(const Instance& instance, View q) {
  std::string text = fmt::format("({:.4g})", fmt::join(q, ", "));
  if (const auto contact = instance.validity->contact(q)) text += " touches " + describe(*contact, *instance.scene);
  return text;
}

}  // namespace

std::string path_fault(const Problem& problem, const Configurations& path) {
  if (path.empty()) return "is empty";
  if (path.dimension() != problem.space.dimension()) {
    return fmt::format("has {} coordinates, and {} has {}", path.dimension(), problem.space.name(),
                       problem.space.dimension());
  }
  const auto instance = make_instance(problem);
  const View start = problem.start;
  if (!std::equal(start.begin(), start.end(), path.front().begin(), path.front().end())) {
    return "does not begin at the start";
  }
  if (instance->to_goal(path.back()) > problem.goal_tolerance) return "does not end at the goal";
  Configuration invalid(problem.space.dimension());
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!instance->space.contains(path[i])) return fmt::format("leaves the space at point {}", i + 1);
    if (!instance->valid(path[i])) {
      return fmt::format("is invalid at point {}: {}", i + 1, place_text(*instance, path[i]));
    }
    if (i == 0) continue;
    const MotionReport forward = instance->motion(path[i - 1], path[i]);
    // The planner may have checked the motion from its other end, where rounding differs.
    if (forward.valid || instance->motion(path[i], path[i - 1]).valid) continue;
    instance->space.interpolate(path[i - 1], path[i], forward.invalid_at, invalid);
    return fmt::format("is invalid between the points {} and {}: {}", i, i + 1, place_text(*instance, invalid));
  }
  return "";
}

std::string trajectory_fault(const Problem& problem, const Configurations& path, const Trajectory& trajectory) {
  // Documents hold numbers with all their digits, so that states agree to within rounding.
  constexpr double tolerance = 1e-9;
  if (path.empty()) return "is empty";
  const std::uint64_t steps = std::accumulate(trajectory.steps.begin(), trajectory.steps.end(), std::uint64_t{0});
  if (steps + 1 != path.size()) {
    return fmt::format("has {} states, and its controls drive the robot through {}", path.size(), steps + 1);
  }
  Configurations states;
  try {
    states = replay(*problem.motion_model, problem.space, path.front(), trajectory);
  } catch (const Error& error) {
    return fmt::format("cannot be driven: {}", error.what());
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (problem.space.distance(std::as_const(states)[i], path[i]) > tolerance) {
      return fmt::format("is not where its controls drive the robot, at point {}", i + 1);
    }
  }
  return "";
}

}  // namespace trellis
