// SPDX-License-Identifier: GPL-3.0-or-later
// Leads through a triangulation: the expanded nodes, and the end of a lead.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

struct Lead {
  std::unique_ptr<Instance> parent;
  std::unique_ptr<Guide> guide;
  std::unique_ptr<Instance> sub;
  Solution found;
  std::unique_ptr<Heuristic> h;

  explicit Lead(const Problem& problem, const std::vector<Options::Entry>& options) {
    const GuideKind& kind = *find_guide("decomposition");
    parent = make_instance(problem);
    guide = kind.make(Options::validate(*kind.component, options));
    sub = guide->project(*parent);
    solve();
  }
  void solve() {
    const PlannerKind& planner = *find_planner("graph_search");
    const Options options = Options::validate(*planner.component, {});
    UniformGuidance uniform(sub->space);
    Search search(2);
    found = planner.make(options, {*sub, uniform, Stream(1, "0/0", "proposals"), search, false})
                ->solve(uniform, planner.common(options).budget);
    REQUIRE(found.solved());
    h = guide->heuristic(*parent, sub.get(), &found);
  }
};

/// An extension that found nothing.
Outcome failed(const Configuration& proposal, const Configuration& near) {
  Outcome outcome;
  outcome.proposal = proposal;
  outcome.near = near;
  return outcome;
}

bool same(const Configurations& a, const Configurations& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::equal(a[i].begin(), a[i].end(), b[i].begin())) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("the node that a lead expands is one of the tree's, near the proposal", "[guide][decomposition]") {
  const auto problem = test::cup_problem();
  Lead lead(problem, {{"explore", 0.0}, {"ahead", std::int64_t{1}}, {"abandon", 0.0}});
  Stream stream(1, "", "expand");
  Configuration q(3);
  std::vector<Configuration> nodes = {problem.start};
  std::set<std::uint32_t> expanded;
  // Every second node belongs to the tree from the goal, every fifth is not connected.
  const auto excluded = [](std::size_t row) { return row > 0 && (row % 2 == 0 || row % 5 == 0); };
  for (int i = 0; i < 400; ++i) {
    lead.h->sample(stream, q);
    const std::uint32_t row = lead.h->vertex();
    if (row != no_node) {
      REQUIRE(row < nodes.size());
      CHECK_FALSE(excluded(row));
      expanded.insert(row);
      // A triangle's side is about twice the bounding radius, 0.63 m, and at most two triangles lie between.
      CHECK(std::hypot(nodes[row][0] - q[0], nodes[row][1] - q[1]) < 2.5);
    }
    const Configuration near = nodes[row == no_node ? 0 : row];
    Outcome outcome = failed(q, near);
    if (lead.parent->validity->state(q)) {
      const auto id = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back(q);
      outcome.fate = Fate::reached;
      outcome.added = nodes.back();
      outcome.added_row = id;
      outcome.from_goal = id % 2 == 0;
      outcome.connected = id % 5 != 0;
    }
    lead.h->observe(outcome, true);
  }
  // Seldom the same one.
  CHECK(expanded.size() > 40);
  lead.h->select_tree(TreeSide::goal);
  lead.h->sample(stream, q);
  CHECK(lead.h->vertex() == no_node);
}

TEST_CASE("a lead is abandoned when it improves no coverage, and after so many expansions", "[guide][decomposition]") {
  const auto problem = test::cup_problem();
  Stream stream(2, "", "abandon");
  Configuration q(3);
  {
    Lead lead(problem, {{"explore", 0.0}, {"abandon", 1.0}});
    lead.h->sample(stream, q);
    Configuration first = problem.start;
    first[1] += 0.5;
    Outcome outcome = failed(q, problem.start);
    outcome.fate = Fate::advanced;
    outcome.added = first;
    outcome.added_row = 1;
    lead.h->observe(outcome, true);
    CHECK_FALSE(lead.h->stale());
    // The same position again is no progress.
    lead.h->sample(stream, q);
    outcome.added_row = 2;
    lead.h->observe(outcome, true);
    CHECK(lead.h->stale());
  }
  Lead lead(problem, {{"explore", 0.0}, {"abandon", 0.0}, {"expansions", std::int64_t{30}}});
  for (int i = 0; i < 30; ++i) {
    CHECK_FALSE(lead.h->stale());
    lead.h->sample(stream, q);
    // Proposals of other guides do not belong to the lead.
    lead.h->observe(failed(q, problem.start), false);
    lead.h->observe(failed(q, problem.start), true);
  }
  CHECK(lead.h->stale());
}

TEST_CASE("leads are shortest paths but for a share of random ones", "[guide][decomposition]") {
  const auto problem = test::cup_problem();
  Stream stream(3, "", "leads");
  Configuration q(3);
  for (const double share : {0.0, 1.0}) {
    Lead lead(problem, {{"random_leads", share}});
    const Configurations shortest = lead.h->lifted_path();
    int other = 0;
    for (int i = 0; i < 5; ++i) {
      lead.h->sample(stream, q);
      const auto again = lead.guide->heuristic(*lead.parent, lead.sub.get(), &lead.found);
      const Configurations path = again->lifted_path();
      CHECK(path.front()[0] == problem.start[0]);
      CHECK(path.back()[0] == problem.goal()[0]);
      other += same(path, shortest) ? 0 : 1;
    }
    CHECK(other == (share > 0.0 ? 5 : 0));
  }
}

