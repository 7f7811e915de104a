// SPDX-License-Identifier: GPL-3.0-or-later
// Teams of robots: their collision checks, the guides that divide them, and the times of their paths.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/guide/schedule.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/guide/team_space.hpp>
#include <trellis/planner/pruning.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/team_times.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

/// Discs on a ring that change places with those opposite.
Problem ring(std::size_t count, double radius) {
  Configuration start, goal;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    const double x = 4.0 * std::cos(angle), y = 4.0 * std::sin(angle);
    start.insert(start.end(), {5.0 + x, 5.0 + y});
    goal.insert(goal.end(), {5.0 - x, 5.0 - y});
  }
  return test::make_problem("ring", test::rectangle_world({}), Robot::team(std::vector(count, Robot::disc(radius))),
                            start, goal);
}

/// Two discs in a corridor that is too narrow to pass, with a bay half-way.
Problem corridor() {
  return test::make_problem("corridor", test::rectangle_world({{0, 0, 10, 4.5}, {0, 5.5, 4.4, 10}, {5.6, 5.5, 10, 10}}),
                            Robot::team({Robot::disc(0.4), Robot::disc(0.4)}), {1, 5, 9, 5}, {9, 5, 1, 5});
}

/// Discs of radius 0.3 among shelves, each from one place of a grid to another (examples/warehouse.lua).
Problem warehouse(std::size_t count) {
  test::Rectangles shelves;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) shelves.push_back({3.0 + 4 * i, 3.0 + 5 * k, 5.0 + 4 * i, 6.0 + 5 * k});
  }
  std::vector<Vec2> places;
  for (int i = 0; i <= 10; ++i) {
    for (int k = 0; k <= 10; ++k) {
      const Vec2 place{1.0 + 1.8 * i, 1.0 + 1.8 * k};
      if (std::none_of(shelves.begin(), shelves.end(), [&](const auto& shelf) {
            return place.x > shelf[0] - 0.5 && place.x < shelf[2] + 0.5 && place.y > shelf[1] - 0.5 &&
                   place.y < shelf[3] + 0.5;
          })) {
        places.push_back(place);
      }
    }
  }
  Configuration start, goal;
  for (std::size_t i = 1; i <= count; ++i) {
    const Vec2 from = places[i * 23 % places.size()], to = places[(i * 41 + 7) % places.size()];
    start.insert(start.end(), {from.x, from.y});
    goal.insert(goal.end(), {to.x, to.y});
  }
  return test::make_problem("warehouse", test::rectangle_world(shelves, 20.0),
                            Robot::team(std::vector(count, Robot::disc(0.3))), start, goal);
}

/// A disc, a bar that turns and an arm.
Robot mixed_team() {
  return Robot::team({Robot::disc(0.5), test::rectangle_robot(1.6, 0.3),
                      Robot::arm({.links = {1.5, 1.2, 0.8}, .widths = {0.2, 0.2, 0.1}, .base = {5, 5}})});
}

/// \param guide  its name; "joined": couple with where = "path"
StrategySpec guided(const std::string& guide, const std::vector<Options::Entry>& planner = {{"bound", 0.0}}) {
  const bool joined = guide == "joined";
  return GuideSpec::make(joined ? "couple" : guide, joined ? std::vector<Options::Entry>{{"where", std::string("path")}}
                                                           : std::vector<Options::Entry>()) >>
         PlannerSpec::make("rrt_connect", planner);
}

