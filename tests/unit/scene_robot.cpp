// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "unit/scene_brute.hpp"

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/recentred.hpp>

using namespace trellis;
using Catch::Matchers::Contains;
using test::fault_of;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double inf = std::numeric_limits<double>::infinity();

Body box_body(const Box2& box, int parent, Vec2 joint, int axis, bool absolute = false) {
  Body body;
  body.parts = {Polygon{rectangle_vertices(box)}};
  body.parent = parent;
  body.joint = joint;
  body.angle_axis = axis;
  body.absolute = absolute;
  return body;
}

Robot car_with_trailer() {
  return {"car",
          {box_body({{-0.25, -0.125}, {0.25, 0.125}}, -1, {}, 2),
           box_body({{-0.65, -0.125}, {-0.35, 0.125}}, 0, {}, 3, true)}};
}

Robot arm(int links, bool absolute) {
  std::vector<Body> bodies;
  bodies.reserve(static_cast<std::size_t>(links));
  for (int i = 0; i < links; ++i) {
    bodies.push_back(box_body({{0, -0.05}, {1, 0.05}}, i - 1, i == 0 ? Vec2{0, 0} : Vec2{1, 0}, i, absolute));
  }
  return {"arm", std::move(bodies), false, {5, 5}};
}

std::vector<Vec2> points_of(const Robot& robot, View q, const std::vector<std::pair<std::size_t, Vec2>>& marks) {
  std::vector<Pose2> poses(robot.bodies().size());
  robot.place(q, poses);
  std::vector<Vec2> points;
  points.reserve(marks.size());
  for (const auto& [body, p] : marks) points.push_back(poses[body](p));
  return points;
}

// Vertices and random inner points of every body.
std::vector<std::pair<std::size_t, Vec2>> marks_of(const Robot& robot, Stream& stream) {
  std::vector<std::pair<std::size_t, Vec2>> marks;
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    for (const auto& part : robot.bodies()[i].parts) {
      if (const auto* disc = std::get_if<Disc>(&part)) {
        const double angle = stream.uniform(0, 2 * pi);
        marks.emplace_back(i, disc->centre + disc->radius * Vec2{std::cos(angle), std::sin(angle)});
        continue;
      }
      const auto& v = std::get<Polygon>(part).vertices;
      for (const Vec2 p : v) marks.emplace_back(i, p);
      const double s = stream.uniform(), t = stream.uniform();
      marks.emplace_back(i, v[0] + s * (v[1] - v[0]) + (1 - s) * t * (v[2] - v[0]));
    }
  }
  return marks;
}

// The length of the path of every point along the motion, by small steps, never exceeds the bound.
void check_displacement(const Robot& robot, const Space& space, std::uint64_t seed) {
  Stream stream(seed, "0", "displacement");
  double tightest = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    Configuration a(space.dimension()), b(space.dimension()), q(space.dimension());
    space.sample_uniform(stream, a);
    space.sample_uniform(stream, b);
    if (trial % 2 == 0) {
      for (std::size_t j = 0; j < b.size(); ++j) b[j] = a[j] + 0.05 * (b[j] - a[j]);
      space.normalise(b);
    }
    const double bound = robot.displacement_bound(space, a, b);
    const auto marks = marks_of(robot, stream);
    auto last = points_of(robot, a, marks);
    std::vector<double> distance(marks.size(), 0.0);
    constexpr int steps = 60;
    for (int k = 1; k <= steps; ++k) {
      space.interpolate(a, b, static_cast<double>(k) / steps, q);
      const auto now = points_of(robot, q, marks);
      for (std::size_t i = 0; i < marks.size(); ++i) distance[i] += norm(now[i] - last[i]);
      last = now;
    }
    const double longest = *std::max_element(distance.begin(), distance.end());
    REQUIRE(longest <= bound + 1e-9);
    tightest = std::max(tightest, longest / bound);
  }
  // A bound that is never nearly met would cost needless checks.
  CHECK(tightest > 0.5);
}

}  // namespace

