// SPDX-License-Identifier: GPL-3.0-or-later
// Retrieval of stored paths, their connection, and the resulting guidance.
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/guide/set_up.hpp>
#include <trellis/memory/library.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/folder.hpp"
#include "support/outcomes.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

using Points = std::vector<std::array<double, 2>>;

/// A point robot's problem in an empty square of 10 m, but for rectangles.
Problem plane(const test::Rectangles& rectangles, Configuration start, Configuration goal) {
  return test::make_problem("plane", test::rectangle_world(rectangles), Robot::point(), std::move(start),
                            std::move(goal));
}

Configurations path_of(const Points& points) {
  Configurations path(2);
  for (const auto& p : points) path.push(p);
  return path;
}

/// A temporary library. A process reads each file once, so each has its own name.
class Stored {
 public:
  explicit Stored(const std::vector<std::pair<Problem, Configurations>>& solved) {
    Library library(file(), Library::Mode::write);
    for (const auto& [problem, path] : solved) {
      REQUIRE(library.add(stored_path(problem, path), problem.space, 0.0));
    }
  }
  [[nodiscard]] std::string file() const { return folder_.file("paths.db"); }

 private:
  test::Folder folder_;
};

/// The guide on an instance: its space is solved and h created, as by the executor.
struct Retrieved {
  std::unique_ptr<Instance> parent;
  std::unique_ptr<Guide> guide;
  std::unique_ptr<Instance> sub;
  std::unique_ptr<Search> search;
  std::unique_ptr<UniformGuidance> uniform;
  std::unique_ptr<Planner> planner;
  Solution found;
  std::unique_ptr<Heuristic> h;

  void solve() {
    const Budget budget;
    found = planner->solve(*uniform, budget);
    while (guide->repairs().another(found.solved() ? &found : nullptr) > 0) found = planner->solve(*uniform, budget);
    h = guide->heuristic(*parent, sub.get(), &found);
  }
};

Retrieved retrieve(const Problem& problem, std::vector<Options::Entry> options) {
  Retrieved r;
  const GuideKind& kind = *find_guide("experience");
  r.parent = make_instance(problem);
  r.guide = kind.make(Options::validate(*kind.component, options));
  r.sub = r.guide->project(*r.parent);
  r.guide->attach(*r.sub);
  r.search = std::make_unique<Search>(r.sub->space.dimension());
  r.uniform = std::make_unique<UniformGuidance>(r.sub->space);
  const PlannerKind& searcher = *find_planner(kind.default_planner);
  r.planner = searcher.make(Options::validate(*searcher.component, {}),
                            {*r.sub, *r.uniform, Stream(1, "0/0", "proposals"), *r.search, false});
  r.solve();
  return r;
}

/// The farthest that any point of `path` is from the polyline `from`.
double farthest(const Space& space, const Configurations& path, const Configurations& from) {
  constexpr int steps = 20;
  double most = 0.0;
  Configuration q(space.dimension());
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    for (int step = 0; step <= steps; ++step) {
      space.interpolate(path[i], path[i + 1], static_cast<double>(step) / steps, q);
      double least = 1e300;
      for (std::size_t k = 0; k + 1 < from.size(); ++k) {
        least = std::min(least, nearest_on_motion(space, from[k], from[k + 1], q).squared_distance);
      }
      most = std::max(most, std::sqrt(least));
    }
  }
  return most;
}

const Points over = {{1, 1}, {1, 9}, {9, 9}, {9, 1}};
const Points under = {{1, 1}, {1, 0.5}, {9, 0.5}, {9, 1}};

}  // namespace

TEST_CASE("an empty library guides nowhere, and a missing one is empty", "[guide][experience]") {
  const Problem problem = plane({}, {1, 1}, {9, 1});
  const Stored nothing({});
  for (const std::string& file : {nothing.file(), nothing.file() + ".missing"}) {
    const auto r = retrieve(problem, {{"db", file}});
    CHECK(r.found.status == Status::no_path);
    CHECK(r.sub->checks.validity == 0);
    CHECK(test::record_of(*r.h).at(problem.start) == Approx(std::exp(-problem.space.log_volume())));
  }
}

