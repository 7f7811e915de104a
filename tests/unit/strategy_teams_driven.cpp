// SPDX-License-Identifier: GPL-3.0-or-later
// Teams of robots with motion models: their motions are driven, and robots that follow a motion never go back.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/guide/driven_space.hpp>
#include <trellis/motion/team_model.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

using Model = std::shared_ptr<const MotionModel>;

Model model_of(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  const MotionKind& kind = *find_motion(name);
  return kind.make(Options::validate(*kind.component, given));
}

Model car() {
  return model_of("car", {{"wheelbase", 0.3}, {"max_speed", 1.0}, {"min_speed", -0.5}, {"max_steering", 0.7}});
}
/// A car that only goes forwards.
Model forward_car() {
  return model_of("car", {{"wheelbase", 0.3}, {"max_speed", 1.0}, {"min_speed", 0.0}, {"max_steering", 0.7}});
}

/// \param poses  start and goal of each robot: x, y, theta
Problem cars(World world, const std::vector<Model>& models,
             const std::vector<std::pair<Configuration, Configuration>>& poses) {
  Configuration start, goal;
  for (const auto& [from, to] : poses) {
    start.insert(start.end(), from.begin(), from.end());
    goal.insert(goal.end(), to.begin(), to.end());
  }
  Problem problem = test::make_problem(
      "cars", std::move(world), Robot::team(std::vector(models.size(), test::rectangle_robot(0.5, 0.3))), start, goal);
  std::vector<std::vector<std::size_t>> axes;
  for (const TeamMember& member : problem.scene->members()) axes.push_back(member.axes);
  problem.motion_model = std::make_shared<const TeamModel>(models, axes);
  problem.space = state_space(problem.space, *problem.motion_model);
  problem.start.resize(problem.space.dimension());
  problem.goals.front().resize(problem.space.dimension());
  problem.goal_tolerance = 0.4;
  return problem;
}

/// Cars that cross each other's path in an empty room.
Problem crossing(std::size_t count, const Model& model) {
  const std::vector<std::pair<Configuration, Configuration>> all = {
      {{1, 5, 0}, {9, 5, 0}}, {{5, 1, 1.57}, {5, 9, 1.57}}, {{9, 4, 3.1}, {1, 4, 3.1}}, {{4, 9, -1.57}, {4, 1, -1.57}}};
  return cars(test::rectangle_world({}), std::vector(count, model),
              {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)});
}

/// Two cars that meet in a corridor too narrow to pass.
/// \param bay  half-way
Problem corridor(const Model& model, bool bay) {
  test::Rectangles walls = {{0, 0, 10, 4.7}, {0, 5.3, 3.5, 10}, {6.5, 5.3, 10, 10}};
  walls.push_back(bay ? std::array<double, 4>{3.5, 7.7, 6.5, 10} : std::array<double, 4>{3.5, 5.3, 6.5, 10});
  return cars(test::rectangle_world(walls), {model, model}, {{{1, 5, 0}, {9, 5, 0}}, {{9, 5, 3.14}, {1, 5, 3.14}}});
}

StrategySpec guided(const std::string& guide, double proposals = 20000.0) {
  const bool joined = guide == "joined";
  return GuideSpec::make(joined ? "couple" : guide, joined ? std::vector<Options::Entry>{{"where", std::string("path")}}
                                                           : std::vector<Options::Entry>()) >>
         PlannerSpec::make("kinodynamic_rrt",
                           {{"bound", 0.0}, {"proposals", proposals}, {"extend", std::string("curves")}});
}

/// The path is what the trajectory drives, all robots are valid all along, and each is driven by its own model.
void check_run(const Problem& problem, const RunRecord& run) {
  const Solution& solution = run.levels.front().solution;
  REQUIRE(solution.solved());
  CHECK(problem.space.distance(run.path.back(), problem.goal()) <= problem.goal_tolerance);
  const Configurations replayed = replay(*problem.motion_model, problem.space, problem.start, solution.trajectory);
  REQUIRE(std::ranges::equal(replayed.values(), run.path.values()));
  const auto checker = make_checker("fcl", problem.scene, problem.space, 0.01);
  int invalid = 0;
  for (std::size_t i = 1; i < run.path.size(); ++i) {
    invalid += checker->motion(run.path[i - 1], run.path[i]).valid ? 0 : 1;
    invalid += problem.motion_model->admits(run.path[i]) ? 0 : 1;
  }
  CHECK(invalid == 0);
  REQUIRE(run.times.has_value());
  CHECK(run.times->makespan == Approx(solution.trajectory.duration()).margin(1e-9));
}

}  // namespace

