// SPDX-License-Identifier: GPL-3.0-or-later
// Kinodynamic robots: the record of their paths, and the planners that are rejected.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/recording_guidance.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

/// The guides of a list, the first one outermost, above a kinodynamic RRT.
StrategySpec strategy(const std::vector<GuideSpec>& guides, const std::string& extend = "controls") {
  const PlannerSpec planner = PlannerSpec::make("kinodynamic_rrt", {{"extend", extend}});
  if (guides.empty()) return StrategySpec(planner);
  GuideSpec all = guides.front();
  for (std::size_t i = 1; i < guides.size(); ++i) all = all >> guides[i];
  return all >> planner;
}

}  // namespace

TEST_CASE("a driven path is recorded as its controls, which give its states to the bit", "[kinodynamic]") {
  for (const std::string model : {"unicycle1", "unicycle2", "car"}) {
    const Problem problem = test::driven(test::cup_problem(), model);
    for (const auto& [guided, extend] :
         {std::pair(false, "controls"), std::pair(true, "controls"), std::pair(false, "curves")}) {
      CAPTURE(model, guided, extend);
      const auto spec = guided ? strategy({GuideSpec::make("skeleton", {}), GuideSpec::make("holonomic", {})}, extend)
                               : strategy({}, extend);
      const auto run = execute(spec, problem, 3, {.shortcut = 100});
      REQUIRE(run.solved);
      const auto states = replay(*problem.motion_model, problem.space, problem.start, run.trajectory);
      REQUIRE(states.size() == run.path.size());
      CHECK(std::equal(states.values().begin(), states.values().end(), run.path.values().begin()));
      CHECK(run.trajectory.duration() == Approx(0.1 * static_cast<double>(states.size() - 1)));
      CHECK(run.shortcut_checks == 0);
      CHECK(problem.space.distance(run.path.back(), problem.goal()) <= problem.goal_tolerance);
      auto instance = make_instance(problem);
      for (std::size_t i = 0; i < states.size(); ++i) CHECK(instance->valid(states[i]));
      for (std::size_t i = 1; i < states.size(); ++i) CHECK(instance->motion(states[i - 1], states[i]).valid);
      const auto again = execute(spec, problem, 3);
      CHECK(std::equal(run.path.values().begin(), run.path.values().end(), again.path.values().begin(),
                       again.path.values().end()));
    }
  }
}

TEST_CASE("a default planner that becomes kinodynamic keeps the options that its guide sets", "[kinodynamic]") {
  const Problem driven = test::driven(test::simple_passage_problem());
  const auto goals = [&](const std::vector<GuideSpec>& guides) {
    std::size_t proposals = 0;
    std::ptrdiff_t of_goals = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const RunRecord run = execute(strategy(guides), driven, seed, {.companion = false});
      const LevelRecord& level = run.levels.at(1);
      CHECK(level.planner == "kinodynamic_rrt");
      proposals += level.search.proposals.size();
      of_goals += std::count(level.search.proposal_sources.begin(), level.search.proposal_sources.end(), 0);
    }
    CHECK(proposals > 100);
    return of_goals;
  };
  // lazy asks for a search without a goal bias where a guide stands below it; shrink asks for nothing.
  CHECK(goals({GuideSpec::make("holonomic", {}), GuideSpec::make("lazy", {})}) == 0);
  CHECK(goals({GuideSpec::make("holonomic", {}), GuideSpec::make("shrink", {})}) > 0);
}

TEST_CASE("a motion of too many integration steps is refused", "[kinodynamic]") {
  Problem problem = test::driven(test::cup_problem());
  problem.motion_model =
      find_motion("unicycle1")->make(Options::validate(*find_motion("unicycle1")->component, {{"dt", 1e-12}}));
  CHECK_THROWS_WITH(execute(strategy({}), problem, 1),
                    Contains("longest = ") && Contains("dt = 1e-12 s") && Contains("increase dt"));
}

TEST_CASE("a planner that cannot respect the motion model is refused, and one that drives where there is none",
          "[kinodynamic]") {
  const Problem driven = test::driven(test::cup_problem());
  const StrategySpec straight(PlannerSpec::make("rrt", {}));
  for (const bool running : {false, true}) {
    const auto refused = [&] { running ? static_cast<void>(execute(straight, driven, 1)) : check(straight, driven); };
    CHECK_THROWS_WITH(refused(), Contains("rrt joins configurations by straight motions") &&
                                     Contains("motion model unicycle1") && Contains("kinodynamic_rrt") &&
                                     Contains("holonomic()") && Contains("level 0"));
  }
  CHECK_THROWS_WITH(check(strategy({}), test::cup_problem()),
                    Contains("kinodynamic_rrt drives a motion model") && Contains("motion.unicycle1"));
  // shrink's level has the motion model: its default planner is kinodynamic, and another planner is an error.
  CHECK_NOTHROW(check(strategy({GuideSpec::make("shrink", {})}), driven));
  CHECK_THROWS_WITH(check(strategy({GuideSpec::make("shrink", {}, PlannerSpec::make("rrt", {}))}), driven),
                    Contains("level 1") && Contains("rrt joins configurations by straight motions"));
  GuideSpec driving = GuideSpec::make("shrink", {}, PlannerSpec::make("kinodynamic_rrt", {}));
  CHECK_NOTHROW(check(strategy({driving}), driven));
  CHECK_NOTHROW(check(strategy({GuideSpec::make("shrink", {}), GuideSpec::make("holonomic", {})}), driven));
  CHECK_NOTHROW(check(strategy({GuideSpec::make("lazy", {}), GuideSpec::make("holonomic", {})}), driven));
  // holonomic's own search is one of straight motions.
  CHECK_THROWS_WITH(
      check(strategy({GuideSpec::make("holonomic", {}, PlannerSpec::make("kinodynamic_rrt", {}))}), driven),
      Contains("level 1") && Contains("kinodynamic_rrt drives a motion model"));
}

