// SPDX-License-Identifier: GPL-3.0-or-later
// Planners of OMPL that draw from a guide. Built where OMPL is installed.
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <memory>

#include <trellis/ompl.hpp>

#include "support/catch.hpp"
#include "support/space.hpp"
#include "support/worlds.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;
using namespace trellis;

namespace {

/// A wall with a gap.
trellis::Problem gap_problem() {
  return test::make_problem("gap", test::rectangle_world({{4.5, 0, 5.5, 6.7}, {4.5, 7.3, 5.5, 10}}, 10.0),
                            test::rectangle_robot(), {1, 2, 0}, {9, 2, 0});
}

struct Planned {
  bool solved = false;
  std::uint64_t checks = 0;
  LevelRecord root;
};

template <class P>
Planned guided(OmplGuide::Search search, std::uint64_t seed) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
  const Problem problem = gap_problem();
  OmplProblem of(problem);
  Sampler sampler(GuideSpec::make("skeleton", {}), problem, seed);
  OmplGuide guide(of.information(), sampler, search);
  P planner(of.information());
  if constexpr (requires { planner.setRange(0.5); }) planner.setRange(0.5);
  planner.setProblemDefinition(of.definition());
  planner.setup();
  const ob::PlannerTerminationCondition over([&] { return guide.connected() || guide.draws() > 5000; });
  Planned planned;
  planned.solved = planner.solve(over) == ob::PlannerStatus::EXACT_SOLUTION || guide.connected();
  CHECK(guide.checks() == of.checks());
  planned.checks = guide.checks() + sampler.checks();
  planned.root = sampler.levels().front();
  return planned;
}

}  // namespace

TEST_CASE("OMPL's planners find a gap by a guide's draws", "[ompl]") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CAPTURE(seed);
    const Planned rrt = guided<og::RRT>(OmplGuide::Search::tree, seed);
    CHECK(rrt.solved);
    const Planned connect = guided<og::RRTConnect>(OmplGuide::Search::trees, seed);
    CHECK(connect.solved);
    const Planned prm = guided<og::PRM>(OmplGuide::Search::roadmap, seed);
    CHECK(prm.solved);
    for (const Planned* one : {&rrt, &connect, &prm}) {
      const Search& search = one->root.search;
      CHECK(search.fates.size() == search.proposals.size());
      CHECK(search.parents.size() == search.nodes.size());
      CHECK(std::count(search.fates.begin(), search.fates.end(), Fate::rejected) <
            static_cast<std::ptrdiff_t>(search.fates.size()));
      CHECK(one->root.guided);
    }
  }
}

TEST_CASE("the same seed gives a tree of OMPL's the same draws", "[ompl]") {
  const Planned one = guided<og::RRTConnect>(OmplGuide::Search::trees, 7);
  const Planned two = guided<og::RRTConnect>(OmplGuide::Search::trees, 7);
  CHECK(one.checks == two.checks);
  const auto& a = one.root.search.proposals.values();
  const auto& b = two.root.search.proposals.values();
  REQUIRE(a.size() == b.size());
  CHECK(std::equal(a.begin(), a.end(), b.begin()));
}

TEST_CASE("a space information of one's own asks a guide", "[ompl]") {
  ompl::msg::noOutputHandler();
  const Problem problem = gap_problem();
  const auto space = std::make_shared<ob::SE2StateSpace>();
  ob::RealVectorBounds bounds(2);
  bounds.setLow(0.0);
  bounds.setHigh(10.0);
  space->setBounds(bounds);
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  const auto instance = make_instance(problem);
  std::uint64_t own = 0;
  information->setStateValidityChecker([&](const ob::State* q) {
    ++own;
    const Configuration at = reals_of(*space, q);
    return instance->space.contains(at) && instance->valid(at);
  });
  information->setStateValidityCheckingResolution(0.005);
  information->setup();
  Sampler sampler(GuideSpec::make("skeleton", {}), problem, 1);
  own = 0;
  OmplGuide guide(information, sampler, OmplGuide::Search::tree);
  const std::uint64_t before = own;
  ob::ScopedState<ob::SE2StateSpace> start(space);
  start->setXY(1, 2);
  start->setYaw(0);
  ob::ScopedState<ob::SE2StateSpace> goal(space);
  goal->setXY(9, 2);
  goal->setYaw(0);
  const auto definition = std::make_shared<ob::ProblemDefinition>(information);
  definition->setStartAndGoalStates(start, goal);
  og::RRT planner(information);
  planner.setRange(0.5);
  planner.setProblemDefinition(definition);
  planner.setup();
  const ob::PlannerTerminationCondition over([&] { return guide.draws() > 5000; });
  CHECK(planner.solve(over) == ob::PlannerStatus::EXACT_SOLUTION);
  CHECK(guide.checks() == own - before);
  // Without the guide it is as before.
  const std::uint64_t draws = guide.draws();
  own = 0;
  { OmplGuide other(information, sampler, OmplGuide::Search::tree); }
  CHECK(information->isValid(start.get()));
  CHECK(own == 1);
  CHECK(guide.draws() == draws);
  // Refusals have their place: the guide learns what is blocked.
  CHECK(sampler.nodes() > 10);
}

TEST_CASE("states of SE(3) are configurations of a body in space", "[ompl]") {
  ompl::msg::noOutputHandler();
  const Problem problem = test::slot_problem();
  const auto space = std::make_shared<ob::SE3StateSpace>();
  ob::RealVectorBounds bounds(3);
  for (unsigned j = 0; j < 3; ++j) {
    bounds.setLow(j, problem.space.coordinates()[j].lo);
    bounds.setHigh(j, problem.space.coordinates()[j].hi);
  }
  space->setBounds(bounds);
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  const auto instance = make_instance(problem);
  information->setStateValidityChecker([&](const ob::State* q) {
    const Configuration at = reals_of(*space, q);
    return instance->space.contains(at) && instance->valid(at);
  });
  information->setup();
  Sampler sampler(GuideSpec::make("workspace", {}), problem, 1);
  OmplGuide guide(information, sampler, OmplGuide::Search::tree);
  const auto state = [&](const Configuration& q) {
    ob::ScopedState<> of(space);
    space->copyFromReals(of.get(), {q.begin(), q.end()});
    return of;
  };
  const auto definition = std::make_shared<ob::ProblemDefinition>(information);
  definition->setStartAndGoalStates(state(problem.start), state(problem.goal()));
  og::RRT planner(information);
  planner.setRange(0.5);
  planner.setProblemDefinition(definition);
  planner.setup();
  const ob::PlannerTerminationCondition over([&] { return guide.draws() > 2000; });
  static_cast<void>(planner.solve(over));
  // All nodes but the start have one of these as their parent: each was found by its coordinates.
  const Search search = sampler.levels().front().search;
  REQUIRE(search.nodes.size() > 20);
  for (std::size_t i = 1; i < search.nodes.size(); ++i) CHECK(search.parents[i] < i);
}
