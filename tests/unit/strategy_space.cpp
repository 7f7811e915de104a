// SPDX-License-Identifier: GPL-3.0-or-later
// Guides for a rigid body in space: each one plans, alike for one seed, or says why it does not.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/guides.hpp"
#include "support/space.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

/// The slot with a ball and a mesh beside it.
Problem slot() {
  Problem problem = test::slot_problem();
  problem.scene = problem.scene->with_obstacles({0, 1, 2, 5});
  return problem;
}

/// Without a companion: the guides are set up in every run.
PlannerSpec planner() {
  return PlannerSpec::make("rrt_connect", {{"step", 1.0}, {"proposals", 20000.0}, {"bound", 0.0}});
}

void check_path(const Problem& problem, const Configurations& path) {
  const auto fine = make_checker("fcl_plain", problem.scene, problem.space, 0.25 * problem.resolution);
  REQUIRE(path.size() > 1);
  CHECK(std::equal(path[0].begin(), path[0].end(), problem.start.begin()));
  CHECK(problem.space.distance(path[path.size() - 1], problem.goal()) <= problem.goal_tolerance);
  for (std::size_t i = 1; i < path.size(); ++i) CHECK(fine->motion(path[i - 1], path[i]).valid);
}

}  // namespace

TEST_CASE("every guide plans for a body in space, or says in a sentence why not", "[strategy][space]") {
  const Problem problem = slot();
  const std::vector<std::string> planar = {"learned", "holonomic", "blossom"};
  for (const GuideKind& kind : test::guides_of_one_robot()) {
    const std::string& name = kind.component->name;
    if (name == "experience") continue;  // needs a library: below
    INFO(name);
    const StrategySpec strategy(planner(), test::guide_of(kind));
    if (std::find(planar.begin(), planar.end(), name) != planar.end()) {
      CHECK_THROWS_AS(execute(strategy, problem, 1), Error);
      continue;
    }
    const RunRecord run = execute(strategy, problem, 1);
    const RunRecord again = execute(strategy, problem, 1);
    REQUIRE(!run.path.empty());
    check_path(problem, run.path);
    CHECK(std::equal(run.path.values().begin(), run.path.values().end(), again.path.values().begin(),
                     again.path.values().end()));
  }
}

TEST_CASE("stored paths guide a body in space, a subspace among them", "[strategy][space]") {
  const test::Folder folder;
  const std::string file = folder.file("paths.db");
  Problem problem = slot();
  {
    Library library(file, Library::Mode::write);
    for (const std::uint64_t seed : {11U, 12U, 13U}) {
      const RunRecord run = execute(StrategySpec(planner()), problem, seed);
      REQUIRE(!run.path.empty());
      CHECK(library.add(stored_path(problem, run.path), problem.space, 0.0));
    }
  }
  const auto checks = [&](const StrategySpec& strategy) {
    const RunRecord run = execute(strategy, problem, 1);
    const RunRecord again = execute(strategy, problem, 1);
    REQUIRE(!run.path.empty());
    check_path(problem, run.path);
    CHECK(std::equal(run.path.values().begin(), run.path.values().end(), again.path.values().begin(),
                     again.path.values().end()));
    return run.validity_checks;
  };
  const auto plain = checks(StrategySpec(planner()));
  const std::string db = file;
  CHECK(checks(GuideSpec::make("experience", {{"db", db}, {"follow", std::string("waypoints")}}) >> planner()) < plain);
  checks(GuideSpec::make("experience", {{"db", db}, {"follow", std::string("tube")}}) >> planner());
  checks(GuideSpec::make("pca", {{"db", db}}) >> planner());
  checks(GuideSpec::make("experience", {{"db", db}}) >> GuideSpec::make("shrink", {{"scale", 0.5}}) >> planner());

  // The same paths for ends elsewhere, where they are repaired.
  problem.start[0] = 1.4;
  problem.start[1] = 4;
  problem.goals.front()[1] = 6;
  checks(GuideSpec::make("experience", {{"db", db}}) >> planner());
}

TEST_CASE("three kinds of space nest above a body in space", "[strategy][space]") {
  const Problem problem = slot();
  const StrategySpec strategy = GuideSpec::make("workspace", {}) >> GuideSpec::make("shrink", {{"scale", 0.5}}) >>
                                GuideSpec::make("lazy", {}) >> planner();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const RunRecord run = execute(strategy, problem, seed);
    REQUIRE(!run.path.empty());
    REQUIRE(run.levels.size() == 4);
    CHECK(run.levels.back().space.dimension() == 3);
    check_path(problem, run.path);
  }
}

TEST_CASE("lifts by handles are refused in space", "[strategy][space]") {
  const StrategySpec strategy = GuideSpec::make("workspace", {{"lift", std::string("handles")}}) >> planner();
  CHECK_THROWS_WITH(execute(strategy, slot(), 1), Contains("works in the plane"));
}

TEST_CASE("guides nest in pairs, sequences and mixtures above a body in space", "[strategy][space][slow]") {
  const Problem problem = slot();
  const auto small = PlannerSpec::make("rrt_connect", {{"step", 1.0}, {"proposals", 150.0}, {"bound", 0.0}});
  std::vector<std::string> names;
  for (const GuideKind& kind : test::guides_of_one_robot()) {
    const std::string& name = kind.component->name;
    if (name != "experience" && name != "learned" && name != "holonomic" && name != "blossom") names.push_back(name);
  }
  // A guide may refuse the space of another one in a sentence; a fault fails.
  const auto plans_or_says_why = [&](const StrategySpec& strategy) {
    try {
      const RunRecord run = execute(strategy, problem, 1);
      if (!run.path.empty()) check_path(problem, run.path);
    } catch (const Error& error) {
      CHECK(std::string(error.what()).size() > 20);
    }
  };
  for (const std::string& upper : names) {
    for (const std::string& lower : names) {
      CAPTURE(upper, lower);
      const GuideSpec a = GuideSpec::make(upper, {}), b = GuideSpec::make(lower, {});
      if (!find_guide(lower)->default_planner.empty()) plans_or_says_why(a >> b >> small);
      if (upper < lower) plans_or_says_why((a + b) >> small);
      if (upper < lower) plans_or_says_why(sequence({a, b}, 20) >> small);
    }
  }
}
