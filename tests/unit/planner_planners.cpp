// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that every sampling planner keeps, on every problem.
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/planner.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

struct Outcomes {
  Solution solution;
  Search search;
  Checks checks;
};

Options options_of(const PlannerKind& kind, const std::vector<Options::Entry>& given) {
  return Options::validate(*kind.component, given);
}

/// The problem as a planner can have it.
Problem fitting(const PlannerKind& kind, const Problem& problem) {
  return kind.kinodynamic && !problem.motion_model ? test::driven(problem) : problem;
}

Outcomes run(const PlannerKind& kind, const Problem& given_problem, std::uint64_t seed, int solves = 1,
             const std::vector<Options::Entry>& given = {}) {
  const Problem problem = fitting(kind, given_problem);
  auto instance = make_instance(problem);
  UniformGuidance guidance(instance->space);
  Outcomes out;
  out.search.nodes = Configurations(instance->space.dimension());
  out.search.proposals = Configurations(instance->space.dimension());
  const Options options = options_of(kind, given);
  auto planner = kind.make(options, {*instance, guidance, Stream(seed, "0", "proposals"), out.search, false});
  for (int i = 0; i < solves; ++i) out.solution = planner->solve(guidance, kind.common(options).budget);
  out.checks = instance->checks;
  return out;
}

/// A path is checked again at a quarter of the resolution.
void check_path(const Problem& problem, const Configurations& path) {
  REQUIRE(path.size() >= 2);
  const auto& space = problem.space;
  CHECK(space.distance(path.front(), problem.start) == 0.0);
  CHECK(space.distance(path.back(), problem.goal()) <= problem.goal_tolerance);
  const auto checker = make_planar_checker(problem.scene, space, problem.resolution);
  CHECK(checker->valid(path.front()));
  for (std::size_t i = 1; i < path.size(); ++i) CHECK(checker->motion(path[i - 1], path[i]).valid);
}

std::vector<Problem> problems(const PlannerKind& kind) {
  if (kind.kinodynamic) {
    return {test::driven(test::cup_problem()), test::driven(test::cup_problem(), "unicycle2"),
            test::driven(test::cup_problem(), "car")};
  }
  return {test::cup_problem(), test::trap_problem(), test::point_problem(3)};
}

std::vector<const PlannerKind*> sampling_planners() {
  std::vector<const PlannerKind*> kinds;
  for (const auto& kind : planner_kinds()) {
    if (!kind.graph) kinds.push_back(&kind);
  }
  return kinds;
}

}  // namespace

TEST_CASE("a solved problem comes with a valid path from start to goal", "[planner][slow]") {
  for (const auto* kind : sampling_planners()) {
    for (const auto& problem : problems(*kind)) {
      CAPTURE(kind->component->name, problem.name);
      int solved = 0;
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto out = run(*kind, problem, seed);
        if (!out.solution.solved()) continue;
        ++solved;
        check_path(problem, out.solution.path);
      }
      // A roadmap needs many vertices in a narrow passage.
      CHECK(solved >= (kind->component->name == "drrt" ? 2 : 4));
    }
  }
}

TEST_CASE("every proposal has one fate, and every check is counted", "[planner]") {
  for (const auto* kind : sampling_planners()) {
    CAPTURE(kind->component->name);
    const auto out = run(*kind, test::cup_problem(), 2);
    CHECK(out.search.fates.size() == out.search.proposals.size());
    CHECK(out.search.proposal_sources.size() == out.search.proposals.size());
    CHECK(out.checks.validity >= out.checks.motion);
    // A driven path has a state for each step.
    CHECK((kind->kinodynamic || out.search.nodes.size() >= out.solution.path.size()));
  }
}

TEST_CASE("the same seed gives the same search, another seed another", "[planner][determinism]") {
  for (const auto* kind : sampling_planners()) {
    CAPTURE(kind->component->name);
    const auto problem = test::cup_problem();
    const auto a = run(*kind, problem, 11);
    const auto b = run(*kind, problem, 11);
    const auto c = run(*kind, problem, 12);
    CHECK(std::equal(a.search.nodes.values().begin(), a.search.nodes.values().end(), b.search.nodes.values().begin(),
                     b.search.nodes.values().end()));
    CHECK(a.checks.validity == b.checks.validity);
    CHECK_FALSE(std::equal(a.search.nodes.values().begin(), a.search.nodes.values().end(),
                           c.search.nodes.values().begin(), c.search.nodes.values().end()));
  }
}

