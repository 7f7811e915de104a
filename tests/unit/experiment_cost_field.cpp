// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths of shortest paths through configurations, against closed forms.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <trellis/experiment/cost_field.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

CostFieldInstance instance_of(const Problem& problem) {
  const std::shared_ptr<Instance> instance = make_instance(problem);
  return {problem.space, problem.start, problem.goal(), [instance](View q) { return instance->validity->state(q); },
          [instance](View a, View b) { return instance->validity->motion(a, b).valid; }};
}

/// A point in a square with a wall from its lower side that leaves a gap of 2 m above.
Problem wall_problem() {
  auto problem = test::make_problem("wall", test::rectangle_world({{4, 0, 6, 8}}), Robot::point(), {1, 5}, {9, 5});
  problem.resolution = 0.01;
  return problem;
}

double length(Vec2 a, Vec2 b) { return norm(a - b); }

/// Whether the open segment from a to b misses the open box of the wall.
bool sees(Vec2 a, Vec2 b) {
  double from = 0.0;
  double to = 1.0;
  const auto cut = [&](double p, double v, double lo, double hi) {
    if (v == 0.0) {
      if (p <= lo || p >= hi) to = -1.0;
      return;
    }
    const double t0 = (lo - p) / v;
    const double t1 = (hi - p) / v;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  };
  cut(a.x, b.x - a.x, 4, 6);
  cut(a.y, b.y - a.y, 0, 8);
  return to - from <= 1e-12;
}

/// The shortest path past the wall's two corners.
double geodesic(Vec2 a, Vec2 b) {
  if (sees(a, b)) return length(a, b);
  const Vec2 left{4, 8};
  const Vec2 right{6, 8};
  double best = std::numeric_limits<double>::infinity();
  for (const Vec2 corner : {left, right}) {
    if (sees(a, corner) && sees(corner, b)) best = std::min(best, length(a, corner) + length(corner, b));
  }
  for (const auto& [first, second] : {std::pair(left, right), std::pair(right, left)}) {
    if (sees(a, first) && sees(second, b)) best = std::min(best, length(a, first) + 2.0 + length(second, b));
  }
  return best;
}

/// The mean and the largest excess of the field over the truth, relative, at random free points.
std::pair<double, double> excess(const CostField& field, const Problem& problem, int points) {
  Stream stream(1, "", "points");
  const Vec2 start{problem.start[0], problem.start[1]};
  const Vec2 goal{problem.goal()[0], problem.goal()[1]};
  double sum = 0.0;
  double most = 0.0;
  int counted = 0;
  for (int i = 0; i < points; ++i) {
    const Vec2 p{stream.uniform(0, 10), stream.uniform(0, 10)};
    const double cost = field.cost(std::array{p.x, p.y});
    if (p.x >= 4 && p.x <= 6 && p.y <= 8) {
      CHECK(cost == std::numeric_limits<double>::infinity());
      continue;
    }
    const double truth = geodesic(start, p) + geodesic(p, goal);
    // Never below the true cost, except for corners that a motion cuts between two checked configurations.
    CHECK(cost >= truth - 0.01);
    sum += cost / truth - 1.0;
    most = std::max(most, cost / truth - 1.0);
    ++counted;
  }
  return {sum / counted, most};
}

}  // namespace

TEST_CASE("in open space the cost is that of two straight lines", "[experiment][cost_field]") {
  for (const auto& problem :
       {test::make_problem("open plane", test::rectangle_world({}), Robot::point(), {1, 5}, {9, 5}),
        test::make_problem("open", test::rectangle_world({}), test::rectangle_robot(), {1, 5, -2.5}, {9, 5, 2.5})}) {
    CAPTURE(problem.name);
    const CostField field(instance_of(problem), {300}, 1);
    CHECK(field.optimum() == Approx(problem.space.distance(problem.start, problem.goal())).epsilon(1e-12));
    CHECK(field.path().size() == 2);
    Stream stream(2, "", "points");
    Configuration q(problem.space.dimension());
    int inside = 0;
    int in_ellipse = 0;
    for (int i = 0; i < 20000; ++i) {
      problem.space.sample_uniform(stream, q);
      // Clear of the walls, where the robot may not be.
      if (q[0] < 0.4 || q[0] > 9.6 || q[1] < 0.4 || q[1] > 9.6) continue;
      const double truth = problem.space.distance(problem.start, q) + problem.space.distance(q, problem.goal());
      if (i < 500) CHECK(field.cost(q) == Approx(truth).epsilon(1e-9));
      inside += truth <= 1.1 * field.optimum() ? 1 : 0;
      if (q.size() == 2) {
        // The ellipse with the ends as foci, its axes a and b.
        const double a = 0.5 * 1.1 * 8.0;
        const double b = std::sqrt(a * a - 16.0);
        in_ellipse += (q[0] - 5) * (q[0] - 5) / (a * a) + (q[1] - 5) * (q[1] - 5) / (b * b) <= 1.0 ? 1 : 0;
      }
    }
    if (q.size() == 2) CHECK(inside == in_ellipse);
  }
}

