// SPDX-License-Identifier: GPL-3.0-or-later
// Guides that follow the points of one or several paths; excluded regions of spaces; options of the skeleton.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/aligned_lift.hpp>
#include <trellis/guide/excluded.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/guide/position.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/solved_guide.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::solve_guide;
using test::SolvedGuide;

namespace {

void tell(SolvedGuide& w, View added, bool mine) {
  Outcome outcome;
  outcome.fate = added.empty() ? Fate::rejected : Fate::reached;
  outcome.proposal = added.empty() ? View(w.parent->start) : added;
  outcome.near = w.parent->start;
  outcome.added = added;
  if (added.empty()) outcome.blocked_at = w.parent->start;
  w.guide->learn(outcome);
  w.h->observe(outcome, mine);
}

const std::vector<Options::Entry> waypoints = {{"follow", std::string("waypoints")}};

double least_distance(const Space& space, View q, const Configurations& path) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < path.size(); ++i) {
    least = std::min(least, nearest_on_motion(space, path[i - 1], path[i], q).squared_distance);
  }
  return std::sqrt(least);
}

}  // namespace

TEST_CASE("waypoints are proposed in turn, each until it is reached", "[guide][waypoints]") {
  for (const auto* name : {"shrink", "identity", "lazy"}) {
    CAPTURE(name);
    auto w = solve_guide(name, waypoints, test::cup_problem());
    auto& h = dynamic_cast<WaypointHeuristic&>(*w.h);
    const auto& path = std::as_const(w.found.path);
    Stream stream(1, "0", "waypoints");
    Configuration q(3);
    std::size_t before = 0;
    while (h.waypoint() < path.size()) {
      const std::size_t at = h.waypoint();
      REQUIRE(at > before);
      before = at;
      const bool kept = w.parent->valid(path[at]);
      CHECK(test::record_of(h).atoms() == (kept ? 1.0 : 0.0));
      h.sample(stream, q);
      CHECK(w.parent->space.distance(q, path[at]) <= (kept ? 0.0 : h.radius() + 1e-12));
      if (kept) {
        // The motion to it is blocked: the guide proposes points near it as well.
        tell(w, {}, true);
        CHECK(h.waypoint() == at);
        CHECK(test::record_of(h).atoms() == 0.5);
        for (int i = 0; i < 20; ++i) {
          h.sample(stream, q);
          CHECK(w.parent->space.distance(q, path[at]) <= h.radius() + 1e-12);
        }
      }
      // A node elsewhere reaches nothing.
      tell(w, w.parent->start, true);
      CHECK(h.waypoint() == at);
      tell(w, path[at], true);
    }
    // Afterwards the guide uses the whole path.
    CHECK(test::record_of(h).atoms() == 0.0);
    for (int i = 0; i < 200; ++i) {
      h.sample(stream, q);
      CHECK(least_distance(w.parent->space, q, path) <= h.radius() + 1e-9);
    }
  }
}

TEST_CASE("a waypoint without progress makes h stale, and another path continues from the planner's nodes",
          "[guide][waypoints]") {
  auto options = waypoints;
  options.emplace_back("evidence", std::int64_t{30});
  auto w = solve_guide("shrink", options, test::cup_problem());
  const Configurations path = w.found.path;
  REQUIRE(path.size() > 6);
  for (std::size_t i = 1; i < 4; ++i) tell(w, std::as_const(path)[i], false);
  for (int i = 0; i < 30; ++i) {
    CHECK_FALSE(w.h->stale());
    tell(w, {}, true);
  }
  CHECK(w.h->stale());
  const auto next = w.guide->heuristic(*w.parent, w.sub.get(), &w.found);
  CHECK_FALSE(next->stale());
  CHECK(dynamic_cast<WaypointHeuristic&>(*next).waypoint() >= 4);
}

