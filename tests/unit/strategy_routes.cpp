// SPDX-License-Identifier: GPL-3.0-or-later
// The law of a hierarchy: what a level found reaches the level above. For every pair a >> b of the catalogue, another
// route of a gives another route of b, and where b's space has positions, on the same side of an obstacle. A route
// above hierarchies of two and three guides, as scripts write them, reaches the path of the root.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/custom.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/reached_nodes.hpp>
#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/refuses.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

constexpr double middle_x = 5.0;
constexpr double middle_y = 5.0;

/// A block halfway, with as much room above it as below it.
Problem block_problem() {
  return test::make_problem("block", test::rectangle_world({{3.5, 3, 6.5, 7}}), test::rectangle_robot(), {1, 5, 0},
                            {9, 5, 0});
}

enum class Side { below = -1, above = 1 };

/// A path in a space, past the block on one side; in a space without positions, with its second coordinate in the place
/// of y.
Configurations path_past(const Instance& instance, Side side) {
  const std::size_t axis = instance.position_axes.size() == 2 ? instance.position_axes[1]
                           : instance.space.dimension() > 1   ? 1
                                                              : 0;
  const Axis& y = instance.space.axes()[axis];
  const double beside = 0.5 * (y.lo + y.hi) + static_cast<double>(side) * 0.35 * (y.hi - y.lo);
  Configurations corners(instance.space.dimension());
  corners.push(instance.start);
  for (const double t : {0.2, 0.8}) {
    Configuration q(instance.space.dimension());
    instance.space.interpolate(instance.start, instance.goal(), t, q);
    q[axis] = beside;
    corners.push(q);
  }
  corners.push(instance.goal());
  Configurations path(instance.space.dimension());
  Configuration q(instance.space.dimension());
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    constexpr int pieces = 20;
    for (int k = i == 0 ? 0 : 1; k <= pieces; ++k) {
      instance.space.interpolate(corners[i], corners[i + 1], static_cast<double>(k) / pieces, q);
      path.push(q);
    }
  }
  return path;
}

/// The shortest path of a graph of positions, past the block on one side. Empty if there is none.
Configurations graph_path_past(const Instance& instance, Side side) {
  const Graph& graph = *instance.graph;
  const auto& vertices = std::as_const(graph.vertices);
  const auto allowed = [&](View q) {
    return std::abs(q[0] - middle_x) > 1.0 || (q[1] - middle_y) * static_cast<double>(side) > 0.0;
  };
  std::vector<double> cost(vertices.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> parent(vertices.size(), 0);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  cost[graph.start] = 0.0;
  queue.emplace(0.0, graph.start);
  while (!queue.empty()) {
    const auto [c, v] = queue.top();
    queue.pop();
    if (c > cost[v]) continue;
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
      const Graph::Edge& edge = graph.edges[e];
      if (edge.from != v && edge.to != v) continue;
      const std::uint32_t next = edge.from == v ? edge.to : edge.from;
      bool open = allowed(vertices[next]);
      for (std::size_t i = 0; i < edge.points.size(); ++i) open = open && allowed(edge.points[i]);
      if (!open || c + edge.cost >= cost[next]) continue;
      if (!graph.verified && !instance.validity->motion(vertices[v], vertices[next]).valid) continue;
      cost[next] = c + edge.cost;
      parent[next] = e;
      queue.emplace(cost[next], next);
    }
  }
  Configurations path(instance.space.dimension());
  const std::uint32_t goal = graph.goals.front();
  if (!std::isfinite(cost[goal])) return path;
  std::vector<Configuration> back;
  for (std::uint32_t at = goal; at != graph.start;) {
    const Graph::Edge& edge = graph.edges[parent[at]];
    const bool forward = edge.to == at;
    const std::size_t n = edge.points.size();
    if (n == 0) back.emplace_back(vertices[at].begin(), vertices[at].end());
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const View q = edge.points[forward ? n - 1 - i : i];
      back.emplace_back(q.begin(), q.end());
    }
    at = forward ? edge.from : edge.to;
  }
  path.push(vertices[graph.start]);
  for (auto q = back.rbegin(); q != back.rend(); ++q) path.push(*q);
  return path;
}