namespace {

/// Two homotopy classes, above and below a wall; above is shorter.
Problem two_passages() {
  return test::make_problem("two passages", test::rectangle_world({{4, 2, 6, 8.5}}), test::rectangle_robot(), {2, 6, 0},
                            {8, 6, 0});
}

double highest(const Configurations& path) {
  double y = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) y = std::max(y, path[i][1]);
  return y;
}

}  // namespace

TEST_CASE("what is found invalid makes leads through it costly", "[guide][decomposition]") {
  const Problem problem = two_passages();
  Lead lead(problem, {{"random_leads", 0.0}, {"size", 1.0}});
  const bool above = highest(lead.found.path) > 8.5;
  Stream stream(4, "", "invalid");
  Configuration q(3), blocked(3);
  // Whatever is tried on that side of the wall fails.
  for (int i = 0; i < 4000; ++i) {
    lead.h->sample(stream, q);
    blocked = {stream.uniform(4, 6), above ? stream.uniform(8.5, 10) : stream.uniform(0, 2), 0};
    Outcome outcome = failed(q, problem.start);
    outcome.blocked_at = blocked;
    lead.h->observe(outcome, true);
  }
  lead.guide->repairs().before_resolve();
  lead.solve();
  CHECK((highest(lead.found.path) > 8.5) != above);
}

TEST_CASE("a place that another guide refuted ends a lead through its cell, and the next one avoids it",
          "[guide][decomposition]") {
  const Problem problem = two_passages();
  Lead lead(problem, {{"random_leads", 0.0}, {"size", 1.0}});
  const bool above = highest(lead.found.path) > 8.5;
  lead.guide->repairs().avoid(Configuration{5, above ? 0.5 : 9.5, 0});
  CHECK_FALSE(lead.h->stale());
  lead.guide->repairs().avoid(Configuration{5, 5, 0});  // within the wall
  CHECK_FALSE(lead.h->stale());
  // Each cell of the passage in turn: the refuted place on the other side counts once.
  for (int i = 0; i < 20 && (highest(lead.found.path) > 8.5) == above; ++i) {
    const Configurations& path = lead.found.path;
    std::size_t at = 0;
    while (at < path.size() && !(path[at][0] > 4 && path[at][0] < 6)) ++at;
    REQUIRE(at < path.size());
    lead.guide->repairs().avoid(Configuration{path[at][0], path[at][1], 0});
    REQUIRE(lead.h->stale());
    lead.guide->repairs().before_resolve();
    lead.solve();
    CHECK_FALSE(lead.h->stale());
  }
  CHECK((highest(lead.found.path) > 8.5) != above);
}

TEST_CASE("configurations that a level above found invalid make leads through them costly", "[guide][decomposition]") {
  const Problem problem = two_passages();
  Lead lead(problem, {{"random_leads", 0.0}, {"size", 1.0}});
  const bool above = highest(lead.found.path) > 8.5;
  Stream stream(4, "", "invalid");
  for (int i = 0; i < 4000; ++i) {
    lead.guide->repairs().found_invalid(
        Configuration{stream.uniform(4, 6), above ? stream.uniform(8.5, 10) : stream.uniform(0, 2), 0});
  }
  lead.guide->repairs().before_resolve();
  lead.solve();
  CHECK((highest(lead.found.path) > 8.5) != above);
}

TEST_CASE("a decomposition whose search is guided keeps to the lead of its guide", "[guide][decomposition]") {
  const auto problem = test::cup_problem();
  Lead lead(problem, {{"abandon", 1.0}, {"random_leads", 1.0}, {"explore", 0.5}, {"expansions", std::int64_t{30}}});
  lead.sub->guided = true;
  lead.guide->attach(*lead.sub);
  // Costs are lengths, so that the guide's factors decide, not the sizes of cells.
  for (const Graph::Edge& edge : lead.sub->graph->edges) {
    CHECK(edge.cost == Approx(path_length(lead.sub->space, edge.points)));
  }
  lead.solve();
  const Configurations path = lead.h->lifted_path();
  Stream stream(4, "", "guided lead");
  Configuration q(3);
  const auto fail = [&] {
    lead.h->sample(stream, q);
    // A triangle's side is about twice the bounding radius, 0.63 m: proposals lie in the cells of the lead.
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < path.size(); ++i)
      least = std::min(least, std::hypot(path[i][0] - q[0], path[i][1] - q[1]));
    CHECK(least < 1.3);
    lead.h->observe(failed(q, problem.start), true);
  };
  for (int i = 0; i < 29; ++i) fail();
  CHECK_FALSE(lead.h->stale());
  // A node farther along the lead is progress, which the level above counts; then as many proposals may fail again.
  const double before = lead.h->progress();
  Outcome outcome;
  outcome.fate = Fate::reached;
  outcome.proposal = outcome.added = path[path.size() / 2];
  outcome.near = problem.start;
  outcome.connected = true;
  outcome.added_row = 1;
  lead.h->observe(outcome, false);
  CHECK(lead.h->progress() > before);
  CHECK(lead.h->connected() == Approx(lead.h->progress() - before));
  for (int i = 0; i < 29; ++i) fail();
  CHECK_FALSE(lead.h->stale());
  fail();
  CHECK(lead.h->stale());
  // Another solve gives the same lead: none is random.
  lead.guide->repairs().before_resolve();
  CHECK(same(lead.guide->heuristic(*lead.parent, lead.sub.get(), &lead.found)->lifted_path(), path));
  // A refuted place costs more than its length.
  lead.guide->repairs().avoid(path[path.size() / 2]);
  lead.guide->repairs().before_resolve();
  lead.solve();
  CHECK_FALSE(same(lead.h->lifted_path(), path));
}

