// SPDX-License-Identifier: GPL-3.0-or-later
// A flat subspace fitted to valid configurations.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/principal_axes.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

double inner(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void check_orthonormal(const std::vector<std::vector<double>>& axes) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t k = 0; k <= i; ++k) CHECK(std::abs(inner(axes[i], axes[k]) - (i == k ? 1.0 : 0.0)) < 1e-12);
  }
}

/// An arm of three links, one of them with limits, between two boxes or beside others.
Problem arm_problem(const test::Rectangles& boxes = {{6.5, 6.5, 8, 8}, {2, 2, 3.5, 3.5}}) {
  Arm arm{.links = {2, 1.5, 1}, .widths = {0.2, 0.2, 0.1}, .base = {5, 5}};
  arm.limits = {std::nullopt, std::pair(-2.5, 2.5)};
  return test::make_problem("arm", test::rectangle_world(boxes), Robot::arm(arm), {1.8, 0.3, 0.3}, {-0.8, -0.4, 0.5});
}

std::unique_ptr<Guide> guide_of(const std::vector<Options::Entry>& options) {
  const GuideKind& kind = *find_guide("pca");
  return kind.make(Options::validate(*kind.component, options));
}

}  // namespace

TEST_CASE("principal axes are those of the points, the longest first", "[guide][pca]") {
  // Along (3, 4, 0) / 5 with a deviation of 2, along z of 1, and hardly anything else.
  Stream stream(1, "pca", "points");
  std::vector<double> points;
  for (int i = 0; i < 20000; ++i) {
    const double a = 2.0 * stream.normal();
    const double b = stream.normal();
    const double c = 0.01 * stream.normal();
    points.insert(points.end(), {0.6 * a - 0.8 * c, 0.8 * a + 0.6 * c, b});
  }
  const auto axes = principal_axes(points, {}, 3);
  REQUIRE(axes.size() == 3);
  check_orthonormal(axes);
  CHECK(inner(axes[0], {0.6, 0.8, 0.0}) > 0.999);
  CHECK(inner(axes[1], {0.0, 0.0, 1.0}) > 0.999);

  SECTION("a first direction comes first, and the others are orthogonal to it") {
    const auto given = principal_axes(points, {{0.0, 0.0, 7.0}}, 3);
    check_orthonormal(given);
    CHECK(inner(given[0], {0.0, 0.0, 1.0}) == Approx(1.0));
    CHECK(inner(given[1], {0.6, 0.8, 0.0}) > 0.999);
    CHECK(principal_axes(points, {{0.0, 0.0, 0.0}}, 3) == axes);
  }
}

TEST_CASE("with its ends on it, a path of the subspace is one of C", "[guide][pca]") {
  const auto problem = arm_problem({{7.8, 7.8, 8.4, 8.4}, {2, 2, 3.5, 3.5}});
  auto parent = make_instance(problem);
  const auto guide = guide_of({{"dimensions", std::int64_t{2}}, {"samples", std::int64_t{100}}});
  const auto sub = guide->project(*parent);
  CHECK(sub->space.name() == "R^2 of SO(2) x R x SO(2)");
  // Each sample was a check at least.
  CHECK(sub->checks.validity >= 100);
  CHECK(sub->valid(sub->start));
  CHECK(sub->valid(sub->goal()));

  const PlannerKind& planner = *find_planner("rrt_connect");
  UniformGuidance uniform(sub->space);
  Search search(2);
  const Options options = Options::validate(*planner.component, {{"step", 0.1}});
  const Solution found = planner.make(options, {*sub, uniform, Stream(1, "0/0", "proposals"), search, false})
                             ->solve(uniform, planner.common(options).budget);
  REQUIRE(found.solved());
  const auto h = guide->heuristic(*parent, sub.get(), &found);
  const Configurations path = h->lifted_path();
  REQUIRE(path.size() == found.path.size());
  CHECK(problem.space.distance(path.front(), problem.start) < 1e-9);
  CHECK(problem.space.distance(path.back(), problem.goal()) < 1e-9);
  const auto checker = make_checker("planar", problem.scene, problem.space, problem.resolution);
  for (std::size_t i = 1; i < path.size(); ++i) CHECK(checker->motion(path[i - 1], path[i]).valid);
}