/// A guide of the catalogue whose search always finds the path past one side of the block.
/// \param followed  receives the path that its h follows
class Forced final : public Guide, public SpendsParentsChecks {
 public:
  Forced(const GuideKind& kind, Side side, Configurations& followed)
      : guide_(kind.make(Options::validate(*kind.component, {}))), side_(side), followed_(followed) {}

  std::unique_ptr<Instance> project(const Instance& parent) override { return guide_->project(parent); }
  void attach(Instance& sub) override { guide_->attach(sub); }
  void attach_parent(Instance& parent, bool guided) override {
    if (auto* spender = dynamic_cast<SpendsParentsChecks*>(guide_.get())) spender->attach_parent(parent, guided);
  }
  void project(View q, MutableView s) const override { guide_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { guide_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View q) const override { return guide_->log_fibre_density(q); }
  [[nodiscard]] bool closed_fibre() const override { return guide_->closed_fibre(); }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution*) override {
    Solution forced;
    forced.status = Status::solved;
    if (sub->graph) {
      forced.path = graph_path_past(*sub, side_);
    } else {
      forced.path = Configurations(sub->space.dimension());
      const Configurations path = path_past(parent, side_);
      Configuration s(sub->space.dimension());
      for (std::size_t i = 0; i < path.size(); ++i) {
        guide_->project(path[i], s);
        forced.path.push(s);
      }
    }
    auto h = guide_->heuristic(parent, sub, &forced);
    if (followed_.empty()) followed_ = h->lifted_path();
    return h;
  }
  void learn(const Outcome& outcome) override { guide_->learn(outcome); }
  void restart() override { guide_->restart(); }
  Repairs& repairs() override { return guide_->repairs(); }

 private:
  std::unique_ptr<Guide> guide_;
  Side side_;
  Configurations& followed_;
};

class ForcedKind final : public CustomGuide {
 public:
  ForcedKind(const GuideKind& kind, Side side, Configurations& followed)
      : CustomGuide({.name = kind.component->name,
                     .identity = kind.component->name + (side == Side::above ? " above" : " below"),
                     .default_planner = kind.default_planner,
                     .resolves = 0}),
        kind_(kind),
        side_(side),
        followed_(followed) {}
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite&) const override {
    return std::make_unique<Forced>(kind_, side_, followed_);
  }

 private:
  const GuideKind& kind_;
  Side side_;
  Configurations& followed_;
};

/// A guide with S = {0} that follows the path past one side of the block.
class Route final : public SamplingGuide {
 public:
  explicit Route(Side side) : side_(side) {}
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    if (!reached_.begun()) reached_.begin(parent.space, parent.start, parent.goals);
    return follow_path("route", {}, parent, path_past(parent, side_), reached_.both());
  }
  void learn(const Outcome& outcome) override {
    if (!outcome.added.empty() && outcome.connected) reached_.add(outcome.added, outcome.from_goal);
  }
  void restart() override { reached_.clear(); }

 private:
  Side side_;
  ReachedNodes reached_;
};

class RouteKind final : public CustomGuide {
 public:
  explicit RouteKind(Side side)
      : CustomGuide({.name = "route",
                     .identity = side == Side::above ? "route above" : "route below",
                     .default_planner = "",
                     .resolves = 0}),
        side_(side) {}
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite&) const override { return std::make_unique<Route>(side_); }

 private:
  Side side_;
};

/// b with the planner that searches its space where it is guided, without a bound.
GuideSpec unbounded(const GuideKind& kind) {
  std::vector<Options::Entry> options = kind.guided_planner.options;
  options.emplace_back("bound", 0.0);
  const std::string& name = kind.guided_planner.name.empty() ? kind.default_planner : kind.guided_planner.name;
  return GuideSpec::make(kind.component->name, {}, PlannerSpec::make(name, options));
}

