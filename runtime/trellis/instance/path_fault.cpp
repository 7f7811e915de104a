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

std::optional<InvalidPlace> first_invalid_place(Instance& instance, const Configurations& path) {
  using Kind = InvalidPlace::Kind;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const View point = path[i];
    const auto at_point = [&](Kind kind) { return InvalidPlace{kind, i, Configuration(point.begin(), point.end())}; };
    if (!instance.space.contains(point)) return at_point(Kind::outside);
    if (!instance.valid(point)) return at_point(Kind::point);
    if (i == 0) continue;
    const MotionReport forward = instance.motion(path[i - 1], point);
    if (forward.valid || instance.motion(point, path[i - 1]).valid) continue;
    InvalidPlace place{Kind::motion, i, Configuration(point.size())};
    instance.space.interpolate(path[i - 1], point, forward.invalid_at, place.invalid);
    return place;
  }
  return std::nullopt;
}

Problem with_finer_motions(Problem problem) {
  problem.resolution /= path_check_refinement;
  return problem;
}

std::string path_fault(const Problem& problem, const Configurations& path) {
  if (path.empty()) return "is empty";
  if (path.dimension() != problem.space.dimension()) {
    return fmt::format("has {} coordinates, and {} has {}", path.dimension(), problem.space.name(),
                       problem.space.dimension());
  }
  const auto instance = make_instance(problem);
  // A search normalises angles; a problem stores them as the user gave them.
  Configuration start = problem.start;
  Configuration first(path.front().begin(), path.front().end());
  problem.space.normalise(start);
  problem.space.normalise(first);
  if (start != first) {
    return "does not begin at the start";
  }
  if (instance->to_goal(path.back()) > problem.goal_tolerance) return "does not end at the goal";
  const auto place = first_invalid_place(*instance, path);
  if (!place) return "";
  const std::size_t number = place->point + 1;
  switch (place->kind) {
    case InvalidPlace::Kind::outside: return fmt::format("leaves the space at point {}", number);
    case InvalidPlace::Kind::point:
      return fmt::format("is invalid at point {}: {}", number, place_text(*instance, place->invalid));
    case InvalidPlace::Kind::motion:
      return fmt::format("is invalid between the points {} and {}: {}", place->point, number,
                         place_text(*instance, place->invalid));
  }
  throw Fault("unknown kind of invalid place");
}

std::string trajectory_fault(const Problem& problem, const Configurations& path, const Trajectory& trajectory) {
  // Documents store numbers with all their digits, so that states agree to within rounding.
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