TEST_CASE("a budget of proposals or checks ends the search, with the path to the nearest node", "[planner]") {
  // The goal is walled in.
  auto problem = test::make_problem("walled", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(),
                                    {1, 5, 0}, {9, 5, 0});
  for (const auto* kind : sampling_planners()) {
    CAPTURE(kind->component->name);
    const auto out = run(*kind, problem, 1, 1, {{"proposals", std::int64_t{500}}});
    CHECK(out.solution.status == Status::budget_spent);
    CHECK(out.search.proposals.size() == 500);
    REQUIRE_FALSE(out.solution.path.empty());
    CHECK(problem.space.distance(out.solution.path.front(), problem.start) == 0.0);
    const auto fewer = run(*kind, problem, 1, 1, {{"checks", std::int64_t{200}}});
    CHECK(fewer.solution.status == Status::budget_spent);
  }
}

TEST_CASE("an invalid start or goal is distinct from a search without success", "[planner]") {
  auto problem = test::cup_problem();
  problem.start = {6.75, 5, 0};
  auto other = test::cup_problem();
  other.goals = {{6.75, 5, 0}};
  for (const auto* kind : sampling_planners()) {
    CAPTURE(kind->component->name);
    CHECK(run(*kind, problem, 1).solution.status == Status::invalid_start);
    CHECK(run(*kind, other, 1).solution.status == Status::invalid_goal);
  }
}

TEST_CASE("a resumed planner searches for another path within the same budget", "[planner]") {
  for (const auto* kind : sampling_planners()) {
    CAPTURE(kind->component->name);
    const auto problem = test::cup_problem();
    const auto once = run(*kind, problem, 4);
    const auto twice = run(*kind, problem, 4, 2);
    REQUIRE(once.solution.solved());
    CHECK(twice.search.proposals.size() > once.search.proposals.size());
    if (twice.solution.solved()) check_path(fitting(*kind, problem), twice.solution.path);
  }
}

TEST_CASE("rrt_connect grows the smaller tree, or both in turn", "[planner]") {
  const PlannerKind& kind = *find_planner("rrt_connect");
  const auto grown = [&](const std::string& grow, std::uint64_t seed) {
    return run(kind, test::trap_problem(), seed, 1, {{"grow", grow}});
  };
  // The nodes of the tree that an accepted proposal extended, and those of the other one, before it.
  const auto larger_extended = [](const Search& search) {
    std::vector<std::size_t> side(search.nodes.size());
    for (std::size_t row = 0; row < side.size(); ++row) {
      const std::uint32_t parent = search.parents[row];
      side[row] = parent == row ? (row == 0 ? 0 : 1) : side[parent];
    }
    int count = 0;
    for (std::size_t i = 0; i < search.added.size(); ++i) {
      if (search.added[i] == no_node) continue;
      const auto begin = side.begin();
      const auto own = std::count(begin, begin + search.added[i], side[search.near[i]]);
      count += 2 * own > static_cast<std::ptrdiff_t>(search.added[i]) ? 1 : 0;
    }
    return count;
  };
  int in_turn = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    const auto smaller = grown("smaller", seed);
    REQUIRE(smaller.solution.solved());
    check_path(test::trap_problem(), smaller.solution.path);
    CHECK(larger_extended(smaller.search) == 0);
    const auto turns = grown("in_turn", seed);
    in_turn += larger_extended(turns.search);
    // The robot is no arm.
    CHECK(std::ranges::equal(grown("auto", seed).search.nodes.values(), turns.search.nodes.values()));
  }
  CHECK(in_turn > 0);
}

TEST_CASE("start and goal in one place are solved at once", "[planner]") {
  auto problem = test::cup_problem();
  problem.goals = {problem.start};
  for (const auto* kind : sampling_planners()) {
    CAPTURE(kind->component->name);
    CHECK(run(*kind, problem, 1).solution.solved());
  }
}

TEST_CASE("lazy roadmaps spend fewer checks than those that check every edge", "[planner]") {
  const auto problem = test::cup_problem();
  std::uint64_t eager = 0;
  std::uint64_t lazy = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    eager += run(*find_planner("prm_star"), problem, seed).checks.validity;
    lazy += run(*find_planner("lazy_prm_star"), problem, seed).checks.validity;
  }
  CHECK(lazy < eager);
}

