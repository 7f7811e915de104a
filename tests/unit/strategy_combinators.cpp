// SPDX-License-Identifier: GPL-3.0-or-later
// schedule, race, split and the rules of blend: their laws, and their steps.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/parallel.hpp>
#include <trellis/strategy/ablation.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/bounded_loss.hpp"
#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/random_specs.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
GuideSpec shrink(double scale, const std::vector<Options::Entry>& more = {}) {
  std::vector<Options::Entry> given = {{"scale", scale}};
  given.insert(given.end(), more.begin(), more.end());
  return guide("shrink", given);
}
/// A planner without a limit on its guides' proposals.
PlannerSpec unbounded(std::vector<Options::Entry> given = {}) {
  given.emplace_back("bound", 0.0);
  return PlannerSpec::make("rrt", given);
}
PlannerSpec rrt(const std::vector<Options::Entry>& given = {}) { return PlannerSpec::make("rrt", given); }
/// A search that ends before it has found anything.
GuideSpec hopeless() { return GuideSpec::make("identity", {}, unbounded({{"proposals", std::int64_t{2}}})); }

bool same(const Configurations& a, const Configurations& b) {
  return std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

/// The goal is walled in: the budget of proposals is drawn in full.
Problem walled() {
  return test::make_problem("walled", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(), {1, 5, 0},
                            {9, 5, 0});
}

/// The parts of the guide that drew, in the order in which they began to: "010".
std::string order(const LevelRecord& level) {
  std::string parts;
  for (const auto source : level.search.proposal_sources) {
    if (source < 3) continue;
    const char part = static_cast<char>('0' + source - 3);
    if (parts.empty() || parts.back() != part) parts.push_back(part);
  }
  return parts;
}

}  // namespace

TEST_CASE("a schedule, and a race, of one guide is that guide", "[combinators][laws]") {
  const auto a = guide("skeleton") >> shrink(0.4);
  CHECK(schedule({a}) == a);
  CHECK(schedule({a}, {.rounds = 3, .turn = 50}) == a);
  CHECK(race({a}) == a);
  CHECK(race({a}, {.slice = 7}) == a);
}

TEST_CASE("nesting distributes over schedules and races", "[combinators][laws]") {
  const auto a = guide("skeleton");
  const auto b = shrink(0.5);
  const auto c = guide("lazy");
  CHECK(a >> schedule({b, c}, {.rounds = 2}) == schedule({a >> b, a >> c}, {.rounds = 2}));
  CHECK(a >> race({b, c}, {.slice = 9}) == race({a >> b, a >> c}, {.slice = 9}));
  CHECK(a >> race({b, guide("goal_bias")}) == race({a >> b, guide("goal_bias")}));
  CHECK((a >> race({b, schedule({c, b})})) >> rrt() == a >> (race({b, schedule({c, b})}) >> rrt()));
  CHECK(schedule({schedule({a, b}), c}) == schedule({a, schedule({b, c})}));
  CHECK(race({race({a, b}), c}).terms().size() == 2);
  CHECK_FALSE(schedule({a, b}) == schedule({b, a}));
  CHECK_FALSE(schedule({a, b}) == sequence({a, b}));
  CHECK_FALSE(schedule({a, b}) == race({a, b}));
  CHECK_FALSE(schedule({a, b}, {.turn = 10}) == schedule({a, b}));
}