/// Whether all robots of a planar team are free of each other and of obstacles, robot by robot, by checkers of two.
class PairwiseJudge {
 public:
  explicit PairwiseJudge(const Problem& problem) : problem_(problem), members_(problem.scene->members()) {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      for (std::size_t k = i + 1; k < members_.size(); ++k) {
        const std::vector<std::size_t> axes = axes_of(members_, {i, k});
        std::vector<Axis> own;
        for (const std::size_t axis : axes) own.push_back(problem.space.axes()[axis]);
        pairs_.push_back({axes, make_checker("fcl", problem.scene->reduced(axes), Space("pair", own), 0.05)});
      }
    }
  }
  [[nodiscard]] bool valid(View q) const {
    return std::all_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
      Configuration part;
      for (const std::size_t axis : pair.axes) part.push_back(q[axis]);
      return pair.checker->valid(part);
    });
  }

 private:
  struct Pair {
    std::vector<std::size_t> axes;
    std::unique_ptr<Checker> checker;
  };
  const Problem& problem_;
  std::vector<TeamMember> members_;
  std::vector<Pair> pairs_;
};

void check_path(const Problem& problem, const Configurations& path) {
  REQUIRE(path.size() >= 2);
  CHECK(std::ranges::equal(path.front(), problem.start));
  CHECK(std::ranges::equal(path.back(), problem.goal()));
  const PairwiseJudge judge(problem);
  Configuration q(problem.space.dimension());
  int invalid = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double length = problem.space.distance(path[i - 1], path[i]);
    const int steps = 1 + static_cast<int>(length / 0.02);
    for (int k = 0; k <= steps; ++k) {
      problem.space.interpolate(path[i - 1], path[i], static_cast<double>(k) / steps, q);
      invalid += judge.valid(q) ? 0 : 1;
    }
  }
  CHECK(invalid == 0);
}

}  // namespace

TEST_CASE("a team is valid where each two of its robots are", "[team][collision]") {
  const World world = test::rectangle_world({{1, 7, 3, 8}, {7, 1, 8, 3}});
  const Problem problem = test::make_problem("mixed", world, mixed_team(), {}, {});
  CHECK(problem.space.dimension() == 8);
  CHECK(problem.space.name() == "R^2 x SE(2) x SO(2)^3");
  const PairwiseJudge judge(problem);
  const auto planar = make_checker("planar", problem.scene, problem.space, 0.05);
  const auto fcl = make_checker("fcl", problem.scene, problem.space, 0.05);
  Stream stream(1, "team", "validity");
  Configuration q(8), to(8);
  int valid = 0;
  for (int i = 0; i < 4000; ++i) {
    problem.space.sample_uniform(stream, q);
    const bool expected = judge.valid(q);
    valid += expected ? 1 : 0;
    REQUIRE(planar->valid(q) == expected);
    REQUIRE(fcl->valid(q) == expected);
    REQUIRE(planar->contact(q).has_value() == !expected);
    problem.space.sample_uniform(stream, to);
    if (!expected) continue;
    const MotionReport a = planar->motion(q, to), b = fcl->motion(q, to);
    REQUIRE(a.valid == b.valid);
    REQUIRE(a.checks == b.checks);
    // A certified motion is valid at all of many configurations.
    Certificate certificate;
    certificate.tolerance = 5e-8;
    planar->certify(q, to, certificate);
    if (!certificate.valid()) continue;
    Configuration at(8);
    for (int k = 0; k <= 100; ++k) {
      problem.space.interpolate(q, to, k / 100.0, at);
      REQUIRE(judge.valid(at));
    }
  }
  CHECK(valid > 1000);
  CHECK(valid < 3000);
}

TEST_CASE("no configuration of a team within its bound on invalid ones is valid", "[team][collision]") {
  const Problem problem = test::make_problem("mixed", test::rectangle_world({{1, 7, 3, 8}}), mixed_team(), {}, {});
  const auto checker = make_checker("planar", problem.scene, problem.space, 0.05);
  Stream stream(2, "team", "invalid radius");
  Configuration q(8), other(8), tangent(8);
  int positive = 0;
  for (int i = 0; i < 3000; ++i) {
    problem.space.sample_uniform(stream, q);
    if (checker->valid(q)) continue;
    const double radius = checker->invalid_radius(q);
    if (radius <= 0.0) continue;
    ++positive;
    for (int k = 0; k < 10; ++k) {
      double squares = 0.0;
      for (double& x : tangent) {
        x = stream.normal();
        squares += x * x;
      }
      for (double& x : tangent) x *= 0.999 * radius / std::sqrt(squares);
      problem.space.exp(q, tangent, other);
      problem.space.normalise(other);
      if (problem.space.contains(other)) REQUIRE_FALSE(checker->valid(other));
    }
  }
  CHECK(positive > 300);
}