TEST_CASE("a world checks its obstacles and names the faulty one", "[scene][world]") {
  const Box2 bounds{{0, 0}, {10, 10}};
  const auto fault = [&](Shape shape, const std::string& name = "obstacle 3 (mine)") {
    return fault_of([&] { World(bounds, {{"first", Box2{{1, 1}, {2, 2}}}, {name, std::move(shape)}}); });
  };
  CHECK_THAT(fault(Box2{{1, 1}, {1, 2}}), Contains("obstacle 3 (mine)") && Contains("xmin < xmax"));
  CHECK_THAT(fault(Box2{{1, 1}, {2, inf}}), Contains("obstacle 3 (mine)"));
  CHECK_THAT(fault(Disc{{1, 1}, 0.0}),
             Contains("obstacle 3 (mine)") && Contains("radius greater than 0 and at most 1e+09 m, got 0"));
  CHECK_THAT(fault(Disc{{1, 1}, -1.0}), Contains("got -1"));
  CHECK_THAT(fault(Disc{{inf, 1}, 1.0}), Contains("centre within 1e+09 m of 0"));
  CHECK_THAT(fault(Polygon{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}), Contains("obstacle 3 (mine)") && Contains("meets"));
  CHECK_THAT(fault(Disc{{1, 1}, 0.0}, ""), Contains("obstacle 2"));
  CHECK_THAT(fault_of([] { World({{0, 0}, {0, 1}}, {}); }), Contains("boundary"));
}

TEST_CASE("a world splits polygons and remembers whose parts they are", "[scene][world]") {
  const Polygon l{{{0, 0}, {0, 2}, {1, 2}, {1, 1}, {2, 1}, {2, 0}}};  // clockwise
  const World world({{-1, -1}, {10, 10}}, {{"", Box2{{4, 4}, {5, 5}}}, {"l", l}, {"d", Disc{{8, 8}, 1}}});
  CHECK(world.obstacles()[0].name == "obstacle 1");
  CHECK(brute::area(std::get<Polygon>(world.obstacles()[1].shape)) == Approx(3.0));
  REQUIRE(world.parts().size() == 4);
  CHECK(world.parts()[0].obstacle == 0);
  CHECK(world.parts()[1].obstacle == 1);
  CHECK(world.parts()[2].obstacle == 1);
  CHECK(world.parts()[3].obstacle == 2);
  CHECK(world.parts()[3].shape == ConvexShape(Disc{{8, 8}, 1}));
}

TEST_CASE("a robot refuses what cannot move", "[scene][robot]") {
  const Box2 box{{0, 0}, {1, 1}};
  CHECK_THAT(fault_of([] { Robot("r", {}); }), Contains("robot 'r'") && Contains("at least one body"));
  CHECK_THAT(fault_of([&] { Robot("r", {box_body(box, 0, {}, 2)}); }), Contains("body 1") && Contains("earlier body"));
  CHECK_THAT(fault_of([&] { Robot("r", {box_body(box, -1, {}, 1)}); }), Contains("axis 2 or a later one"));
  CHECK_THAT(fault_of([&] { Robot("r", {box_body(box, -1, {}, 3)}); }), Contains("axis 2") && Contains("no body"));
  CHECK_THAT(fault_of([&] { Robot("r", {box_body(box, -1, {}, -1)}, false); }), Contains("nothing moves it"));
  CHECK_THAT(fault_of([&] { Robot("r", {box_body(box, -1, {inf, 0}, 2)}); }), Contains("joint of body 1"));
  Body bent;
  bent.parts = {Polygon{{{0, 0}, {2, 0}, {1, 0.5}, {0, 2}}}};
  CHECK_THAT(fault_of([&] { Robot("r", {bent}); }), Contains("part 1 of body 1") && Contains("convex"));
  CHECK_THAT(fault_of([] { Robot::disc(0.0); }), Contains("radius greater than 0"));
  CHECK_THAT(fault_of([] { Robot::rigid({Box2{{0, 0}, {0, 1}}}); }), Contains("shape 1"));
}