TEST_CASE("past a wall costs come down to those of the visibility graph", "[experiment][cost_field]") {
  const auto problem = wall_problem();
  const double truth = geodesic({1, 5}, {9, 5});
  REQUIRE(truth == Approx(2.0 + 6.0 * std::sqrt(2.0)));
  double before = 0.1;
  for (const std::size_t samples : {200, 2000, 20000}) {
    CAPTURE(samples);
    const CostField field(instance_of(problem), {samples}, 1);
    CHECK(field.size() == samples + 2);
    CHECK(field.optimum() >= truth - 0.01);
    CHECK(path_length(problem.space, field.path()) == Approx(field.optimum()).epsilon(1e-12));
    CHECK(field.cost(problem.start) == Approx(field.optimum()).epsilon(1e-9));
    CHECK(field.cost(problem.goal()) == Approx(field.optimum()).epsilon(1e-9));
    const auto [mean, most] = excess(field, problem, 400);
    CHECK(field.optimum() / truth - 1.0 < before);
    CHECK(mean < before);
    CHECK(most < 2.0 * before);
    before *= 0.4;
  }
}

TEST_CASE("a known path bounds the optimum, and its points join the roadmap", "[experiment][cost_field]") {
  const auto problem = wall_problem();
  Configurations path(2);
  for (const auto& p : {Configuration{1, 5}, {3.999, 8.001}, {6.001, 8.001}, {9, 5}}) path.push(p);
  const double bound = path_length(problem.space, path);
  const CostField without(instance_of(problem), {100}, 3);
  const CostField with(instance_of(problem), {100}, 3, {path});
  CHECK(without.optimum() > bound + 1e-3);
  CHECK(with.optimum() <= bound * (1.0 + 1e-12));
  CHECK(with.size() == without.size() + 2);
  CHECK(with.cost(std::array{4.0, 8.001}) < bound + 1e-3);
}

TEST_CASE("where nothing leads there the cost is infinite", "[experiment][cost_field]") {
  auto problem = test::make_problem("closed", test::rectangle_world({{4, 0, 6, 10}}), Robot::point(), {1, 5}, {9, 5});
  const CostField field(instance_of(problem), {500}, 1);
  CHECK(field.optimum() == std::numeric_limits<double>::infinity());
  CHECK(field.path().empty());
  CHECK(field.cost(problem.start) == std::numeric_limits<double>::infinity());
  CHECK(field.cost(std::array{5.0, 5.0}) == std::numeric_limits<double>::infinity());
  problem.goals = {{5, 5}};
  CHECK_THROWS_WITH(CostField(instance_of(problem), {10}, 1), Catch::Matchers::Contains("valid goal"));
}

TEST_CASE("the field is the same for the same seed, and no run's path is shorter than it says",
          "[experiment][cost_field]") {
  for (const auto& problem : {test::cup_problem(), test::simple_passage_problem(), test::point_problem(5)}) {
    CAPTURE(problem.name);
    const CostField a(instance_of(problem), {}, 1);
    const CostField b(instance_of(problem), {}, 1);
    const CostField c(instance_of(problem), {}, 2);
    CHECK(a.optimum() == b.optimum());
    CHECK(a.optimum() == Approx(c.optimum()).epsilon(0.06));
    ExecuteOptions options;
    options.shortcut = 300;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto run = execute(PlannerSpec::make("rrt_connect", {}), problem, seed, options);
      REQUIRE(run.solved);
      CHECK(run.length > 0.97 * a.optimum());
      for (std::size_t i = 0; i < run.path.size(); ++i) {
        CHECK(a.cost(run.path[i]) == b.cost(run.path[i]));
        CHECK(a.cost(run.path[i]) < 1.1 * run.length);
        CHECK(a.cost(run.path[i]) >= a.optimum() * (1.0 - 0.05));
      }
    }
  }
}
