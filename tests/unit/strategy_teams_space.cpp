// SPDX-License-Identifier: GPL-3.0-or-later
// Teams of bodies that move freely in space: their space, their collision checks and certificates, and the guides that
// divide them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/guide/team_space.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/team_times.hpp>
#include <trellis/scene/uncoupled.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::shared_ptr<const Mesh> tetrahedron() {
  static const auto mesh =
      std::make_shared<const Mesh>(Mesh::hull({{0, 0, 0}, {1.5, 0, 0}, {0, 1.5, 0}, {0, 0, 1.5}}, "tetrahedron"));
  return mesh;
}

Robot3 plank() { return {"plank", {{Cuboid{{1.6, 0.8, 0.3}}, {}}}}; }
Robot3 ball(double radius) { return {"ball", {{Sphere{radius}, {}}}, false}; }
/// A robot of two solids, and one of a mesh.
Robot3 hammer() { return {"hammer", {{Capsule{0.15, 1.2}, {}}, {Cuboid{{0.7, 0.3, 0.3}}, {{0, 0, 0.7}, {}}}}}; }
Robot3 wedge() { return {"wedge", {{tetrahedron(), {{-0.3, -0.3, -0.3}, {}}}}}; }

Problem problem_of(std::string name, World3 world, const Robot3& robot, Configuration start, Configuration goal) {
  Problem problem;
  problem.name = std::move(name);
  auto scene = std::make_shared<const SpatialScene>(std::move(world), robot);
  problem.space = scene->own_space();
  problem.scene = std::move(scene);
  problem.start = std::move(start);
  problem.goals = {std::move(goal)};
  problem.collision = "fcl";
  return problem;
}

World3 pillar_world(Contain contain = Contain::robot) {
  return {{{0, 0, 0}, {6, 6, 6}}, {{"pillar", {Cylinder{0.5, 4.0}, {{3, 3, 2}, {}}}}}, contain};
}

/// All kinds of solids in one team.
Problem mixed() {
  return problem_of("mixed", pillar_world(Contain::reference), Robot3::team({plank(), ball(0.6), hammer(), wedge()}),
                    {}, {});
}

/// Planks that change places with those opposite, about a pillar.
Problem crossing(std::size_t count) {
  Configuration start, goal;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    const double x = 2.0 * std::cos(angle), y = 2.0 * std::sin(angle);
    const double half = 0.5 * angle;
    start.insert(start.end(), {3 + x, 3 + y, 3, 0, 0, std::sin(half), std::cos(half)});
    goal.insert(goal.end(), {3 - x, 3 - y, 3, std::sin(half), std::cos(half), 0, 0});
  }
  Robot3 small("plank", {{Cuboid{{0.9, 0.4, 0.2}}, {}}});
  Problem problem =
      problem_of("crossing", World3({{0, 0, 0}, {6, 6, 6}}, {}), Robot3::team(std::vector(count, small)), start, goal);
  problem.space.normalise(problem.start);
  problem.space.normalise(problem.goals.front());
  return problem;
}

/// Whether each robot is valid where all others are obstacles of the world, placed by their poses.
bool valid_among_others(const Problem& problem, View q) {
  const SpatialScene& scene = spatial(*problem.scene);
  for (const Robot3::Member& member : scene.robot.members()) {
    std::vector<Obstacle3> obstacles = scene.world.obstacles();
    for (const Robot3::Member& other : scene.robot.members()) {
      if (other.number == member.number) continue;
      const Pose3 pose = other.robot->pose(other.own(q));
      for (const Solid& solid : other.robot->solids()) obstacles.push_back({"", {solid.shape, pose * solid.pose}});
    }
    const auto alone = std::make_shared<const SpatialScene>(scene.world.with(obstacles), *member.robot);
    if (!make_checker("fcl_plain", alone, alone->default_space(1.0), 0.05)->valid(member.own(q))) return false;
  }
  return true;
}

