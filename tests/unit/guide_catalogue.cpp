// SPDX-License-Identifier: GPL-3.0-or-later
// Properties of the guides of the catalogue beyond the laws of all guides.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/scene/planar/aggregate.hpp>
#include <trellis/scene/planar/polygon.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/space/nearest.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/outcomes.hpp"
#include "support/solved_guide.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::solve_guide;
using test::SolvedGuide;

namespace {

void block(SolvedGuide& w, const Configuration& at) {
  Outcome outcome;
  outcome.proposal = at;
  outcome.near = w.parent->start;
  outcome.blocked_at = at;
  w.guide->learn(outcome);
  w.h->observe(outcome, true);
}

/// Boxes, discs and non-convex polygons, between start and goal at the left and right.
Problem mixed_field(std::uint64_t seed) {
  Stream stream(seed, "", "mixed field");
  std::vector<Obstacle> obstacles;
  for (int i = 0; i < 24; ++i) {
    const Vec2 at{stream.uniform(2, 7.5), stream.uniform(0.2, 9)};
    const double size = stream.uniform(0.2, 0.7);
    Shape shape = Box2{at, {at.x + size, at.y + size}};
    if (i % 3 == 1) shape = Disc{at, 0.5 * size};
    if (i % 3 == 2) {
      shape = Polygon{{at, {at.x + size, at.y}, {at.x + size, at.y + size}, {at.x + 0.6 * size, at.y + 0.3 * size}}};
    }
    obstacles.push_back({"obstacle " + std::to_string(i + 1), shape});
  }
  return test::make_problem("mixed field", World(Box2{{0, 0}, {10, 10}}, std::move(obstacles)), test::rectangle_robot(),
                            {0.8, 5, 0}, {9.2, 5, 0});
}

double outside(const Polygon& polygon, Vec2 p) {
  double most = -1e9;
  for (std::size_t i = 0; i < polygon.vertices.size(); ++i) {
    const Vec2 a = polygon.vertices[i];
    const Vec2 along = polygon.vertices[(i + 1) % polygon.vertices.size()] - a;
    most = std::max(most, -cross(along, p - a) / norm(along));
  }
  return most;
}

}  // namespace

TEST_CASE("hulls hold what they stand for, and a smaller error makes more of them", "[guide][aggregate]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const World world = planar(*mixed_field(seed).scene).world;
    const auto checker = [](const World& w) {
      const Space space = default_space(Robot::point(), w, 1.0);
      return make_planar_checker(std::make_shared<PlanarScene>(w, Robot::point()), space, 0.05);
    };
    const auto real = checker(world);
    std::size_t before = 0;
    for (const double error : {2.0, 0.5, 0.1, 0.0}) {
      CAPTURE(error);
      const World coarse = aggregated(world, error);
      CHECK(coarse.obstacles().size() >= before);
      before = coarse.obstacles().size();
      const auto among_hulls = checker(coarse);
      Stream stream(seed, "", "points");
      for (int i = 0; i < 2000; ++i) {
        const Configuration p = {stream.uniform(0, 10), stream.uniform(0, 10)};
        if (among_hulls->valid(p)) REQUIRE(real->valid(p));
        // Within the error of the true obstacles, up to the sampling interval of the outline, a tenth of it.
        if (!among_hulls->valid(p) && error > 0.0) CHECK(real->clearance(p) <= 1.1 * error + 0.01);
      }
    }
    CHECK(before == world.obstacles().size());
  }
}

TEST_CASE("the convex hull has no point outside, and no straight vertex", "[scene][aggregate]") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Stream stream(seed, "", "hull");
    std::vector<Vec2> points;
    for (int i = 0; i < 40; ++i) {
      // On a coarse lattice many of them are on a line, and some are the same.
      points.push_back({static_cast<double>(stream.below(8)), static_cast<double>(stream.below(8))});
    }
    const Polygon hull = convex_hull(points);
    CHECK_NOTHROW(validated_polygon(hull, "hull"));
    for (const Vec2 p : points) CHECK(outside(hull, p) <= 1e-12);
    for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
      const std::size_t n = hull.vertices.size();
      const Vec2 a = hull.vertices[i];
      CHECK(cross(hull.vertices[(i + 1) % n] - a, hull.vertices[(i + 2) % n] - a) > 0.0);
    }
  }
}