TEST_CASE("splits compose with every guide, and add up", "[combinators][laws]") {
  const auto a = guide("skeleton");
  const auto b = shrink(0.5);
  CHECK(split(a >> rrt()) == a >> split(rrt()));
  CHECK(a >> split(b >> rrt()) == (a >> b) >> split(rrt()));
  CHECK(split(split(rrt()), {.depth = 2}) == split(rrt(), {.depth = 3}));
  CHECK(split(split(rrt(), {.effort = 10})).undivided() == split(rrt(), {.effort = 10}));
  CHECK_FALSE(StrategySpec(split(rrt())) == StrategySpec(rrt()));
  CHECK((a >> split(rrt(), {.depth = 2})).text() == "skeleton() >> split { rrt(), depth = 2 }");
  CHECK((a >> split(rrt(), {.depth = 2})).tree() ==
        "split { rrt(), depth = 2 }\n"
        "└─ skeleton()  searched by graph_search()\n");
  CHECK((a >> split(rrt())).json().find(R"("split":{"planner":"rrt")") != std::string::npos);
  CHECK((a >> split(rrt())).hash() != (a >> rrt()).hash());
  CHECK_THROWS_WITH(split(PlannerSpec::make("graph_search", {})), Contains("need no sub-goals"));
  CHECK_THROWS_WITH(split(rrt(), {.depth = 0}), Contains("split: option 'depth'"));
  CHECK_THROWS_WITH(schedule({}), Contains("at least one guide"));
  CHECK_THROWS_WITH(schedule({a, b}, {.rounds = 0}), Contains("schedule: option 'rounds'"));
  CHECK_THROWS_WITH(race({a, b}, {.slice = 0}), Contains("race: option 'slice'"));
  CHECK_THROWS_WITH(blend({a, b}, {.credit = "efficiency", .rule = "exp3"}), Contains("one of the two"));
}

TEST_CASE("every kind prints itself and can be taken apart", "[combinators]") {
  const auto a = guide("skeleton");
  const auto b = shrink(0.5);
  const auto c = guide("lazy");
  const auto strategy = race({schedule({a, b + c}, {.rounds = 2}), sequence({b, a >> c})}, {.slice = 50}) >> rrt();
  CHECK(strategy.text() ==
        "race { schedule { skeleton(), 0.5*shrink(0.5) + 0.5*lazy(), rounds = 2 }, shrink(0.5) .. (skeleton() >> "
        "lazy()), slice = 50 } >> rrt()");
  CHECK(strategy.tree() ==
        "rrt()\n"
        "└─ race, slice 50\n"
        "   ├─ 1. schedule, rounds 2, turn inf\n"
        "   │  ├─ 1. skeleton()  searched by graph_search()\n"
        "   │  └─ 2. mixture\n"
        "   │     ├─ 0.5 x shrink(0.5)  searched by rrt()\n"
        "   │     └─ 0.5 x lazy()  searched by lazy_prm()\n"
        "   └─ 2. sequence, turns of 200 proposals\n"
        "      ├─ 1. shrink(0.5)  searched by rrt()\n"
        "      └─ 2. lazy()  searched by rrt { goal_bias = 0, uniform = 0, bound = 0 }\n"
        "         └─ skeleton()  searched by graph_search()\n");
  CHECK(strategy.json().find(R"("rounds":2,"turn":null)") != std::string::npos);
}