struct ForcedRun {
  Configurations followed;  ///< the path that a's h follows first
  RunRecord run;
};

ForcedRun run_forced(const GuideKind& a, const GuideKind& b, Side side, std::uint64_t seed) {
  static const Problem problem = block_problem();
  ForcedRun result;
  const auto forced = std::make_shared<ForcedKind>(a, side, result.followed);
  const PlannerSpec root = PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}, {"proposals", std::int64_t{300}}});
  result.run = execute(GuideSpec::make(forced) >> unbounded(b) >> root, problem, seed);
  return result;
}

const LevelRecord& level_of(const RunRecord& run, const std::string& guide) {
  const auto found = std::find_if(run.levels.begin(), run.levels.end(), [&](const LevelRecord& level) {
    return level.depth == 1 && level.name.starts_with(guide);
  });
  REQUIRE(found != run.levels.end());
  return *found;
}

/// The mean height over the middle line of a level's path, beside the block.
double height(const LevelRecord& level) {
  const Configurations& path = level.solution.path;
  double sum = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (std::abs(path[i][level.position_axes[0]] - middle_x) > 2.0) continue;
    sum += path[i][level.position_axes[1]] - middle_y;
    n += 1.0;
  }
  return sum / n;
}

bool equal(const Configurations& a, const Configurations& b) {
  return std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

/// Whether a space is searched, so that there can be a route.
bool searches(const GuideKind& kind) { return !kind.default_planner.empty(); }

}  // namespace

TEST_CASE("another route of a gives another route of b, for every pair a >> b", "[strategy][routes]") {
  constexpr int seeds = 3;
  int pairs = 0;
  int runs = 0;
  int followed = 0;
  for (const GuideKind& a : test::guides_of_one_robot()) {
    for (const GuideKind& b : test::guides_of_one_robot()) {
      if (!searches(a) || !searches(b) || test::refuses(a, b, block_problem())) continue;
      CAPTURE(a.component->name, b.component->name);
      bool applies = false;
      for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const ForcedRun up = run_forced(a, b, Side::above, seed);
        const ForcedRun down = run_forced(a, b, Side::below, seed);
        // f may map both routes to one, or h have none, as that of a library without paths.
        if (up.followed.empty() || equal(up.followed, down.followed)) continue;
        const LevelRecord& above = level_of(up.run, b.component->name);
        const LevelRecord& below = level_of(down.run, b.component->name);
        // b's space may have no path at all.
        if (!above.solution.solved() && !below.solution.solved()) continue;
        applies = true;
        CHECK_FALSE(equal(above.solution.path, below.solution.path));
        if (above.position_axes.size() != 2) continue;
        const bool follows = height(above) > 0.0 && height(below) < 0.0;
        // A tree may grow past the other side before its guide does.
        if (find_planner(b.default_planner)->graph) CHECK(follows);
        ++runs;
        followed += follows ? 1 : 0;
      }
      pairs += applies ? 1 : 0;
    }
  }
  CHECK(pairs >= 110);
  CHECK(followed >= runs * 95 / 100);
}

namespace {

/// How many runs there were, and in how many the path of the root passes the block on the side of the route.
struct Followed {
  int runs = 0;
  int followed = 0;
};

/// The height over the middle line at which a path of the root crosses the middle of the block.
double height_at_middle(const Configurations& path) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const View a = path[i - 1];
    const View b = path[i];
    if (a[0] > middle_x || b[0] < middle_x) continue;
    return a[1] + (b[1] - a[1]) * (middle_x - a[0]) / std::max(b[0] - a[0], 1e-9) - middle_y;
  }
  return 0.0;
}