/// The gap between two boxes along the best of the fifteen axes that can separate them; negative where they meet.
double box_gap(const Vec3& a, const Pose3& at_a, const Vec3& b, const Pose3& at_b) {
  const std::array<Vec3, 3> x = {at_a.orientation({1, 0, 0}), at_a.orientation({0, 1, 0}), at_a.orientation({0, 0, 1})};
  const std::array<Vec3, 3> y = {at_b.orientation({1, 0, 0}), at_b.orientation({0, 1, 0}), at_b.orientation({0, 0, 1})};
  const std::array<double, 3> half_a = {0.5 * a.x, 0.5 * a.y, 0.5 * a.z}, half_b = {0.5 * b.x, 0.5 * b.y, 0.5 * b.z};
  const Vec3 between = at_b.position - at_a.position;
  double best = -std::numeric_limits<double>::infinity();
  const auto along = [&](const Vec3& axis) {
    const double length = norm(axis);
    if (length < 1e-9) return;
    double extent = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      extent += half_a.at(i) * std::abs(dot(axis, x.at(i))) + half_b.at(i) * std::abs(dot(axis, y.at(i)));
    }
    best = std::max(best, (std::abs(dot(axis, between)) - extent) / length);
  };
  for (const Vec3& axis : x) along(axis);
  for (const Vec3& axis : y) along(axis);
  for (const Vec3& u : x) {
    for (const Vec3& v : y) along(cross(u, v));
  }
  return best;
}

/// \param guide  its name; "joined": couple with where = "path"
StrategySpec guided(const std::string& guide, const std::vector<Options::Entry>& planner = {{"bound", 0.0}}) {
  const bool joined = guide == "joined";
  return GuideSpec::make(joined ? "couple" : guide, joined ? std::vector<Options::Entry>{{"where", std::string("path")}}
                                                           : std::vector<Options::Entry>()) >>
         PlannerSpec::make("rrt_connect", planner);
}

void check_path(const Problem& problem, const Configurations& path) {
  REQUIRE(path.size() >= 2);
  CHECK(std::ranges::equal(path.front(), problem.start));
  CHECK(problem.space.distance(path.back(), problem.goal()) <= problem.goal_tolerance);
  Configuration q(problem.space.dimension());
  int invalid = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const int steps = 1 + static_cast<int>(problem.space.distance(path[i - 1], path[i]) / 0.05);
    for (int k = 0; k <= steps; ++k) {
      problem.space.interpolate(path[i - 1], path[i], static_cast<double>(k) / steps, q);
      invalid += valid_among_others(problem, q) ? 0 : 1;
    }
  }
  CHECK(invalid == 0);
}

}  // namespace

TEST_CASE("robots of a team in space that are uncoupled pass through each other, and no others", "[strategy][team]") {
  const Problem problem =
      problem_of("three", World3({{0, 0, 0}, {6, 6, 6}}, {}), Robot3::team({ball(0.5), plank(), ball(0.5)}), {}, {});
  const auto valid = [&](const std::shared_ptr<const Scene>& scene, const Configuration& q) {
    return make_checker("fcl", scene, problem.space, 0.05)->valid(q);
  };
  const Configuration first_two = {1, 1, 1, 1.2, 1, 1, 0, 0, 0, 1, 4, 4, 4};
  const Configuration last_two = {1, 1, 1, 4.2, 4, 4, 0, 0, 0, 1, 4, 4, 4};
  CHECK_FALSE(valid(problem.scene, first_two));
  CHECK_FALSE(valid(problem.scene, last_two));
  const auto apart = uncoupled(*problem.scene, {{2, 1}});
  REQUIRE(apart);
  CHECK(valid(apart, first_two));
  CHECK_FALSE(valid(apart, last_two));
  // What guides make of the team keeps it: smaller robots, and the team without robot 3.
  CHECK(
      valid(std::make_shared<const SpatialScene>(spatial(*apart).world, spatial(*apart).robot.scaled(0.9)), first_two));
  const Robot3& team = spatial(*apart).robot;
  CHECK_FALSE(team.scaled(0.5).are_coupled(1, 2));
  CHECK(team.scaled(0.5).are_coupled(1, 3));
}

