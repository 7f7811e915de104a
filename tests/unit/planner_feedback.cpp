// SPDX-License-Identifier: GPL-3.0-or-later
// The reports of planners to their guidance, and their queries.
#include <algorithm>
#include <set>
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

Problem problem_for(const PlannerKind& kind) {
  return kind.kinodynamic ? test::driven(test::cup_problem()) : test::cup_problem();
}

PlannerRun make_run(const std::string& planner, std::uint64_t seed = 1, const std::vector<Options::Entry>& given = {}) {
  return {planner, problem_for(*find_planner(planner)), seed, given};
}

std::vector<std::string> sampling_planners() {
  std::vector<std::string> names;
  for (const auto& kind : planner_kinds()) {
    if (!kind.graph) names.push_back(kind.component->name);
  }
  return names;
}

bool same(View a, View b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

/// The vertices that valid edges of a roadmap join to a row.
std::set<std::uint32_t> component(const Search& search, std::uint32_t row,
                                  const std::function<bool(std::uint32_t, std::uint32_t)>& valid) {
  std::vector<std::vector<std::uint32_t>> neighbours(search.nodes.size());
  for (const auto& [a, b] : search.edges) {
    if (!valid(a, b)) continue;
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  std::set<std::uint32_t> reached = {row};
  std::vector<std::uint32_t> open = {row};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    for (const std::uint32_t next : neighbours[at]) {
      if (reached.insert(next).second) open.push_back(next);
    }
  }
  return reached;
}

}  // namespace

TEST_CASE("a guidance receives the outcome of its proposal before any other", "[planner][feedback]") {
  for (const auto& planner : sampling_planners()) {
    CAPTURE(planner);
    auto run = make_run(planner);
    run.solve();
    std::vector<std::size_t> first(run.guidance.proposals + 1, 0);
    std::size_t own = 0;
    bool before = true;
    for (const auto& outcome : run.guidance.outcomes) {
      if (outcome.proposals == 0) continue;
      if (first[outcome.proposals]++ == 0) before = before && outcome.mine;
      own += outcome.mine ? 1 : 0;
    }
    CHECK(before);
    CHECK(own == run.guidance.proposals);
  }
}

TEST_CASE("every node of a tree is reported once, by its row and by the tree that it is in", "[planner][feedback]") {
  for (const std::string planner : {"rrt", "rrt_connect", "rrt_star", "kinodynamic_rrt"}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      CAPTURE(planner, seed);
      auto run = make_run(planner, seed,
                          planner == "kinodynamic_rrt" ? std::vector<Options::Entry>{{"extend", std::string("curves")}}
                                                       : std::vector<Options::Entry>{});
      REQUIRE(run.solve().solved());
      const auto& search = run.search;
      std::vector<int> reports(search.nodes.size(), 0);
      for (const auto& outcome : run.guidance.outcomes) {
        CHECK((outcome.added_row != no_node) == !outcome.added.empty());
        if (outcome.added.empty()) continue;
        REQUIRE(outcome.added_row < search.nodes.size());
        CHECK(same(outcome.added, std::as_const(search.nodes)[outcome.added_row]));
        CHECK(outcome.connected);
        ++reports[outcome.added_row];
        std::uint32_t root = outcome.added_row;
        while (search.parents[root] != root) root = search.parents[root];
        CHECK(outcome.from_goal == same(std::as_const(search.nodes)[root], run.instance->goal()));
      }
      for (std::uint32_t row = 0; row < search.nodes.size(); ++row) {
        CHECK(reports[row] == (search.parents[row] == row ? 0 : 1));
      }
    }
  }
}

TEST_CASE("a guidance receives everything that a planner finds invalid", "[planner][feedback]") {
  for (const auto& planner : sampling_planners()) {
    // A motion driven beyond the goal may be invalid there, which is of no interest.
    if (planner == "kinodynamic_rrt") continue;
    for (const bool coarse : {false, true}) {
      if (coarse && planner != "lazy_prm") continue;
      CAPTURE(planner, coarse);
      std::vector<Options::Entry> options;
      if (coarse) options = {{"edges", std::string("coarse_to_fine")}, {"enhance", 1.0}};
      auto run = make_run(planner, 1, options);
      REQUIRE(run.solve().solved());
      std::size_t reports = 0;
      for (const auto& outcome : run.guidance.outcomes) {
        if (outcome.blocked_at.empty()) continue;
        ++reports;
        CHECK_FALSE(run.validity->state(outcome.blocked_at));
      }
      CHECK(reports > 10);
      CHECK(reports + reports == run.validity->invalid_states + run.validity->invalid_motions);
    }
  }
}

TEST_CASE("a blocked motion to the goal is news from a kinodynamic tree too", "[planner][feedback]") {
  std::size_t blocked = 0;
  for (std::uint64_t seed = 1; seed <= 20 && blocked == 0; ++seed) {
    auto run = make_run("kinodynamic_rrt", seed, {{"connect", 6.0}});
    run.solve();
    for (const auto& outcome : run.guidance.outcomes) {
      if (!outcome.mine && !outcome.blocked_at.empty() && same(outcome.proposal, run.instance->goal())) ++blocked;
    }
  }
  CHECK(blocked > 0);
}