TEST_CASE("the work of setting up grows with the stored paths, up to those that are retrieved", "[guide][experience]") {
  const Problem problem = plane({}, {1, 5}, {9, 5});
  const Stored library({{problem, path_of({{1, 5}, {9, 5}})}, {problem, path_of({{1, 5}, {5, 8}, {9, 5}})}});
  for (const char* name : {"experience", "path_database"}) {
    const auto work = [&](const std::string& file, std::int64_t candidates) {
      const Options options =
          Options::validate(*find_guide(name)->component, {{"db", file}, {"candidates", candidates}});
      return set_up_of(name, options, *problem.scene).run;
    };
    const double none = work("missing.db", 10);
    const double one = work(library.file(), 1);
    CHECK(one > none);
    CHECK(work(library.file(), 10) - one == one - none);
    CHECK(work(library.file(), 2) == work(library.file(), 10));
  }
}

TEST_CASE("path_database names the node with the least cost to go, and forgets motions that are blocked",
          "[guide][path_database]") {
  const Problem problem = plane({}, {1, 1}, {9, 1});
  const Stored library({{problem, path_of(over)}, {problem, path_of(under)}});
  const GuideKind& kind = *find_guide("path_database");
  const auto parent = make_instance(problem);
  parent->step = 0.5;
  const auto guide = kind.make(Options::validate(*kind.component, {{"db", library.file()}}));
  REQUIRE(guide->project(*parent) == nullptr);
  const auto h = guide->heuristic(*parent, nullptr, nullptr);
  Stream stream(1, "", "proposals");
  Configuration q(2);
  // Along the shorter of the paths, a step at a time, from the last node.
  std::uint32_t row = no_node;
  const auto follow = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      h->sample(stream, q);
      CHECK(h->vertex() == row);
      row = static_cast<std::uint32_t>(row == no_node ? 1 : row + 1);
      h->observe(test::reached(q, row), true);
    }
  };
  CHECK(test::record_of(*h).atoms() == 1.0);
  follow(8);
  CHECK(q[1] == 0.5);
  const double before = q[0];
  CHECK(before > 1.0);
  // A node elsewhere costs more to go; a better one is extended at once.
  const Configuration aside = {1.0, 2.0};
  h->observe(test::reached(aside, 50), false);
  h->sample(stream, q);
  CHECK(h->vertex() == row);
  // The motion is blocked: proposals about the point, then the other path.
  h->observe(test::blocked(q), true);
  CHECK(test::record_of(*h).atoms() == 0.0);
  for (int i = 0; i < 400 && h->vertex() != 50; ++i) {
    h->sample(stream, q);
    h->observe(test::blocked(q), true);
  }
  CHECK(h->vertex() == 50);
  const auto path = h->lifted_path();
  REQUIRE(path.size() > 2);
  CHECK(path[path.size() - 2][1] > 0.5);
  h->select_tree(TreeSide::goal);
  CHECK(h->vertex() == no_node);
  CHECK(test::record_of(*h).at(problem.start) == Approx(std::exp(-problem.space.log_volume())));
}

TEST_CASE("a stored path is followed from the query's start to its goal, in either stored direction",
          "[guide][experience]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored library({{stored, path_of(over)}});
  for (const bool backwards : {false, true}) {
    // Near the stored ends, not at them.
    Problem query = plane({{4, 0, 6, 3}}, {1.2, 1.1}, {8.9, 1.3});
    if (backwards) std::swap(query.start, query.goals.front());
    const auto r = retrieve(query, {{"db", library.file()}});
    REQUIRE(r.found.solved());
    const Configurations path = r.h->lifted_path();
    CHECK(std::equal(path.front().begin(), path.front().end(), query.start.begin()));
    CHECK(std::equal(path.back().begin(), path.back().end(), query.goal().begin()));
    CHECK(farthest(query.space, path, path_of(over)) < 0.4);
    CHECK(r.sub->checks.validity > 0);
    CHECK(r.parent->checks.motion == 0);
  }
}

