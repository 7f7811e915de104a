// SPDX-License-Identifier: GPL-3.0-or-later
// Between a level's planner and a guide's heuristic are the level, its observers, and the combinators: each forwards
// every call.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/custom.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/spy_heuristic.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::HeardCalls;
using test::SpyHeuristic;

namespace {

/// What all spies of a strategy heard.
struct Heard {
  std::shared_ptr<HeardCalls> h = std::make_shared<HeardCalls>();
  int guide_restarts = 0;
  int heuristics = 0;
};

/// S = C, whose path guides a spy.
class SpyGuide final : public Guide {
 public:
  SpyGuide(Heard& heard, bool spaceless) : heard_(heard), spaceless_(spaceless) {}
  std::unique_ptr<Instance> project(const Instance& parent) override {
    if (spaceless_) return nullptr;
    auto sub = std::make_unique<Instance>(parent);
    sub->checks = {};
    return sub;
  }
  void project(View q, MutableView s) const override { std::copy(q.begin(), q.end(), s.begin()); }
  void lift(View s, Stream&, MutableView q) const override { std::copy(s.begin(), s.end(), q.begin()); }
  [[nodiscard]] double log_fibre_density(View) const override { return 0.0; }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    ++heard_.heuristics;
    return std::make_unique<SpyHeuristic>(parent.space, heard_.h, no_node);
  }
  void restart() override { ++heard_.guide_restarts; }

 private:
  Heard& heard_;
  bool spaceless_;
};

class Spied final : public CustomGuide {
 public:
  Spied(Heard& heard, const std::string& name, bool spaceless)
      : CustomGuide({.name = name, .identity = name, .default_planner = spaceless ? "" : "rrt", .resolves = 10}),
        heard_(heard),
        spaceless_(spaceless) {}
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite&) const override {
    return std::make_unique<SpyGuide>(heard_, spaceless_);
  }

 private:
  Heard& heard_;
  bool spaceless_;
};

GuideSpec spied(Heard& heard, const std::string& name, bool spaceless = false) {
  return GuideSpec::make(std::make_shared<Spied>(heard, name, spaceless));
}

}  // namespace

TEST_CASE("every call of a planner reaches the heuristic, whatever stands between", "[strategy][forwarding]") {
  const Problem problem = test::point_problem(5);
  struct Case {
    const char* name;
    GuideSpec (*combine)(Heard&);
  };
  const std::vector<Case> cases = {
      {"alone", [](Heard& heard) { return spied(heard, "a"); }},
      {"S = {0}", [](Heard& heard) { return spied(heard, "a", true); }},
      {"mixture", [](Heard& heard) { return spied(heard, "a") + spied(heard, "b", true); }},
      {"sequence",
       [](Heard& heard) {
         return sequence({spied(heard, "a"), spied(heard, "b", true)});
       }},
      {"blend",
       [](Heard& heard) {
         return blend({spied(heard, "a"), spied(heard, "b", true)});
       }},
      {"schedule",
       [](Heard& heard) {
         return schedule({spied(heard, "a"), spied(heard, "b")});
       }},
      {"race",
       [](Heard& heard) {
         return race({spied(heard, "a"), spied(heard, "b")});
       }},
  };
  for (const Case& one : cases) {
    for (const bool watched : {false, true}) {
      CAPTURE(one.name, watched);
      ExecuteOptions options;
      if (watched) options.watch = [](const LevelRecord&, const Guidance&) {};
      const auto run = [&](Heard& heard, const PlannerSpec& planner) {
        return execute(one.combine(heard) >> planner, problem, 1, options);
      };
      Heard connect;
      // Without a bound, S is searched before anything is drawn.
      const auto planner = [](const std::string& name, std::int64_t proposals, double goal_bias = 0.0) {
        return PlannerSpec::make(name, {{"bound", 0.0}, {"goal_bias", goal_bias}, {"proposals", proposals}});
      };
      run(connect, planner("rrt_connect", 500));
      CHECK(std::count(connect.h->sides.begin(), connect.h->sides.end(), TreeSide::goal) > 0);
      CHECK(std::count(connect.h->sides.begin(), connect.h->sides.end(), TreeSide::start) > 0);
      CHECK(connect.h->vertices > 0);
      CHECK_FALSE(connect.h->connections.empty());
      CHECK(connect.h->progresses > 0);
      CHECK_FALSE(connect.h->outcomes.empty());
      CHECK(connect.guide_restarts > 0);
      Heard roadmap;
      run(roadmap, planner("lazy_prm", 500));
      CHECK_FALSE(roadmap.h->edges.empty());
      Heard anytime;
      run(anytime, planner("rrt_star", 2000, 0.3));
      CHECK_FALSE(anytime.h->lengths.empty());
      // The control of a guided proposal is the heuristic's, that of another one the planner's.
      Heard driven;
      const Problem cart = test::driven(test::simple_passage_problem());
      const RunRecord drove = execute(one.combine(driven) >> planner("kinodynamic_rrt", 300, 0.2), cart, 1, options);
      const Search& search = drove.levels.front().search;
      const ControlRecord& record = search.controls;
      REQUIRE(record.ends.size() == search.proposals.size());
      std::size_t own = 0;
      for (std::size_t i = 0; i < record.ends.size(); ++i) {
        REQUIRE(record.ends[i] == i + 1);
        const bool spies =
            record.controls[i][0] == SpyHeuristic::control && record.controls[i][1] == SpyHeuristic::control;
        CHECK(spies == (search.proposal_sources[i] >= 3));
        if (spies) CHECK(record.steps[i] == SpyHeuristic::steps);
        own += spies ? 0 : 1;
      }
      CHECK(own > 20);
      CHECK(own < record.ends.size());
    }
  }
}

TEST_CASE("a heuristic of one's own with S = {0} is made anew where the planner lost nodes", "[strategy][forwarding]") {
  // `drop` puts an obstacle back, so the tree in its S loses branches.
  const Problem problem = test::cup_problem();
  int remade = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Heard heard;
    const GuideSpec spy = spied(heard, "a", true);
    const GuideSpec drop = GuideSpec::make("drop", {}, PlannerSpec::make("rrt", {{"step", 0.5}}));
    execute(spy >> drop >> PlannerSpec::make("rrt", {{"step", 0.5}}), problem, seed);
    // The first is of the tree that is planted.
    CHECK(heard.guide_restarts >= 1);
    if (heard.guide_restarts > 1) CHECK(heard.h->restarts > 0);
    remade += heard.heuristics > 1 ? 1 : 0;
  }
  CHECK(remade > 0);
}