TEST_CASE("the recorded density of h along waypoints or several paths is correct at every step",
          "[guide][waypoints][paths][density]") {
  auto both = waypoints;
  both.emplace_back("paths", std::int64_t{2});
  for (const auto& options : {waypoints, both, std::vector<Options::Entry>{{"paths", std::int64_t{3}}}}) {
    for (const auto& problem : {test::cup_problem(), test::trap_problem(), test::simple_passage_problem()}) {
      CAPTURE(problem.name, options.size());
      auto w = solve_guide("shrink", options, problem);
      const auto& space = w.parent->space;
      Stream stream(7, "0", "record");
      Configuration q(space.dimension());
      Configurations probes(space.dimension());
      for (int i = 0; i < 60; ++i) {
        if (i % 2 == 0) {
          space.sample_uniform(stream, q);
        } else {
          const View p = w.paths[static_cast<std::size_t>(i) % w.paths.size()]
                                [stream.below(w.paths.front().size()) % w.paths.back().size()];
          for (std::size_t j = 0; j < q.size(); ++j) q[j] = p[j] + stream.uniform(-0.05, 0.05);
          space.reflect(q);
        }
        probes.push(q);
      }
      std::vector<double> sums(probes.size(), 0.0);
      double atoms = 0.0;
      double drawn_atoms = 0.0;
      DensityRecord record;
      constexpr int steps = 1500;
      for (int t = 0; t < steps; ++t) {
        const DensityRecord now = test::record_of(*w.h);
        atoms += now.atoms() / steps;
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += now.at(std::as_const(probes)[i]) / steps;
        w.h->sample(stream, q);
        record.served(*w.h);
        for (const auto& path : w.paths) {
          for (std::size_t i = 0; i < path.size(); ++i) {
            if (space.distance(path[i], q) == 0.0) drawn_atoms += 1.0 / steps;
          }
        }
        tell(w, t % 3 == 0 ? View(q) : View(), true);
      }
      REQUIRE(record.exact());
      CHECK(record.atoms() == Approx(atoms).margin(1e-12));
      CHECK(drawn_atoms == Approx(atoms).margin(0.05));
      for (std::size_t i = 0; i < sums.size(); ++i) {
        CHECK(record.at(std::as_const(probes)[i]) == Approx(sums[i]).epsilon(1e-9).margin(1e-300));
      }
      record.compact();
      // One for the balls about each waypoint's path, five for their sizes where paths are followed by steps.
      CHECK(record.terms() <= (options.front().first == "follow" ? 1 : 5 * w.paths.size()));
    }
  }
}

TEST_CASE("several paths are separated except near their ends, and exclusions end", "[guide][paths]") {
  const auto problem = test::cup_problem();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    auto w = solve_guide(
        "shrink", {{"paths", std::int64_t{2}}, {"distinct", 0.5}, {"follow", std::string("tube")}, {"window", 100.0}},
        problem, seed);
    REQUIRE(w.paths.size() == 2);
    const auto& space = w.parent->space;
    const auto far = [&](View q) {
      return space.distance(q, problem.start) > 1.5 && space.distance(q, problem.goal()) > 1.5;
    };
    Configuration q(3);
    for (std::size_t i = 1; i < w.paths[1].size(); ++i) {
      for (int k = 0; k < 8; ++k) {
        space.interpolate(w.paths[1][i - 1], w.paths[1][i], k / 8.0, q);
        // Balls of 0.5 about points at most 0.25 apart leave a tube of sqrt(0.5^2 - 0.125^2) without gaps.
        if (far(q)) CHECK(least_distance(space, q, w.paths[0]) >= 0.48);
      }
    }
    for (const auto& path : w.paths) {
      for (std::size_t i = 0; i < path.size(); ++i) CHECK(w.sub->valid(path[i]));
      for (std::size_t i = 1; i < path.size(); ++i) CHECK(w.sub->motion(path[i - 1], path[i]).valid);
    }
    // Both guide: about half of the proposals each.
    Stream stream(seed, "0", "several");
    int first = 0;
    for (int i = 0; i < 400; ++i) {
      w.h->sample(stream, q);
      if (least_distance(space, q, w.paths[0]) < least_distance(space, q, w.paths[1])) ++first;
    }
    CHECK(first > 130);
    CHECK(first < 270);
  }
}

TEST_CASE("a goal near a path is a goal again when exclusions end", "[guide][paths][goals]") {
  Problem problem =
      test::make_problem("open", test::rectangle_world({{1, 8, 2, 9}}), test::rectangle_robot(), {1, 2, 0}, {9, 2, 0});
  problem.goals.push_back({5, 2.6, 0});
  const auto& second = problem.goals.back();
  int dropped = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const auto w = solve_guide("shrink", {{"paths", std::int64_t{2}}, {"distinct", 1.0}}, problem, seed);
    REQUIRE_FALSE(w.paths.empty());
    const auto& first = w.paths.front();
    // The search for the second path may not end at the goal beside the first one.
    const bool ends_there = w.parent->space.distance(first.back(), second) < 1.0;
    dropped += !ends_there && least_distance(w.parent->space, second, first) < 0.9 ? 1 : 0;
    CHECK(w.sub->goals.size() == 2);
  }
  CHECK(dropped > 0);
}

