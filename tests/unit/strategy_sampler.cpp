// SPDX-License-Identifier: GPL-3.0-or-later
// A guide that a planner elsewhere asks.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <trellis/planner/planner.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/sampler.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

Problem block_problem() {
  return test::make_problem("block", test::rectangle_world({{1.5, 1, 2, 3}, {2.4, 1.2, 2.8, 2}}, 4.0),
                            test::rectangle_robot(), {0.6, 2, 0}, {3.4, 2, 0});
}

/// Reports to a sampler what a planner observes.
class Relay final : public Advice {
 public:
  Relay(Sampler& sampler, const Instance& instance) : sampler_(sampler), instance_(instance) {}

  void map(std::uint32_t row, std::uint32_t number) { numbers_[row] = number; }
  void tell() {
    sampler_.spent(instance_.checks.validity - told_);
    told_ = instance_.checks.validity;
  }
  void answer(std::uint64_t id, const Outcome& outcome) {
    tell();
    if (outcome.added.empty()) return sampler_.rejected(id, outcome.near, outcome.proposal, outcome.blocked_at);
    const auto known = numbers_.find(outcome.added_row);
    const Side side = outcome.from_goal ? Side::goal : Side::start;
    if (known != numbers_.end()) return sampler_.joined(known->second, side);
    const std::uint32_t near = outcome.near_row == no_node ? no_node : numbers_.at(outcome.near_row);
    map(outcome.added_row,
        sampler_.accepted(id, outcome.added, near, outcome.fate == Fate::reached, outcome.connected, side));
  }
  void drew(std::uint32_t node) { node_ = node; }

  void observe(const Outcome& outcome, bool mine) override {
    REQUIRE_FALSE(mine);
    answer(0, outcome);
  }
  [[nodiscard]] std::uint32_t vertex() const override {
    if (node_ == no_node) return no_node;
    for (const auto& [row, number] : numbers_) {
      if (number == node_) return row;
    }
    return no_node;
  }
  [[nodiscard]] bool worth_connecting(View from, View to) const override { return sampler_.worth_connecting(from, to); }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override { return sampler_.edge_factor(a, b); }
  void found(double length) override { sampler_.path_found(length); }

 private:
  Sampler& sampler_;
  const Instance& instance_;
  std::uint64_t told_ = 0;
  std::uint32_t node_ = no_node;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;
};

constexpr std::int64_t most = 150;

bool needs_file(const GuideSpec& guide) {
  return guide.name() == "learned" || guide.name() == "experience" || guide.name() == "path_database";
}

PlannerSpec planner_named(const std::string& name) {
  return PlannerSpec::make(name, {{"proposals", most}, {"bound", 0.0}});
}

/// What a planner of Trellis draws from a sampler.
Configurations drawn_elsewhere(const GuideSpec& guide, const std::string& name, const Problem& problem,
                               std::uint64_t seed) {
  const PlannerSpec spec = planner_named(name);
  const PlannerKind& kind = *find_planner(name);
  const PlannerCommon common = kind.common(spec.options());
  const auto instance = root_instance(StrategySpec(spec), problem);
  Sampler sampler(guide, problem, seed,
                  {.step = common.step, .uniform = common.uniform, .goal_bias = common.goal_bias});
  Search search(instance->space.dimension());
  Relay relay(sampler, *instance);
  const auto planner =
      kind.make(spec.options(), {*instance, relay, Stream(seed, "0", "proposals"), search, true, nullptr, name});
  REQUIRE_FALSE(planner->begin(common.budget));
  const bool trees = name == "rrt_connect" || common.step == 0.0;
  for (std::uint32_t row = 0; row < search.nodes.size(); ++row) {
    relay.map(row, row == 0 || !trees ? row : sampler.root(Side::goal, row - 1));
  }
  Configuration q(instance->space.dimension());
  for (std::int64_t drawn = 0; drawn < most;) {
    const Plan plan = planner->plan();
    relay.tell();
    if (!plan.proposal) {
      if (planner->work()) break;
      continue;
    }
    const Draw draw = sampler.draw(q, plan.tree.value_or(Side::start));
    ++drawn;
    relay.drew(draw.node);
    search.proposals.push(q);
    const Outcome outcome = planner->extend(q);
    search.fates.push_back(outcome.fate);
    relay.answer(draw.id, outcome);
    if (planner->follow()) break;
  }
  return search.proposals;
}

}  // namespace