TEST_CASE("every path found among hulls is valid among the obstacles", "[guide][aggregate][property]") {
  int solved = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Problem problem = mixed_field(seed);
    const auto checker = make_planar_checker(problem.scene, problem.space, problem.resolution);
    if (!checker->valid(problem.start) || !checker->valid(problem.goal())) continue;
    for (const double error : {0.1, 0.3, 1.0}) {
      CAPTURE(seed, error);
      const SolvedGuide w = solve_guide("aggregate", {{"error", error}}, problem, seed);
      if (!w.found.solved()) continue;
      ++solved;
      CHECK(checker->valid(w.found.path.front()));
      for (std::size_t i = 1; i < w.found.path.size(); ++i) {
        REQUIRE(checker->motion(w.found.path[i - 1], w.found.path[i]).valid);
      }
      // Nor does the tree hold anything that is invalid.
      for (std::size_t i = 0; i < w.search.nodes.size(); ++i) REQUIRE(checker->valid(w.search.nodes[i]));
    }
  }
  CHECK(solved >= 60);
}

TEST_CASE("where the hulls close the only passage they are refined until it is open", "[guide][aggregate]") {
  const auto problem = test::simple_passage_problem();
  const SolvedGuide w = solve_guide("aggregate", {{"error", 1.0}}, problem);
  CHECK(w.found.solved());
  CHECK_FALSE(solve_guide("aggregate", {{"error", 1.0}, {"effort", std::int64_t{1}}}, problem).found.solved());
  // A start between two obstacles that a hull would hold.
  auto between = test::make_problem("between", test::rectangle_world({{4, 4, 4.5, 6}, {5.5, 4, 6, 6}}),
                                    test::rectangle_robot(), {5, 5, 0}, {9, 9, 0});
  const SolvedGuide freed = solve_guide("aggregate", {{"error", 2.0}}, between);
  CHECK(freed.sub->valid(freed.sub->start));
  CHECK(freed.found.solved());
}

TEST_CASE("only a dropped obstacle that refutes a path in C returns", "[guide][drop]") {
  const auto problem = test::cup_problem();
  auto w = solve_guide(
      "drop", {{"obstacles", std::vector<std::string>{"obstacle 1", "obstacle 2"}}, {"follow", std::string("tube")}},
      problem);
  const Configuration in_first = {6.75, 5, 0};
  const Configuration in_second = {4.5, 1.75, 0};
  const Configuration in_third = {4.5, 8.25, 0};
  CHECK(w.sub->valid(in_first));
  CHECK(w.sub->valid(in_second));
  CHECK_FALSE(w.sub->valid(in_third));
  REQUIRE(w.found.solved());
  const auto spent = w.parent->checks.validity;
  // A blocking obstacle elsewhere stays removed.
  block(w, {4.5, 1.75, 0.5});
  CHECK(w.parent->checks.validity == spent);
  CHECK_FALSE(w.h->stale());
  w.guide->repairs().before_resolve();
  CHECK(w.sub->valid(in_second));
  // Where the path runs into the first one it comes back, alone.
  Configuration q(3);
  for (std::size_t i = 1; i < w.found.path.size() && !w.h->stale(); ++i) {
    for (int k = 0; k <= 100 && !w.h->stale(); ++k) {
      problem.space.interpolate(w.found.path[i - 1], w.found.path[i], 0.01 * k, q);
      const auto contact = make_planar_checker(problem.scene, problem.space, problem.resolution)->contact(q);
      if (contact && contact->obstacle == 0U) block(w, q);
    }
  }
  CHECK(w.h->stale());
  CHECK(w.parent->checks.validity > spent);  // finding the blocking obstacles counts in C
  w.guide->repairs().before_resolve();
  CHECK_FALSE(w.sub->valid(in_first));
  CHECK(w.sub->valid(in_second));
}