TEST_CASE("simple robots know their size", "[scene][robot]") {
  CHECK(Robot::point().is_point());
  CHECK(Robot::point().dimension() == 2);
  CHECK(Robot::point().bounding_radius() == 0.0);
  CHECK(Robot::point().inscribed_radius() == 0.0);

  const Robot disc = Robot::disc(0.5);
  CHECK_FALSE(disc.is_point());
  CHECK(disc.bounding_radius() == 0.5);
  CHECK(disc.inscribed_radius() == 0.5);

  const Robot box = Robot::rigid({Box2{{-2, -1}, {2, 1}}});
  CHECK(box.dimension() == 3);
  CHECK(box.bounding_radius() == Approx(std::sqrt(5.0)));
  CHECK(box.inscribed_radius() == Approx(1.0));
  CHECK(Robot::rigid({Box2{{-2, -1}, {2, 1}}}, false).dimension() == 2);
  CHECK(Robot::rigid({Box2{{1, 1}, {2, 2}}}).inscribed_radius() == 0.0);

  // The seam between convex parts is no border: the largest disc reaches across it.
  const Robot plus = Robot::rigid({Polygon{
      {{-3, -1}, {-1, -1}, {-1, -3}, {1, -3}, {1, -1}, {3, -1}, {3, 1}, {1, 1}, {1, 3}, {-1, 3}, {-1, 1}, {-3, 1}}}});
  CHECK(plus.bodies()[0].parts.size() > 1);
  CHECK(plus.inscribed_radius() == Approx(std::sqrt(2.0)));

  const Robot car = car_with_trailer();
  CHECK(car.dimension() == 4);
  CHECK(car.bounding_radius() == Approx(std::hypot(0.65, 0.125)));
  CHECK(car.inscribed_radius() == Approx(0.125));
  CHECK(arm(3, false).bounding_radius() == Approx(2.0 + std::hypot(1.0, 0.05)));

  // A joint off the reference point: known while nothing turns, carried around by a turn.
  CHECK(Robot("still", {box_body({{-1, -1}, {1, 1}}, -1, {0.5, 0}, -1)}).inscribed_radius() == Approx(0.5));
  CHECK(Robot("still", {box_body({{-1, -1}, {1, 1}}, -1, {0.5, 0}, -1)}).bounding_radius() ==
        Approx(std::hypot(1.5, 1)));
  CHECK(Robot("turns", {box_body({{-1, -1}, {1, 1}}, -1, {0.5, 0}, 2)}).inscribed_radius() == Approx(0.5));
  CHECK(Robot("turns", {box_body({{-1, -1}, {1, 1}}, -1, {0.5, 0}, 2)}).bounding_radius() ==
        Approx(0.5 + std::sqrt(2.0)));
}

TEST_CASE("bodies are placed along their chain", "[scene][robot]") {
  SECTION("an arm with relative and with absolute angles") {
    const double a = 0.3, b = -1.1, c = 2.0;
    const auto tip = [](const Robot& robot, const Configuration& q) { return points_of(robot, q, {{2, {1, 0}}})[0]; };
    const Vec2 expected = Vec2{5, 5} + Vec2{std::cos(a), std::sin(a)} + Vec2{std::cos(a + b), std::sin(a + b)} +
                          Vec2{std::cos(a + b + c), std::sin(a + b + c)};
    CHECK(norm(tip(arm(3, false), {a, b, c}) - expected) < 1e-14);
    CHECK(norm(tip(arm(3, true), {a, a + b, a + b + c}) - expected) < 1e-14);
  }
  SECTION("a trailer is jointed to the car and has its own heading") {
    const auto p = points_of(car_with_trailer(), Configuration{1, 2, 0.7, pi / 2}, {{1, {-0.5, 0}}})[0];
    CHECK(norm(p - Vec2{1, 1.5}) < 1e-15);
  }
  SECTION("a body without an axis keeps its parent's angle") {
    const Robot robot("r", {box_body({{0, 0}, {1, 1}}, -1, {}, 2), box_body({{0, 0}, {1, 1}}, 0, {2, 0}, -1)});
    const auto p = points_of(robot, Configuration{0, 0, pi / 2}, {{1, {1, 0}}})[0];
    CHECK(norm(p - Vec2{0, 3}) < 1e-15);
  }
  SECTION("the joint of a root is an offset that does not turn") {
    const Robot robot("r", {box_body({{0, 0}, {1, 1}}, -1, {1, 0}, 2)});
    CHECK(norm(points_of(robot, Configuration{3, 4, pi / 2}, {{0, {1, 0}}})[0] - Vec2{4, 5}) < 1e-15);
  }
}