TEST_CASE("a planner draws from a sampler what it draws within Trellis", "[strategy][sampler]") {
  const Problem problem = block_problem();
  for (const auto& kind : test::guides_of_one_robot()) {
    const GuideSpec guide = test::guide_of(kind);
    if (needs_file(guide)) continue;
    for (const char* name : {"rrt", "rrt_connect", "prm"}) {
      CAPTURE(guide.text(), name);
      const RunRecord run = execute(guide >> planner_named(name), problem, 3);
      const Configurations& within = run.levels.front().search.proposals;
      const Configurations drawn = drawn_elsewhere(guide, name, problem, 3);
      REQUIRE(drawn.size() > 0);
      REQUIRE(drawn.size() <= within.size());
      const auto& values = drawn.values();
      CHECK(std::equal(values.begin(), values.end(), within.values().begin()));
    }
  }
}

TEST_CASE("hierarchies and combinations are asked as within Trellis", "[strategy][sampler]") {
  const Problem problem = block_problem();
  const auto guide = [](const char* name) { return GuideSpec::make(name, {}); };
  const std::vector<GuideSpec> guides = {
      guide("skeleton") >> guide("shrink") >> guide("lazy"), guide("skeleton") + guide("gaussian"),
      sequence({guide("shrink"), guide("bridge_test")}), blend({guide("skeleton"), guide("obstacle_based")}),
      race({guide("shrink"), guide("lazy")})};
  for (const GuideSpec& of : guides) {
    for (const std::uint64_t seed : {1U, 2U}) {
      CAPTURE(of.text(), seed);
      const RunRecord run = execute(of >> planner_named("rrt"), problem, seed);
      const Configurations& within = run.levels.front().search.proposals;
      const Configurations drawn = drawn_elsewhere(of, "rrt", problem, seed);
      REQUIRE(drawn.size() <= within.size());
      CHECK(std::equal(drawn.values().begin(), drawn.values().end(), within.values().begin()));
    }
  }
}