TEST_CASE("what is presumed valid and found invalid at one place, time and again, refutes the path there",
          "[guide][lazy]") {
  for (const std::string name : {"shrink", "skeleton", "widen"}) {
    CAPTURE(name);
    auto w = solve_guide(name, {{"evidence", 5.0}}, test::cup_problem());
    REQUIRE(w.found.solved());
    REQUIRE_FALSE(w.h->stale());
    const Configurations path = w.h->lifted_path();
    const View there = std::as_const(path)[path.size() / 2];
    const Configuration place(there.begin(), there.end());
    const Configuration elsewhere(path[1].begin(), path[1].end());
    w.guide->repairs().found_invalid(elsewhere);
    for (int i = 0; i < 4; ++i) w.guide->repairs().found_invalid(place);
    CHECK_FALSE(w.h->stale());
    w.guide->repairs().found_invalid(place);
    CHECK(w.h->stale());
    const Configurations refuted = w.guide->repairs().refuted_places();
    REQUIRE(refuted.size() == 1);
    CHECK(std::hypot(refuted[0][0] - place[0], refuted[0][1] - place[1]) < 1e-9);
    // Another search in S finds another path, or none, and clears the counts.
    w.guide->repairs().before_resolve();
    if (!w.sub->graph) CHECK_FALSE(w.sub->valid(place));
  }
}

TEST_CASE("drop identifies the world's obstacles by name", "[guide][drop]") {
  const auto parent = make_instance(test::cup_problem());
  const auto make = [&](const std::string& name) {
    const GuideKind& kind = *find_guide("drop");
    kind.make(Options::validate(*kind.component, {{"obstacles", std::vector<std::string>{name}}}))->project(*parent);
  };
  CHECK_NOTHROW(make("obstacle 2"));
  // As scripts name them.
  auto problem = test::cup_problem();
  auto obstacles = planar(*problem.scene).world.obstacles();
  obstacles[1].name = "obstacle 2 (lower wall)";
  problem.scene = std::make_shared<PlanarScene>(World(planar(*problem.scene).world.bounds(), std::move(obstacles)),
                                                planar(*problem.scene).robot);
  for (const auto* name : {"lower wall", "obstacle 2", "obstacle 2 (lower wall)"}) {
    CAPTURE(name);
    const auto w = solve_guide("drop", {{"obstacles", std::vector<std::string>{name}}}, problem);
    CHECK(w.sub->valid(Configuration{4.5, 1.75, 0}));
    CHECK_FALSE(w.sub->valid(Configuration{6.75, 5, 0}));
  }
  CHECK_THROWS_WITH(make("obstacel 2"),
                    Catch::Contains("the world has no obstacle 'obstacel 2'") && Catch::Contains("obstacle 2"));
  CHECK_THROWS_WITH(
      Options::validate(*find_guide("drop")->component, {{"obstacles", std::vector<std::string>{"a", "a"}}}),
      Catch::Contains("twice"));
}

TEST_CASE("widened obstacles are thinner, and thin ones are gone", "[guide][widen]") {
  std::vector<Obstacle> obstacles = {{"box", Box2{{4, 0}, {6, 4}}},
                                     {"thin", Box2{{4, 5}, {6, 5.2}}},
                                     {"disc", Disc{{2, 8}, 0.5}},
                                     {"small disc", Disc{{5, 8}, 0.1}},
                                     {"ell", Polygon{{{7, 7}, {9, 7}, {9, 7.6}, {7.6, 7.6}, {7.6, 9}, {7, 9}}}}};
  const auto problem =
      test::make_problem("shapes", World(Box2{{0, 0}, {10, 10}}, obstacles), Robot::point(), {1, 1}, {9, 1});
  const auto w = solve_guide("widen", {{"distance", 0.2}}, problem);
  const auto valid = [&](double x, double y) { return w.sub->valid(Configuration{x, y}); };
  CHECK(w.sub->scene->obstacle_count() == 3);
  CHECK(valid(4.19, 2));
  CHECK_FALSE(valid(4.21, 2));
  CHECK(valid(5, 5.1));
  CHECK(valid(2.31, 8));
  CHECK_FALSE(valid(2.29, 8));
  CHECK(valid(5, 8));
  CHECK(valid(7.19, 8));
  CHECK_FALSE(valid(7.3, 8));
  CHECK(valid(7.41, 8));
  CHECK(valid(2, 0.001));
  CHECK_FALSE(valid(5, 1));
}

