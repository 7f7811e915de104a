// SPDX-License-Identifier: GPL-3.0-or-later
// Angles by handle points on the medial axis.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/handles.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// A corridor 1.2 m wide that runs to the right and then upwards, and a rod of 1.6 m.
Problem bent_corridor() {
  return test::make_problem("corridor", test::rectangle_world({{0, 1.2, 8.8, 10}}),
                            Robot::rigid({Box2{{-0.8, -0.1}, {0.8, 0.1}}}), {1, 0.6, 0},
                            {9.4, 9, 0.5 * std::numbers::pi});
}

/// A car and its trailer, each with an angle of its own in the world.
Problem with_trailer() {
  Body car{.parts = {Polygon{rectangle_vertices({{-0.5, -0.2}, {0.5, 0.2}})}}, .joint = {}, .angle_axis = 2};
  Body trailer{.parts = {Polygon{rectangle_vertices({{-1.2, -0.2}, {-0.2, 0.2}})}},
               .parent = 0,
               .joint = {-0.5, 0},
               .angle_axis = 3,
               .absolute = true};
  return test::make_problem("trailer", test::rectangle_world({{0, 1.6, 8.4, 10}}), Robot("truck", {car, trailer}),
                            {3, 0.8, 0, 0}, {9.2, 9, 0.5 * std::numbers::pi, 0.5 * std::numbers::pi});
}

/// The angle between a line and a direction, in either orientation.
double off(double angle, double direction) { return std::abs(std::remainder(angle - direction, std::numbers::pi)); }

}  // namespace

TEST_CASE("handles on the medial axis turn a body along its corridor", "[guide][handles]") {
  const Problem problem = bent_corridor();
  const auto parent = make_instance(problem);
  const auto position = std::make_shared<PositionProjection>("workspace", *parent);
  const HandleLift lift(position, *parent);
  Configuration q(3);
  int along = 0;
  constexpr int draws = 2000;
  for (const auto& [place, direction] :
       {std::pair(Configuration{4, 0.6}, 0.0), std::pair(Configuration{9.4, 6}, 0.5 * std::numbers::pi)}) {
    Stream stream(1, "0", "lift");
    along = 0;
    for (int i = 0; i < draws; ++i) {
      lift.lift(place, stream, q);
      CHECK(q[0] == place[0]);
      CHECK(q[1] == place[1]);
      along += off(q[2], direction) < 0.35 ? 1 : 0;
    }
    CAPTURE(direction);
    // Uniform angles lie so near in 22 of a hundred.
    CHECK(along > draws * 3 / 4);
    q[0] = place[0];
    q[1] = place[1];
    lift.set_likely_angles(q);
    CHECK(off(q[2], direction) < 0.1);
  }
}

TEST_CASE("the density of angles by handles is that of their draws", "[guide][handles][slow]") {
  for (const Problem& problem : {bent_corridor(), with_trailer()}) {
    CAPTURE(problem.name);
    const auto parent = make_instance(problem);
    const auto position = std::make_shared<PositionProjection>("workspace", *parent);
    const HandleLift lift(position, *parent);
    const std::size_t d = parent->space.dimension();
    // Over a fibre the density integrates to 1, and the share of the draws where it is above its median is what it
    // says.
    Configuration q(d);
    Stream stream(7, "0", "fibre");
    for (const Configuration& place : {Configuration{4, 0.6}, Configuration{8.2, 0.8}, Configuration{9.3, 3}}) {
      constexpr int points = 20000;
      std::vector<double> densities;
      double mean = 0.0;
      const double fibre = std::exp(-position->log_fibre_density(parent->start));
      for (int i = 0; i < points; ++i) {
        position->lift(place, stream, q);
        densities.push_back(std::exp(lift.log_fibre_density(q)) * fibre);
        mean += densities.back() / points;
      }
      CHECK(mean == Approx(1.0).margin(0.06));
      std::vector<double> sorted = densities;
      std::nth_element(sorted.begin(), sorted.begin() + points / 2, sorted.end());
      const double middle = sorted[points / 2];
      double expected = 0.0;
      for (const double density : densities) expected += density > middle ? density / points : 0.0;
      double drawn = 0.0;
      for (int i = 0; i < points; ++i) {
        lift.lift(place, stream, q);
        drawn += std::exp(lift.log_fibre_density(q)) * fibre > middle ? 1.0 / points : 0.0;
      }
      CHECK(drawn == Approx(expected).margin(0.06));
      CHECK(drawn > 0.55);
    }
  }
}