TEST_CASE("prm finds the shortest path over all valid motions to neighbours, by a part of their checks", "[planner]") {
  const auto problem = test::cup_problem();
  std::uint64_t checks = 0;
  std::uint64_t all = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    const auto out = run(*find_planner("prm"), problem, seed);
    REQUIRE(out.solution.solved());
    const auto instance = make_instance(problem);
    const Configurations& nodes = out.search.nodes;
    // Each node is joined to its ten nearest among those before it. Bellman and Ford find the shortest path.
    struct Edge {
      std::size_t a, b;
      double length;
    };
    std::vector<Edge> edges;
    for (std::size_t b = 1; b < nodes.size(); ++b) {
      std::vector<Edge> to;
      for (std::size_t a = 0; a < b; ++a) to.push_back({a, b, problem.space.distance(nodes[a], nodes[b])});
      std::stable_sort(to.begin(), to.end(), [](const Edge& x, const Edge& y) { return x.length < y.length; });
      to.resize(std::min<std::size_t>(to.size(), 10));
      for (const Edge& edge : to) {
        if (instance->motion(nodes[edge.a], nodes[edge.b]).valid) edges.push_back(edge);
      }
    }
    std::vector<double> cost(nodes.size(), std::numeric_limits<double>::infinity());
    cost[0] = 0.0;
    for (bool changed = true; changed;) {
      changed = false;
      for (const Edge& edge : edges) {
        for (const auto& [from, to] : {std::pair(edge.a, edge.b), std::pair(edge.b, edge.a)}) {
          if (cost[from] + edge.length >= cost[to]) continue;
          cost[to] = cost[from] + edge.length;
          changed = true;
        }
      }
    }
    CHECK(path_length(problem.space, out.solution.path) == Approx(cost[1]).epsilon(1e-9));
    checks += out.checks.validity;
    all += instance->checks.validity;
  }
  CHECK(2 * checks < all);
}

TEST_CASE("every lazy evaluation of a roadmap finds valid paths and reports the validated nodes",
          "[planner][lazy][slow]") {
  const auto& kind = *find_planner("lazy_prm");
  for (const std::string remove : {"all", "first"}) {
    for (const std::string edges : {"in_turn", "coarse_to_fine"}) {
      for (const double enhance : {0.0, 1.0}) {
        CAPTURE(remove, edges, enhance);
        const std::vector<Options::Entry> options = {{"remove", remove}, {"edges", edges}, {"enhance", enhance}};
        for (const auto& problem : problems(kind)) {
          for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            const auto out = run(kind, problem, seed, 1, options);
            REQUIRE(out.solution.solved());
            check_path(problem, out.solution.path);
            CHECK_FALSE(out.search.expands);
            REQUIRE(out.search.validated.size() == out.search.nodes.size());
            // Each validated node is one check beside those of edges; the path's nodes are validated.
            const auto validated = std::count(out.search.validated.begin(), out.search.validated.end(), 1);
            CHECK(static_cast<std::uint64_t>(validated) <= out.checks.validity);
            CHECK(validated >= static_cast<std::ptrdiff_t>(out.solution.path.size()));
            for (std::size_t i = 0; i < out.solution.path.size(); ++i) {
              bool found = false;
              for (std::size_t k = 0; k < out.search.nodes.size() && !found; ++k) {
                found = out.search.validated[k] != 0 &&
                        problem.space.distance(out.search.nodes[k], out.solution.path[i]) == 0.0;
              }
              CHECK(found);
            }
            // Nodes beside start, goal and proposals come from enhancement only.
            if (enhance == 0.0) {
              CHECK(out.search.nodes.size() <= out.search.proposals.size() + 2);
            } else if (out.search.proposals.size() > 200) {
              CHECK(out.search.nodes.size() > out.search.proposals.size() + 2);
            }
          }
        }
      }
    }
  }
}

TEST_CASE("coarse looks find an invalid path sooner", "[planner][lazy]") {
  const auto& kind = *find_planner("lazy_prm");
  const auto spent = [&](const std::string& edges) {
    std::uint64_t checks = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      checks += run(kind, test::cup_problem(), seed, 1, {{"edges", edges}}).checks.validity;
    }
    return checks;
  };
  CHECK(spent("coarse_to_fine") < spent("in_turn"));
}

TEST_CASE("only unguided lazy roadmaps that check for real have unseen nodes", "[planner][lazy]") {
  for (const auto* kind : sampling_planners()) {
    if (kind->component->name == "lazy_prm") continue;
    const auto out = run(*kind, test::cup_problem(), 1);
    CHECK(out.search.validated.empty());
    CHECK(out.search.expands);
  }
}

TEST_CASE("shortcutting never lengthens a path and keeps it valid", "[planner][shortcut]") {
  const auto problem = test::cup_problem();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto out = run(*find_planner("rrt"), problem, seed);
    REQUIRE(out.solution.solved());
    auto instance = make_instance(problem);
    Stream stream(seed, "0", "shortcut");
    const auto shorter = shortcut(*instance, out.solution.path, 200, stream);
    CHECK(path_length(problem.space, shorter) < path_length(problem.space, out.solution.path));
    check_path(problem, shorter);
  }
}