TEST_CASE("where there is no second path the search for it ends with its budget, and one guides", "[guide][paths]") {
  auto w = solve_guide("identity", {{"paths", std::int64_t{4}}, {"effort", std::int64_t{300}}},
                       test::simple_passage_problem());
  REQUIRE(w.paths.size() == 1);
  CHECK(dynamic_cast<StepHeuristic*>(w.h.get()) != nullptr);
  // A resumed search searches for as many again.
  CHECK(w.guide->repairs().another(&w.found) == 300);
  CHECK(w.guide->repairs().another(nullptr) == 0);
}

TEST_CASE("excluded balls are what brute force says", "[guide][paths]") {
  const auto problem = test::cup_problem();
  const auto& space = problem.space;
  Stream stream(3, "0", "balls");
  for (const double radius : {0.0, 0.05, 0.4}) {
    ExcludedBalls balls(space, radius);
    std::vector<Configuration> centres;
    Configuration a(3);
    Configuration b(3);
    for (int i = 0; i < 300; ++i) {
      space.sample_uniform(stream, a);
      const auto inside = [&](View q) {
        return std::any_of(centres.begin(), centres.end(),
                           [&](const auto& c) { return space.squared_distance(c, q) <= radius * radius; });
      };
      CHECK(balls.contains(a) == inside(a));
      space.sample_uniform(stream, b);
      space.interpolate(a, b, 0.2, b);
      const bool enters = std::any_of(centres.begin(), centres.end(), [&](const auto& c) {
        return nearest_on_motion(space, a, b, c).squared_distance <= radius * radius;
      });
      const auto t = balls.entered(a, b);
      REQUIRE(t.has_value() == enters);
      if (t) {
        space.interpolate(a, b, *t, b);
        // The reported position is inside, up to rounding.
        double least = std::numeric_limits<double>::infinity();
        for (const auto& c : centres) least = std::min(least, space.distance(c, b));
        CHECK(least <= radius + 1e-9);
      }
      if (i % 3 == 0) {
        balls.add(a);
        centres.push_back(a);
      }
    }
    balls.clear();
    CHECK_FALSE(balls.contains(centres.front()));
  }
}

TEST_CASE("a region is dropped after so many failures in a row, and then the whole world serves", "[guide][skeleton]") {
  const auto problem = test::simple_passage_problem();
  const double even = std::exp(-problem.space.log_volume());
  const auto wholly_uniform = [&](const SolvedGuide& w) {
    Stream stream(1, "0", "anywhere");
    Configuration q(3);
    for (int i = 0; i < 200; ++i) {
      problem.space.sample_uniform(stream, q);
      if (std::abs(test::record_of(*w.h).at(q) - even) > 1e-12) return false;
    }
    return true;
  };
  for (const std::int64_t drop : {0, 20}) {
    CAPTURE(drop);
    auto w = solve_guide(
        "skeleton",
        {{"follow", std::string("regions")}, {"prune", false}, {"drop", drop}, {"resolves", std::int64_t{0}}}, problem);
    CHECK_FALSE(wholly_uniform(w));
    Stream stream(2, "0", "failures");
    Configuration q(3);
    DensityRecord record;
    for (int i = 0; i < 2000; ++i) {
      w.h->sample(stream, q);
      record.served(*w.h);
      tell(w, {}, true);
    }
    CHECK(wholly_uniform(w) == (drop > 0));
    CHECK(record.exact());
  }
}

TEST_CASE("a region moves on where enough of the robot is inside it", "[guide][skeleton]") {
  const auto problem = test::simple_passage_problem();
  const double robot = problem.scene->bounding_radius();
  // The same walker, beside the skeleton by one bounding radius and a half: inside a region of two with its reference
  // point, not with its whole circle.
  const auto travelled = [&](double penetration) {
    auto w = solve_guide("skeleton",
                         {{"follow", std::string("regions")}, {"prune", false}, {"penetration", penetration}}, problem);
    const auto before = w.h->epoch();
    const auto path = w.found.path;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const View p = std::as_const(path)[i];
      if (p[0] > 3.0) break;
      const Configuration q = {p[0], p[1] + 1.5 * robot, 0.0};
      tell(w, q, false);
    }
    return w.h->epoch() - before;
  };
  CHECK(travelled(0.5) > 0);
  CHECK(travelled(1.0) < travelled(0.5));
}

