// SPDX-License-Identifier: GPL-3.0-or-later
// A heuristic made of others passes on every call: whatever a planner reports or asks reaches those within, in their
// own space, and their answers reach the planner.
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/kept_tree.hpp>
#include <trellis/guide/lifted.hpp>
#include <trellis/guide/pieces.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/outcomes.hpp"
#include "support/spy_heuristic.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::HeardCalls;
using test::SpyHeuristic;

namespace {

const Space se2 = Space::se2({0, 10}, {0, 10});

Space plane() {
  std::vector<Axis> axes = {se2.axes()[0], se2.axes()[1]};
  return {"plane", axes};
}

/// A heuristic over SE(2) and what the spies within it heard.
struct Wrapped {
  std::unique_ptr<Heuristic> h;
  std::vector<std::shared_ptr<HeardCalls>> calls;
  std::vector<SpyHeuristic*> spies;
  std::function<Configuration(const Configuration&)> f = [](const Configuration& q) { return q; };

  std::unique_ptr<SpyHeuristic> spy(const Space& space) {
    calls.push_back(std::make_shared<HeardCalls>());
    auto made = std::make_unique<SpyHeuristic>(space, calls.back());
    spies.push_back(made.get());
    return made;
  }
};

Wrapped sum() {
  Wrapped w;
  std::vector<SumHeuristic::Part> parts;
  for (const double weight : {1.0, 3.0}) parts.push_back({weight, w.spy(se2)});
  w.h = std::make_unique<SumHeuristic>("sum", std::move(parts));
  return w;
}

Wrapped several() {
  Wrapped w;
  std::vector<std::unique_ptr<PathFollower>> parts;
  for (int i = 0; i < 3; ++i) parts.push_back(w.spy(se2));
  w.h = std::make_unique<SeveralPaths>(std::move(parts));
  return w;
}

Wrapped beside_a_tree() {
  Wrapped w;
  w.h = std::make_unique<TreeAndPath>(std::make_shared<KeptTree>(se2, Configuration{1, 1, 0}), w.spy(se2));
  return w;
}

Wrapped lifted(const Space& s) {
  Wrapped w;
  const auto axes = std::make_shared<const AxisProjection>(se2, s);
  w.f = [axes](const Configuration& q) {
    Configuration image(axes->space().dimension());
    axes->project(q, image);
    return image;
  };
  w.h = std::make_unique<LiftedHeuristic>(axes, s, w.spy(s), Configuration{1, 1, 0}, Configuration{9, 9, 1},
                                          LiftedHeuristic::Points::atoms);
  return w;
}

/// A sum of what is lifted: one within the other.
Wrapped nested() {
  Wrapped w = lifted(plane());
  std::vector<SumHeuristic::Part> parts;
  parts.push_back({1.0, std::move(w.h)});
  w.h = std::make_unique<SumHeuristic>("nested", std::move(parts));
  return w;
}

const Configuration a = {1, 2, 0.5};
const Configuration b = {3, 4, 1.5};

Outcome rejected(View q) {
  Outcome outcome;
  outcome.proposal = q;
  return outcome;
}

void check_forwards(Wrapped w) {
  Heuristic& h = *w.h;
  const auto pair = std::pair(w.f(a), w.f(b));
  h.select_tree(TreeSide::goal);
  for (const auto& calls : w.calls) CHECK(calls->sides == std::vector{TreeSide::goal});
  Stream stream(1, "0", "sample");
  Configuration q(3);
  h.sample(stream, q);
  CHECK(se2.contains(q));
  CHECK(h.vertex() == SpyHeuristic::row);
  CHECK_FALSE(h.worth_connecting(a, b));
  std::vector<double> control(2);
  CHECK(h.draw_control(stream, {a, 5, b, 9}, control) == SpyHeuristic::steps);
  CHECK(control == std::vector(2, SpyHeuristic::control));
  std::size_t drew = 0;
  for (const auto& calls : w.calls) {
    drew += calls->controls.size();
    for (const auto& query : calls->controls) {
      CHECK(std::pair(query.from, query.proposal) == pair);
      CHECK(query.row == 5);
      CHECK(query.longest == 9);
    }
  }
  CHECK(drew == 1);
  std::size_t asked = 0;
  for (const auto& calls : w.calls) {
    asked += calls->connections.size();
    for (const auto& connection : calls->connections) CHECK(connection == pair);
  }
  CHECK(asked == 1);  // the guide of the proposal decides
  CHECK(h.progress() == SpyHeuristic::metres * static_cast<double>(w.calls.size()));
  CHECK(h.connected() == 2.0 * SpyHeuristic::metres * static_cast<double>(w.calls.size()));
  CHECK(h.edge_factor(a, b) == SpyHeuristic::factor);
  for (const auto& calls : w.calls) CHECK(calls->edges.back() == pair);
  CHECK(test::record_of(h).atoms() == Approx(SpyHeuristic::atoms));
  h.restart();
  for (const auto& calls : w.calls) CHECK(calls->restarts == 1);
  h.found(12.5);
  for (const auto& calls : w.calls) CHECK(calls->lengths == std::vector{12.5});

  const std::uint64_t before = h.epoch();
  Outcome outcome;
  const Configuration blocked = {5, 6, 2};
  outcome.fate = Fate::advanced;
  outcome.proposal = q;
  outcome.near = a;
  outcome.added = b;
  outcome.blocked_at = blocked;
  outcome.from_goal = true;
  outcome.connected = false;
  outcome.added_row = 42;
  outcome.near_row = 41;
  outcome.control = control;
  outcome.steps = 2;
  h.observe(outcome, true);
  h.observe(rejected(a), false);
  CHECK(h.epoch() > before);
  int mine = 0;
  for (const auto& calls : w.calls) {
    REQUIRE(calls->outcomes.size() == 2);
    const HeardCalls::Observed& heard = calls->outcomes.front();
    CHECK(heard.fate == Fate::advanced);
    CHECK(heard.proposal == w.f(q));
    CHECK(heard.near == w.f(a));
    CHECK(heard.added == w.f(b));
    CHECK(heard.blocked_at == w.f(blocked));
    CHECK(heard.from_goal);
    CHECK_FALSE(heard.connected);
    CHECK(heard.added_row == 42);
    CHECK(heard.near_row == 41);
    CHECK(heard.control == control);
    CHECK(heard.steps == 2);
    mine += heard.mine ? 1 : 0;
    const HeardCalls::Observed& second = calls->outcomes.back();
    CHECK(second.connected);
    CHECK(second.proposal == w.f(a));
    CHECK(second.near.empty());
    CHECK(second.added.empty());
    CHECK(second.blocked_at.empty());
    CHECK_FALSE(second.mine);
  }
  CHECK(mine == 1);

  const Configurations path = h.lifted_path();
  REQUIRE(path.size() == 2);
  const Configurations within = w.spies.front()->lifted_path();
  for (std::size_t i = 0; i < 2; ++i) {
    const Configuration image = w.f({path[i].begin(), path[i].end()});
    CHECK(image == Configuration(within[i].begin(), within[i].end()));
  }
  CHECK_FALSE(h.stale());
}

}  // namespace