TEST_CASE("the space of a team in space is the product of those of its bodies", "[team][space]") {
  const Problem problem = mixed();
  CHECK(problem.space.name() == "SE(3) x R^3 x SE(3) x SE(3)");
  CHECK(problem.space.dimension() == 24);
  CHECK(problem.space.degrees() == 21);
  CHECK(crossing(3).space.name() == "(SE(3))^3");
  const std::vector<TeamMember> members = problem.scene->members();
  REQUIRE(members.size() == 4);
  CHECK(members[2].axes == std::vector<std::size_t>{10, 11, 12, 13, 14, 15, 16});
  std::vector<Space> own;
  for (const TeamMember& member : members) own.push_back(space_of(problem.space, member));
  Stream stream(1, "team", "product");
  Configuration a(24), b(24), middle(24), there(24);
  std::vector<double> tangent(21);
  for (int i = 0; i < 500; ++i) {
    problem.space.sample_uniform(stream, a);
    problem.space.sample_uniform(stream, b);
    problem.space.interpolate(a, b, 0.3, middle);
    double squares = 0.0;
    for (std::size_t r = 0; r < members.size(); ++r) {
      const std::size_t first = members[r].axes.front(), width = members[r].axes.size();
      const View from = View(a).subspan(first, width), to = View(b).subspan(first, width);
      squares += own[r].squared_distance(from, to);
      // All robots move evenly, each along the shortest motion of its own space.
      Configuration expected(width);
      own[r].interpolate(from, to, 0.3, expected);
      for (std::size_t j = 0; j < width; ++j) CHECK(middle[first + j] == Approx(expected[j]).margin(1e-12));
      // The metric of a body bounds how far its points move.
      const Robot3::Member& member = spatial(*problem.scene).robot.members()[r];
      CHECK(member.robot->displacement_bound(from, to) <= std::sqrt(2.0) * own[r].distance(from, to) * (1.0 + 1e-12));
    }
    CHECK(problem.space.squared_distance(a, b) == Approx(squares));
    problem.space.log(a, b, tangent);
    problem.space.exp(a, tangent, there);
    CHECK(problem.space.distance(there, b) < 1e-9);
  }
}

TEST_CASE("a part of a space keeps whole rotations, their weights and names", "[team][space]") {
  const Space whole = mixed().space;
  const Space part = whole.part({7, 8, 9, 13, 14, 15, 16}, "part");
  CHECK(part.name() == "part");
  CHECK(part.degrees() == 6);
  CHECK(part.factors()[3].kind == Factor::Kind::rotation);
  CHECK(part.factors()[3].column == 3);
  CHECK(part.factors()[3].axis.weight == whole.factors()[10].axis.weight);
  CHECK(part.factors()[3].axis.name == whole.factors()[10].axis.name);
  CHECK_THROWS_AS(whole.part({13, 14, 15}, "part"), Fault);
  CHECK_THROWS_AS(whole.part({14, 13, 15, 16}, "part"), Fault);
}

