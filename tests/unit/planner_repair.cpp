// SPDX-License-Identifier: GPL-3.0-or-later
// Planners that are called again after a change of the instance keep their valid parts.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/planner.hpp>

#include "support/catch.hpp"
#include "support/recording_guidance.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::PlannerRun;

namespace {

const std::vector<std::string>& trees() {
  static const std::vector<std::string> names = {"rrt", "rrt_connect", "rrt_star", "kinodynamic_rrt"};
  return names;
}
const std::vector<std::string>& roadmaps() {
  static const std::vector<std::string> names = {"prm", "lazy_prm", "prm_star", "lazy_prm_star", "lazy_rrg_star"};
  return names;
}
std::vector<std::string> all_planners() {
  std::vector<std::string> names = trees();
  names.insert(names.end(), roadmaps().begin(), roadmaps().end());
  return names;
}

std::vector<Options::Entry> options_for(const std::string& planner) {
  if (planner.ends_with("star")) return {{"improve", 200.0}};
  return {};
}

PlannerRun make_run(const std::string& planner, std::uint64_t seed) {
  const Problem problem = find_planner(planner)->kinodynamic ? test::driven(test::cup_problem()) : test::cup_problem();
  return {planner, problem, seed, options_for(planner)};
}

std::function<bool(View)> disc(double x, double y, double radius) {
  return [=](View q) { return std::hypot(q[0] - x, q[1] - y) <= radius; };
}

double distance_to_path(const Configurations& path, double x, double y) {
  double least = 1e9;
  for (std::size_t i = 0; i < path.size(); ++i) least = std::min(least, std::hypot(path[i][0] - x, path[i][1] - y));
  return least;
}

bool equal(const Configurations& a, const Configurations& b) {
  return std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

/// A disc on the path, away from its ends.
std::function<bool(View)> disc_on(const Configurations& path, double radius = 0.3) {
  const View middle = path[path.size() / 2];
  return disc(middle[0], middle[1], radius);
}

void check_path(PlannerRun& run, const Configurations& path) {
  REQUIRE(path.size() >= 2);
  CHECK(run.instance->space.distance(path.front(), run.instance->start) == 0.0);
  CHECK(run.instance->to_goal(path.back()) <= run.instance->goal_tolerance);
  for (std::size_t i = 1; i < path.size(); ++i) CHECK(run.validity->motion(path[i - 1], path[i]).valid);
}

}  // namespace

TEST_CASE("a path that is still valid after the instance changed is found again at the cost of its own motions",
          "[planner][repair]") {
  for (const auto& planner : all_planners()) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      CAPTURE(planner, seed);
      auto run = make_run(planner, seed);
      const Solution first = run.solve();
      REQUIRE(first.solved());
      // A disc away from the path.
      double x = 0.5;
      double y = 0.5;
      if (distance_to_path(first.path, x, y) < 1.0) y = 9.5;
      REQUIRE(distance_to_path(first.path, x, y) > 0.5);
      const std::size_t nodes = run.search.nodes.size();
      const std::size_t proposals = run.search.proposals.size();
      run.validity->exclude(disc(x, y, 0.4));
      const Solution again = run.solve();
      REQUIRE(again.solved());
      check_path(run, again.path);
      if (planner.find("star") != std::string::npos && planner != "rrt_star") continue;  // it continues to improve
      CHECK(run.search.proposals.size() == proposals);
      CHECK(run.search.nodes.size() == nodes);
      CHECK(equal(first.path, again.path));
      CHECK(run.validity->asked_again <= 3 * first.path.size());
    }
  }
}