TEST_CASE("regions keep to the path of a search that a guide guides", "[guide][skeleton]") {
  const auto problem = test::make_problem("block", test::rectangle_world({{3.5, 3, 6.5, 7}}), test::rectangle_robot(),
                                          {1, 5, 0}, {9, 5, 0});
  for (const bool guided : {false, true}) {
    CAPTURE(guided);
    auto w = solve_guide("skeleton", {{"follow", std::string("regions")}, {"explore", 0.0}}, problem);
    w.sub->guided = guided;
    w.h = w.guide->heuristic(*w.parent, w.sub.get(), &w.found);
    // The tree has reached every vertex, so that regions start from all of them.
    const auto& vertices = std::as_const(w.sub->graph->vertices);
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const Configuration q = {vertices[v][0], vertices[v][1], 0.0};
      tell(w, q, false);
    }
    Stream stream(3, "0", "regions");
    Configuration q(3);
    double farthest = 0.0;
    for (int i = 0; i < 500; ++i) {
      w.h->sample(stream, q);
      farthest = std::max(farthest, least_distance(w.sub->space, View(q.data(), 2), w.found.path));
    }
    const double radius = 2.0 * problem.scene->bounding_radius();
    CHECK((farthest <= radius + 1e-9) == guided);
  }
}

TEST_CASE("a waypoint farther than a step is reached in several extensions", "[guide][waypoints]") {
  const auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  Configurations path(3);
  path.push(problem.start);
  Configuration q(3);
  parent->space.interpolate(problem.start, problem.goals.front(), 0.2, q);
  path.push(q);
  path.push(problem.goals.front());
  ReachedIndex reached(parent->space, parent->start);
  WaypointHeuristic h("waypoints", *parent, path, 0.01, 60, reached);
  Stream stream(6, "0", "waypoints");
  for (std::uint32_t row = 1; row <= 3; ++row) {
    h.sample(stream, q);
    REQUIRE(std::equal(q.begin(), q.end(), path[1].begin()));
    Configuration added(3);
    parent->space.interpolate(problem.start, path[1], 0.25 * row, added);
    Outcome outcome;
    outcome.fate = Fate::advanced;
    outcome.proposal = path[1];
    outcome.near = problem.start;
    outcome.added = added;
    outcome.added_row = row;
    h.observe(outcome, true);
    // The next extension starts at the node that this one added.
    h.sample(stream, q);
    CHECK(h.vertex() == row);
    CHECK(h.waypoint() == 1);
  }
}

TEST_CASE("regions that travel along the path found are progress", "[guide][skeleton]") {
  const auto problem = test::simple_passage_problem();
  auto w = solve_guide("skeleton", {{"follow", std::string("regions")}}, problem);
  const double length = path_length(w.sub->space, w.found.path);
  const double before = w.h->progress();
  CHECK(before == 0.0);
  double last = before;
  for (std::size_t i = 0; i < w.found.path.size(); ++i) {
    const Configuration q = {w.found.path[i][0], w.found.path[i][1], 0.0};
    tell(w, q, false);
    CHECK(w.h->progress() >= last);
    last = w.h->progress();
  }
  CHECK(last > 0.7 * length);
  CHECK(last <= 1.001 * length);
  // What nodes reached before is connected, and no progress of the next h.
  w.h = w.guide->heuristic(*w.parent, w.sub.get(), &w.found);
  CHECK(w.h->progress() == 0.0);
  CHECK(w.h->connected() > 0.7 * length);
}

TEST_CASE("a refuted tube names the point of the path at which it was blocked", "[guide][paths]") {
  const auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  Configurations path(3);
  path.push(problem.start);
  path.push(problem.goals.front());
  PathHeuristic h("tube", parent->space, path, 0.2, 1.0, 5, nullptr);
  Configuration blocked(3);
  parent->space.interpolate(problem.start, problem.goals.front(), 0.1, blocked);
  Outcome outcome;
  outcome.proposal = problem.goals.front();
  outcome.near = problem.start;
  outcome.blocked_at = blocked;
  for (int i = 0; i < 5; ++i) {
    CHECK_FALSE(h.refuted_place());
    h.observe(outcome, true);
  }
  CHECK(h.stale());
  REQUIRE(h.refuted_place());
  CHECK(parent->space.distance(*h.refuted_place(), blocked) < 0.2);
}