TEST_CASE("informed samples lie where a shorter path could pass, and cover it", "[guide][informed]") {
  // The bound reaches beyond walls and round the angle.
  auto problem = test::make_problem("corner", test::rectangle_world({{4, 4, 5, 5}}), test::rectangle_robot(),
                                    {0.5, 0.7, 3.0}, {2.5, 0.4, -2.9});
  const Space& space = problem.space;
  for (const double cost : {2.2, 3.5, 6.0}) {
    CAPTURE(cost);
    const SolvedGuide w = solve_guide("informed", {{"cost", cost}}, problem);
    const auto detour = [&](View q) { return space.distance(problem.start, q) + space.distance(q, problem.goal()); };
    Stream stream(3, "", "informed");
    Configuration q(3);
    for (int i = 0; i < 5000; ++i) {
      w.h->sample(stream, q);
      REQUIRE(space.contains(q));
      REQUIRE(detour(q) <= cost * (1.0 + 1e-12));
      REQUIRE(test::record_of(*w.h).at(q) > 0.0);
    }
    const DensityRecord now = test::record_of(*w.h);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int points = 200000;
    for (int i = 0; i < points; ++i) {
      space.sample_uniform(stream, q);
      const double p = now.at(q) * std::exp(space.log_volume());
      REQUIRE((p > 0.0) == (detour(q) <= cost));
      sum += p;
      squares += p * p;
    }
    const double mean = sum / points;
    CHECK(std::abs(mean - 1.0) < 4.0 * std::sqrt((squares / points - mean * mean) / points));
  }
}

TEST_CASE("of several goals informed samples lie where a shorter path to any of them could pass",
          "[guide][informed][goals]") {
  auto problem = test::make_problem("corner", test::rectangle_world({{4, 4, 5, 5}}), test::rectangle_robot(),
                                    {0.5, 0.7, 3.0}, {2.5, 0.4, -2.9});
  problem.goals.push_back({0.7, 2.0, 2.0});
  problem.goals.push_back({9, 9, 0});
  const Space& space = problem.space;
  for (const double cost : {1.6, 2.4, 4.0}) {
    CAPTURE(cost);
    const SolvedGuide w = solve_guide("informed", {{"cost", cost}}, problem);
    const auto detour = [&](View q, std::size_t goal) {
      return space.distance(problem.start, q) + space.distance(q, problem.goals[goal]);
    };
    const auto inside = [&](View q) { return detour(q, 0) <= cost || detour(q, 1) <= cost; };
    Stream stream(3, "", "informed");
    Configuration q(3);
    std::array<int, 3> near{};
    for (int i = 0; i < 3000; ++i) {
      w.h->sample(stream, q);
      REQUIRE(space.contains(q));
      for (std::size_t goal = 0; goal < 3; ++goal) near.at(goal) += detour(q, goal) <= cost * (1.0 + 1e-12) ? 1 : 0;
      REQUIRE(test::record_of(*w.h).at(q) > 0.0);
    }
    // The first goal is farther than the least cost, and the last one than all.
    CHECK((near[0] > 300) == (cost > 2.1));
    CHECK(near[1] > 300);
    CHECK(near[2] == 0);
    const DensityRecord now = test::record_of(*w.h);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int points = 100000;
    for (int i = 0; i < points; ++i) {
      space.sample_uniform(stream, q);
      const double p = now.at(q) * std::exp(space.log_volume());
      REQUIRE((p > 0.0) == inside(q));
      sum += p;
      squares += p * p;
    }
    const double mean = sum / points;
    CHECK(std::abs(mean - 1.0) < 4.0 * std::sqrt((squares / points - mean * mean) / points));
  }
  CHECK_THROWS_WITH(solve_guide("informed", {{"cost", 1.0}}, problem), Catch::Contains("to the nearest goal is 1.3"));
}