TEST_CASE("a subspace goes through the nearest of several goals, as many as it has dimensions", "[guide][pca][goals]") {
  auto problem = arm_problem();
  const Configuration own = problem.goal();
  problem.goals = {own, {problem.start[0] + 0.3, problem.start[1], problem.start[2]}};
  for (int order = 0; order < 2; ++order) {
    auto parent = make_instance(problem);
    const auto guide = guide_of({{"dimensions", std::int64_t{2}}, {"samples", std::int64_t{100}}});
    const auto sub = guide->project(*parent);
    REQUIRE(sub->goals.size() == 2);
    CHECK(sub->goal()[1] == Approx(sub->start[1]).margin(1e-9));  // the nearer one is along the first axis
    for (const Configuration& goal : problem.goals) {
      Configuration s(2);
      Configuration q(3);
      Configuration back(2);
      guide->project(goal, s);
      CHECK(std::ranges::any_of(sub->goals, [&](const Configuration& other) { return other == s; }));
      // The start, the goal and the points between them lie on the subspace.
      problem.space.interpolate(problem.start, goal, 0.5, q);
      guide->project(q, back);
      const double whole = problem.space.distance(problem.start, goal);
      CHECK(sub->space.distance(s, sub->start) == Approx(whole));
      CHECK(sub->space.distance(back, sub->start) == Approx(0.5 * whole));
    }
    std::swap(problem.goals[0], problem.goals[1]);
  }
}

TEST_CASE("motions of the subspace are those of C, round an axis as well", "[guide][pca]") {
  const auto problem = arm_problem();
  auto parent = make_instance(problem);
  const auto guide = guide_of({{"dimensions", std::int64_t{2}}});
  const auto sub = guide->project(*parent);
  const auto checker = make_checker("planar", problem.scene, problem.space, problem.resolution);
  Stream stream(2, "pca", "motions");
  Configuration a(2);
  Configuration b(2);
  Configuration s(2);
  Configuration q(3);
  int blocked = 0;
  for (int i = 0; i < 500; ++i) {
    sub->space.sample_uniform(stream, a);
    sub->space.sample_uniform(stream, b);
    if (!sub->valid(a)) continue;
    const MotionReport report = sub->motion(a, b);
    blocked += report.valid ? 0 : 1;
    for (int k = 1; k <= 200; ++k) {
      sub->space.interpolate(a, b, k / 200.0, s);
      // Thinner than the resolution, a contact may be missed.
      if (report.valid && !sub->valid(s)) {
        sub->space.interpolate(a, b, (k - 1) / 200.0, s);
        const bool before = sub->valid(s);
        sub->space.interpolate(a, b, std::min(1.0, (k + 1) / 200.0), s);
        CHECK((before && sub->valid(s)));
      }
    }
    if (!report.valid) {
      sub->space.interpolate(a, b, report.invalid_at, s);
      CHECK_FALSE(sub->valid(s));
    }
  }
  CHECK(blocked > 50);
}

TEST_CASE("the density on the fibres of a subspace is one, fibre by fibre", "[guide][pca]") {
  for (const std::int64_t k : {1, 2}) {
    CAPTURE(k);
    const auto problem = arm_problem();
    auto parent = make_instance(problem);
    const auto guide = guide_of({{"dimensions", k}});
    const auto sub = guide->project(*parent);
    const auto& space = problem.space;
    // Over C it has the mass of that part of S's box that the subspace has inside of C.
    Stream stream(3, "pca", "density");
    Configuration q(3);
    Configuration s(static_cast<std::size_t>(k));
    constexpr int points = 200000;
    double mass = 0.0;
    double squares = 0.0;
    for (int i = 0; i < points; ++i) {
      space.sample_uniform(stream, q);
      guide->project(q, s);
      if (!sub->space.contains(s)) continue;
      const double p = std::exp(guide->log_fibre_density(q) + space.log_volume());
      mass += p / points;
      squares += p * p / points;
    }
    const double error = std::sqrt((squares - mass * mass) / points);
    int inside = 0;
    constexpr int tries = 100000;
    for (int i = 0; i < tries; ++i) {
      sub->space.sample_uniform(stream, s);
      guide->lift(s, stream, q);
      // Where the subspace has left C, what is lifted projects to something else.
      Configuration back(s.size());
      guide->project(q, back);
      inside += sub->space.distance(back, s) < 1e-9 ? 1 : 0;
    }
    const double expected = std::exp(sub->space.log_volume()) * inside / tries;
    CHECK(std::abs(mass - expected) < 5.0 * error + 0.01 * expected);
  }
}