TEST_CASE("kinodynamic_rrt drives a team in the product", "[team][kinodynamic]") {
  const Problem problem = crossing(2, car());
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    const auto planner =
        PlannerSpec::make("kinodynamic_rrt", {{"proposals", 50000.0}, {"extend", std::string("curves")}});
    const RunRecord run = execute(planner, problem, seed);
    REQUIRE(run.solved);
    CHECK(run.certified);
    check_run(problem, run);
  }
}

TEST_CASE("guides that divide a team of cars find motions of all", "[team][kinodynamic]") {
  for (const Model& model : {car(), forward_car()}) {
    const Problem problem = crossing(4, model);
    for (const char* guide : {"prioritise", "decouple", "joined"}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        CAPTURE(model->text(), guide, seed);
        const RunRecord run = execute(guided(guide), problem, seed);
        REQUIRE(run.solved);
        CHECK(run.certified);
        check_run(problem, run);
        // The guide alone found it: the root drives it again, without a check.
        CHECK(run.levels.front().search.checks.validity < run.validity_checks / 4);
        const RunRecord again = execute(guided(guide), problem, seed);
        CHECK(std::ranges::equal(run.path.values(), again.path.values()));
        CHECK(run.validity_checks == again.validity_checks);
      }
    }
  }
}

TEST_CASE("cars that cannot pass each other on their paths plan together", "[team][kinodynamic]") {
  const auto named = [](const RunRecord& run) {
    return std::any_of(run.levels.begin(), run.levels.end(),
                       [](const LevelRecord& level) { return level.name == "robots 1, 2"; });
  };
  const Problem closed = corridor(car(), false);
  CHECK(named(execute(guided("joined", 2000.0), closed, 1)));
  CHECK_FALSE(named(execute(guided("decouple", 2000.0), closed, 1)));
}

TEST_CASE("cars pass each other in a bay, one after the other", "[team][kinodynamic]") {
  int solved = 0;
  for (const Model& model : {car(), forward_car()}) {
    const Problem problem = corridor(model, true);
    for (const char* guide : {"prioritise", "joined"}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        CAPTURE(model->text(), guide, seed);
        const RunRecord run = execute(guided(guide), problem, seed);
        solved += run.solved ? 1 : 0;
        if (run.solved) check_run(problem, run);
      }
    }
  }
  CHECK(solved >= 15);
}