TEST_CASE("informed uses the best reported path as long as it is valid", "[guide][informed]") {
  const auto problem = test::point_problem(5);
  const SolvedGuide w = solve_guide("informed", {}, problem);
  const Configuration corner = {9.5, 0.5};
  const double uniform = std::exp(-problem.space.log_volume());
  CHECK(test::record_of(*w.h).at(corner) == Approx(uniform));
  w.h->found(14.0);
  CHECK(test::record_of(*w.h).at(corner) == 0.0);
  const double there = test::record_of(*w.h).at(problem.start);
  CHECK(there > uniform);
  w.h->found(15.0);  // no better
  CHECK(test::record_of(*w.h).at(problem.start) == there);
  w.h->found(13.0);
  CHECK(test::record_of(*w.h).at(problem.start) > there);
  CHECK_THROWS_WITH(solve_guide("informed", {{"cost", 5.0}}, problem), Catch::Contains("no path is as short"));
}

TEST_CASE("information_gain proposes where its model is least certain, and with utility where that is valid",
          "[guide][information_gain]") {
  const auto problem = test::point_problem(5);
  // Shares of the proposals in the left half, which is known to be free, and in the right one, known to be invalid.
  const auto shares = [&](const std::string& gain) {
    SolvedGuide w =
        solve_guide("information_gain", {{"candidates", std::int64_t{20}}, {"gain", gain}, {"reach", 0.5}}, problem);
    Configuration q(2);
    for (q[0] = 0.25; q[0] < 10.0; q[0] += 0.5) {
      for (q[1] = 0.25; q[1] < 10.0; q[1] += 0.5) {
        if (q[0] < 4.0) w.h->observe(test::reached(q), false);
        if (q[0] > 6.0) w.h->observe(test::blocked(q), false);
      }
    }
    Stream stream(3, "", "gain");
    std::array<double, 2> share{};
    for (int i = 0; i < 1000; ++i) {
      w.h->sample(stream, q);
      if (q[0] < 3.5) share[0] += 0.001;
      if (q[0] > 6.5) share[1] += 0.001;
    }
    return share;
  };
  const auto information = shares("information");
  CHECK(information[0] + information[1] < 0.05);  // 0.7 of the space
  const auto utility = shares("utility");
  CHECK(utility[1] == 0.0);
}