TEST_CASE("a part of a team is the team of its robots, one robot a robot alone", "[team][scene]") {
  const Problem problem = ring(4, 0.5);
  const auto two = problem.scene->reduced(axes_of(problem.scene->members(), {1, 3}));
  REQUIRE(two->members().size() == 2);
  CHECK(two->members()[1].number == 4);
  CHECK(two->body_name(1) == "robot 4");
  const auto one = problem.scene->reduced({2, 3});
  CHECK(one->members().empty());
  CHECK(one->translates());
  CHECK(planar(*one).robot.name() == "disc");
  CHECK(problem.scene->shrunken(0.5)->members().size() == 4);
  CHECK(problem.scene->shrunken(0.5)->bounding_radius() == Approx(0.25));
  CHECK_THROWS_WITH(Robot::team({Robot::disc(1.0)}), Contains("at least two"));
  CHECK_THROWS_WITH(Robot::team({Robot::disc(1.0), Robot::point()}), Contains("robot 2 is a point"));
}

TEST_CASE("guides that divide a team find valid paths of all robots", "[team]") {
  for (const Problem& problem : {ring(6, 0.7), test::team_problem()}) {
    for (const char* guide : {"prioritise", "couple", "joined"}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        CAPTURE(problem.name, guide, seed);
        const RunRecord run = execute(guided(guide), problem, seed);
        REQUIRE(run.solved);
        CHECK(run.certified);
        check_path(problem, run.path);
        // The guide alone found it: the root checked next to nothing.
        CHECK(run.levels.front().search.checks.validity < run.validity_checks / 4);
      }
    }
  }
}

TEST_CASE("the path of a divided team is certified when it is found, and has few configurations", "[team]") {
  // Between two checked configurations the paths of these seeds touched another robot, or had one configuration for
  // each proposal of the root's budget.
  for (const auto& [count, seed] : {std::pair<std::size_t, std::uint64_t>{16, 6}, {24, 3}, {24, 6}}) {
    CAPTURE(count, seed);
    const Problem problem = warehouse(count);
    const RunRecord run = execute(guided("prioritise", {{"bound", 0.0}, {"proposals", 2000.0}}), problem, seed);
    REQUIRE(run.solved);
    CHECK(run.refuted_paths == 0);
    CHECK(run.path.size() < 20 * count);
    if (count == 16) check_path(problem, run.path);
  }
}

TEST_CASE("pruning leaves out the configurations between which the motion is valid", "[team]") {
  Configurations path(1);
  for (const double x : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}) path.push(Configuration{x});
  const auto pruned = [&](const std::function<bool(double, double)>& valid) {
    PathPruning pruning(path, [&](View a, View b) { return valid(a[0], b[0]); });
    while (!pruning.done()) pruning.step();
    const auto values = pruning.path().values();
    return std::vector<double>(values.begin(), values.end());
  };
  CHECK(pruned([](double, double) { return true; }) == std::vector<double>{0, 7});
  CHECK(pruned([](double, double) { return false; }) == std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7});
  // No motion passes 4.
  CHECK(pruned([](double a, double b) { return b <= 4.0 || a >= 4.0; }) == std::vector<double>{0, 4, 7});
  Configurations one(1);
  one.push(Configuration{2.0});
  CHECK(PathPruning(one, [](View, View) { return true; }).done());
}

