// SPDX-License-Identifier: GPL-3.0-or-later
// Which goal of C a path in S leads to, and the goals of S.
#include <algorithm>
#include <vector>

#include <trellis/guide/goal_choice.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// The position alone.
struct Position {
  static void project(View q, MutableView s) { std::copy_n(q.begin(), 2, s.begin()); }
};

Configurations ending_at(double x, double y) {
  Configurations path(2);
  path.push(std::vector{1.0, 5.0});
  path.push(std::vector{x, y});
  return path;
}

}  // namespace

TEST_CASE("goals of S are sorted, each once, and within S", "[instance][goals]") {
  Problem problem = test::cup_problem();
  problem.goals = {{9, 5, 0}, {2, 5, 1}, {1, 9, 0}, {9, 5, 3}, {2, 5, 2}, {1, 7, 0}};
  const auto parent = make_instance(problem);
  Instance sub;
  sub.space = Space::euclidean({{0, 9}, {0, 8}});
  project_ends(Position(), *parent, sub);
  CHECK(sub.start == Configuration{1, 5});
  CHECK(sub.goals == std::vector<Configuration>{{2, 5}, {1, 7}, {9, 5}});
  std::ranges::reverse(parent->goals);
  Instance again;
  again.space = sub.space;
  project_ends(Position(), *parent, again);
  CHECK(again.goals == sub.goals);
  // Without any within S, all stay.
  again.space = Space::euclidean({{20, 30}, {20, 30}});
  project_ends(Position(), *parent, again);
  CHECK(again.goals.size() == 4);
}

TEST_CASE("a path leads to the goal where it ends, and after a refuted path to another one there", "[guide][goals]") {
  Problem problem = test::cup_problem();
  problem.goals = {{9, 5, 3}, {9, 5, 0.5}, {9, 5, -1}, {2, 5, 1}};
  const Space s = Space::euclidean({{0, 10}, {0, 10}});
  std::ranges::sort(problem.goals);
  do {
    const auto parent = make_instance(problem);
    GoalChoice choice;
    const auto chosen = [&](const Configurations& path) { return choice.choose(*parent, Position::project, s, path); };
    CHECK(chosen(ending_at(2, 5)) == Configuration{2, 5, 1});
    CHECK(chosen(ending_at(9, 5)) == Configuration{9, 5, 0.5});
    CHECK_FALSE(choice.replaced());
    choice.refute();
    CHECK(chosen(ending_at(9, 5)) == Configuration{9, 5, -1});
    CHECK(choice.replaced());
    CHECK(chosen(ending_at(9, 5)) == Configuration{9, 5, -1});
    CHECK_FALSE(choice.replaced());
    choice.refute();
    CHECK(chosen(ending_at(8.7, 5)) == Configuration{9, 5, 3});
    choice.refute();
    CHECK(chosen(ending_at(9, 5)) == Configuration{9, 5, 0.5});
    choice.refute();
    CHECK(chosen(ending_at(2, 5)) == Configuration{2, 5, 1});
  } while (std::ranges::next_permutation(problem.goals).found);
}