TEST_CASE("blossom names a node and draws its controls in the order of the cost to go where they end",
          "[guide][blossom]") {
  const Problem problem = test::driven(test::cup_problem(), "unicycle2");
  const MotionModel& model = *problem.motion_model;
  constexpr std::int64_t controls = 12;
  SolvedGuide w =
      solve_guide("blossom", {{"share", 1.0}, {"controls", controls}, {"heading", std::string("found")}}, problem);
  REQUIRE(w.found.solved());
  // The cost to go along the path in S, by points 1 mm apart.
  const Space& s = w.sub->space;
  Configurations points(s.dimension());
  std::vector<double> left;
  double length = 0.0;
  for (std::size_t i = w.found.path.size() - 1; i-- > 0;) {
    const View a = w.found.path[i];
    const View b = w.found.path[i + 1];
    const double piece = s.distance(a, b);
    const auto parts = static_cast<int>(std::ceil(piece / 0.001));
    Configuration q(s.dimension());
    for (int k = 0; k <= parts; ++k) {
      s.interpolate(b, a, static_cast<double>(k) / parts, q);
      points.push(q);
      left.push_back(length + piece * k / parts);
    }
    length += piece;
  }
  const auto to_go = [&](View x) {
    Configuration q(s.dimension());
    w.guide->project(x, q);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i) {
      least = std::min(least, left[i] + 2.0 * s.distance(points[i], q));
    }
    return least;
  };
  Stream stream(4, "", "blossom");
  Configuration q(5);
  std::vector<double> control(2);
  std::vector<double> costs;
  for (std::int64_t i = 0; i < controls; ++i) {
    w.h->sample(stream, q);
    CHECK(problem.space.contains(q));
    const std::uint32_t steps = w.h->draw_control(stream, {w.parent->start, 0, q, 10}, control);
    if (steps == 0) break;
    REQUIRE(steps <= 10);
    REQUIRE(model.allows(control));
    Configuration at = w.parent->start;
    for (std::uint32_t k = 0; k < steps; ++k) model.step(problem.space, at, control, at);
    CHECK(problem.space.contains(at));
    costs.push_back(to_go(at));
    if (i == 0) {
      // The best control of the start becomes a node, which is extended next.
      Outcome outcome = test::reached(at, 7);
      outcome.near = w.parent->start;
      outcome.near_row = 0;
      w.h->observe(outcome, true);
      CHECK(costs.front() < to_go(w.parent->start));
      w.h->sample(stream, q);
      CHECK(w.h->vertex() == 7);
    }
    if (costs.size() == 4) break;
  }
  REQUIRE(costs.size() == 4);
  for (std::size_t i = 1; i < costs.size(); ++i) CHECK(costs[i] > costs[i - 1] - 0.2);
  // Without progress nodes farther back are extended too, and their controls are new ones.
  bool back = false;
  for (int i = 0; i < 400 && !back; ++i) {
    w.h->sample(stream, q);
    back = w.h->vertex() != 7;
    Outcome failed = test::blocked(q);
    failed.near_row = w.h->vertex();
    w.h->observe(failed, true);
  }
  CHECK(back);
  // After a restart there is the start alone.
  w.h->restart();
  w.h->sample(stream, q);
  CHECK(w.h->vertex() == no_node);
}

TEST_CASE("state_cells proposes in cells beside those with a node, and names the node to extend",
          "[guide][state_cells]") {
  auto problem = test::point_problem(5);
  problem.start = {0.5, 0.5};
  SolvedGuide w = solve_guide("state_cells", {{"cell", 1.0}, {"explore", 0.0}}, problem);
  Stream stream(3, "", "cells");
  Configuration q(2);
  const auto cell = [](View at) { return std::pair(static_cast<int>(at[0]), static_cast<int>(at[1])); };
  const auto drawn = [&] {
    std::set<std::pair<int, int>> cells;
    for (int i = 0; i < 200; ++i) {
      w.h->sample(stream, q);
      cells.insert(cell(q));
    }
    return cells;
  };
  CHECK(drawn() == std::set<std::pair<int, int>>{{1, 0}, {0, 1}});
  CHECK(w.h->vertex() == no_node);  // the start: the nearest node is as good
  // A second node in a cell is the same state.
  const Configuration first = {1.4, 0.5};
  const Configuration second = {1.6, 0.5};
  w.h->observe(test::reached(first, 7), false);
  w.h->observe(test::reached(second, 8), false);
  CHECK(drawn() == std::set<std::pair<int, int>>{{0, 1}, {1, 1}, {2, 0}});
  while (w.h->sample(stream, q), cell(q) != std::pair(2, 0)) {
  }
  CHECK(w.h->vertex() == 7);
  // Cells whose proposals fail are tried less often.
  for (int i = 0; i < 20; ++i) {
    while (w.h->sample(stream, q), cell(q) != std::pair(0, 1)) w.h->observe(test::blocked(q), false);
    w.h->observe(test::blocked(q), true);
  }
  int there = 0;
  for (int i = 0; i < 1000; ++i) {
    w.h->sample(stream, q);
    if (cell(q) == std::pair(0, 1)) ++there;
  }
  CHECK(there < 20);
  // The tree from the goal has cells of its own; a restart forgets all.
  w.h->select_tree(TreeSide::goal);
  w.h->sample(stream, q);
  CHECK(problem.space.distance(q, problem.goal()) < 2.5);
  w.h->restart();
  w.h->select_tree(TreeSide::start);
  CHECK(drawn() == std::set<std::pair<int, int>>{{1, 0}, {0, 1}});
}