TEST_CASE("robots that cannot pass each other on their paths plan together", "[team]") {
  const Problem problem = corridor();
  // Alone, either robot goes straight through the corridor: no schedule of these paths exists.
  const RunRecord alone = execute(GuideSpec::make("decouple", {{"tries", std::int64_t{3}}}) >>
                                      PlannerSpec::make("rrt_connect", {{"bound", 0.0}, {"proposals", 300.0}}),
                                  problem, 1);
  const auto named = [](const RunRecord& run, const std::string& name) {
    return std::count_if(run.levels.begin(), run.levels.end(),
                         [&](const LevelRecord& level) { return level.name == name; });
  };
  CHECK(named(alone, "robots 1, 2") == 0);
  const RunRecord joined = execute(guided("joined"), problem, 1);
  REQUIRE(joined.solved);
  CHECK(named(joined, "robots 1, 2") == 1);
  check_path(problem, joined.path);
  const RunRecord together = execute(guided("couple"), problem, 1);
  REQUIRE(together.solved);
  CHECK(named(together, "robots 1, 2") >= 1);
  check_path(problem, together.path);
}

TEST_CASE("only robots in conflict leave their paths, and only about the conflict", "[team]") {
  // Robots 1 and 2 meet half-way in a corridor wide enough to pass, far from robot 3, which crosses nothing.
  const Problem problem =
      test::make_problem("meeting", test::rectangle_world({{0, 0, 20, 8.5}, {0, 11.5, 20, 12}}, 20.0),
                         Robot::team({Robot::disc(0.4), Robot::disc(0.4), Robot::disc(0.4)}), {1, 10, 19, 10, 1, 16},
                         {19, 10, 1, 10, 19, 16});
  const RunRecord run = execute(guided("couple"), problem, 1);
  REQUIRE(run.solved);
  check_path(problem, run.path);
  int windows = 0;
  for (const LevelRecord& level : run.levels) {
    if (level.name != "robots 1, 2") {
      CHECK(level.name.find(", 3") == std::string::npos);
      continue;
    }
    ++windows;
    // The window begins and ends near the meeting, not at the ends of the paths.
    CHECK(level.start[0] > 5.0);
    CHECK(level.start[2] < 15.0);
    CHECK(level.goal[0] < 15.0);
    CHECK(level.goal[2] > 5.0);
  }
  CHECK(windows >= 1);
}

TEST_CASE("thirty-two discs in a warehouse are coupled where they conflict", "[team]") {
  const Problem problem = warehouse(32);
  for (const char* guide : {"prioritise", "couple"}) {
    CAPTURE(guide);
    const RunRecord run = execute(guided(guide, {{"bound", 0.0}, {"proposals", 2000.0}}), problem, 1);
    REQUIRE(run.solved);
    CHECK(run.certified);
    CHECK(run.refuted_paths == 0);
  }
}

TEST_CASE("a divided team has the same bytes for the same seed, and other paths for another", "[team]") {
  const Problem problem = ring(6, 0.6);
  for (const char* guide : {"prioritise", "couple", "joined"}) {
    CAPTURE(guide);
    const RunRecord a = execute(guided(guide), problem, 3);
    const RunRecord b = execute(guided(guide), problem, 3);
    const RunRecord c = execute(guided(guide), problem, 4);
    CHECK(std::ranges::equal(a.path.values(), b.path.values()));
    CHECK(a.validity_checks == b.validity_checks);
    CHECK_FALSE(std::ranges::equal(a.path.values(), c.path.values()));
  }
}

TEST_CASE("a guide of single robots guides each robot of a divided team", "[team]") {
  const Problem problem = test::team_problem();
  const StrategySpec strategy = GuideSpec::make("skeleton", {}) >> GuideSpec::make("prioritise", {}) >>
                                PlannerSpec::make("rrt_connect", {{"bound", 0.0}});
  const RunRecord run = execute(strategy, problem, 1);
  REQUIRE(run.solved);
  check_path(problem, run.path);
  const auto skeletons = std::count_if(run.levels.begin(), run.levels.end(),
                                       [](const LevelRecord& level) { return level.name.starts_with("skeleton"); });
  CHECK(skeletons == 2);
}