TEST_CASE("a scaled robot is the same figure about the reference point", "[scene][robot]") {
  Stream stream(5, "0", "scaled");
  for (const Robot& robot : {car_with_trailer(), Robot::rigid({Box2{{-1, 0}, {2, 1}}, Disc{{0.5, 0.5}, 1}})}) {
    for (const double factor : {0.1, 0.5, 2.0}) {
      const Robot small = robot.scaled(factor);
      Configuration q(robot.dimension());
      for (double& x : q) x = stream.uniform(-3, 3);
      auto marks = marks_of(robot, stream);
      const auto before = points_of(robot, q, marks);
      for (auto& [body, p] : marks) p = factor * p;
      const auto after = points_of(small, q, marks);
      const Vec2 reference{q[0], q[1]};
      for (std::size_t i = 0; i < marks.size(); ++i) {
        CHECK(norm((after[i] - reference) - factor * (before[i] - reference)) < 1e-12);
      }
      CHECK(small.bounding_radius() == Approx(factor * robot.bounding_radius()));
      CHECK(small.inscribed_radius() == Approx(factor * robot.inscribed_radius()));
    }
  }
  CHECK_THROWS_AS(Robot::disc(1).scaled(0.0), Error);
  CHECK_THROWS_AS(Robot::disc(1).scaled(-inf), Error);
}

TEST_CASE("a thinned arm keeps its joints and lies within the whole arm", "[scene][robot]") {
  // Links of every kind: a rectangle, a tapered one, one bent to a side, a hand of two parts beside its axis.
  Body upper = box_body({{-0.2, -0.3}, {2, 0.3}}, -1, {}, 0);
  Body taper;
  taper.parts = {Polygon{{{0, -0.2}, {1.5, -0.05}, {1.5, 0.1}, {0, 0.2}}}};
  taper.parent = 0;
  taper.joint = {2, 0};
  taper.angle_axis = 1;
  Body bent;
  bent.parts = {Polygon{{{-0.1, -0.1}, {1, 0.8}, {0.9, 1.1}, {-0.1, 0.1}}}};
  bent.parent = 1;
  bent.joint = {1.5, 0};
  bent.angle_axis = 2;
  Body hand;
  hand.parts = {Polygon{{{0, 0.1}, {0.5, 0.1}, {0.4, 0.3}}}, Disc{{0.2, -0.2}, 0.15}};
  hand.parent = 2;
  hand.joint = {0.9, 0.9};
  hand.angle_axis = 3;
  const Robot whole = Robot("arm", {upper, taper, bent, hand}, false, {1, 2})
                          .apart({{0, 2}})
                          .limited({std::nullopt, std::pair(-2.0, 2.0)});
  for (const double factor : {0.01, 0.3, 0.5, 0.9, 1.0}) {
    const Robot thin = whole.thinned(factor);
    CHECK(thin.pairs() == whole.pairs());
    CHECK(thin.limits() == whole.limits());
    REQUIRE(thin.bodies().size() == whole.bodies().size());
    Stream stream(8, "0", "thinned");
    std::vector<Pose2> poses(4), same(4);
    const Configuration q{0.3, -0.4, 1.2, 2.5};
    whole.place(q, poses);
    thin.place(q, same);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      CHECK(poses[i]({0.7, -0.2}) == same[i]({0.7, -0.2}));
      for (std::size_t k = 0; k < whole.bodies()[i].parts.size(); ++k) {
        const ConvexShape& part = whole.bodies()[i].parts[k];
        const ConvexShape& small = thin.bodies()[i].parts[k];
        if (const auto* disc = std::get_if<Disc>(&part)) {
          CHECK(std::get<Disc>(small) == Disc{disc->centre, factor * disc->radius});
          continue;
        }
        const auto& outer = std::get<Polygon>(part).vertices;
        const auto& inner = std::get<Polygon>(small).vertices;
        double area = 0.0, thin_area = 0.0;
        for (std::size_t a = 0; a < outer.size(); ++a) {
          const std::size_t b = (a + 1) % outer.size();
          area += 0.5 * cross(outer[a], outer[b]);
          thin_area += 0.5 * cross(inner[a], inner[b]);
          for (const Vec2 p : inner) CHECK(cross(outer[b] - outer[a], p - outer[a]) > -1e-12);
        }
        CHECK(thin_area == Approx(factor * area));
      }
    }
    const Space space = default_space(whole, World({{0, 0}, {10, 10}}, {}), 1 / pi);
    Configuration a(4), b(4);
    space.sample_uniform(stream, a);
    space.sample_uniform(stream, b);
    CHECK(thin.displacement_bound(space, a, b) == whole.displacement_bound(space, a, b));
  }
  const Robot plain = Robot::arm({.links = {2, 1}, .widths = {0.4, 0.2}}).thinned(0.5);
  CHECK(std::get<Polygon>(plain.bodies()[0].parts[0]).vertices == rectangle_vertices({{0, -0.1}, {2, 0.1}}));
  CHECK(std::get<Polygon>(plain.bodies()[1].parts[0]).vertices == rectangle_vertices({{0, -0.05}, {1, 0.05}}));
  CHECK_THROWS_AS(whole.thinned(0.0), Error);
}