SCENARIO("a planner elsewhere answers draws", "[strategy][sampler]") {
  GIVEN("a sampler of a skeleton") {
    const Problem problem = block_problem();
    Sampler sampler(GuideSpec::make("skeleton", {}), problem, 1, {.uniform = 0.0});
    Configuration q(3);
    CHECK(sampler.level() == Found::untried);
    WHEN("it draws") {
      const Draw draw = sampler.draw(q);
      THEN("the guiding space was searched, and the draw is the guide's") {
        CHECK(draw.id == 1);
        CHECK(draw.guided);
        CHECK(sampler.level() == Found::found);
        CHECK(sampler.space().contains(q));
        CHECK(sampler.levels().size() == 2);
        CHECK(sampler.levels()[0].search.proposals.size() == 1);
      }
      THEN("nodes are numbered and found by their coordinates") {
        CHECK(sampler.accepted(draw.id, q, 0, true) == 1);
        CHECK(sampler.node(q) == 1);
        CHECK(sampler.node(problem.start) == 0);
        CHECK(sampler.node(View{problem.goal()}) == no_node);
        CHECK(sampler.nodes() == 2);
        sampler.cleared();
        CHECK(sampler.nodes() == 1);
        CHECK(sampler.node(q) == no_node);
        CHECK(sampler.node(problem.start) == 0);
      }
      THEN("wrong answers are refused") {
        CHECK_THROWS_WITH(sampler.accepted(7, q, 0, true), Contains("draw 7 is not the last one, 1"));
        CHECK_THROWS_WITH(sampler.accepted(1, q, 9, true), Contains("no node 9"));
        CHECK_THROWS_WITH(sampler.accepted(1, View{q}.first(2), 0, true), Contains("2 coordinates"));
        CHECK_THROWS_WITH(sampler.accepted(1, Configuration{NAN, 0, 0}, 0, true), Contains("not finite"));
        CHECK_THROWS_WITH(sampler.rejected(0, q, {}, {}), Contains("second end"));
        CHECK_THROWS_WITH(sampler.joined(4), Contains("no node 4"));
        sampler.rejected(1, problem.start, q, q);
        CHECK_THROWS_WITH(sampler.rejected(1, problem.start, q, q), Contains("draw 1 has an answer"));
      }
      THEN("many draws need a planner that does not answer") {
        CHECK_THROWS_WITH(sampler.draw_many(4), Contains("optimistic"));
      }
    }
    WHEN("it has drawn the same twice, with and without an answer in between") {
      Sampler other(GuideSpec::make("skeleton", {}), problem, 1, {.uniform = 0.0});
      Configuration r(3);
      sampler.draw(q);
      const Draw draw = other.draw(r);
      other.rejected(draw.id, {}, {}, {});
      THEN("a draw without an answer counts as rejected") {
        for (int i = 0; i < 20; ++i) {
          const std::uint64_t id = other.draw(r).id;
          other.rejected(id, {}, {}, {});
          sampler.draw(q);
          CHECK(q == r);
        }
        CHECK(sampler.levels()[0].search.fates.size() == 21);
      }
    }
  }
  GIVEN("a sampler whose searches are interrupted now and then") {
    const Problem problem = block_problem();
    int polls = 0;
    Sampler sampler(GuideSpec::make("shrink", {{"scale", 0.5}}), problem, 1,
                    {.interrupted = [&] { return ++polls % 40 == 0; }});
    Configuration q(3);
    THEN("the other draws continue") {
      int drawn = 0;
      for (int i = 0; i < 200; ++i) {
        try {
          sampler.rejected(sampler.draw(q).id, problem.start, q, q);
          ++drawn;
        } catch (const SamplerInterrupted&) {
        }
      }
      CHECK(drawn > 50);
      CHECK(drawn < 200);
    }
  }
  GIVEN("a sampler for planners in bulk") {
    const Problem problem = block_problem();
    const SamplerOptions options = {.uniform = 0.0, .goal_bias = 0.1, .optimistic = true};
    Sampler sampler(GuideSpec::make("skeleton", {}), problem, 4, options);
    const Configurations many = sampler.draw_many(200);
    THEN("its draws advance to the goal") {
      REQUIRE(many.size() == 200);
      double nearest = std::numeric_limits<double>::infinity();
      int goals = 0;
      for (std::size_t i = 0; i < many.size(); ++i) {
        const double distance = problem.space.distance(many[i], problem.goal());
        if (distance == 0.0)
          ++goals;
        else
          nearest = std::min(nearest, distance);
      }
      CHECK(nearest < 0.5);
      CHECK(goals > 5);
      CHECK(goals < 50);
    }
    THEN("one at a time they are the same") {
      Sampler other(GuideSpec::make("skeleton", {}), problem, 4, options);
      Configuration q(3);
      for (std::size_t i = 0; i < many.size(); ++i) {
        other.draw(q);
        CHECK(std::equal(q.begin(), q.end(), many[i].begin()));
      }
    }
  }
}

TEST_CASE("a sampler's grant pauses the searches below", "[strategy][sampler]") {
  const Problem problem = block_problem();
  const GuideSpec guide = GuideSpec::make("shrink", {{"scale", 0.5}});
  Sampler sampler(guide, problem, 2, {.uniform = 0.0, .grant = 1.0});
  Configuration q(3);
  const Draw first = sampler.draw(q);
  CHECK_FALSE(first.guided);
  CHECK(sampler.level() == Found::searching);
  const std::uint64_t before = sampler.checks();
  CHECK(sampler.allow(1000000));
  CHECK(sampler.level() == Found::found);
  CHECK(sampler.checks() > before);
  CHECK(sampler.draw(q).guided);
}

TEST_CASE("a sampler returns the density of its next draw", "[strategy][sampler]") {
  const Problem problem = block_problem();
  Sampler guided(GuideSpec::make("skeleton", {}), problem, 2, {.uniform = 0.5});
  const auto at_start = guided.density(problem.start);
  REQUIRE(at_start);
  const double uniform = 0.5 * std::exp(-problem.space.log_volume());
  CHECK(*at_start >= uniform);
  CHECK(guided.density(Configuration{3.9, 3.9, 3.0}).value() == Approx(uniform));
  // It does not change what is drawn.
  Sampler other(GuideSpec::make("skeleton", {}), problem, 2, {.uniform = 0.5});
  Configuration q(3);
  Configuration r(3);
  guided.draw(q);
  other.draw(r);
  CHECK(q == r);
}