TEST_CASE("a path is moved to the medial axis where it sees it", "[guide][handles]") {
  const Problem problem = bent_corridor();
  const auto parent = make_instance(problem);
  const auto position = std::make_shared<PositionProjection>("workspace", *parent);
  const auto point = position->point_instance(*parent);
  Configurations path(2);
  path.push(Configuration{1, 0.2});
  path.push(Configuration{8, 0.1});
  path.push(Configuration{9.9, 2});
  path.push(Configuration{9.9, 9});
  const Configurations moved = HandleLift(position, *parent).on_axis(path, *point);
  CHECK(point->checks.motion > 0);
  REQUIRE(moved.size() > 40);
  CHECK(Configuration(moved[0].begin(), moved[0].end()) == Configuration{1, 0.2});
  CHECK(Configuration(moved[moved.size() - 1].begin(), moved[moved.size() - 1].end()) == Configuration{9.9, 9});
  std::size_t central = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) central += point->clearance(moved[i]) > 0.55 ? 1 : 0;
  CHECK(central * 10 > moved.size() * 8);
}

TEST_CASE("the whole robot moves until its handles are nearest to the medial axis", "[guide][handles]") {
  for (const Problem& problem : {bent_corridor(), with_trailer()}) {
    CAPTURE(problem.name);
    const auto parent = make_instance(problem);
    const auto position = std::make_shared<PositionProjection>("workspace", *parent);
    const HandleLift lift(position, *parent);
    Stream stream(5, "0", "near");
    Configuration q(parent->space.dimension());
    double before = 0.0;
    double after = 0.0;
    for (int i = 0; i < 200; ++i) {
      q = problem.start;
      q[0] += stream.uniform(-0.5, 0.5);
      q[1] += stream.uniform(-0.4, 0.4);
      for (std::size_t j = 2; j < q.size(); ++j) q[j] += stream.uniform(-0.4, 0.4);
      const Configuration placed = q;
      before += lift.distance(q);
      lift.draw_near(q);
      CHECK(parent->space.contains(q));
      CHECK(lift.distance(q) <= lift.distance(placed));
      after += lift.distance(q);
      // Another call gains next to nothing.
      const double reached = lift.distance(q);
      lift.draw_near(q);
      CHECK(lift.distance(q) > 0.7 * reached - 0.01);
    }
    CHECK(after < 0.25 * before);
  }
}

TEST_CASE("the path of the workspace is lifted to robots whose handles lie near the medial axis", "[guide][handles]") {
  const Problem problem = bent_corridor();
  const auto parent = make_instance(problem);
  const GuideKind& kind = *find_guide("workspace");
  const HandleLift lift(std::make_shared<PositionProjection>("workspace", *parent), *parent);
  const auto guide = kind.make(Options::validate(*kind.component, {{"lift", std::string("handles")}}));
  const auto sub = guide->project(*parent);
  guide->attach(*sub);
  UniformGuidance uniform(sub->space);
  Search search(2);
  const PlannerKind& planner = *find_planner(kind.default_planner);
  const Options options = Options::validate(*planner.component, {});
  const Solution found = planner.make(options, {*sub, uniform, Stream(1, "0/0", "proposals"), search, false})
                             ->solve(uniform, planner.common(options).budget);
  REQUIRE(found.solved());
  const auto h = guide->heuristic(*parent, sub.get(), &found);
  const Configurations path = h->lifted_path();
  REQUIRE(path.size() > 10);
  std::size_t near = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    CHECK(parent->valid(path[i]));
    near += lift.distance(path[i]) < 0.1 ? 1 : 0;
  }
  CHECK(near * 10 > path.size() * 8);
}

TEST_CASE("handles are points of the robot that a script gives", "[guide][handles]") {
  const Problem truck = with_trailer();
  const auto parent = make_instance(truck);
  const auto position = std::make_shared<PositionProjection>("workspace", *parent);
  const auto handles = parse_handles("workspace", {"0.5, 0", "2: -1.2,0.1"}, planar(*truck.scene).robot);
  REQUIRE(handles.size() == 2);
  CHECK(handles[0].body == 0);
  CHECK(handles[1].body == 1);
  CHECK(handles[1].point.y == 0.1);
  // The car's nose alone is drawn to the axis, the rest of it is left where it is.
  const HandleLift nose(position, *parent, parse_handles("workspace", {"0.5, 0"}, planar(*truck.scene).robot));
  const HandleLift ends(position, *parent);
  Configuration q = truck.start;
  q[1] += 0.3;
  const Configuration placed = q;
  nose.draw_near(q);
  CHECK(nose.distance(q) < nose.distance(placed));
  CHECK(nose.distance(placed) != Approx(ends.distance(placed)));
  const auto fault = [&](const std::string& text) {
    try {
      static_cast<void>(parse_handles("workspace", {text}, planar(*truck.scene).robot));
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const std::string wrong : {"", "1", "1 2", "1, x", "0: 1, 2", ": 1, 2", "1, 2, 3"}) {
    CAPTURE(wrong);
    CHECK(fault(wrong).find("expected \"x, y\"") != std::string::npos);
  }
  CHECK(fault("3: 1, 2").find("has bodies 1 to 2") != std::string::npos);
}