TEST_CASE("a heuristic made of others passes on every call", "[guide][forwarding]") {
  SECTION("a sum") { check_forwards(sum()); }
  SECTION("several paths") { check_forwards(several()); }
  SECTION("a path beside a tree") { check_forwards(beside_a_tree()); }
  SECTION("what is lifted from fewer axes") { check_forwards(lifted(plane())); }
  SECTION("what is lifted from the same axes") { check_forwards(lifted(se2)); }
  SECTION("a sum of what is lifted") { check_forwards(nested()); }
}

TEST_CASE("what is made of others is stale where they are", "[guide][forwarding]") {
  Wrapped of_one = lifted(plane());
  of_one.spies.front()->refute();
  CHECK(of_one.h->stale());
  Wrapped any = sum();
  any.spies.back()->refute();
  CHECK(any.h->stale());
  // Several paths guide until the last is refuted.
  Wrapped all = several();
  for (std::size_t i = 0; i < all.spies.size(); ++i) {
    CHECK_FALSE(all.h->stale());
    all.spies[i]->refute();
    all.h->observe(rejected(a), false);
  }
  CHECK(all.h->stale());
}

TEST_CASE("lengths of S hold in C only where f lengthens none", "[guide][forwarding]") {
  std::vector<Axis> axes = {se2.axes()[0], se2.axes()[1]};
  axes[0].weight *= 2.0;
  Wrapped w = lifted(Space("stretched", axes));
  CHECK(w.h->progress() == 0.0);
  CHECK(w.h->connected() == 0.0);
  w.h->found(12.5);
  CHECK(w.calls.front()->lengths.empty());
}