TEST_CASE("a team in space is valid where each body is among the others", "[team][collision]") {
  const Problem problem = mixed();
  const auto filtered = make_checker("fcl", problem.scene, problem.space, 0.05);
  const auto plain = make_checker("fcl_plain", problem.scene, problem.space, 0.05);
  Stream stream(1, "team in space", "validity");
  Configuration q(24), to(24), at(24);
  int valid = 0, certified = 0;
  for (int i = 0; i < 3000; ++i) {
    problem.space.sample_uniform(stream, q);
    const bool expected = valid_among_others(problem, q);
    REQUIRE(filtered->valid(q) == expected);
    REQUIRE(plain->valid(q) == expected);
    REQUIRE(filtered->contact(q).has_value() == !expected);
    REQUIRE((filtered->clearance(q) > 0.0) == expected);
    if (!expected) continue;
    ++valid;
    // A short motion, so that some are valid.
    problem.space.sample_uniform(stream, to);
    problem.space.interpolate(q, Configuration(to), 0.15, to);
    const MotionReport a = filtered->motion(q, to), b = plain->motion(q, to);
    REQUIRE(a.valid == b.valid);
    REQUIRE(a.checks == b.checks);
    Certificate certificate;
    certificate.tolerance = 5e-8;
    filtered->certify(q, to, certificate);
    // What is certified is valid at all configurations, and has the clearance that is certified.
    if (certificate.valid()) {
      ++certified;
      REQUIRE(a.valid);
      for (int k = 0; k <= 20; ++k) {
        problem.space.interpolate(q, to, k / 20.0, at);
        REQUIRE(valid_among_others(problem, at));
        REQUIRE(filtered->clearance(at) >= certificate.clearance * (1.0 - 1e-3) - 1e-4);
      }
    } else {
      // What is refuted touches, or nearly.
      problem.space.interpolate(q, to, *certificate.refuted_at, at);
      REQUIRE(filtered->clearance(at) < 1e-4);
    }
  }
  CHECK(valid > 300);
  CHECK(valid < 2900);
  CHECK(certified > 50);
}

TEST_CASE("boxes of a team touch where no axis separates them, balls where their centres are near",
          "[team][collision]") {
  const World3 empty({{-4, -4, -4}, {4, 4, 4}}, {}, Contain::none);
  const Problem boxes = problem_of("boxes", empty, Robot3::team({plank(), plank()}), {}, {});
  const Problem balls = problem_of("balls", empty, Robot3::team({ball(0.7), ball(0.4)}), {}, {});
  const auto of_boxes = make_checker("fcl", boxes.scene, boxes.space, 0.05);
  const auto of_balls = make_checker("fcl", balls.scene, balls.space, 0.05);
  Stream stream(2, "team in space", "pairs");
  Configuration q(14), p(6);
  int meet = 0, apart = 0;
  for (int i = 0; i < 20000; ++i) {
    boxes.space.sample_uniform(stream, q);
    // Near each other.
    for (std::size_t j = 0; j < 3; ++j) q[7 + j] = q[j] + 0.4 * (q[7 + j] - q[j]);
    const auto pose = [&](std::size_t first) {
      return Pose3{{q[first], q[first + 1], q[first + 2]}, {q[first + 3], q[first + 4], q[first + 5], q[first + 6]}};
    };
    const double gap = box_gap({1.6, 0.8, 0.3}, pose(0), {1.6, 0.8, 0.3}, pose(7));
    if (std::abs(gap) > 1e-9) {
      REQUIRE(of_boxes->valid(q) == (gap > 0.0));
      (gap > 0.0 ? apart : meet) += 1;
    }
    balls.space.sample_uniform(stream, p);
    for (std::size_t j = 0; j < 3; ++j) p[3 + j] = p[j] + 0.3 * (p[3 + j] - p[j]);
    const double between = norm(Vec3{p[3] - p[0], p[4] - p[1], p[5] - p[2]}) - 1.1;
    REQUIRE(of_balls->valid(p) == (between > 0.0));
    if (between > 0.0) REQUIRE(of_balls->clearance(p) == Approx(between).margin(1e-5));
  }
  CHECK(meet > 1000);
  CHECK(apart > 1000);
}