TEST_CASE("a workspace that a tree searches excludes the places that were refuted", "[guide][workspace]") {
  const auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  const GuideKind& kind = *find_guide("workspace");
  for (const bool tree : {false, true}) {
    CAPTURE(tree);
    const auto guide = kind.make(Options::validate(*kind.component, {}));
    const auto sub = guide->project(*parent);
    if (tree) sub->graph = nullptr;
    guide->attach(*sub);
    Configuration place(3);
    parent->space.interpolate(problem.start, problem.goals.front(), 0.2, place);
    const View position(place.data(), 2);
    REQUIRE(sub->validity->state(position));
    guide->repairs().avoid(place);
    CHECK(sub->validity->state(position) != tree);
    // The guide of the search is notified of it.
    CHECK(guide->repairs().take_lost_places().size() == 1);
  }
}

TEST_CASE("regions begin at every vertex that a node comes near", "[guide][skeleton]") {
  const auto problem = test::simple_passage_problem();
  const double robot = problem.scene->bounding_radius();
  auto w = solve_guide("skeleton", {{"follow", std::string("regions")}, {"prune", false}}, problem);
  // A vertex of the path that is far from where regions are.
  const Graph& graph = *w.sub->graph;
  std::optional<std::uint32_t> far;
  for (std::uint32_t v = 0; v < graph.vertices.size(); ++v) {
    const View at = std::as_const(graph.vertices)[v];
    if (least_distance(w.sub->space, at, w.found.path) > 0.0) continue;
    const double from_ends =
        std::min(w.sub->space.distance(at, w.sub->start), w.sub->space.distance(at, w.sub->goal()));
    if (from_ends > 8.0 * robot) far = v;
  }
  REQUIRE(far);
  const View vertex = std::as_const(graph.vertices)[*far];
  Stream stream(1, "0", "spawn");
  // The share of proposals that come from regions about it.
  const auto share = [&] {
    Configuration q(3);
    int there = 0;
    constexpr int draws = 2000;
    for (int i = 0; i < draws; ++i) {
      const bool of_region = w.h->sample(stream, q) == 0;
      there += of_region && w.sub->space.distance(View(q).first(2), vertex) < 6.0 * robot ? 1 : 0;
    }
    return static_cast<double>(there) / draws;
  };
  CHECK(share() == 0.0);
  // A region's radius is two bounding radii.
  tell(w, Configuration{vertex[0], vertex[1] + 2.1 * robot, 0.0}, false);
  CHECK(share() == 0.0);
  tell(w, Configuration{vertex[0], vertex[1] + robot, 0.0}, false);
  CHECK(share() > 0.1);
}

TEST_CASE("a region's proposals move along its edge where they are aligned", "[guide][skeleton]") {
  for (const auto* model : {"unicycle1", "unicycle2", "car"}) {
    CAPTURE(model);
    // A corridor from left to right, whose axis is level.
    const auto problem =
        test::driven(test::make_problem("corridor", test::rectangle_world({{0, 0, 10, 4}, {0, 6, 10, 10}}),
                                        test::rectangle_robot(), {2, 5, 0}, {8, 5, 0}),
                     model);
    const auto backwards = [&](double alignment) {
      auto w = solve_guide("skeleton", {{"explore", 0.0}, {"alignment", alignment}}, problem);
      Stream stream(1, "0", "aligned");
      Configuration q(problem.space.dimension());
      int count = 0;
      for (int i = 0; i < 2000; ++i) {
        REQUIRE(w.h->sample(stream, q) == 0);
        REQUIRE(problem.space.contains(q));
        const double forward = q.size() > 3 && q[3] < 0.0 ? -1.0 : 1.0;
        const bool aligned = forward * std::cos(q[2]) >= alignment - 1e-6;
        count += aligned ? 0 : 1;
        CHECK(test::record_of(*w.h).at(q) > 0.0);
        // The same place with the opposite heading.
        q[2] = std::remainder(q[2] + std::numbers::pi, 2.0 * std::numbers::pi);
        CHECK((test::record_of(*w.h).at(q) > 0.0) == (alignment <= 0.0));
      }
      return count;
    };
    CHECK(backwards(0.5) == 0);
    CHECK(backwards(-1.0) == 0);
  }
}

