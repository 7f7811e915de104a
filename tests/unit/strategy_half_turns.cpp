// SPDX-License-Identifier: GPL-3.0-or-later
// A reported path says in which direction it turns, also where it turns by half.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/instance/half_turns.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

constexpr double pi = std::numbers::pi;

Configurations path_of(const std::vector<Configuration>& points) {
  Configurations path(points.front().size());
  for (const auto& q : points) path.push(q);
  return path;
}

/// A bar that turns about its end, with an obstacle on one side of it.
/// \param side  1: above, so that it turns below; -1: below
Problem hinged(double side) {
  const Robot bar = Robot::rigid({Box2{{0, -0.05}, {2, 0.05}}});
  const double y = 5.0 + side * 1.2;
  return test::make_problem("hinged", test::rectangle_world({{4.7, y - 0.2, 5.3, y + 0.2}}), bar, {5, 5, 0},
                            {5, 5, -pi});
}

/// The path with its numbers written with 17 digits and read again.
Configurations read_again(const Configurations& path) {
  Configurations result(path.dimension());
  for (std::size_t i = 0; i < path.size(); ++i) {
    Configuration q;
    for (const double x : path[i]) q.push_back(std::strtod(fmt::format("{:.17g}", x).c_str(), nullptr));
    result.push(q);
  }
  return result;
}

/// Whether each motion, from point to point in the path's order, is valid at a fine resolution.
bool valid_forwards(Problem problem, const Configurations& path) {
  problem.resolution /= 16.0;
  const auto instance = make_instance(problem);
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (!instance->motion(path[i - 1], path[i]).valid) return false;
  }
  return true;
}

bool valid_backwards(const Problem& problem, const Configurations& path) {
  Configurations reversed(path.dimension());
  for (std::size_t i = path.size(); i-- > 0;) reversed.push(path[i]);
  return valid_forwards(problem, reversed);
}

}  // namespace

TEST_CASE("the midpoint of a half turn is that of the motion that is valid", "[instance][half_turns]") {
  for (const double side : {1.0, -1.0}) {
    CAPTURE(side);
    const Problem problem = hinged(side);
    const auto instance = make_instance(problem);
    const Configurations path = path_of({{5, 5, 0}, {5, 5, -pi}});
    // One of the two half turns is blocked. The ends alone say the one that leads above.
    CHECK(valid_forwards(problem, path) == (side < 0.0));
    const Configurations divided = with_half_turns_divided(instance->space, *instance->validity, path, 1e-8);
    REQUIRE(divided.size() == 3);
    CHECK(std::as_const(divided)[1][2] == Approx(-side * 0.5 * pi));
    CHECK(valid_forwards(problem, read_again(divided)));
    CHECK(valid_backwards(problem, read_again(divided)));
    CHECK(path_length(problem.space, divided) == Approx(path_length(problem.space, path)));
    // Once divided, a path stays.
    CHECK(std::ranges::equal(with_half_turns_divided(instance->space, *instance->validity, divided, 1e-8).values(),
                             divided.values()));
  }
}

TEST_CASE("a path without half turns keeps its points", "[instance][half_turns]") {
  const Problem problem = hinged(1.0);
  const auto instance = make_instance(problem);
  const Configurations path = path_of({{5, 5, 0}, {5, 5, 3.1}, {5, 5, -1}, {5, 8, -1}, {2, 8, 2.1}});
  CHECK(std::ranges::equal(with_half_turns_divided(instance->space, *instance->validity, path, 1e-8).values(),
                           path.values()));
  CHECK(instance->checks.motion == 0);
  CHECK(with_half_turns_divided(instance->space, *instance->validity, path_of({{5, 5, 0}}), 1e-8).size() == 1);
  // Angles with five decimals.
  CHECK(with_half_turns_divided(instance->space, *instance->validity, path_of({{5, 5, 0}, {5, 5, 3.14159}}), 1e-8)
            .size() == 3);
}