TEST_CASE("bodies that pass close by are certified, and those that touch between two checks refuted",
          "[team][collision]") {
  const World3 empty({{-4, -4, -4}, {4, 4, 4}}, {});
  const Problem balls = problem_of("balls", empty, Robot3::team({ball(0.5), ball(0.5)}), {}, {});
  // The first one passes the second, which waits, at a distance.
  const auto certificate = [&](double gap, double resolution) {
    const auto checker = make_checker("fcl", balls.scene, balls.space, resolution);
    Certificate found;
    found.tolerance = 1e-9;
    checker->certify(Configuration{-3, 1.0 + gap, 0, 0, 0, 0}, Configuration{3, 1.0 + gap, 0, 0, 0, 0}, found);
    return found;
  };
  for (const double gap : {0.3, 1e-2, 1e-4, 1e-6}) {
    CAPTURE(gap);
    const Certificate found = certificate(gap, 0.05);
    REQUIRE(found.valid());
    CHECK(found.clearance <= gap * (1.0 + 1e-9));
    CHECK(found.clearance > 0.4 * gap - 1e-9);
  }
  // Checked in steps of 0.8 m the motion seems valid.
  const auto coarse = make_checker("fcl", balls.scene, balls.space, 0.8);
  const Configuration from{-3.0, 0.99, 0, 0, 0, 0}, to{2.6, 0.99, 0, 0, 0, 0};
  CHECK(coarse->motion(from, to).valid);
  Certificate found;
  found.tolerance = 1e-9;
  coarse->certify(from, to, found);
  CHECK_FALSE(found.valid());
  // Two that move together keep their distance: one look is enough.
  const Problem planks = problem_of("planks", empty, Robot3::team({plank(), plank()}), {}, {});
  const auto checker = make_checker("fcl", planks.scene, planks.space, 0.05);
  Certificate together;
  together.tolerance = 1e-9;
  checker->certify(Configuration{-2, 0, 0, 0, 0, 0, 1, -2, 0.801, 0, 0, 0, 0, 1},
                   Configuration{2, 0, 0, 0, 0, 0, 1, 2, 0.801, 0, 0, 0, 0, 1}, together);
  CHECK(together.valid());
  CHECK(together.clearance == Approx(1e-3).epsilon(0.11));
}

TEST_CASE("a part of a team in space is the team of its bodies, one of them a body alone", "[team][scene]") {
  const Problem problem = mixed();
  const std::vector<TeamMember> members = problem.scene->members();
  const auto two = problem.scene->reduced(axes_of(members, {1, 3}));
  REQUIRE(two->members().size() == 2);
  CHECK(two->members()[1].number == 4);
  CHECK(two->members()[1].axes.front() == 3);
  CHECK(two->body_name(1) == "robot 4");
  const auto one = problem.scene->reduced(members[2].axes);
  CHECK(one->members().empty());
  CHECK(one->translates());
  CHECK(spatial(*one).robot.name() == "hammer");
  // The position alone of a plank determines the ball inside of it.
  const auto position = problem.scene->reduced({0, 1, 2});
  CHECK(position->bounding_radius() == Approx(0.15));
  CHECK(problem.scene->shrunken(0.5)->members().size() == 4);
  CHECK(problem.scene->shrunken(0.5)->bounding_radius() == Approx(0.5 * problem.scene->bounding_radius()));
  CHECK_THROWS_WITH(Robot3::team({plank()}), Contains("at least two"));
  CHECK_THROWS_WITH(Robot3::team({plank(), Robot3::point()}), Contains("robot 2 is a point"));
  CHECK_THROWS_WITH(Robot3::team(std::vector(65, ball(0.1))), Contains("at most 64"));
  CHECK(Robot3::team({Robot3::team({plank(), ball(0.1)}), plank()}).members().size() == 3);
}

TEST_CASE("guides that divide a team find valid paths of all bodies in space", "[team]") {
  const Problem problem = crossing(4);
  for (const char* guide : {"prioritise", "couple", "joined"}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(guide, seed);
      const RunRecord run = execute(guided(guide), problem, seed);
      REQUIRE(run.solved);
      CHECK(run.certified);
      check_path(problem, run.path);
      REQUIRE(run.times.has_value());
      CHECK(run.times->makespan > 3.9);
      CHECK(run.times->sum_of_costs >= run.times->makespan);
      const RunRecord again = execute(guided(guide), problem, seed);
      CHECK(std::ranges::equal(run.path.values(), again.path.values()));
      CHECK(run.validity_checks == again.validity_checks);
    }
  }
}