/// Runs `route >> guides` on both sides of the block, with the planners and bounds that guides have by default.
/// \param guides  from the farthest below the root to the nearest
/// \return no runs where a space has no positions, in which a route has no side
Followed run_routes(const std::vector<const GuideKind*>& guides, std::uint64_t seeds) {
  static const Problem problem = block_problem();
  const PlannerSpec root = PlannerSpec::make(
      "rrt", {{"step", 0.5}, {"bound", 0.0}, {"uniform", 0.0}, {"goal_bias", 0.02}, {"proposals", std::int64_t{1500}}});
  Followed result;
  for (const Side side : {Side::below, Side::above}) {
    GuideSpec guide = GuideSpec::make(std::make_shared<RouteKind>(side));
    for (const GuideKind* kind : guides) guide = guide >> test::guide_of(*kind);
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const RunRecord run = execute(guide >> root, problem, seed);
      const bool positions = std::all_of(run.levels.begin(), run.levels.end(),
                                         [](const LevelRecord& level) { return level.position_axes.size() == 2; });
      if (!positions) return {};
      ++result.runs;
      if (run.solved && height_at_middle(run.path) * static_cast<double>(side) > 0.0) ++result.followed;
    }
  }
  return result;
}

/// The guides of the catalogue whose space is searched, for one robot. A library without paths has no route.
std::vector<const GuideKind*> searching_guides() {
  std::vector<const GuideKind*> some;
  for (const GuideKind& kind : test::guides_of_one_robot()) {
    if (searches(kind) && kind.component->name != "experience") some.push_back(&kind);
  }
  return some;
}

}  // namespace

TEST_CASE("a route reaches the root through any two guides, at their default bounds", "[strategy][routes]") {
  const auto guides = searching_guides();
  int pairs = 0;
  Followed all;
  for (const GuideKind* a : guides) {
    for (const GuideKind* b : guides) {
      if (test::refuses(*a, *b, block_problem())) continue;
      CAPTURE(a->component->name, b->component->name);
      const Followed of = run_routes({a, b}, 3);
      if (of.runs == 0) continue;
      ++pairs;
      all.runs += of.runs;
      all.followed += of.followed;
      CHECK(of.followed >= of.runs - 1);
    }
  }
  CHECK(pairs >= 110);
  CAPTURE(pairs, all.runs, all.followed);
  CHECK(all.followed >= all.runs * 99 / 100);
}

TEST_CASE("a route reaches the root through three guides, at their default bounds", "[strategy][routes]") {
  const auto guides = searching_guides();
  Stream stream(1, "", "triples");
  const auto any = [&] { return guides[stream.below(guides.size())]; };
  int triples = 0;
  Followed all;
  for (int i = 0; i < 60; ++i) {
    const GuideKind* a = any();
    const GuideKind* b = any();
    const GuideKind* c = any();
    if (test::refuses(*a, *b, block_problem()) || test::refuses(*b, *c, block_problem())) continue;
    CAPTURE(a->component->name, b->component->name, c->component->name);
    const Followed of = run_routes({a, b, c}, 3);
    triples += of.runs > 0 ? 1 : 0;
    all.runs += of.runs;
    all.followed += of.followed;
    CHECK(of.followed >= of.runs - 1);
  }
  CAPTURE(triples, all.runs, all.followed);
  CHECK(triples >= 20);
  CHECK(all.followed >= all.runs * 99 / 100);
}

TEST_CASE("a level waits for the first search of a graph below it", "[strategy][routes]") {
  static const Problem problem = block_problem();
  const PlannerSpec root = PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}});
  for (const std::string graph : {"workspace", "decomposition", "skeleton"}) {
    CAPTURE(graph);
    const GuideSpec guide = GuideSpec::make(graph, {}) >> GuideSpec::make("identity", {});
    const RunRecord run = execute(guide >> root, problem, 1);
    const auto first = std::find_if(run.turns.begin(), run.turns.end(),
                                    [](const Turn& turn) { return turn.level == 2 && turn.solve_ended; });
    REQUIRE(first != run.turns.end());
    // No proposal of the level above comes before the path of the graph.
    CHECK(
        std::none_of(run.turns.begin(), first, [](const Turn& turn) { return turn.level == 1 && turn.proposals > 0; }));
    CHECK(run.levels.at(1).guided_proposals > 0);
  }
}