TEST_CASE("of several goals a stored path leads to the one that it reaches, whatever their order",
          "[guide][experience][goals]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored library({{stored, path_of(over)}});
  Problem query = plane({{4, 0, 6, 3}}, {1.2, 1.1}, {8.9, 1.3});
  query.goals = {{5, 8.9}, {8.9, 1.3}, {1.1, 9.1}};
  std::ranges::sort(query.goals);
  Configurations first;
  do {
    const auto r = retrieve(query, {{"db", library.file()}, {"join", 0.3}});
    REQUIRE(r.found.solved());
    const Configurations path = r.h->lifted_path();
    CHECK(std::ranges::equal(path.front(), query.start));
    // The goal beside the first corner of the stored path.
    CHECK(std::ranges::equal(path.back(), Configuration{1.1, 9.1}));
    if (first.empty()) first = path;
    CHECK(std::ranges::equal(path.values(), first.values()));
  } while (std::ranges::next_permutation(query.goals).found);
  query.goals = {{9.5, 9.5}, {8.9, 1.3}};
  const auto r = retrieve(query, {{"db", library.file()}});
  REQUIRE(r.found.solved());
}

TEST_CASE("of several paths the one is followed that the present world violates least", "[guide][experience]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored library({{stored, path_of(over)}, {stored, path_of(under)}});
  // Both are free: the shorter one.
  const auto open = retrieve(plane({}, {1, 1}, {9, 1}), {{"db", library.file()}});
  CHECK(farthest(open.sub->space, open.h->lifted_path(), path_of(under)) < 0.3);
  // A wall across the short one.
  const Problem blocked = plane({{4, 0, 6, 3}}, {1, 1}, {9, 1});
  const auto r = retrieve(blocked, {{"db", library.file()}});
  CHECK(farthest(r.sub->space, r.h->lifted_path(), path_of(over)) < 0.3);
  // Walls across both, a thin one across the long one: the path avoids walls whose repair costs more than the detour.
  const Problem both = plane({{4, 0, 6, 3}, {4, 8.9, 4.1, 9.1}}, {1, 1}, {9, 1});
  const auto thin = retrieve(both, {{"db", library.file()}});
  CHECK(farthest(thin.sub->space, thin.h->lifted_path(), path_of(over)) < 0.3);
  const auto cheap = retrieve(both, {{"db", library.file()}, {"repair", 1.0}});
  CHECK(farthest(cheap.sub->space, cheap.h->lifted_path(), path_of(under)) < 0.3);
}

TEST_CASE("only candidates for the path with the least repair are checked", "[guide][experience]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored one({{stored, path_of(under)}});
  const Stored both({{stored, path_of(under)}, {stored, path_of(over)}});
  const Problem query = plane({}, {1, 1}, {9, 1});
  const auto alone = retrieve(query, {{"db", one.file()}});
  const auto beside = retrieve(query, {{"db", both.file()}});
  CHECK(alone.sub->checks.validity > 0);
  CHECK(alone.sub->checks.validity == beside.sub->checks.validity);
}

TEST_CASE("paths from A to B and from B to C make one from A to C", "[guide][experience]") {
  const Points ab = {{1, 1}, {1, 9}, {5, 9}};
  const Points bc = {{9, 1}, {9, 9}, {5.1, 9}};  // stored from C to B, and ends a little beside
  const Stored library({{plane({}, {1, 1}, {5, 9}), path_of(ab)}, {plane({}, {9, 1}, {5.1, 9}), path_of(bc)}});
  const Problem query = plane({{4, 0, 6, 8}}, {1, 1}, {9, 1});
  const auto r = retrieve(query, {{"db", library.file()}});
  REQUIRE(r.found.solved());
  const Configurations path = r.h->lifted_path();
  Configurations whole = path_of(ab);
  for (std::size_t i = 3; i-- > 0;) whole.push(bc[i]);
  CHECK(farthest(query.space, path, whole) < 1e-6);
  CHECK(farthest(query.space, whole, path) < 0.3);
  for (std::size_t i = 1; i < path.size(); ++i) CHECK(r.parent->motion(path[i - 1], path[i]).valid);
  // Too far from each other to be connected: the path changes between them where that costs least, outside of the
  // stored paths.
  const auto apart = retrieve(query, {{"db", library.file()}, {"join", 0.05}});
  CHECK(apart.found.solved());
}