TEST_CASE("no point moves farther than the displacement bound", "[scene][robot]") {
  const World world({{0, 0}, {10, 10}}, {});
  const auto check = [&](const Robot& robot, std::uint64_t seed) {
    check_displacement(robot, default_space(robot, world, 1 / pi), seed);
  };
  check(Robot::rigid({Box2{{-0.5, -0.25}, {1.5, 0.25}}}), 1);
  check(Robot::disc(0.4), 2);
  check(car_with_trailer(), 3);
  check(arm(1, false), 4);
  check(arm(2, true), 5);
  const Robot offset("offset", {box_body({{0, 0}, {1, 1}}, -1, {1, 2}, 2), box_body({{0, 0}, {1, 1}}, 0, {1, 1}, -1)});
  check(offset, 6);
}

TEST_CASE("the displacement bound covers its cases", "[scene][robot]") {
  const Robot bar = Robot::rigid({Box2{{-1, -0.1}, {1, 0.1}}});
  const Space space = default_space(bar, World({{0, 0}, {10, 10}}, {}), 1 / pi);
  const double r = std::hypot(1, 0.1);
  CHECK(bar.displacement_bound(space, Configuration{1, 1, 0}, Configuration{4, 5, 0}) == Approx(5));
  CHECK(bar.displacement_bound(space, Configuration{1, 1, 3}, Configuration{1, 1, -3}) == Approx(r * (2 * pi - 6)));
  // Long chains leave the stack's buffers.
  const Robot chain = arm(40, false);
  const Space joints = default_space(chain, World({{0, 0}, {10, 10}}, {}), 1 / pi);
  Configuration a(40, 0.0), b(40, 0.0);
  b[0] = 0.1;
  CHECK(chain.displacement_bound(joints, a, b) == Approx(0.1 * (39 + std::hypot(1, 0.05))));
  // An absolute child does not turn with its parent.
  const Robot car = car_with_trailer();
  const Space c = default_space(car, World({{0, 0}, {10, 10}}, {}), 1 / pi);
  CHECK(car.displacement_bound(c, Configuration{1, 1, 0, 0}, Configuration{1, 1, 1, 0}) ==
        Approx(std::hypot(0.25, 0.125)));
}