TEST_CASE("a vertex of a roadmap is reported as connected once motions that were checked join it to the start",
          "[planner][feedback][roadmap]") {
  for (const std::string planner : {"prm", "prm_star", "lazy_prm", "lazy_prm_star", "lazy_rrg_star"}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      CAPTURE(planner, seed);
      auto run = make_run(
          planner, seed,
          planner.ends_with("star") ? std::vector<Options::Entry>{{"improve", 100.0}} : std::vector<Options::Entry>{});
      const Solution solution = run.solve();
      REQUIRE(solution.solved());
      std::set<std::uint32_t> from_start;
      std::set<std::uint32_t> from_goal;
      std::set<std::uint32_t> reported;
      for (const auto& outcome : run.guidance.outcomes) {
        if (outcome.added.empty()) continue;
        reported.insert(outcome.added_row);
        if (!outcome.connected) continue;
        // Each side is reported once.
        CHECK((outcome.from_goal ? from_goal : from_start).insert(outcome.added_row).second);
      }
      // All but the start and the goal.
      CHECK(reported.size() >= run.search.nodes.size() - 2);
      const auto motion = [&](std::uint32_t a, std::uint32_t b) {
        const auto& nodes = std::as_const(run.search.nodes);
        return run.validity->state(nodes[a]) && run.validity->state(nodes[b]) &&
               run.validity->motion(nodes[a], nodes[b]).valid;
      };
      const auto by_start = component(run.search, 0, motion);
      const auto by_goal = component(run.search, 1, motion);
      from_start.insert(0);
      from_goal.insert(1);
      if (!planner.starts_with("lazy")) {
        // All edges are checked.
        CHECK(from_start == by_start);
        CHECK(from_goal == by_goal);
        continue;
      }
      CHECK(std::includes(by_start.begin(), by_start.end(), from_start.begin(), from_start.end()));
      CHECK(std::includes(by_goal.begin(), by_goal.end(), from_goal.begin(), from_goal.end()));
      // The path was checked, and most of the roadmap was not.
      if (planner == "lazy_prm") CHECK(from_start.size() < reported.size() / 2);
      for (std::size_t i = 0; i < solution.path.size(); ++i) {
        const auto on_path = [&](std::uint32_t row) {
          return same(std::as_const(run.search.nodes)[row], solution.path[i]);
        };
        CHECK(std::any_of(from_start.begin(), from_start.end(), on_path));
        CHECK(std::any_of(from_goal.begin(), from_goal.end(), on_path));
      }
    }
  }
}

TEST_CASE("where validity is presumed, a lazy roadmap's vertices are connected as soon as edges join them",
          "[planner][feedback][roadmap]") {
  auto run = make_run("lazy_prm", 1, {{"samples", std::int64_t{200}}, {"batch", std::int64_t{200}}});
  run.validity->counted = false;
  run.guided = true;
  REQUIRE(run.solve().solved());
  std::set<std::uint32_t> connected = {0};
  for (const auto& outcome : run.guidance.outcomes) {
    if (outcome.connected && !outcome.added.empty() && !outcome.from_goal) connected.insert(outcome.added_row);
  }
  CHECK(connected.size() > 150);
  CHECK(run.instance->checks.validity == 0);
}

TEST_CASE("a tree is extended from the node that the guidance names", "[planner][feedback]") {
  for (const std::string planner : {"rrt", "rrt_connect", "rrt_star", "kinodynamic_rrt"}) {
    CAPTURE(planner);
    auto run = make_run(planner, 3, {{"proposals", std::int64_t{60}}});
    run.guidance.choose_vertex = [&] { return static_cast<std::uint32_t>(run.search.nodes.size() / 2); };
    std::vector<std::uint32_t> wanted;
    auto choose = run.guidance.choose_vertex;
    run.guidance.choose_vertex = [&, choose] {
      wanted.push_back(choose());
      return wanted.back();
    };
    run.solve();
    REQUIRE(wanted.size() == run.search.proposals.size());
    std::size_t followed = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) followed += run.search.near[i] == wanted[i] ? 1 : 0;
    // A row of the other tree is no node to extend.
    if (planner == "rrt_connect") {
      CHECK(followed > 5);
      CHECK(followed < wanted.size());
    } else {
      CHECK(followed == wanted.size());
    }
    // A row that is none changes nothing.
    auto plain = make_run(planner, 3, {{"proposals", std::int64_t{60}}});
    plain.solve();
    auto none = make_run(planner, 3, {{"proposals", std::int64_t{60}}});
    none.guidance.choose_vertex = [] { return no_node - 1; };
    none.solve();
    CHECK(none.search.near == plain.search.near);
  }
}

TEST_CASE("motions beyond a proposal are tried only where the guidance finds them worth it", "[planner][feedback]") {
  for (const std::string planner : {"rrt", "rrt_connect", "rrt_star", "kinodynamic_rrt"}) {
    CAPTURE(planner);
    std::vector<Options::Entry> options = {{"proposals", std::int64_t{2000}}, {"goal_bias", 0.0}};
    if (planner == "kinodynamic_rrt") options.emplace_back("connect", 6.0);
    auto run = make_run(planner, 1, options);
    std::size_t asked = 0;
    run.guidance.judge_connection = [&](View from, View to) {
      asked += from.size() == to.size() ? 1 : 0;
      return false;
    };
    run.solve();
    CHECK(asked > 0);
    CHECK(run.search.nodes.size() <= run.search.proposals.size() + 2);
    for (const auto& outcome : run.guidance.outcomes) {
      if (!outcome.mine) CHECK_FALSE(same(outcome.proposal, run.instance->goal()));
    }
  }
}

TEST_CASE("RRT-Connect says which tree a proposal is for", "[planner][feedback]") {
  auto run = make_run("rrt_connect");
  REQUIRE(run.solve().solved());
  REQUIRE(run.guidance.sides.size() == run.guidance.proposals);
  for (const auto& outcome : run.guidance.outcomes) {
    const bool goal_side = run.guidance.sides[outcome.proposals - 1] == TreeSide::goal;
    CHECK(outcome.from_goal == (outcome.mine == goal_side));
  }
}