TEST_CASE("a sampler refuses what a run refuses", "[strategy][sampler]") {
  const Problem problem = block_problem();
  const GuideSpec skeleton = GuideSpec::make("skeleton", {});
  CHECK_THROWS_WITH(Sampler(skeleton, problem, 1, {.step = -1.0}), Contains("'step' is -1"));
  CHECK_THROWS_WITH(Sampler(skeleton, problem, 1, {.uniform = 1.5}), Contains("'uniform' is 1.5"));
  CHECK_THROWS_WITH(Sampler(skeleton, problem, 1, {.goal_bias = 1.0}), Contains("'goal_bias' is 1"));
  CHECK_THROWS_WITH(Sampler(skeleton, problem, 1, {.grant = -1.0}), Contains("'grant' is -1"));
  Problem blocked = problem;
  blocked.start = {1.7, 2, 0};
  CHECK_THROWS_WITH(Sampler(skeleton, blocked, 1), Contains("start"));
  CHECK_THROWS_WITH(Sampler(skeleton, test::driven(problem), 1), Contains("motion model unicycle1"));
  Sampler sampler(skeleton, problem, 1);
  Configuration q(2);
  CHECK_THROWS_WITH(sampler.draw(q), Contains("2 coordinates"));
  CHECK_THROWS_WITH(sampler.node(q), Contains("2 coordinates"));
  CHECK_THROWS_WITH(sampler.worth_connecting(problem.start, q), Contains("2 coordinates"));
  CHECK_THROWS_WITH(sampler.edge_factor(q, problem.start), Contains("2 coordinates"));
  CHECK_THROWS_WITH(sampler.root(Side::goal, 1), Contains("no goal 1 of 1"));
  Configuration r(3);
  Sampler stopped(skeleton, problem, 1, {.interrupted = [] { return true; }});
  for (int i = 0; i < 3; ++i) CHECK_THROWS_AS(stopped.draw(r), SamplerInterrupted);
  // A guide that cannot make its space fails at each call, not at the first alone.
  Sampler unsuited(GuideSpec::make("couple", {}), problem, 1);
  for (int i = 0; i < 3; ++i) CHECK_THROWS_WITH(unsuited.draw(r), Contains("couple"));
  CHECK_THROWS_WITH(unsuited.accepted(0, problem.start, no_node, true), Contains("couple"));
  CHECK_THROWS_WITH(unsuited.levels(), Contains("couple"));
  CHECK(unsuited.level() == Found::untried);
}

TEST_CASE("bounded loss holds for planners elsewhere", "[strategy][sampler]") {
  struct Case {
    std::uint64_t alone;  // checks until it has a path
    std::uint64_t guided;
    std::uint64_t step;  // checks of one call
  };
  for (const double bound : {1.5, 2.0, 4.0}) {
    for (const std::uint64_t slice : {1U, 64U, 1000U}) {
      for (const Case& one : {Case{1000, 100000, 7}, Case{1000, 10, 7}, Case{500, 2000, 1}, Case{5000, 4000, 100},
                              Case{1, 100000, 13}, Case{777, 778, 50}}) {
        CAPTURE(bound, slice, one.alone, one.guided, one.step);
        Bounded both(bound, slice);
        const auto planner = [&](Who who, std::uint64_t until) {
          return [&both, who, until, step = one.step] {
            for (std::uint64_t n = 0; n < until && !both.over();) {
              const std::uint64_t more = std::min(step, until - n);
              n += more;
              both.spent(who, more);
            }
            return !both.over();
          };
        };
        const auto first = both.run(planner(Who::alone, one.alone), planner(Who::guided, one.guided));
        REQUIRE(first);
        const double total = static_cast<double>(both.checks(Who::alone) + both.checks(Who::guided));
        const double most = bound * static_cast<double>(one.alone) + static_cast<double>(slice + one.step);
        CHECK(total <= most);
        CHECK(both.checks(Who::alone) <= one.alone);
      }
    }
  }
}

TEST_CASE("bounded planners end with each other, and pass on what they throw", "[strategy][sampler]") {
  Bounded both(2.0, 10);
  const auto nothing = [&] {
    both.spent(Who::guided, 100);
    return false;
  };
  const auto path = [&] {
    for (int i = 0; i < 50; ++i) both.spent(Who::alone, 1);
    return true;
  };
  CHECK(both.run(path, nothing) == Who::alone);
  CHECK_FALSE(both.run([] { return false; }, nothing));
  CHECK_THROWS_WITH(both.run(path, []() -> bool { throw Error("a fault of the user"); }), "a fault of the user");
  CHECK_THROWS_AS(Bounded(1.0), Error);
  CHECK_THROWS_AS(Bounded(2.0, 0), Error);
}