TEST_CASE("a turn by half in space passes through its midpoint", "[instance][half_turns][space]") {
  // A bar that turns about its end, with a ball on one side of it.
  Problem problem;
  problem.name = "bar";
  problem.scene = std::make_shared<const SpatialScene>(
      World3({{0, 0, 0}, {10, 10, 10}}, {{"ball", {Sphere{0.3}, {{5, 6.2, 5}, {}}}}}),
      Robot3("bar", {{Cuboid{{2, 0.1, 0.1}}, {{1, 0, 0}, {}}}}));
  problem.space = problem.scene->default_space(1.0);
  problem.collision = "fcl";
  problem.start = {5, 5, 5, 0, 0, 0, 1};
  problem.goals = {{5, 5, 5, 0, 0, 1, 0}};
  const auto instance = make_instance(problem);
  const Configurations divided =
      with_half_turns_divided(instance->space, *instance->validity, path_of({problem.start, problem.goal()}), 1e-8);
  REQUIRE(divided.size() == 3);
  const double quarter = std::sqrt(0.5);
  CHECK(std::abs(std::as_const(divided)[1][5]) == Approx(quarter));
  CHECK(std::as_const(divided)[1][6] == Approx(quarter));
  for (const auto* planner : {"rrt", "rrt_connect", "prm"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      CAPTURE(planner, seed);
      const RunRecord run = execute(PlannerSpec::make(planner, {}), problem, seed);
      REQUIRE(run.solved);
      const Configurations path = read_again(run.path);
      CHECK(valid_forwards(problem, path));
      CHECK(valid_backwards(problem, path));
      for (std::size_t i = 1; i < path.size(); ++i) {
        CHECK(angle_between({path[i - 1][3], path[i - 1][4], path[i - 1][5], path[i - 1][6]},
                            {path[i][3], path[i][4], path[i][5], path[i][6]}) < 0.99 * pi);
      }
    }
  }
}

TEST_CASE("every planner reports a path whose turns have the direction that was checked", "[executor][half_turns]") {
  for (const PlannerKind& kind : planner_kinds()) {
    if (kind.graph || kind.kinodynamic) continue;
    for (const double side : {1.0, -1.0}) {
      for (const bool swapped : {false, true}) {
        CAPTURE(kind.component->name, side, swapped);
        Problem problem = hinged(side);
        if (swapped) std::swap(problem.start, problem.goals.front());
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
          const RunRecord run = execute(PlannerSpec::make(kind.component->name, {}), problem, seed);
          REQUIRE(run.solved);
          const Configurations path = read_again(run.path);
          CHECK(valid_forwards(problem, path));
          CHECK(valid_backwards(problem, path));
          CHECK(path_fault(problem, path).empty());
          CHECK(run.length == Approx(path_length(problem.space, path)));
        }
      }
    }
  }
}

TEST_CASE("a guided search reports a half turn in a direction that is free, from whichever end it was verified",
          "[executor][half_turns]") {
  // A lazy guide stores verified motions without their direction.
  std::vector<StrategySpec> strategies;
  for (const char* guide : {"lazy", "shrink", "identity"}) {
    for (const char* planner : {"rrt", "rrt_connect", "prm", "rrt_star"}) {
      for (const char* below : {"rrt_connect", "lazy_prm"}) {
        const auto long_step =
            planner == std::string("prm") ? std::vector<Options::Entry>{} : std::vector<Options::Entry>{{"step", 5.0}};
        strategies.push_back(GuideSpec::make(guide, {}, PlannerSpec::make(below, {})) >>
                             PlannerSpec::make(planner, long_step));
      }
    }
  }
  for (const StrategySpec& strategy : strategies) {
    for (const double side : {1.0, -1.0}) {
      for (const bool swapped : {false, true}) {
        CAPTURE(strategy.text(), side, swapped);
        Problem problem = hinged(side);
        if (swapped) std::swap(problem.start, problem.goals.front());
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
          const RunRecord run = execute(strategy, problem, seed);
          REQUIRE(run.solved);
          CHECK(path_fault(problem, read_again(run.path)).empty());
          CHECK(valid_forwards(problem, read_again(run.path)));
        }
      }
    }
  }
}