namespace {

/// A plank among a block and a ball.
Problem plank_problem() {
  World3 world({{0, 0, 0}, {4, 3, 3}},
               {{"block", {Cuboid{{0.4, 3, 1}}, {{2, 1.5, 0.5}, {}}}}, {"ball", {Sphere{0.4}, {{2, 1.5, 2.2}, {}}}}});
  Problem problem;
  problem.name = "plank";
  problem.scene =
      std::make_shared<const SpatialScene>(std::move(world), Robot3("plank", {{Cuboid{{0.8, 0.5, 0.1}}, {}}}));
  problem.space = problem.scene->default_space(problem.scene->bounding_radius());
  const double half = std::sqrt(0.5);
  problem.start = {1, 1.5, 1, 0, half, 0, half};
  problem.goals = {{3, 1.5, 1.4, half, 0, 0, half}};
  problem.collision = "fcl";
  return problem;
}

}  // namespace

TEST_CASE("a subspace of a space with rotations is made of rotation vectors from the start", "[guide][pca][space]") {
  const Problem problem = plank_problem();
  auto parent = make_instance(problem);
  const auto guide = guide_of({{"samples", std::int64_t{60}}});
  const auto sub = guide->project(*parent);
  CHECK(sub->space.name() == "R^3 of SE(3)");
  CHECK(sub->space.dimension() == 3);
  CHECK(sub->valid(sub->start));
  CHECK(sub->valid(sub->goal()));
  // With its ends on it, the first coordinate is the distance from the start in the chart: of a turn about one axis.
  CHECK(sub->goal()[0] - sub->start[0] == Approx(problem.space.distance(problem.start, problem.goal())));
  Stream stream(5, "pca", "lift");
  Configuration s(3), back(3), q(7);
  for (int i = 0; i < 500; ++i) {
    sub->space.sample_uniform(stream, s);
    guide->lift(s, stream, q);
    REQUIRE(problem.space.contains(q));
    if (!sub->valid(s)) continue;
    guide->project(q, back);
    CHECK(sub->space.distance(back, s) < 1e-7);
  }
}

TEST_CASE("the density on the fibres of a subspace is one with rotations as well", "[guide][pca][space]") {
  const Problem problem = plank_problem();
  auto parent = make_instance(problem);
  for (const std::int64_t k : {1, 3, 5}) {
    CAPTURE(k);
    const auto guide = guide_of({{"dimensions", k}, {"samples", std::int64_t{60}}});
    const auto sub = guide->project(*parent);
    Stream stream(3, "pca", "density");
    Configuration q(7), s(static_cast<std::size_t>(k)), back(s.size());
    constexpr int points = 300000;
    double mass = 0.0, squares = 0.0, turned = 0.0;
    const auto distance = [&] { return problem.space.distance(problem.goal(), q); };
    for (int i = 0; i < points; ++i) {
      problem.space.sample_uniform(stream, q);
      guide->project(q, s);
      if (!sub->space.contains(s)) continue;
      const double p = std::exp(guide->log_fibre_density(q) + problem.space.log_volume());
      mass += p / points;
      squares += p * p / points;
      turned += p * distance() / points;
    }
    const double error = std::sqrt((squares - mass * mass) / points);
    int inside = 0;
    double mean = 0.0;
    constexpr int tries = 100000;
    for (int i = 0; i < tries; ++i) {
      sub->space.sample_uniform(stream, s);
      guide->lift(s, stream, q);
      guide->project(q, back);
      if (!(sub->space.distance(back, s) < 1e-7)) continue;
      ++inside;
      mean += distance();
    }
    const double expected = std::exp(sub->space.log_volume()) * inside / tries;
    CHECK(std::abs(mass - expected) < 5.0 * error + 0.01 * expected);
    CHECK(turned / mass == Approx(mean / inside).epsilon(0.05));
  }
}