TEST_CASE("branches that became invalid are removed, and the others are grown", "[planner][repair]") {
  for (const auto& planner : trees()) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      CAPTURE(planner, seed);
      auto run = make_run(planner, seed);
      const Solution first = run.solve();
      REQUIRE(first.solved());
      const auto nodes = static_cast<std::uint32_t>(run.search.nodes.size());
      const std::size_t proposals = run.search.proposals.size();
      run.validity->exclude(disc_on(first.path));
      const Solution again = run.solve();
      REQUIRE(again.solved());
      check_path(run, again.path);
      // Every node that was extended since has a valid branch, and some of them were kept.
      std::size_t kept = 0;
      std::size_t broken = 0;
      for (std::size_t i = proposals; i < run.search.near.size(); ++i) {
        const std::uint32_t row = run.search.near[i];
        kept += row < nodes && run.search.parents[row] != row ? 1 : 0;
        for (std::uint32_t at = row; run.search.parents[at] != at; at = run.search.parents[at]) {
          const auto& all = std::as_const(run.search.nodes);
          const bool valid = run.kind.kinodynamic ? run.validity->state(all[at])
                                                  : run.validity->motion(all[run.search.parents[at]], all[at]).valid;
          broken += valid ? 0 : 1;
        }
      }
      if (run.search.proposals.size() > proposals + 20) CHECK(kept > 0);
      CHECK(broken == 0);
      // Kept nodes are not recorded again.
      for (std::uint32_t row = nodes; row < run.search.nodes.size(); ++row) {
        CHECK(run.search.parents[row] != row);
      }
    }
  }
}

TEST_CASE("a roadmap keeps its vertices when the instance changes", "[planner][repair][roadmap]") {
  for (const auto& planner : roadmaps()) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      CAPTURE(planner, seed);
      auto run = make_run(planner, seed);
      const Solution first = run.solve();
      REQUIRE(first.solved());
      const std::size_t nodes = run.search.nodes.size();
      run.validity->exclude(disc_on(first.path));
      const Solution again = run.solve();
      REQUIRE(again.solved());
      check_path(run, again.path);
      for (std::size_t row = nodes; row < run.search.nodes.size(); ++row) {
        CHECK(run.instance->space.distance(run.search.nodes[row], run.instance->start) > 0.0);
      }
    }
  }
}

TEST_CASE("where only configurations were excluded, a roadmap rechecks nothing", "[planner][repair][roadmap]") {
  for (const std::string planner : {"prm", "lazy_prm"}) {
    CAPTURE(planner);
    auto run = make_run(planner, 2);
    run.validity->free_repair = true;
    const Solution first = run.solve();
    REQUIRE(first.solved());
    const double y = distance_to_path(first.path, 0.5, 0.5) < 1.0 ? 9.5 : 0.5;
    const Checks before = run.instance->checks;
    run.validity->exclude(disc(0.5, y, 0.4));
    REQUIRE(run.solve().solved());
    // The start and the goal.
    CHECK(run.instance->checks.validity == before.validity + 2);
    CHECK(run.instance->checks.motion == before.motion);
    // Vertices stay connected: none is reported a second time.
    const std::size_t reports = run.guidance.outcomes.size();
    run.validity->exclude(nullptr);
    REQUIRE(run.solve().solved());
    for (std::size_t i = reports; i < run.guidance.outcomes.size(); ++i) {
      CHECK(run.guidance.outcomes[i].added.empty());
    }
  }
}

TEST_CASE("the repair of a tree pauses and resumes", "[planner][repair]") {
  for (const auto& planner : trees()) {
    CAPTURE(planner);
    auto whole = make_run(planner, 5);
    const Solution first = whole.solve();
    REQUIRE(first.solved());
    whole.validity->exclude(disc_on(first.path));
    REQUIRE(whole.solve().solved());

    auto sliced = make_run(planner, 5);
    int left = 1 << 30;
    sliced.paused = [&] { return left-- <= 0; };
    REQUIRE(sliced.solve().solved());
    sliced.validity->exclude(disc_on(first.path));
    int slices = 0;
    Solution solution;
    do {
      left = 7;
      const std::uint64_t checks = sliced.instance->checks.motion;
      solution = sliced.solve();
      REQUIRE(++slices < 100000);
      if (!solution.solved()) CHECK(solution.status == Status::paused);
      // Longer only for the first branch.
      if (slices > 1 && planner == "rrt") CHECK(sliced.instance->checks.motion <= checks + 8 * first.path.size());
      REQUIRE_FALSE(solution.path.empty());
    } while (!solution.solved());
    CHECK(slices > 5);
    check_path(sliced, solution.path);
    // An anytime planner counts what it improves by solves.
    if (planner == "rrt_star") continue;
    CHECK(equal(sliced.search.nodes, whole.search.nodes));
    CHECK(sliced.search.parents == whole.search.parents);
    CHECK(sliced.instance->checks.validity == whole.instance->checks.validity);
  }
}