TEST_CASE("only paths of the same space and robot are retrieved", "[guide][experience]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored library({{stored, path_of(over)}});
  Problem disc = test::make_problem("disc", test::rectangle_world({}), Robot::disc(0.2), {1, 1}, {9, 1});
  CHECK(retrieve(disc, {{"db", library.file()}}).found.status == Status::no_path);
  CHECK(retrieve(disc, {{"db", library.file()}, {"robots", std::string("any")}}).found.solved());
  const Problem wider = test::make_problem("wider", test::rectangle_world({}, 12.0), Robot::point(), {1, 1}, {9, 1});
  CHECK(retrieve(wider, {{"db", library.file()}}).found.status == Status::no_path);
}

TEST_CASE("several distinct paths guide at once", "[guide][experience]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored library({{stored, path_of(over)}, {stored, path_of(under)}});
  const auto r = retrieve(
      stored, {{"db", library.file()}, {"paths", std::int64_t{2}}, {"follow", std::string("tube")}, {"window", 1.0}});
  Stream stream(1, "0", "both");
  Configuration q(2);
  int above = 0;
  for (int i = 0; i < 1000; ++i) {
    r.h->sample(stream, q);
    above += q[1] > 1.5 ? 1 : 0;
  }
  CHECK(above > 250);
  CHECK(above < 600);
}

TEST_CASE("a path without progress of the planner is replaced by another one", "[guide][experience]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored library({{stored, path_of(over)}, {stored, path_of(under)}});
  auto r = retrieve(stored, {{"db", library.file()}});
  REQUIRE(farthest(r.sub->space, r.h->lifted_path(), path_of(under)) < 0.3);
  int tries = 0;
  while (farthest(r.sub->space, r.h->lifted_path(), path_of(over)) > 0.3 && tries < 10) {
    r.guide->repairs().before_resolve();
    r.solve();
    ++tries;
  }
  CHECK(tries > 0);
  CHECK(tries < 10);
}

namespace {

/// Reports an outcome to the guide and to its heuristic.
void report(Retrieved& r, const Outcome& outcome, bool mine) {
  r.guide->learn(outcome);
  r.h->observe(outcome, mine);
}
void add_node(Retrieved& r, View q) { report(r, test::reached(q), false); }
void block(Retrieved& r, View at) { report(r, test::blocked(at), true); }

}  // namespace