TEST_CASE("motions of a subspace with rotations are short ones of C, which stay near it", "[guide][pca][space]") {
  const Problem problem = plank_problem();
  auto parent = make_instance(problem);
  const auto guide = guide_of({{"samples", std::int64_t{60}}});
  const auto sub = guide->project(*parent);
  Stream stream(2, "pca", "motions");
  Configuration a(3), b(3), s(3);
  int blocked = 0, free = 0;
  for (int i = 0; i < 3000; ++i) {
    sub->space.sample_uniform(stream, a);
    sub->space.sample_uniform(stream, b);
    if (!sub->valid(a)) continue;
    const MotionReport report = sub->motion(a, b);
    blocked += report.valid ? 0 : 1;
    free += report.valid ? 1 : 0;
    if (!report.valid) continue;
    int in_a_row = 0;
    for (int k = 1; k <= 100; ++k) {
      sub->space.interpolate(a, b, k / 100.0, s);
      in_a_row = sub->valid(s) ? 0 : in_a_row + 1;
      // Contacts thinner than the resolution, or than the distance from the shortest motion of C, may be missed.
      CHECK(in_a_row < 12);
    }
  }
  CHECK(blocked > 20);
  CHECK(free > 15);
}

TEST_CASE("on a fibre of one dimension lifted samples are uniform", "[guide][pca]") {
  const auto problem = arm_problem();
  auto parent = make_instance(problem);
  const auto guide = guide_of({{"dimensions", std::int64_t{2}}});
  const auto sub = guide->project(*parent);
  Stream stream(4, "pca", "fibre");
  Configuration q(3);
  constexpr int draws = 4000;
  std::vector<double> along;
  for (int i = 0; i < draws; ++i) {
    guide->lift(sub->start, stream, q);
    along.push_back(q[1]);
    // One over the length of the fibre, wherever on it.
    CHECK(guide->log_fibre_density(q) == Approx(guide->log_fibre_density(problem.start)));
  }
  std::sort(along.begin(), along.end());
  const double length = along.back() - along.front();
  REQUIRE(length > 0.1);
  for (const double share : {0.25, 0.5, 0.75}) {
    const double at = along[static_cast<std::size_t>(share * draws)];
    CHECK((at - along.front()) / length == Approx(share).margin(0.04));
  }
}

TEST_CASE("a subspace is fitted to stored paths, and nothing is checked for it", "[guide][pca]") {
  const test::Folder folder;
  const std::string file = folder.file("paths.db");
  const Problem problem = arm_problem({});
  // All that is stored turns the last joint alone; start and goal differ in another.
  Configurations path(3);
  path.push(Configuration{1.8, 0.3, -1.0});
  path.push(Configuration{1.8, 0.3, 1.0});
  {
    Library library(file, Library::Mode::write);
    CHECK(library.add(stored_path(problem, path), problem.space, 0.0));
  }
  auto parent = make_instance(problem);
  const auto guide = guide_of({{"dimensions", std::int64_t{1}}, {"ends", false}, {"db", file}});
  const auto sub = guide->project(*parent);
  CHECK(sub->checks.validity == 0);
  Configuration a(1);
  Configuration b(1);
  const auto apart = [&](const Configuration& from, const Configuration& to) {
    guide->project(from, a);
    guide->project(to, b);
    return std::abs(a[0] - b[0]);
  };
  CHECK(apart({1.8, 0.3, -0.5}, {1.8, 0.3, 0.5}) == Approx(problem.space.axes()[2].weight));
  CHECK(apart({1.8, 0.3, 0.0}, {1.8, 0.6, 0.0}) == Approx(0.0).margin(1e-9));

  const auto other = make_instance(test::cup_problem());
  CHECK_THROWS_WITH(guide_of({{"db", file}})->project(*other),
                    Contains("has 1 paths, and none of this robot in SE(2)") && Contains("--learn"));
}

TEST_CASE("a failed fit is reported", "[guide][pca]") {
  auto parent = make_instance(arm_problem());
  CHECK_THROWS_WITH(guide_of({{"dimensions", std::int64_t{3}}})->project(*parent),
                    Contains("fewer dimensions than SO(2) x R x SO(2), which has 3"));
  const auto walled =
      test::make_problem("walled", test::rectangle_world({{0, 0, 10, 9.99}}), Robot::disc(1.0), {5, 5}, {6, 5});
  auto closed = make_instance(walled);
  CHECK_THROWS_WITH(guide_of({{"samples", std::int64_t{2}}})->project(*closed),
                    Contains("none of 100 checked configurations") && Contains("is valid"));
}