TEST_CASE("every robot has a default space", "[scene][robot]") {
  const World world({{-1, 0}, {10, 5}}, {});
  CHECK(default_space(Robot::point(), world, 1.0) == Space::euclidean({{-1, 10}, {0, 5}}));
  CHECK(default_space(Robot::rigid({Box2{{0, 0}, {1, 1}}}), world, 0.4) == Space::se2({-1, 10}, {0, 5}, 0.4));
  const Space car = default_space(car_with_trailer(), world, 0.4);
  CHECK(car.name() == "R^2 x SO(2)^2");
  REQUIRE(car.dimension() == 4);
  CHECK(car.axes()[2].name == "theta");
  CHECK(car.axes()[3].name == "theta2");
  CHECK(car.axes()[3].weight == 0.4);
  CHECK(car.axes()[3].periodic);
  CHECK(default_space(arm(3, false), world, 0.4).name() == "SO(2)^3");
  CHECK(default_space(arm(1, false), world, 0.4).name() == "SO(2)");
  CHECK(default_space(arm(3, false), world, 0.4).dimension() == 3);
}

TEST_CASE("an arm is a chain of links with limits, whose distant links are self-collision pairs", "[scene][robot]") {
  const World world({{-5, -5}, {5, 5}}, {});
  Arm description{.links = {2, 1.5, 1}, .widths = {0.2, 0.1, 0.1}, .base = {1, 0}};
  description.limits = {std::nullopt, std::pair(-2.0, 1.0)};
  const Robot robot = Robot::arm(description);
  CHECK(robot.body_name(1) == "link 2");
  CHECK(robot.pairs() == std::vector<std::pair<std::size_t, std::size_t>>{{0, 2}});
  CHECK(robot.scaled(0.5).pairs() == robot.pairs());
  const auto tips = points_of(robot, Configuration{pi / 2, -pi / 2, pi / 2}, {{0, {2, 0}}, {1, {1.5, 0}}, {2, {1, 0}}});
  CHECK(norm(tips[0] - Vec2{1, 2}) < 1e-12);
  CHECK(norm(tips[1] - Vec2{2.5, 2}) < 1e-12);
  CHECK(norm(tips[2] - Vec2{2.5, 3}) < 1e-12);

  const Space space = default_space(robot, world, 0.4);
  CHECK(space.name() == "SO(2) x R x SO(2)");
  REQUIRE(space.dimension() == 3);
  CHECK(space.axes()[0].periodic);
  CHECK(space.axes()[1] == Axis{"theta2", -2.0, 1.0, 0.4, false});
  CHECK(space.axes()[2].name == "theta3");

  description.self_collision = false;
  CHECK(Robot::arm(description).pairs().empty());
}

TEST_CASE("an axis with limits may be longer than a turn, and does not wrap", "[scene][robot]") {
  const World world({{-5, -5}, {5, 5}}, {});
  for (const double degrees : {270.0, 360.0, 720.0}) {
    CAPTURE(degrees);
    const double most = degrees * pi / 180.0;
    Arm description{.links = {2, 1}, .widths = {0.2, 0.1}};
    description.limits = {std::pair(-most, most)};
    const Space space = default_space(Robot::arm(description), world, 0.5);
    CHECK(space.name() == "R x SO(2)");
    CHECK(space.axes()[0] == Axis{"theta", -most, most, 0.5, false});
    // Angles a turn apart are different configurations, half the extent of a motion as far as its angle is long.
    const Configuration a = {-0.5 * most, 0};
    const Configuration b = {0.5 * most, 0};
    CHECK(space.distance(a, b) == Approx(0.5 * most));
    CHECK(Robot::arm(description).displacement_bound(space, a, b) >= 3.0 * most);
    CHECK(space.diameter() == Approx(std::hypot(most, 0.5 * pi)));
    Configuration middle(2);
    space.interpolate(a, b, 0.5, middle);
    CHECK(middle[0] == 0.0);
  }
}