TEST_CASE("start and goal are checked again when the instance changes", "[planner][repair]") {
  for (const auto& planner : all_planners()) {
    CAPTURE(planner);
    auto run = make_run(planner, 1);
    const Solution first = run.solve();
    REQUIRE(first.solved());
    const std::size_t nodes = run.search.nodes.size();
    run.validity->exclude(disc(1, 5, 0.1));
    CHECK(run.solve().status == Status::invalid_start);
    run.validity->exclude(disc(9, 5, 0.1));
    CHECK(run.solve().status == Status::invalid_goal);
    run.validity->exclude(nullptr);
    const Solution again = run.solve();
    REQUIRE(again.solved());
    check_path(run, again.path);
    CHECK(run.search.nodes.size() < 2 * nodes + 1000);
  }
}

TEST_CASE("a search goes to the goals that are left", "[planner][repair]") {
  for (const auto& planner : all_planners()) {
    if (planner == "kinodynamic_rrt") continue;
    for (const std::uint64_t seed : {1, 2, 3}) {
      CAPTURE(planner, seed);
      auto run = make_run(planner, seed);
      run.instance->goals.insert(run.instance->goals.end(), {{9, 9, 0}, {5, 9.3, 0}});
      const Solution first = run.solve();
      REQUIRE(first.solved());
      const View end = first.path.back();
      run.validity->exclude(disc(end[0], end[1], 0.1));
      const Solution again = run.solve();
      REQUIRE(again.solved());
      check_path(run, again.path);
      CHECK(run.instance->goals.size() == 2);
    }
  }
}

TEST_CASE("an instance that is replaced with another start or goal is searched from there", "[planner][repair]") {
  for (const auto& planner : all_planners()) {
    for (const bool start : {true, false}) {
      CAPTURE(planner, start);
      auto run = make_run(planner, 1);
      REQUIRE(run.solve().solved());
      auto& end = start ? run.instance->start : run.instance->goals.front();
      end[1] = start ? 6.0 : 4.0;
      ++run.instance->revision;
      const Solution again = run.solve();
      REQUIRE(again.solved());
      check_path(run, again.path);
    }
  }
}

TEST_CASE("RRT-Connect keeps the tree at the goal when the start moves", "[planner][repair]") {
  auto run = make_run("rrt_connect", 3);
  REQUIRE(run.solve().solved());
  const auto nodes = run.search.nodes.size();
  const auto proposals = run.search.proposals.size();
  run.instance->start = {1, 1, 0};
  ++run.instance->revision;
  REQUIRE(run.solve().solved());
  bool kept = false;
  for (std::size_t i = proposals; i < run.search.near.size(); ++i) {
    kept = kept || (run.search.near[i] < nodes && run.search.near[i] > 1);
  }
  CHECK(kept);
  CHECK(run.search.nodes.size() > nodes);
}

TEST_CASE("without a change of the instance a tree that reached the goal is grown anew", "[planner][repair]") {
  for (const std::string planner : {"rrt", "rrt_connect", "kinodynamic_rrt"}) {
    CAPTURE(planner);
    auto run = make_run(planner, 1);
    REQUIRE(run.solve().solved());
    const auto nodes = run.search.nodes.size();
    run.solve();
    REQUIRE(run.search.nodes.size() > nodes);
    CHECK(run.search.parents[nodes] == nodes);
  }
}