TEST_CASE("motions of a path that are valid are not checked again, and those that are not are repaired",
          "[guide][experience]") {
  const Stored library({{plane({}, {1, 1}, {9, 1}), path_of(over)}});
  // A box above the path.
  const Problem query = plane({{4, 0, 6, 3}, {4.5, 8.5, 5.5, 9.5}}, {1, 1}, {9, 1});
  auto r = retrieve(query, {{"db", library.file()}});
  REQUIRE(r.found.solved());
  const Configurations path = r.h->lifted_path();
  std::size_t gap = 0;
  int gaps = 0;
  const auto before = r.parent->checks.validity;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    if (r.parent->motion(path[i], path[i + 1]).valid) continue;
    gap = i;
    ++gaps;
  }
  REQUIRE(gaps == 1);
  // Only the gap cost checks.
  CHECK(r.parent->checks.validity - before < 30);
  // Before the tree reaches them, the guide proposes the points of the path themselves.
  CHECK(test::record_of(*r.h).atoms() == 1.0);
  for (std::size_t i = 1; i <= gap; ++i) add_node(r, path[i]);
  // First the far end; then half of the proposals lie about the gap, on either side of the box.
  block(r, Configuration{4.6, 9});
  CHECK(test::record_of(*r.h).atoms() < 0.6);
  const auto count = [&](const auto& where) {
    Stream stream(1, "0", "gap");
    Configuration q(2);
    int inside = 0;
    for (int i = 0; i < 1000; ++i) {
      r.h->sample(stream, q);
      inside += where(q) ? 1 : 0;
    }
    return inside;
  };
  CHECK(count([](View q) { return q[0] > 4.4 && q[0] < 5.6 && std::abs(q[1] - 9) > 0.15; }) > 200);
  CHECK(test::record_of(*r.h).at(Configuration{5, 9.2}) > 0.0);
  CHECK(test::record_of(*r.h).at(Configuration{5, 5}) == 0.0);
  // The balls grow until they contain the route around the box.
  const auto around = [](View q) { return q[0] > 4.4 && q[0] < 5.6 && q[1] < 8.3; };
  CHECK(count(around) == 0);
  for (int i = 0; i < 70; ++i) block(r, Configuration{4.6, 9});
  CHECK(count(around) > 20);
  // A node at the far end closes the gap.
  add_node(r, path[gap + 1]);
  CHECK(test::record_of(*r.h).atoms() == 1.0);
  CHECK_FALSE(r.h->stale());
}

TEST_CASE("a gap that stays open refutes the path, which is no candidate any more while there is another",
          "[guide][experience]") {
  const Stored library({{plane({}, {1, 1}, {9, 1}), path_of(over)}, {plane({}, {1, 1}, {9, 1}), path_of(under)}});
  const Problem query = plane({{4.5, 8.5, 5.5, 9.5}, {4.5, 0, 5.5, 1}}, {1, 1}, {9, 1});
  // The distance between the path before and after blocked proposals at the start refuted it.
  const auto refuted_distance = [&](Retrieved& r) {
    const Configurations first = r.h->lifted_path();
    for (int i = 0; i < 200 && !r.h->stale(); ++i) block(r, query.start);
    REQUIRE(r.h->stale());
    r.guide->repairs().before_resolve();
    r.solve();
    CHECK_FALSE(r.h->stale());
    return farthest(query.space, r.h->lifted_path(), first);
  };
  for (const std::string follow : {"waypoints", "steps"}) {
    CAPTURE(follow);
    auto r = retrieve(query, {{"db", library.file()}, {"evidence", std::int64_t{20}}, {"follow", follow}});
    CHECK(refuted_distance(r) > 1.0);
  }
  // Without another path the guide follows it again: the tree may have passed the gap since.
  const Stored one({{plane({}, {1, 1}, {9, 1}), path_of(over)}});
  auto r = retrieve(query, {{"db", one.file()}, {"evidence", std::int64_t{20}}});
  CHECK(refuted_distance(r) < 0.1);
}

TEST_CASE("what C finds invalid on an edge counts as a check of it", "[guide][experience]") {
  const Problem stored = plane({}, {1, 1}, {9, 1});
  const Stored library({{stored, path_of(over)}, {stored, path_of(under)}});
  auto r = retrieve(stored, {{"db", library.file()}});
  REQUIRE(farthest(r.sub->space, r.h->lifted_path(), path_of(under)) < 0.3);
  // The found point lies on a path that was not validated. That path now needs a repair; the other one is followed
  // unless its cost is higher.
  const auto cost = [&] {
    double sum = 0.0;
    for (const auto& edge : r.sub->graph->edges) sum += edge.cost;
    return sum;
  };
  const double before = cost();
  block(r, Configuration{5, 9});
  const double after = cost();
  CHECK(after > before + 1.0);
  block(r, Configuration{5, 9});
  CHECK(cost() == after);
  // Outcomes far from the path change nothing, nor do outcomes about valid parts of it.
  block(r, Configuration{5, 8});
  block(r, Configuration{5, 0.5});
  CHECK(cost() == after);
}