TEST_CASE("an impossible arm is an error", "[scene][robot]") {
  const auto fault = [](const Arm& arm) { return fault_of([&] { static_cast<void>(Robot::arm(arm)); }); };
  CHECK_THAT(fault({}), Contains("at least one link"));
  CHECK_THAT(fault({.links = {1, 0}, .widths = {1, 1}}), Contains("length of link 2") && Contains("got 0"));
  CHECK_THAT(fault({.links = {1, 1}, .widths = {1, inf}}), Contains("width of link 2"));
  CHECK_THAT(fault({.links = {1, 1}, .widths = {1}}), Contains("2 links and 1 widths"));
  CHECK_THAT(fault({.links = {1}, .widths = {1}, .base = {}, .limits = {std::pair(1.0, -1.0)}}),
             Contains("limits of joint 1") && Contains("got 1 and -1"));
  CHECK_THAT(fault({.links = {1}, .widths = {1}, .base = {}, .limits = {std::pair(-180.0, 180.0)}}),
             Contains("limits of joint 1") && Contains("in radians, within 20 turns (125.7 rad) of 0") &&
                 Contains("got -180 and 180") && Contains("math.rad"));
  CHECK_THAT(fault({.links = {1}, .widths = {1}, .base = {}, .limits = {{}, {}}}), Contains("limits of 2"));
  CHECK_THAT(fault_of([] { static_cast<void>(Robot::disc(1).apart({{0, 1}})); }), Contains("bodies 1 and 2"));
}

TEST_CASE("a recentred robot is the same body about the centre of its largest disc") {
  const auto body_points = [](const Robot& robot, const Configuration& q) {
    std::vector<Pose2> poses(1);
    robot.place(q, poses);
    std::vector<Vec2> points;
    for (const auto& part : robot.bodies().front().parts) {
      for (const Vec2 v : std::get<Polygon>(part).vertices) points.push_back(poses[0](v));
    }
    return points;
  };
  const std::vector<std::pair<Polygon, double>> shapes = {
      {{{{0.3, 0.0}, {1.1, 0.0}, {1.1, 0.5}, {0.3, 0.5}}}, 0.25},
      {{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.2}, {0.3, 0.2}, {0.3, 1.0}, {0.0, 1.0}}}, 0.1536},
      {{{{-4.0, -4.0}, {-2.0, -4.0}, {-3.0, -2.0}}}, 0.6180}};
  for (const auto& [polygon, radius] : shapes) {
    for (const bool rotates : {true, false}) {
      const Robot robot = Robot::rigid({polygon}, rotates);
      const auto [about, offset] = recentred(robot);
      CHECK(about.inscribed_radius() == Approx(radius).epsilon(0.002));
      CHECK(about.inscribed_radius() >= robot.inscribed_radius());
      CHECK(about.bounding_radius() <= robot.bounding_radius() + 1e-9);
      Configuration q = {2.0, 3.0, 0.7};
      q.resize(robot.dimension());
      const auto before = body_points(robot, q);
      const auto after = body_points(about, recentred_configuration(robot, offset, q));
      REQUIRE(before.size() == after.size());
      for (std::size_t i = 0; i < before.size(); ++i) CHECK(norm(before[i] - after[i]) < 1e-12);
      // Once more changes little.
      CHECK(norm(Vec2{recentred(about).offset.x, recentred(about).offset.y}) < 0.02);
    }
  }
  CHECK(recentred(Robot::disc(0.4)).robot.inscribed_radius() == Approx(0.4));
  CHECK(recentred(Robot::point()).robot.is_point());
  Arm arm;
  arm.links = {1.0};
  arm.widths = {0.1};
  CHECK_THROWS_WITH(recentred(Robot::arm(arm)), Contains("is fixed to its base"));
  // In space: of several solids the one with the largest ball.
  const Robot3 hammer("rigid", {Solid{Cuboid{{0.1, 0.1, 1.0}}, {{0.0, 0.0, 0.5}, {}}},
                                Solid{Cuboid{{0.4, 0.4, 0.4}}, {{0.1, 0.0, 1.2}, {}}}});
  const auto [about, offset] = recentred(hammer);
  CHECK(about.inscribed_radius() == Approx(0.2));
  CHECK(norm(offset - Vec3{0.1, 0.0, 1.2}) < 1e-9);
  const double half = std::sqrt(0.5);
  const Configuration q = {1.0, 2.0, 3.0, half, 0.0, 0.0, half};  // a quarter turn about x
  const Configuration moved = recentred_configuration(hammer, offset, q);
  CHECK(norm(about.pose(moved)(Vec3{}) - hammer.pose(q)(offset)) < 1e-12);
}