TEST_CASE("a Halton sequence leaves smaller holes than uniform samples", "[guide][halton]") {
  const auto problem = test::point_problem(5);
  // The largest distance from a point of the square to its nearest sample.
  const auto dispersion = [&](const std::string& name, std::uint64_t seed) {
    const SolvedGuide w = solve_guide(name, {}, problem);
    Stream stream(seed, "", "dispersion");
    NearestIndex index(problem.space);
    Configuration q(2);
    for (int i = 0; i < 500; ++i) {
      w.h->sample(stream, q);
      index.add(q);
    }
    double most = 0.0;
    for (int x = 0; x <= 100; ++x) {
      for (int y = 0; y <= 100; ++y) {
        most = std::max(most, index.nearest(Configuration{0.1 * x, 0.1 * y}).squared_distance);
      }
    }
    return most;
  };
  // At a corner a shift may leave a hole of its own, so not for every seed.
  int smaller = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    if (dispersion("halton", seed) < dispersion("uniform", seed)) ++smaller;
  }
  CHECK(smaller >= 22);
}

TEST_CASE("samples out of obstacles lie at their surface, those on the medial axis between them", "[guide]") {
  const auto problem = test::make_problem("slit", test::rectangle_world({{0, 0, 10, 4}, {0, 5, 10, 10}}),
                                          Robot::disc(0.1), {1, 4.5}, {9, 4.5});
  Stream stream(4, "", "surface");
  Configuration q(2);
  auto surface = solve_guide("obstacle_based", {}, problem);
  int at_surface = 0;
  for (int i = 0; i < 300; ++i) {
    surface.h->sample(stream, q);
    CHECK(surface.parent->valid(q));
    if (surface.parent->clearance(q) <= 2.0 * problem.resolution) ++at_surface;
  }
  CHECK(at_surface == 300);
  auto axis = solve_guide("medial_axis", {}, problem);
  for (int i = 0; i < 300; ++i) {
    axis.h->sample(stream, q);
    CHECK(axis.parent->valid(q));
    // The slit's middle, but for its ends, where the boundary is nearer.
    if (q[0] > 1.0 && q[0] < 9.0) CHECK(q[1] == Approx(4.5).margin(2.0 * problem.resolution));
  }
}

TEST_CASE("the point's path is the shortest on the grid, and has clearance to obstacles", "[guide][workspace]") {
  const SolvedGuide w = solve_guide("workspace", {{"cell", 0.5}}, test::cup_problem());
  REQUIRE(w.found.solved());
  const auto& space = w.sub->space;
  for (std::size_t i = 1; i < w.found.path.size(); ++i) {
    CHECK(w.sub->motion(w.found.path[i - 1], w.found.path[i]).valid);
  }
  // The graph with every edge validated, searched exactly.
  auto all = std::make_shared<Graph>(*w.sub->graph);
  std::erase_if(all->edges, [&](const Graph::Edge& e) {
    return !w.sub->motion(std::as_const(all->vertices)[e.from], std::as_const(all->vertices)[e.to]).valid;
  });
  all->verified = true;
  Instance checked = *w.sub;
  checked.graph = all;
  Search search(2);
  const PlannerKind& kind = *find_planner("graph_search");
  const Options options = Options::validate(*kind.component, {});
  const Solution best = kind.make(options, {checked, *w.uniform, Stream(1, "0", "proposals"), search, false})
                            ->solve(*w.uniform, kind.common(options).budget);
  REQUIRE(best.solved());
  CHECK(path_length(space, w.found.path) == Approx(path_length(space, best.path)).epsilon(1e-12));
}
