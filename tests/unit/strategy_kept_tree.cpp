// SPDX-License-Identifier: GPL-3.0-or-later
// The part of the tree in S that a search in C keeps.
#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/guide/kept_tree.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// A search whose rows are these, each with its parent.
Search grown(const std::vector<std::pair<Configuration, std::uint32_t>>& all) {
  Search search(all.front().first.size());
  for (const auto& [q, parent] : all) {
    search.nodes.push(q);
    search.parents.push_back(parent);
  }
  return search;
}

Space line() { return {"line", {{.name = "x", .lo = -10, .hi = 10}}}; }

StrategySpec relaxed(bool keep) {
  const auto planner = [&](double share) {
    return PlannerSpec::make("rrt", {{"step", 0.5}, {"uniform", share}, {"bound", 0.0}});
  };
  return {planner(0.5),
          GuideSpec::make("shrink", {{"scale", 0.5}, {"follow", std::string("waypoints")}, {"keep_tree", keep}},
                          planner(0.5))};
}

/// Nodes of S's tree from the start that are nodes of C's, the start left out.
std::size_t kept(const RunRecord& run) {
  const auto set_of = [](const Configurations& nodes) {
    std::set<Configuration> all;
    for (std::size_t i = 1; i < nodes.size(); ++i) all.insert({nodes[i].begin(), nodes[i].end()});
    return all;
  };
  const auto mine = set_of(run.levels[0].search.nodes);
  std::size_t count = 0;
  for (const auto& q : set_of(run.levels[1].search.nodes)) count += mine.contains(q) ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("nodes of S are given in their order, once, each after its parent has come to C", "[strategy][tree]") {
  KeptTree tree(line(), {0.0});
  CHECK_FALSE(tree.any());
  //           0         1         2 (of 1)  3 (of 0)  4 (of 2)
  tree.update(grown({{{0.0}, 0}, {{1.0}, 0}, {{2.0}, 1}, {{-1.0}, 0}, {{3.0}, 2}}));
  const auto next = [&] {
    const auto branch = tree.next();
    return branch ? std::pair(branch->node[0], branch->from) : std::pair(99.0, no_node);
  };
  CHECK(next() == std::pair(1.0, no_node));
  CHECK(next() == std::pair(-1.0, no_node));
  CHECK_FALSE(tree.any());
  tree.add(Configuration{1.0}, 7);
  CHECK(next() == std::pair(2.0, 7U));
  // What came to C by itself is not given, but its children are.
  tree.add(Configuration{2.0}, 9);
  CHECK(next() == std::pair(3.0, 9U));
  CHECK_FALSE(tree.any());
  // Other nodes of C are no nodes of S.
  tree.add(Configuration{2.5}, 11);
  CHECK_FALSE(tree.any());
  // S has grown; and C lost its tree, of which one node is left.
  tree.update(grown({{{0.0}, 0}, {{1.0}, 0}, {{2.0}, 1}, {{-1.0}, 0}, {{3.0}, 2}, {{1.5}, 1}, {{4.0}, 4}}));
  tree.clear();
  CHECK_FALSE(tree.any());
  tree.add(Configuration{1.0}, 20);
  CHECK(next() == std::pair(1.5, 20U));
  CHECK_FALSE(tree.any());
}

TEST_CASE("a tree from the goal, and the nodes of a roadmap, are not kept", "[strategy][tree]") {
  KeptTree tree(line(), {0.0});
  tree.update(grown({{{0.0}, 0}, {{9.0}, 1}, {{8.0}, 1}, {{0.5}, no_node}}));
  CHECK_FALSE(tree.any());
}

TEST_CASE("a larger robot keeps the branches of the smaller one's tree that it can", "[strategy][tree]") {
  std::size_t with = 0;
  std::size_t without = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const RunRecord run = execute(relaxed(true), test::cup_problem(), seed);
    REQUIRE(run.solved);
    with += kept(run);
    without += kept(execute(relaxed(false), test::cup_problem(), seed));
    // Each is joined to its parent's by a motion that is valid for the larger robot.
    const auto& search = run.levels[0].search;
    const auto instance = make_instance(test::cup_problem());
    for (std::size_t i = 1; i < search.nodes.size(); ++i) {
      REQUIRE(instance->motion(search.nodes[search.parents[i]], search.nodes[i]).valid);
    }
  }
  // Without, those points of the path that are valid are kept.
  CHECK(with > 3 * without / 2);
}

TEST_CASE("the density of h beside a tree that is kept is that of what it draws", "[strategy][tree][density]") {
  const RunRecord run = execute(relaxed(true), test::cup_problem(), 1);
  const auto& level = run.levels.front();
  REQUIRE(static_cast<bool>(level.proposal_density));
  // Of the guided proposals, those that are nodes of S are atoms, and points of the path too; the others have a
  // density.
  CHECK(level.proposal_atoms > 0.1);
  CHECK(level.proposal_atoms < 0.9);
}