TEST_CASE("a path that guides by itself forgets the nodes that the planner lost", "[guide][forwarding]") {
  const auto parent = make_instance(test::simple_passage_problem());
  Configurations path(3);
  path.push(parent->start);
  path.push(parent->goal());
  for (const std::string follow : {"steps", "tube"}) {
    CAPTURE(follow);
    const auto piece = along(path, Options::validate(along_settings().component(), {{"follow", follow}}));
    const auto drawn = [&](bool learns, bool restarts) {
      RunShared shared;
      const auto guide = piece->make({1, "0/0", "", shared});
      static_cast<void>(guide->heuristic(*parent, nullptr, nullptr));
      Configuration q(3);
      for (int i = 0; learns && i <= 20; ++i) {
        parent->space.interpolate(parent->start, parent->goal(), i / 40.0, q);
        guide->learn(test::reached(q, 3));
      }
      if (restarts) guide->restart();
      const auto h = guide->heuristic(*parent, nullptr, nullptr);
      Stream stream(1, "0", "draws");
      h->sample(stream, q);
      return q;
    };
    CHECK(drawn(true, false) != drawn(false, false));
    CHECK(drawn(true, true) == drawn(false, false));
  }
}

TEST_CASE("a guide that lost the planner's nodes guides as one that never had any", "[guide][forwarding]") {
  for (const auto& kind : guide_kinds()) {
    if (kind.default_planner.empty()) continue;
    CAPTURE(kind.component->name);
    const Problem problem =
        kind.claims.needs == GuideClaims::Needs::team ? test::team_problem() : test::simple_passage_problem();
    // The same path for each: straight in S, of two legs.
    const auto drawn = [&](bool learns, bool restarts) {
      const auto parent = make_instance(problem);
      const auto guide = kind.make(Options::validate(*kind.component, {}));
      const auto sub = guide->project(*parent);
      guide->attach(*sub);
      Solution found;
      found.status = Status::solved;
      found.path = Configurations(sub->space.dimension());
      Configuration middle(sub->space.dimension());
      sub->space.interpolate(sub->start, sub->goal(), 0.5, middle);
      if (sub->graph) {
        found.path = Configurations(sub->graph->vertices.dimension());
        found.path.push(sub->graph->vertices[sub->graph->start]);
        found.path.push(sub->graph->vertices[sub->graph->goals.front()]);
      } else {
        found.path.push(sub->start);
        found.path.push(middle);
        found.path.push(sub->goal());
      }
      static_cast<void>(guide->heuristic(*parent, sub.get(), &found));
      if (learns) {
        Configuration q(parent->space.dimension());
        for (int i = 0; i <= 40; ++i) {
          parent->space.interpolate(parent->start, parent->goal(), i / 40.0, q);
          guide->learn(test::reached(q, 3));
        }
      }
      if (restarts) guide->restart();
      const auto h = guide->heuristic(*parent, sub.get(), &found);
      Stream stream(1, "0", "draws");
      std::vector<double> draws;
      Configuration q(parent->space.dimension());
      for (int i = 0; i < 20; ++i) {
        h->sample(stream, q);
        draws.insert(draws.end(), q.begin(), q.end());
      }
      return draws;
    };
    CHECK(drawn(true, true) == drawn(false, true));
  }
}