TEST_CASE("a lead that a guide chose is followed from both ends", "[guide][decomposition]") {
  const auto problem = test::cup_problem();
  Lead lead(problem, {});
  lead.sub->guided = true;
  lead.guide->attach(*lead.sub);
  lead.solve();
  const Configurations path = lead.h->lifted_path();
  const auto add = [&](std::size_t i, bool from_goal) {
    Outcome outcome;
    outcome.fate = Fate::reached;
    outcome.proposal = outcome.added = path[i];
    outcome.near = from_goal ? View(problem.goals.front()) : View(problem.start);
    outcome.from_goal = from_goal;
    outcome.added_row = 1;
    lead.h->observe(outcome, false);
  };
  // The least distance of proposals from a position.
  Stream stream(5, "", "two trees");
  const auto nearest_to = [&](View at, TreeSide side) {
    lead.h->select_tree(side);
    Configuration q(3);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 200; ++i) {
      lead.h->sample(stream, q);
      least = std::min(least, std::hypot(q[0] - at[0], q[1] - at[1]));
    }
    return least;
  };
  add(path.size() - 2, true);
  // A node at the goal is no progress of the tree from the start, whose proposals remain at the start.
  CHECK(lead.h->connected() < 0.25 * path_length(lead.parent->space, path));
  CHECK(nearest_to(problem.start, TreeSide::start) < 1.0);
  CHECK(nearest_to(problem.goals.front(), TreeSide::start) > 2.0);
  CHECK(nearest_to(problem.goals.front(), TreeSide::goal) < 1.0);
  CHECK(nearest_to(problem.start, TreeSide::goal) > 2.0);
  // The tree's front has most of the proposals.
  add(path.size() / 2, false);
  CHECK(nearest_to(path[path.size() / 2], TreeSide::start) < 1.0);
  // Nodes that a repair removed are reached no longer.
  lead.guide->restart();
  lead.h = lead.guide->heuristic(*lead.parent, lead.sub.get(), &lead.found);
  CHECK(lead.h->connected() == 0.0);
  CHECK(nearest_to(path[path.size() / 2], TreeSide::start) > 1.0);
}

namespace {

/// Presumes that all is valid.
class Presumed final : public Validity {
 public:
  [[nodiscard]] bool state(View) override { return true; }
  [[nodiscard]] MotionReport motion(View, View) override { return {true, 0, std::numeric_limits<double>::quiet_NaN()}; }
  [[nodiscard]] double clearance(View) override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool spends_checks() const override { return false; }
};

}  // namespace

TEST_CASE("where validity is presumed, a lead connects trees near its end alone", "[guide][decomposition]") {
  const auto problem = test::cup_problem();
  for (const bool presumed : {false, true}) {
    CAPTURE(presumed);
    Lead lead(problem, {});
    if (presumed) lead.parent->validity = std::make_shared<Presumed>();
    lead.solve();
    CHECK(lead.h->worth_connecting(problem.start, problem.goals.front()) != presumed);
    const Configurations path = lead.h->lifted_path();
    Outcome outcome;
    outcome.fate = Fate::reached;
    outcome.proposal = outcome.added = path[path.size() - 2];
    outcome.near = problem.start;
    outcome.added_row = 1;
    lead.h->observe(outcome, false);
    CHECK(lead.h->worth_connecting(problem.start, problem.goals.front()));
  }
}

TEST_CASE("a relaxed space checks collisions where the space above presumes validity", "[guide]") {
  auto parent = make_instance(test::cup_problem());
  const std::shared_ptr<Validity> checked = parent->validity;
  parent->validity = std::make_shared<Presumed>();
  const GuideKind& kind = *find_guide("shrink");
  const auto guide = kind.make(Options::validate(*kind.component, {}));
  const auto sub = guide->project(*parent);
  sub->validity->expect_guided(true);
  REQUIRE_FALSE(checked->motion(parent->start, parent->goal()).valid);
  CHECK_FALSE(sub->validity->motion(parent->start, parent->goal()).valid);
}