TEST_CASE("a driven space places robots along their motion, and motions that go back are invalid",
          "[team][kinodynamic]") {
  const Problem problem = crossing(3, forward_car());
  const auto parent = make_instance(problem);
  // Robot 1 drives straight for two seconds.
  DrivenPath path{{0}, Configurations(9), Configurations(6)};
  Configuration q = problem.start;
  path.states.push(q);
  for (int k = 0; k < 20; ++k) {
    path.controls.push(Configuration{1, 0, 0, 0, 0, 0});
    q[0] += 0.1;
    path.states.push(q);
  }
  DrivenSpace space(*parent, {path}, {1}, "along");
  const auto sub = space.project(*parent);
  REQUIRE(sub->space.dimension() == 4);
  CHECK(sub->start[0] == 0.0);
  CHECK(sub->goal()[0] == Approx(2.0));
  CHECK(sub->goal_tolerance == Approx(0.4 / std::sqrt(3.0)));
  CHECK(sub->motion_model->controls().size() == 3);
  const auto two = problem.scene->reduced({0, 1, 2, 3, 4, 5});
  const auto checker = make_checker("fcl", two, two->default_space(1.0 / std::numbers::pi), 0.05);
  Stream stream(1, "driven", "validity");
  Configuration s(4), to(4);
  int valid = 0;
  for (int i = 0; i < 1000; ++i) {
    sub->space.sample_uniform(stream, s);
    const double seconds = std::min(0.1 * std::round(s[0] / 0.1), 2.0);
    const bool expected = checker->valid(Configuration{1.0 + seconds, 5, 0, s[1], s[2], s[3]});
    REQUIRE(sub->valid(s) == expected);
    if (!expected) continue;
    ++valid;
    to = s;
    to[0] = s[0] - 0.5;
    if (s[0] > 0.6) REQUIRE_FALSE(sub->motion(s, to).valid);
    to = s;
    REQUIRE(sub->motion(s, to).valid);
  }
  CHECK(valid > 500);
  // The motion of both: under the control found before, and the own one; then robot 1 waits.
  Solution found{Status::solved, Configurations(4), {Configurations(3), {}, 0.1}};
  found.trajectory.controls.push(Configuration{0.9, 0.5, 0.1});
  found.trajectory.steps.push_back(3);
  found.trajectory.controls.push(Configuration{0.1, 1.0, 0.0});
  found.trajectory.steps.push_back(2);
  found.path = replay(*sub->motion_model, sub->space, sub->start, found.trajectory);
  const DrivenPath both = space.driven(found);
  CHECK(both.robots == std::vector<std::size_t>{0, 1});
  REQUIRE(both.steps() == 5);
  CHECK(std::ranges::equal(std::as_const(both.controls)[2], std::vector<double>{1, 0, 0.5, 0.1, 0, 0}));
  CHECK(std::ranges::equal(std::as_const(both.controls)[4], std::vector<double>{0, 0, 1, 0, 0, 0}));
  Configuration x = problem.start;
  for (std::size_t k = 0; k < 5; ++k) {
    problem.motion_model->step(problem.space, x, std::as_const(both.controls)[k], x);
    const View at = std::as_const(both.states)[k + 1];
    REQUIRE(std::equal(x.begin(), x.begin() + 6, at.begin()));
  }
}

TEST_CASE("holonomic drops the models of a team, and its guides divide what is left", "[team][kinodynamic]") {
  const Problem problem = crossing(2, car());
  const StrategySpec strategy =
      GuideSpec::make("prioritise", {}) >> GuideSpec::make("holonomic", {}) >>
      PlannerSpec::make("kinodynamic_rrt", {{"bound", 0.0}, {"proposals", 50000.0}, {"extend", std::string("curves")}});
  const RunRecord run = execute(strategy, problem, 1);
  REQUIRE(run.solved);
  check_run(problem, run);
  // A guide of single robots guides each search.
  const StrategySpec below = GuideSpec::make("skeleton", {}) >> guided("prioritise");
  const RunRecord each = execute(below, problem, 1);
  REQUIRE(each.solved);
  check_run(problem, each);
}

TEST_CASE("every guide of a team of cars plans, or says in a sentence why not", "[team][kinodynamic]") {
  const Problem problem = crossing(2, car());
  const auto planner =
      PlannerSpec::make("kinodynamic_rrt", {{"bound", 0.0}, {"proposals", 500.0}, {"extend", std::string("curves")}});
  const int ran = test::plan_with_every_guide(
      problem, planner,
      [](const GuideSpec& guide) {
        return test::above(guide, {"team", "prioritise", "decouple"});
      },
      [&](const RunRecord& run) { check_run(problem, run); });
  CHECK(ran > 30);
}

TEST_CASE("a team whose robots cannot wait, or would have to go back, is refused", "[team][kinodynamic]") {
  CHECK_THROWS_WITH(
      execute(guided("prioritise"), crossing(2, model_of("car", {{"min_speed", 0.1}})), 1),
      Contains("robot 1, a car, cannot: its least speed is above 0") && Contains("prioritise() >> holonomic()"));
  CHECK_THROWS_WITH(execute(guided("decouple"), crossing(2, model_of("unicycle2")), 1),
                    Contains("robot 1, a unicycle2, cannot: a control of 0 keeps the speed"));
  CHECK_THROWS_WITH(execute(guided("couple"), crossing(2, car()), 1), Contains("couple { where = \"path\" }"));
}