TEST_CASE("decouple and team guide a team in space", "[team]") {
  // Two planks that cross each other's path and can wait.
  Problem problem = crossing(2);
  problem.start = {1, 3, 3, 0, 0, 0, 1, 3, 1, 3, 0, 0, 0, 1};
  problem.goals = {{5, 3, 3, 0, 0, 1, 0, 3, 5, 3, 1, 0, 0, 0}};
  for (const char* guide : {"decouple", "team"}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(guide, seed);
      const RunRecord run = execute(guided(guide), problem, seed);
      REQUIRE(run.solved);
      CHECK(run.certified);
      check_path(problem, run.path);
    }
  }
}

TEST_CASE("planners plan in the product of the spaces of bodies", "[team]") {
  const Problem problem = crossing(2);
  for (const char* name : {"rrt", "rrt_connect", "rrt_star", "prm", "prm_star", "lazy_prm", "drrt"}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      CAPTURE(name, seed);
      const auto planner = PlannerSpec::make(name, {{"proposals", 20000.0}});
      const RunRecord run = execute(planner, problem, seed);
      REQUIRE(run.solved);
      CHECK(run.certified);
      check_path(problem, run.path);
      const RunRecord again = execute(planner, problem, seed);
      CHECK(std::ranges::equal(run.path.values(), again.path.values()));
    }
  }
}

TEST_CASE("every guide plans for a team in space, or says in a sentence why not", "[team]") {
  const Problem problem = crossing(2);
  const auto planner = PlannerSpec::make("rrt_connect", {{"bound", 0.0}, {"proposals", 300.0}});
  const int ran = test::plan_with_every_guide(
      problem, planner,
      [](const GuideSpec& guide) {
        return test::above(guide, {"team", "prioritise", "couple"});
      },
      [&](const RunRecord& run) { check_path(problem, run.path); });
  CHECK(ran > 40);
}

TEST_CASE("bodies along paths have the validity of the team in space", "[team]") {
  const Problem problem = crossing(3);
  const auto parent = make_instance(problem);
  const std::vector<TeamMember> members = problem.scene->members();
  Configurations path(7);
  path.push(View(problem.start).subspan(0, 7));
  path.push(Configuration{3, 3, 4, 0, 0, 1, 0});
  path.push(View(problem.goal()).subspan(0, 7));
  TeamSpace space(*parent, {RobotsPath(problem.space, members[0].axes, path)}, members[2].axes, "along");
  const auto sub = space.project(*parent);
  REQUIRE(sub->space.dimension() == 8);
  REQUIRE(sub->space.degrees() == 7);
  CHECK(sub->space.name() == "along");
  const auto two = problem.scene->reduced(axes_of(members, {0, 2}));
  const Problem pair = problem_of("pair", spatial(*two).world, spatial(*two).robot, {}, {});
  const RobotsPath along(problem.space, members[0].axes, path);
  Stream stream(4, "team in space", "along");
  Configuration s(8), q(14);
  int valid = 0;
  for (int i = 0; i < 500; ++i) {
    sub->space.sample_uniform(stream, s);
    along.at(s[0], MutableView(q).first(7));
    std::copy(s.begin() + 1, s.end(), q.begin() + 7);
    const bool expected = valid_among_others(pair, q);
    REQUIRE(sub->valid(s) == expected);
    valid += expected ? 1 : 0;
  }
  CHECK(valid > 100);
}

TEST_CASE("bodies of a team that start in contact are named", "[team]") {
  Problem problem = crossing(3);
  std::copy_n(problem.start.begin(), 7, problem.start.begin() + 14);
  CHECK_THROWS_WITH(check(problem), Contains("robot 1 meets robot 3"));
  Problem outside = problem_of("pillar", pillar_world(), Robot3::team({plank(), ball(0.2)}),
                               {3, 3, 2, 0, 0, 0, 1, 1, 1, 1}, {1, 1, 1, 0, 0, 0, 1, 3, 5, 3});
  CHECK_THROWS_WITH(check(outside), Contains("robot 1 is in collision with pillar"));
}
