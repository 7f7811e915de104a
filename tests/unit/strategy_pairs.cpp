// SPDX-License-Identifier: GPL-3.0-or-later
// Any guide composes with every other.
#include <algorithm>
#include <string>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/refuses.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// A block on the direct route, small enough that every guide has an effect at once.
Problem block_problem() {
  return test::make_problem("block", test::rectangle_world({{1.5, 1, 2, 3}, {2.4, 1.2, 2.8, 2}}, 4.0),
                            test::rectangle_robot(), {0.6, 2, 0}, {3.4, 2, 0});
}

/// The guide with short searches of its own.
GuideSpec small(const GuideKind& kind) {
  if (kind.default_planner.empty()) return GuideSpec::make(kind.component->name, {});
  return GuideSpec::make(kind.component->name, {},
                         PlannerSpec::make(kind.default_planner, {{"proposals", std::int64_t{100}}}));
}

StrategySpec over(const GuideSpec& guide) {
  // Without a companion, which could find a path before the guides are set up.
  return {PlannerSpec::make("rrt", {{"step", 0.5}, {"proposals", std::int64_t{120}}, {"bound", 0.0}}), guide};
}

void check_run(const GuideSpec& guide) {
  static const Problem problem = block_problem();
  const StrategySpec strategy = over(guide);
  CAPTURE(strategy.text());
  const RunRecord one = execute(strategy, problem, 5);
  const RunRecord two = execute(strategy, problem, 5);
  CHECK(one.status == two.status);
  CHECK(one.validity_checks == two.validity_checks);
  REQUIRE(one.levels.size() == two.levels.size());
  for (std::size_t i = 0; i < one.levels.size(); ++i) {
    CAPTURE(i, one.levels[i].name);
    for (const auto rows : {&Search::nodes, &Search::proposals}) {
      const auto& a = (one.levels[i].search.*rows).values();
      const auto& b = (two.levels[i].search.*rows).values();
      CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end()));
    }
    const Space& space = one.levels[i].space;
    const auto& proposals = one.levels[i].search.proposals;
    bool inside = true;
    for (std::size_t k = 0; k < proposals.size(); ++k) inside = inside && space.contains(proposals[k]);
    CHECK(inside);
  }
}

}  // namespace

TEST_CASE("any guide guides the search of any other that has one", "[strategy][pairs]") {
  for (const auto& above : test::guides_of_one_robot()) {
    for (const auto& guided : test::guides_of_one_robot()) {
      if (guided.default_planner.empty()) continue;
      const GuideSpec both = small(above) >> small(guided);
      if (test::refuses(above, guided, block_problem())) {
        CAPTURE(both.text());
        const std::string what = above.component->name + ": needs " + std::string(to_string(above.claims.needs));
        CHECK_THROWS_WITH(execute(over(both), block_problem(), 5), Catch::Matchers::Contains(what));
      } else {
        check_run(both);
      }
    }
  }
}

TEST_CASE("any guide mixes with any other", "[strategy][pairs]") {
  for (const auto& a : test::guides_of_one_robot()) {
    for (const auto& b : test::guides_of_one_robot()) check_run(small(a) + small(b));
  }
}

TEST_CASE("any guide takes turns with any other", "[strategy][pairs]") {
  const auto& kinds = test::guides_of_one_robot();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) check_run(sequence({small(kinds[i]), small(kinds[k])}, 30));
  }
}