TEST_CASE("each guide of a schedule serves until it is refuted, and none comes back", "[combinators][schedule][slow]") {
  const std::vector<Options::Entry> hasty = {
      {"follow", std::string("tube")}, {"evidence", std::int64_t{20}}, {"resolves", std::int64_t{3}}};
  for (const std::int64_t rounds : {1, 2, 3}) {
    CAPTURE(rounds);
    const auto strategy = schedule({shrink(0.1, hasty), shrink(0.2, hasty), shrink(0.3, hasty)}, {.rounds = rounds}) >>
                          unbounded({{"proposals", std::int64_t{2000}}});
    const auto run = execute(strategy, walled(), 1);
    // The robots are too large for no wall: their spaces have no path, but the last stays.
    CHECK(order(run.levels[0]) == "2");
  }
  const auto problem = test::make_problem("slit", test::rectangle_world({{4, 0, 6, 4.92}, {4, 5.08, 6, 10}}),
                                          test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  for (const std::int64_t rounds : {1, 2, 3}) {
    CAPTURE(rounds);
    const auto strategy =
        schedule({shrink(0.05, hasty), shrink(0.1, hasty), shrink(0.15, hasty)}, {.rounds = rounds}) >>
        unbounded({{"proposals", std::int64_t{3000}}});
    const auto run = execute(strategy, problem, 1);
    CHECK(order(run.levels[0]) == "012");
    // Each refutation causes a solve, except the last one, after which the next guide had its turn. The second solve
    // finds no path beside the slit, which the first refutation excluded, so it is the last one.
    CHECK(run.levels[1].solves == static_cast<std::uint64_t>(std::min<std::int64_t>(rounds, 2)));
    CHECK(run.levels[2].solves == static_cast<std::uint64_t>(std::min<std::int64_t>(rounds, 2)));
  }
}

TEST_CASE("a schedule with turns passes on after so many proposals", "[combinators][schedule]") {
  const auto strategy = schedule({guide("uniform"), guide("gaussian"), guide("goal_bias")}, {.turn = 30}) >>
                        unbounded({{"proposals", std::int64_t{400}}});
  const auto run = execute(strategy, walled(), 1);
  const auto& level = run.levels[0];
  CHECK(order(level) == "012");
  CHECK(std::count(level.search.proposal_sources.begin(), level.search.proposal_sources.end(), 3) == 30);
  CHECK(std::count(level.search.proposal_sources.begin(), level.search.proposal_sources.end(), 4) == 30);
}

TEST_CASE("a guide that finds nothing has no turn in a schedule, and loses a race", "[combinators]") {
  const auto problem = test::cup_problem();
  for (const auto& combined : {schedule({hopeless(), shrink(0.5)}), race({hopeless(), shrink(0.5)}),
                               race({shrink(0.5), hopeless()}, {.slice = 5})}) {
    CAPTURE(combined.text());
    const auto run = execute(combined >> unbounded(), problem, 2);
    CHECK(run.solved);
    const char winner = combined.terms().front().guide == shrink(0.5) ? '0' : '1';
    CHECK(order(run.levels[0]) == std::string(1, winner));
  }
  // Without any path the run continues.
  CHECK(execute(race({hopeless(), hopeless()}) >> rrt(), problem, 2).solved);
  CHECK(execute(schedule({hopeless(), hopeless()}) >> rrt(), problem, 2).solved);
}

TEST_CASE("the searches of a race have slices that double, and rest once one has won", "[combinators][race]") {
  // The passage is too narrow for the second robot; the first robot's search is long.
  const auto problem = test::make_problem("slit", test::rectangle_world({{4, 0, 6, 4.95}, {4, 5.05, 6, 10}}),
                                          test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  const auto run = execute(race({guide("identity"), shrink(0.2, {{"follow", std::string("tube")}})}, {.slice = 16}) >>
                               unbounded({{"proposals", std::int64_t{50}}}),
                           problem, 1);
  const auto& loser = run.levels[1].search.proposals;
  const auto& winner = run.levels[2].search.proposals;
  CHECK(run.levels[2].solution.solved());
  CHECK_FALSE(run.levels[1].solution.solved());
  // The loser had whole slices: 16, 48, 112, ...
  const auto slices = static_cast<double>(loser.size()) / 16.0 + 1.0;
  CHECK(std::exp2(std::round(std::log2(slices))) == Approx(slices));
  CHECK(winner.size() <= loser.size());
  CHECK(2 * winner.size() + 16 >= loser.size());
  CHECK(order(run.levels[0]) == "1");
  // What was cut short was no solve.
  CHECK(run.levels[1].solves == 0);
  CHECK(run.levels[2].solves == 1);
}

TEST_CASE("a race continues when its winner is refuted", "[combinators][race]") {
  const auto problem = test::make_problem("slit", test::rectangle_world({{4, 0, 6, 4.97}, {4, 5.03, 6, 10}}),
                                          test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  const std::vector<Options::Entry> hasty = {
      {"follow", std::string("tube")}, {"evidence", std::int64_t{20}}, {"resolves", std::int64_t{2}}};
  const auto run = execute(
      race({shrink(0.05, hasty), shrink(0.08, hasty)}) >> unbounded({{"proposals", std::int64_t{3000}}}), problem, 3);
  const std::string parts = order(run.levels[0]);
  CHECK(parts.size() >= 2);
  CHECK(parts.find('0') != std::string::npos);
  CHECK(parts.find('1') != std::string::npos);
}

TEST_CASE("a blend by exp3 draws by the documented rule, step by step", "[combinators][blend]") {
  const auto problem = test::cup_problem();
  const BlendSettings settings = {.floor = 0.3, .rule = "exp3"};
  const auto strategy = blend({guide("uniform"), guide("goal_bias", {{"share", 0.9}})}, settings) >>
                        unbounded({{"uniform", 0.0}, {"goal_bias", 0.0}, {"connect_goal", false}});
  const auto first = execute(strategy, problem, 3);
  const auto& search = first.levels[0].search;
  double w[2] = {1.0, 1.0};
  std::size_t step = 0;
  ExecuteOptions options;
  options.watch = [&](const LevelRecord&, const Guidance& h) {
    const auto share = [&](std::size_t i) {
      return 0.5 * settings.floor + (1.0 - settings.floor) * w[i] / (w[0] + w[1]);
    };
    CHECK(test::record_of(h).atoms() == Approx(0.9 * share(1)).epsilon(1e-9));
    const auto part = static_cast<std::size_t>(search.proposal_sources[step] - 3);
    if (search.fates[step] != Fate::rejected) w[part] *= std::exp(settings.floor / (2.0 * share(part)));
    ++step;
  };
  execute(strategy, problem, 3, options);
  CHECK(step == search.proposals.size());
}

TEST_CASE("credit by efficiency moves the weights to the part that is dense where progress is made",
          "[combinators][blend]") {
  // In an empty world the search makes progress with a tube about the path, but not with a wide normal about nothing in
  // particular is not. Counted by nodes the two are alike: in an empty world every proposal leads to one.
  const auto problem =
      test::make_problem("empty", test::rectangle_world({}), test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  const auto share = [&](const std::string& credit) {
    double guided = 0.0;
    double all = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto run = execute(blend({guide("identity", {{"follow", std::string("tube")}}), guide("uniform")},
                                     {.floor = 0.1, .credit = credit}) >>
                                   unbounded({{"step", 0.1}, {"uniform", 0.0}, {"goal_bias", 0.0}}),
                               problem, seed);
      for (const auto source : run.levels[0].search.proposal_sources) {
        guided += source == 3 ? 1.0 : 0.0;
        all += 1.0;
      }
    }
    return guided / all;
  };
  CHECK(share("node") == Approx(0.5).margin(0.1));
  CHECK(share("efficiency") > 0.75);
}

TEST_CASE("a part without a density in closed form is credited with what it drew", "[combinators][blend]") {
  // bridge_test has none.
  const auto problem = walled();
  const auto run = execute(blend({guide("bridge_test"), guide("uniform")}, {.credit = "efficiency"}) >>
                               unbounded({{"proposals", std::int64_t{1500}}}),
                           problem, 1);
  CHECK(order(run.levels[0]).size() > 2);
  CHECK_FALSE(static_cast<bool>(run.levels[0].proposal_density));
}

TEST_CASE("the halves of a split are levels whose paths join", "[combinators][split]") {
  const auto problem = test::trap_problem();
  for (const auto& strategy :
       {guide("skeleton") >> split(rrt(), {.depth = 2}), split(shrink(0.5) >> PlannerSpec::make("rrt_connect", {})),
        StrategySpec(split(PlannerSpec::make("rrt_connect", {}))),
        split(guide("lazy") >> PlannerSpec::make("prm", {}))}) {
    CAPTURE(strategy.text());
    const auto run = execute(strategy, problem, 4);
    REQUIRE(run.solved);
    const auto checker = make_planar_checker(problem.scene, problem.space, problem.resolution);
    CHECK(problem.space.distance(run.path.front(), problem.start) == 0.0);
    CHECK(problem.space.distance(run.path.back(), problem.goal()) <= problem.goal_tolerance);
    for (std::size_t i = 1; i < run.path.size(); ++i) CHECK(checker->motion(run.path[i - 1], run.path[i]).valid);
    std::set<std::string> keys;
    std::size_t proposals = 0;
    for (const auto& level : run.levels) {
      CHECK(keys.insert(level.key).second);
      CHECK((level.level == 0 || level.parent < level.level));
      if (level.parent == 0 && level.name.ends_with(" half")) proposals += level.search.proposals.size();
    }
    CHECK(proposals <= run.levels[0].search.proposals.size());
    // The whole's nodes are those of its halves: each but the starts has a parent that came before it.
    const Search& search = run.levels[0].search;
    REQUIRE(search.near.size() == search.proposals.size());
    REQUIRE(search.parents.size() == search.nodes.size());
    for (std::size_t i = 0; i < search.nodes.size(); ++i) {
      CHECK((search.parents[i] == no_node || search.parents[i] <= i));
    }
    CHECK(run.levels[0].root_nodes().size() == search.nodes.size());
  }
}

TEST_CASE("a split that no sub-goal solves is solved undivided", "[combinators][split]") {
  // Halves that may spend next to nothing.
  const auto run = execute(shrink(0.5) >> split(unbounded(), {.tries = 2, .effort = 3}), test::cup_problem(), 1);
  CHECK(run.solved);
  const auto halves = std::count_if(run.levels.begin(), run.levels.end(),
                                    [](const LevelRecord& level) { return level.name.ends_with(" half"); });
  CHECK(halves == 2);
  // Its budget holds for all of it.
  const auto spent =
      execute(shrink(0.5) >> split(unbounded({{"proposals", std::int64_t{500}}}), {.effort = 100}), walled(), 1);
  CHECK(spent.status == Status::budget_spent);
  CHECK(spent.levels[0].search.proposals.size() == 500);
}

TEST_CASE("a guide that never draws is reported", "[combinators][check]") {
  const auto unreachable = [](const GuideSpec& g) { return unreachable_guides(g >> rrt()); };
  REQUIRE(unreachable(schedule({guide("uniform"), shrink(0.5)})).size() == 1);
  CHECK_THAT(unreachable(schedule({guide("uniform"), shrink(0.5)})).front(),
             Contains("shrink(0.5) never draws") && Contains("uniform()") && Contains("never refuted"));
  CHECK(unreachable(schedule({guide("uniform"), shrink(0.5)}, {.turn = 100})).empty());
  CHECK(unreachable(schedule({shrink(0.5), guide("uniform")})).empty());
  REQUIRE(unreachable(race({guide("uniform"), shrink(0.5)})).size() == 1);
  CHECK_THAT(unreachable(race({guide("uniform"), shrink(0.5)})).front(), Contains("wins every race"));
  CHECK(unreachable(race({shrink(0.5), guide("lazy")})).empty());
}

TEST_CASE("ablation takes a guide out of every kind", "[combinators][ablation]") {
  const auto strategy =
      race({schedule({shrink(0.3), shrink(0.6)}), blend({guide("lazy"), guide("skeleton")})}) >> split(rrt());
  const auto ablated = ablations(strategy);
  REQUIRE(ablated.size() == 4);
  CHECK(ablated[0].strategy.text() == "race { shrink(0.6), blend { lazy(), skeleton() } } >> split { rrt() }");
  CHECK(ablated[3].strategy.text() ==
        "race { schedule { shrink(0.3), shrink(0.6) }, blend { lazy() } } >> split { rrt() }");
}

TEST_CASE("random hierarchies run, the same on any number of threads", "[combinators][property][slow]") {
  constexpr std::size_t count = 60;
  const auto problem = test::cup_problem();
  test::RandomSpecs random(7);
  std::vector<StrategySpec> strategies;
  strategies.reserve(count);
  for (std::size_t i = 0; i < count; ++i) strategies.push_back(random.strategy(static_cast<int>(1 + i % 5)));
  const auto run_all = [&](unsigned threads) {
    std::vector<RunRecord> runs(count);
    in_parallel(count, threads, [&](std::size_t i) { runs[i] = execute(strategies[i], problem, i); });
    return runs;
  };
  const auto one = run_all(1);
  const auto four = run_all(4);
  for (std::size_t i = 0; i < count; ++i) {
    CAPTURE(strategies[i].text());
    REQUIRE(one[i].levels.size() == four[i].levels.size());
    CHECK(same(one[i].path, four[i].path));
    CHECK(one[i].validity_checks == four[i].validity_checks);
    std::uint64_t checks = 0;
    for (std::size_t k = 0; k < one[i].levels.size(); ++k) {
      const auto& level = one[i].levels[k];
      CHECK(same(level.search.proposals, four[i].levels[k].search.proposals));
      CHECK(level.search.fates.size() == level.search.proposals.size());
      CHECK(level.search.density.total() == Approx(static_cast<double>(level.search.proposals.size())));
      for (const auto source : level.search.proposal_sources) REQUIRE(source < level.search.sources.size());
      checks += level.search.checks.validity;
    }
    CHECK(checks == one[i].validity_checks);
    CHECK(ablations(strategies[i]).size() >= 1);
    if (!one[i].solved) continue;
    const auto checker = make_planar_checker(problem.scene, problem.space, problem.resolution);
    for (std::size_t k = 1; k < one[i].path.size(); ++k) {
      CHECK(checker->motion(one[i].path[k - 1], one[i].path[k]).valid);
    }
  }
}

TEST_CASE("a run with any combinator can be stopped at any proposal", "[combinators][executor]") {
  const auto problem = test::cup_problem();
  for (const auto& strategy : {race({guide("lazy"), shrink(0.5)}, {.slice = 8}) >> rrt(),
                               schedule({shrink(0.4), guide("lazy")}) >> rrt(), split(shrink(0.5) >> rrt())}) {
    CAPTURE(strategy.text());
    const auto whole = execute(strategy, problem, 3);
    std::uint64_t drawn = 0;
    std::uint64_t stop = 0;
    ExecuteOptions options;
    options.watch = [&](const LevelRecord&, const Guidance&) { ++drawn; };
    options.interrupted = [&] { return drawn >= stop; };
    for (const std::uint64_t at : {0, 1, 9, 40, 150}) {
      drawn = 0;
      stop = at;
      const auto stopped = execute(strategy, problem, 3, options);
      if (stopped.status != Status::interrupted) {
        CHECK(same(stopped.path, whole.path));
        continue;
      }
      CHECK(drawn == at);
      test::check_part(stopped, whole);
    }
  }
}

TEST_CASE("a split whose start is its goal has the trivial path", "[combinators][split]") {
  for (const bool within : {false, true}) {
    auto problem = test::trap_problem();
    problem.goals = {{9, 4, 0}, problem.start};
    if (within) problem.goals[1][0] += 0.5 * problem.goal_tolerance;
    for (const auto& strategy : {StrategySpec(split(PlannerSpec::make("rrt", {}))),
                                 StrategySpec(split(PlannerSpec::make("rrt", {}), {.depth = 2})),
                                 guide("skeleton") >> split(PlannerSpec::make("prm", {}))}) {
      CAPTURE(strategy.text(), within);
      const auto run = execute(strategy, problem, 1);
      CHECK(run.solved);
      REQUIRE(run.path.size() == 1);
      CHECK(std::ranges::equal(run.path.front(), problem.start));
      CHECK(run.length == 0.0);
      CHECK(run.levels[0].search.proposals.empty());
    }
  }
}