TEST_CASE("the density of aligned states is that of their draws", "[guide][skeleton]") {
  for (const auto* model : {"unicycle1", "unicycle2", "car"}) {
    const auto problem = test::driven(test::simple_passage_problem(), model);
    const auto parent = make_instance(problem);
    const auto position = std::make_shared<PositionProjection>("skeleton", *parent);
    const double fibre = std::exp(-position->log_fibre_density(parent->start));
    const Configuration place = {4, 5};
    Configuration q(parent->space.dimension());
    for (const std::vector<Vec2>& directions : {std::vector<Vec2>{{0.6, 0.8}}, {{1, 0}, {0, -1}}}) {
      for (const double alignment : {-0.5, 0.1, 0.9}) {
        CAPTURE(model, directions.size(), alignment);
        const AlignedLift lift(position, parent->motion_model, directions, alignment);
        Stream stream(3, "0", "aligned");
        constexpr int points = 40000;
        constexpr std::size_t bins = 8;
        std::array<double, bins> drawn{};
        std::array<double, bins> expected{};
        const auto bin = [&] {
          const double turn = (q[2] + std::numbers::pi) / (2.0 * std::numbers::pi);
          return std::min(bins - 1, static_cast<std::size_t>(turn * static_cast<double>(bins)));
        };
        for (int i = 0; i < points; ++i) {
          lift.lift(place, stream, q);
          CHECK(q[0] == place[0]);
          CHECK(std::exp(lift.log_fibre_density(q)) > 0.0);
          drawn[bin()] += 1.0 / points;
          position->lift(place, stream, q);
          expected[bin()] += std::exp(lift.log_fibre_density(q)) * fibre / points;
        }
        for (std::size_t k = 0; k < bins; ++k) CHECK(drawn[k] == Approx(expected[k]).margin(0.02));
        CHECK(std::accumulate(expected.begin(), expected.end(), 0.0) == Approx(1.0).margin(0.05));
      }
    }
  }
}

TEST_CASE("with bottlenecks inhibited, further paths keep away from where C may not follow, and from nothing else",
          "[guide][paths]") {
  // Two gaps that the half robot passes, of which the real one passes the upper; and room on either side.
  const auto problem = test::make_problem(
      "two gaps", test::rectangle_world({{4.8, 0, 5.2, 4.9}, {4.8, 5.07, 5.2, 6.0}, {4.8, 6.6, 5.2, 10}}),
      test::rectangle_robot(), {3.5, 5, 0}, {6.5, 5, 0});
  int through_the_bottleneck = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto w =
        solve_guide("shrink", {{"paths", std::int64_t{3}}, {"distinct", 0.3}, {"inhibit", std::string("bottlenecks")}},
                    problem, seed);
    REQUIRE_FALSE(w.paths.empty());
    const auto& space = w.parent->space;
    const auto points_of = [&](const Configurations& path) {
      std::vector<Configuration> points;
      Configuration q(3);
      for (std::size_t i = 1; i < path.size(); ++i) {
        for (int k = 0; k < 10; ++k) {
          space.interpolate(path[i - 1], path[i], k / 10.0, q);
          points.push_back(q);
        }
      }
      return points;
    };
    for (std::size_t i = 0; i < w.paths.size(); ++i) {
      std::vector<Configuration> invalid;
      for (const auto& q : points_of(w.paths[i])) {
        const bool near_ends = space.distance(q, problem.start) <= 0.7 || space.distance(q, problem.goal()) <= 0.7;
        if (!near_ends && !w.parent->validity->state(q)) invalid.push_back(q);
      }
      through_the_bottleneck += invalid.empty() ? 0 : 1;
      // A path that C can follow ends the search for further ones.
      if (invalid.empty()) CHECK(i + 1 == w.paths.size());
      for (std::size_t k = i + 1; k < w.paths.size(); ++k) {
        for (const auto& q : invalid) CHECK(least_distance(space, q, w.paths[k]) > 0.15);
      }
    }
    // What was checked in C is counted.
    CHECK(w.sub->checks.validity > 0);
  }
  CHECK(through_the_bottleneck > 0);
}