TEST_CASE("every guide guides a divided team, and is guided by one, or says in a sentence why not", "[team]") {
  const Problem problem = test::team_problem();
  const auto planner = PlannerSpec::make("rrt_connect", {{"bound", 0.0}, {"proposals", 300.0}});
  const auto pairs = [](const GuideSpec& guide) {
    std::vector<GuideSpec> all;
    for (const char* division : {"team", "decouple", "prioritise", "couple"}) {
      const GuideSpec team = GuideSpec::make(division, {});
      all.push_back(guide >> team);
      all.push_back(guide + team);
      if (guide.searches()) all.push_back(team >> guide);
    }
    return all;
  };
  const int ran = test::plan_with_every_guide(problem, planner, pairs,
                                              [&](const RunRecord& run) { check_path(problem, run.path); });
  CHECK(ran > 150);
}

TEST_CASE("the robots of a divided team go to one goal of several", "[team]") {
  Problem problem = ring(6, 0.7);
  Configuration turned = problem.start;
  std::rotate(turned.begin(), turned.begin() + 2, turned.end());
  problem.goals.push_back(turned);
  for (const char* guide : {"prioritise", "couple", "joined"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      CAPTURE(guide, seed);
      const RunRecord run = execute(guided(guide), problem, seed);
      REQUIRE(run.solved);
      const Solution& divided = run.levels.at(1).solution;
      REQUIRE(divided.solved());
      const View end = divided.path.back();
      CHECK(std::any_of(problem.goals.begin(), problem.goals.end(),
                        [&](const Configuration& goal) { return problem.space.distance(end, goal) < 1e-6; }));
    }
  }
  CHECK_THROWS_WITH(execute(GuideSpec::make("prioritise", {}) >> guided("decouple"), problem, 1),
                    Contains("prioritise() guides no search of decouple, which have one robot each"));
}

TEST_CASE("the bounded loss of a guided run holds for teams", "[team]") {
  const Problem problem = ring(6, 0.5);
  for (const char* guide : {"team", "decouple", "prioritise", "couple", "joined"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      CAPTURE(guide, seed);
      const RunRecord alone = execute(PlannerSpec::make("rrt_connect", {}), problem, seed);
      const RunRecord run = execute(guided(guide, {{"bound", 2.0}}), problem, seed);
      REQUIRE(alone.solved);
      REQUIRE(run.solved);
      // The law: twice the work of the planner alone, that of 800 checks more, and one step of the guided search, which
      // examines no more than a motion of all robots for each of them, or 256 checks and an expansion.
      CHECK(static_cast<double>(run.validity_checks) <= 2.0 * static_cast<double>(alone.validity_checks) + 4000.0);
    }
  }
}

TEST_CASE("a space of robots along paths has the validity of the team", "[team]") {
  const Problem problem = ring(4, 0.5);
  const auto parent = make_instance(problem);
  Configurations path(2);
  for (const Configuration& q : std::vector<Configuration>{{9, 5}, {5, 5}, {5, 1.5}}) path.push(q);
  const std::vector<TeamMember> members = problem.scene->members();
  // The first robot starts at (5, 9): it is the fourth that is at (9, 5).
  TeamSpace space(*parent, {RobotsPath(problem.space, members[3].axes, path)}, members[1].axes, "along");
  const auto sub = space.project(*parent);
  REQUIRE(sub->space.dimension() == 3);
  CHECK(sub->space.axes()[0].hi == Approx(7.5));
  const auto two = problem.scene->reduced(axes_of(members, {1, 3}));
  const auto checker = make_checker("fcl", two, default_space(planar(*two).robot, planar(*two).world, 1.0), 0.05);
  Stream stream(4, "team", "along");
  Configuration s(3), to(3);
  int valid = 0;
  for (int i = 0; i < 2000; ++i) {
    sub->space.sample_uniform(stream, s);
    const Configuration at = s[0] < 4 ? Configuration{9 - s[0], 5} : Configuration{5, 5 - (s[0] - 4)};
    const bool expected = checker->valid(Configuration{s[1], s[2], at[0], at[1]});
    REQUIRE(sub->valid(s) == expected);
    sub->space.sample_uniform(stream, to);
    if (!expected) continue;
    ++valid;
    // What the motion places is valid throughout, where the motion is.
    if (!sub->validity->motion(s, to).valid) continue;
    Configurations two_points(3);
    two_points.push(s);
    two_points.push(to);
    const Configurations placed = space.placed(two_points);
    CHECK(placed.dimension() == 4);
    CHECK(placed.size() == ((s[0] < 4) != (to[0] < 4) ? 3 : 2));
  }
  CHECK(valid > 1000);
}