TEST_CASE("each extension of a kinodynamic tree is recorded as node, proposal, control and result", "[kinodynamic]") {
  for (const std::string extend : {"controls", "curves"}) {
    CAPTURE(extend);
    const Problem problem = test::driven(test::cup_problem(), "unicycle1");
    const MotionModel& model = *problem.motion_model;
    for (const bool guided : {false, true}) {
      const RunRecord run =
          execute(strategy(guided ? std::vector{GuideSpec::make("holonomic", {})} : std::vector<GuideSpec>{}, extend),
                  problem, 3);
      const Search& search = run.levels.front().search;
      const ControlRecord& record = search.controls;
      CHECK(record.longest == 10);
      CHECK(record.dt == 0.1);
      CHECK(record.curves == (extend == "curves"));
      REQUIRE(record.ends.size() == search.proposals.size());
      REQUIRE(record.ends.back() == record.steps.size());
      REQUIRE(record.driven.size() == record.steps.size());
      std::size_t several = 0;
      for (std::size_t i = 0; i < record.ends.size(); ++i) {
        // Driven from the node that was extended, the controls end at the node that was added.
        const View near = search.nodes[search.near[i]];
        Configuration at(near.begin(), near.end());
        std::uint32_t driven = 0;
        for (std::size_t k = record.begin_of(i); k < record.ends[i]; ++k) {
          CHECK(model.allows(record.controls[k]));
          CHECK(record.driven[k] <= record.steps[k]);
          driven += record.driven[k];
          for (std::uint32_t n = 0; n < record.driven[k]; ++n) {
            model.step(problem.space, at, record.controls[k], at);
          }
        }
        several += record.ends[i] - record.begin_of(i) > 1 ? 1 : 0;
        CHECK(driven <= record.longest);
        REQUIRE((driven == 0) == (search.added[i] == no_node));
        if (driven > 0) CHECK(std::ranges::equal(at, search.nodes[search.added[i]]));
      }
      CHECK((several > 0) == record.curves);
    }
  }
}

TEST_CASE("a guidance chooses the control of an extension", "[kinodynamic]") {
  test::PlannerRun run("kinodynamic_rrt", test::driven(test::cup_problem()), 1, {{"proposals", std::int64_t{200}}});
  std::vector<Configuration> chosen;
  run.guidance.choose_control = [&](const ControlQuery& query, MutableView control) {
    CHECK(query.longest == 10);
    CHECK(std::ranges::equal(query.from, std::as_const(run.search.nodes)[query.row]));
    CHECK(std::ranges::equal(query.proposal, run.search.proposals.back()));
    control[0] = 0.01 * static_cast<double>(chosen.size() % 100);
    control[1] = -0.5;
    chosen.emplace_back(control.begin(), control.end());
    return static_cast<std::uint32_t>(1 + chosen.size() % 4);
  };
  run.solve();
  const ControlRecord& record = run.search.controls;
  REQUIRE(chosen.size() == run.search.proposals.size());
  std::size_t at = 0;
  for (const auto& outcome : run.guidance.outcomes) {
    if (!outcome.mine) continue;
    REQUIRE(outcome.control == chosen[at]);
    CHECK(outcome.near_row == run.search.near[at]);
    CHECK(outcome.steps == record.driven[at]);
    CHECK(record.steps[at] == 1 + (at + 1) % 4);
    ++at;
  }
  CHECK(at == chosen.size());
  // A control out of its bounds is a fault of the guide.
  test::PlannerRun wrong("kinodynamic_rrt", test::driven(test::cup_problem()), 1);
  wrong.guidance.choose_control = [](const ControlQuery&, MutableView control) {
    control[0] = 5.0;
    control[1] = 0.0;
    return std::uint32_t{1};
  };
  CHECK_THROWS_AS(wrong.solve(), Fault);
}

TEST_CASE("blossom drives a robot to its goal under its controls, the same ones each time", "[kinodynamic][blossom]") {
  for (const std::string model : {"unicycle1", "unicycle2", "car"}) {
    CAPTURE(model);
    const Problem problem = test::driven(test::cup_problem(), model);
    const StrategySpec spec = GuideSpec::make("blossom", {}) >> PlannerSpec::make("kinodynamic_rrt", {{"bound", 0.0}});
    const RunRecord run = execute(spec, problem, 2);
    CHECK(run.solved);
    const RunRecord again = execute(spec, problem, 2);
    CHECK(std::ranges::equal(run.path.values(), again.path.values()));
    CHECK(run.validity_checks == again.validity_checks);
  }
}