TEST_CASE("a schedule moves robots along their paths without a collision, and exists only if one does", "[team]") {
  const Problem problem = ring(4, 0.5);
  const auto parent = make_instance(problem);
  const std::vector<TeamMember> members = problem.scene->members();
  const auto straight = [&](std::size_t i) {
    Configurations path(2);
    for (const Configuration* q : {&problem.start, &problem.goals.front()}) {
      path.push(View(*q).subspan(2 * i, 2));
    }
    return RobotsPath(problem.space, members[i].axes, path);
  };
  // Paths that cross are passed one after the other; robots that meet head-on cannot pass.
  TeamSpace crossing(*parent, {straight(0), straight(1)}, {}, "crossing");
  const auto paths = crossing.project(*parent);
  ScheduleSearch search(*paths, 16);
  std::optional<Configurations> found;
  while (!found && !search.exhausted()) found = search.expand();
  REQUIRE(found.has_value());
  for (std::size_t i = 1; i < found->size(); ++i) {
    CHECK(paths->motion((*std::as_const(found))[i - 1], (*std::as_const(found))[i]).valid);
  }
  TeamSpace head_on(*parent, {straight(0), straight(2)}, {}, "head-on");
  const auto meeting = head_on.project(*parent);
  ScheduleSearch none(*meeting, 16);
  while (!none.exhausted()) REQUIRE_FALSE(none.expand().has_value());
}

TEST_CASE("drrt moves a team in the product of single robots' roadmaps", "[team]") {
  const Problem problem = ring(4, 0.4);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    const RunRecord run = execute(PlannerSpec::make("drrt", {}), problem, seed);
    REQUIRE(run.solved);
    check_path(problem, run.path);
  }
}

TEST_CASE("a path of a team is timed by the robot that moves farthest", "[team]") {
  const Problem problem = ring(2, 0.2);
  Configurations path(4);
  // Robot 1 moves 3 m while robot 2 moves 1 m, then robot 2 alone 2 m.
  for (const Configuration& q : std::vector<Configuration>{{0, 0, 5, 5}, {3, 0, 5, 6}, {3, 0, 5, 8}}) path.push(q);
  const TeamTimes times = times_of(problem.space, problem.scene->members(), path);
  CHECK(times.at == std::vector<double>{0, 3, 5});
  CHECK(times.makespan == 5);
  CHECK(times.sum_of_costs == 8);
}

TEST_CASE("a guide of teams says what it needs", "[team]") {
  CHECK_THROWS_WITH(execute(guided("prioritise"), test::cup_problem(), 1),
                    Contains("needs a team, as robots { robot.disc(0.3), robot.disc(0.3) }"));
  const auto named = [](const std::vector<std::string>& robots) {
    return GuideSpec::make("team", {{"robots", robots}}) >> PlannerSpec::make("rrt_connect", {});
  };
  CHECK_THROWS_WITH(execute(named({"9"}), ring(3, 0.5), 1), Contains("no robot 9 in the team, which has 1, 2, 3"));
  CHECK_THROWS_WITH(execute(named({"2", "2"}), ring(3, 0.5), 1), Contains("one is there twice"));
  Problem close = ring(4, 0.5);
  close.start = {5, 5, 5, 5.5, 1, 1, 9, 9};
  CHECK_THROWS_WITH(check(close), Contains("robot 1 meets robot 2"));
}
