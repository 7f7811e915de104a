// SPDX-License-Identifier: GPL-3.0-or-later
// For each matcher: a trial that satisfies it, one that does not, and its message.
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/trial/matcher.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using namespace trellis::trial;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

namespace {

PlannerSpec rrt(std::vector<Options::Entry> given = {}) {
  given.emplace_back("step", 0.5);
  return PlannerSpec::make("rrt", given);
}
GuideSpec guide(const std::string& name) { return GuideSpec::make(name, {}); }

Trial trial_of(const std::string& name, StrategySpec strategy, std::uint64_t count = 12,
               const Problem& problem = test::simple_passage_problem()) {
  Measure measure;
  std::get<TubeSettings>(measure.target).points = 256;
  std::get<TubeSettings>(measure.target).pool = 2048;
  return Trial({.name = name,
                .strategy = std::move(strategy),
                .problem = problem,
                .seeds = seeds(count),
                .measure = std::make_shared<const Measure>(measure)});
}

// Shared by all tests, as trials keep their runs.
const Trial& plain() {
  static const Trial trial = trial_of("plain", rrt());
  return trial;
}
const Trial& guided() {
  static const Trial trial = trial_of("guided", guide("skeleton") >> rrt());
  return trial;
}
/// Its budget ends the search almost at once.
const Trial& hopeless() {
  static const Trial trial = trial_of("hopeless", rrt({{"proposals", 10.0}}));
  return trial;
}

struct Said {
  bool holds = false;
  std::string text;
  std::string help;
};

Said judge(const Trial& trial, const MatcherPointer& matcher) {
  const Verdict verdict = matcher->judge(trial);
  return {verdict.holds, sentence(trial, *matcher, verdict), evidence(trial, *matcher, verdict)};
}

/// A robot in a closed room.
Problem prison() {
  return test::make_problem("prison", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(), {1, 1, 0},
                            {9, 9, 0});
}

}  // namespace

TEST_CASE("a trial runs once for all callers, with the same result on any number of threads") {
  const Trial copy = plain();
  CHECK(&copy.runs() == &plain().runs());
  CHECK(plain().text() == "plain on simple_passage, 12 seeds (1–12)");
  REQUIRE(plain().runs().size() == 12);
  for (std::size_t i = 0; i < 12; ++i) CHECK(plain().runs()[i].seed == i + 1);
  const auto again = plain().runs_again(3);
  for (std::size_t i = 0; i < 12; ++i) CHECK(difference_text(plain().runs()[i], again[i]).empty());
}

TEST_CASE("scoring a trial changes nothing of its runs") {
  const Trial fresh = trial_of("plain", rrt(), 2);
  const auto before = fresh.runs();
  const auto& after = fresh.scored_runs();
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(difference_text(before[i], after[i]).empty());
    CHECK_FALSE(before[i].levels.front().own);
    CHECK(after[i].levels.front().own);
  }
}

TEST_CASE("a trial is refused without seeds, and with one twice") {
  const Setup setup{.name = "plain", .strategy = rrt(), .problem = test::cup_problem(), .seeds = {}};
  CHECK_THROWS_WITH(Trial(setup), "a trial of plain: no seed given");
  Setup twice = setup;
  twice.seeds = {3, 1, 3};
  CHECK_THROWS_WITH(Trial(twice), "a trial of plain: a seed is given twice");
}

TEST_CASE("solves: a share of the seeds") {
  CHECK(judge(plain(), solves(at_least(1.0))).text == "plain solves at least 100 % of the seeds: 12 of 12 (100 %)");
  CHECK(judge(plain(), solves(at_least(1.0))).holds);
  CHECK(judge(hopeless(), solves(exactly(0.0))).holds);
  CHECK(judge(hopeless(), solves(below(0.5))).holds);

  const Said said = judge(hopeless(), solves(at_least(0.5)));
  CHECK_FALSE(said.holds);
  CHECK(said.text == "hopeless solves at least 50 % of the seeds: 0 of 12 (0 %)");
  CHECK_THAT(said.help, StartsWith("seed 1: found no path (budget spent)\n"));
  CHECK_THAT(said.help, Contains("0 root"));
  CHECK_THAT(said.help, Contains("replay: in trellis repl, with the problem 'simple_passage' as p: plan(rrt { "));

  const Said too_good = judge(plain(), solves(at_most(0.5)));
  CHECK_FALSE(too_good.holds);
  CHECK_THAT(too_good.help, StartsWith("seed 1: found a path\n"));
}

TEST_CASE("solves: with a confidence it speaks of all seeds, and 12 are few") {
  // Wilson's interval of 12 of 12 begins at 12 / (12 + 1.645^2).
  const Said said = judge(plain(), solves(at_least(0.9).with_confidence(0.95)));
  CHECK_FALSE(said.holds);
  CHECK_THAT(said.text, Contains("12 of 12 (100 %), at least 81.6 % with 95 % confidence"));
  CHECK(judge(plain(), solves(at_least(0.8).with_confidence(0.95))).holds);
}

TEST_CASE("spends: fewer than another, seed by seed, with a confidence") {
  const Said said = judge(guided(), spends(below(plain()).validity_checks()));
  INFO(said.text);
  CHECK(said.holds);
  CHECK_THAT(said.text, StartsWith("guided spends fewer validity checks than plain: 0."));
  CHECK_THAT(said.text, Contains("with 95 % confidence; less on "));

  const Said reversed = judge(plain(), spends(below(guided()).validity_checks()));
  CHECK_FALSE(reversed.holds);
  CHECK_THAT(reversed.help, Contains("; guided spent "));
  CHECK_THAT(reversed.help, StartsWith("seed "));
  // No strategy spends less than itself, however often it is tested.
  CHECK_FALSE(judge(plain(), spends(below(plain()).validity_checks())).holds);
  CHECK_FALSE(judge(guided(), spends(below(plain()).validity_checks().by(0.99))).holds);
}

TEST_CASE("spends: a run without a path has spent its budget for nothing") {
  // It spent far fewer checks than the others, and found no path.
  const Said said = judge(hopeless(), spends(below(plain()).validity_checks()));
  CHECK_FALSE(said.holds);
  CHECK_THAT(said.text, Contains("12 without a path"));
  CHECK_THAT(said.help, Contains("found no path (budget spent); spent "));
  CHECK_FALSE(judge(hopeless(), spends(at_most(1e9).validity_checks())).holds);
  CHECK(judge(hopeless(), spends(exactly(10).proposals())).holds);
  // The cost of `hopeless` is a lower bound of its cost to a path, so guided may cost more than that.
  CHECK_FALSE(judge(guided(), spends(below(hopeless()).validity_checks())).holds);
}

TEST_CASE("spends: more than another, which is what misleads") {
  const Said said = judge(plain(), spends(above(guided()).validity_checks()));
  INFO(said.text);
  CHECK(said.holds);
  CHECK_THAT(said.text, StartsWith("plain spends more validity checks than guided: "));
  CHECK_THAT(said.text, Contains(" times as many at the median, at least ") && Contains("; more on "));
  CHECK(judge(plain(), spends(above(guided()).validity_checks().by(1.0))).holds);

  const Said reversed = judge(guided(), spends(above(plain()).validity_checks().by(0.2)));
  CHECK_FALSE(reversed.holds);
  CHECK_THAT(reversed.text, StartsWith("guided spends 20 % more validity checks than plain: 0."));
  CHECK_THAT(reversed.help, StartsWith("seed ") && Contains("; plain spent "));
  CHECK_FALSE(judge(plain(), spends(above(plain()).validity_checks())).holds);
  CHECK_FALSE(judge(plain(), spends(above(guided()).validity_checks().by(1e6))).holds);
}

TEST_CASE("spends: more than a run without a path cannot be shown") {
  // The cost of `hopeless` to a path is unknown; its actual cost is at most its budget.
  CHECK_FALSE(judge(plain(), spends(above(hopeless()).validity_checks())).holds);
  CHECK_FALSE(judge(hopeless(), spends(above(plain()).validity_checks())).holds);
  const Trial beaten = trial_of("beaten", rrt({{"proposals", 5.0}}));
  CHECK_FALSE(judge(hopeless(), spends(above(beaten).proposals())).holds);
  const Said few =
      judge(trial_of("plain", rrt(), 4), spends(above(trial_of("guided", guide("skeleton") >> rrt(), 4)).nodes()));
  CHECK_FALSE(few.holds);
  CHECK_THAT(few.text, Contains("at least -∞ times") && Contains("; 4 seeds show nothing"));
}

TEST_CASE("spends: too few seeds show nothing, and it says how many would") {
  const Trial few = trial_of("guided", guide("skeleton") >> rrt(), 4);
  const Trial others = trial_of("plain", rrt(), 4);
  const Said said = judge(few, spends(below(others).validity_checks()));
  CHECK_FALSE(said.holds);
  CHECK_THAT(said.text, Contains("; 4 seeds show nothing with 95 % confidence, however they come out: that takes 5"));
}

TEST_CASE("spends: budgets, of all levels and of one") {
  const Trial nested = trial_of("nested", guide("skeleton") >> guide("lazy") >> rrt(), 6);
  // Where nothing guides the search that presumes validity, nothing is validated there.
  const Trial presuming = trial_of("presuming", guide("lazy") >> rrt(), 6);
  CHECK(judge(presuming, spends(exactly(0).validity_checks().in_level("lazy"))).holds);
  const Said said = judge(nested, spends(exactly(0).validity_checks().in_level("root")));
  CHECK_FALSE(said.holds);
  CHECK_THAT(said.text, StartsWith("nested spends exactly 0 validity checks in level root: from "));
  CHECK(judge(nested, spends(at_most(1e9).motion_checks())).holds);
  CHECK(judge(nested, spends(at_least(1).nodes().in_level("skeleton >> lazy"))).holds);
  const Said little = judge(nested, spends(at_most(3).nodes()));
  CHECK_FALSE(little.holds);
  CHECK_THAT(little.text, Contains("nodes at the median of 6 runs, at most "));
}

TEST_CASE("levels are found by their numbers, names and paths, and errors are reported") {
  const Trial nested = trial_of("nested", guide("shrink") >> guide("lazy") >> rrt(), 1);
  const auto& runs = nested.runs();
  CHECK(find_level(runs, "root") == "0");
  CHECK(find_level(runs, "0") == "0");
  CHECK(find_level(runs, "lazy") == find_level(runs, "1"));
  CHECK(find_level(runs, "lazy()") == find_level(runs, "1"));
  CHECK(find_level(runs, "shrink >> lazy >> rrt") == find_level(runs, "2"));
  CHECK_THROWS_WITH(find_level(runs, "lasy"), Contains("no level is called 'lasy' (did you mean 'lazy'?)") &&
                                                  Contains("the levels are: 0 (root), 1 (lazy()), 2 (shrink("));
  CHECK_THROWS_WITH(find_level(runs, "7"), StartsWith("there is no level 7; the levels are: 0 (root)"));
  const Trial mixed = trial_of("mixed", ((guide("skeleton") >> guide("lazy")) + guide("lazy")) >> rrt(), 1);
  CHECK_THROWS_WITH(find_level(mixed.runs(), "lazy"), Contains("are all called 'lazy'; give one by its number"));
  CHECK_NOTHROW(find_level(mixed.runs(), "skeleton >> lazy"));
}

TEST_CASE("finds_paths: valid, and no longer than asked for") {
  CHECK(judge(plain(), finds_paths()).text == "plain finds valid paths: 12 paths found, all valid");
  CHECK(judge(plain(), finds_paths(at_most(100))).holds);
  const Said said = judge(plain(), finds_paths(below(5)));
  CHECK_FALSE(said.holds);
  CHECK_THAT(said.text, StartsWith("plain finds valid paths, below 5 m long: "));
  CHECK_FALSE(judge(hopeless(), finds_paths()).holds);
  CHECK_FALSE(judge(plain(), finds_paths(below(plain()))).holds);
  CHECK_THAT(judge(plain(), finds_paths(above(guided()))).text,
             StartsWith("plain finds valid paths longer than those of guided: "));
}

TEST_CASE("has_efficiency: what the samples of all seeds together support") {
  const Said said = judge(plain(), has_efficiency("root", above(-100)));
  CHECK(said.holds);
  CHECK_THAT(said.text, StartsWith("plain has at the root an efficiency above -100 nats: the samples of all 12 seeds "
                                   "together are -") &&
                            EndsWith(" nats above uniform"));
  const Said low = judge(plain(), has_efficiency("root", above(20)));
  CHECK_FALSE(low.holds);
  CHECK_THAT(low.help, Contains("as estimated from its own samples") && Contains("own space, own path"));

  // Nearly all of its samples lie in the target. That they do not fill it shows only in all of them together.
  const Said thin = judge(guided(), has_efficiency("root", above(0.4)));
  CHECK_FALSE(thin.holds);
  CHECK_THAT(thin.text,
             Contains("; they lie in the target, +") && Contains(" but do not fill it ({ part = \"mass\" })"));
  CHECK_THAT(judge(guided(), has_efficiency("root", above(plain()))).text,
             Contains(" nats above uniform, those of plain -"));
  CHECK_FALSE(judge(guided(), has_efficiency("root", above(plain()))).holds);
  CHECK_FALSE(judge(plain(), has_efficiency("root", above(plain()))).holds);
  CHECK_THROWS_WITH(has_efficiency("root", above(0).with_confidence(0.99)),
                    StartsWith("has_efficiency: what samples support is known with 95 % confidence, not 99 %"));

  const Said none = judge(hopeless(), has_efficiency("root", above(-100)));
  CHECK_FALSE(none.holds);
  CHECK_THAT(none.text, Contains("no run was scored: "));
}

TEST_CASE("has_efficiency: samples of known density are judged by it") {
  const Level proposals = Level("root").expansion();
  // The proposals of plain RRT: uniform but for the goal.
  CHECK(judge(plain(), has_efficiency(proposals, above(-0.1))).holds);
  CHECK_FALSE(judge(plain(), has_efficiency(proposals, above(0.1))).holds);
  CHECK_FALSE(judge(guided(), has_efficiency(proposals, above(plain()))).holds);
  const Said worse = judge(plain(), has_efficiency(proposals, above(guided()).by(1)));
  INFO(worse.text);
  CHECK(worse.holds);
}

TEST_CASE("has_efficiency: levels in their own space, and few seeds, are judged run by run") {
  const Level lifted = Level("skeleton").lifted();
  CHECK_THAT(judge(guided(), has_efficiency(lifted, above(-100))).text,
             Contains("has at level skeleton (lifted) an efficiency") && Contains("of all 12 seeds together"));
  const Said own = judge(guided(), has_efficiency("skeleton", above(-100)));
  CHECK(own.holds);
  CHECK_THAT(own.text, Contains(" nats above uniform, as far as its samples show, on average of 12 runs, at least -"));
  const Trial few = trial_of("few", rrt(), 3);
  CHECK_THAT(judge(few, has_efficiency("root", above(-100))).text, Contains("on average of 3 runs"));
}

TEST_CASE("has_efficiency: mass is counted, with the lower end of the interval of its mean") {
  const Level mass = Level("root").mass();
  const Said said = judge(guided(), has_efficiency(mass, above(0.5)));
  CHECK(said.holds);
  CHECK_THAT(said.text, StartsWith("guided has at the root a mass above 0.5 nats: +"));
  CHECK_THAT(said.text, Contains(" nats of mass above uniform on average of 12 runs, at least "));
  CHECK_FALSE(judge(guided(), has_efficiency(mass, above(20))).holds);
  CHECK_THAT(judge(guided(), has_efficiency(mass, above(0.5).with_confidence(0.99))).text,
             Contains("with 99 % confidence"));

  const Said better = judge(guided(), has_efficiency(mass, above(plain())));
  CHECK(better.holds);
  CHECK_THAT(better.text, StartsWith("guided has at the root a mass above that of plain: a difference of +") &&
                              Contains(", at least +"));
  CHECK_FALSE(judge(plain(), has_efficiency(mass, above(guided()))).holds);
  CHECK_FALSE(judge(guided(), has_efficiency(mass, above(plain()).by(50))).holds);
  CHECK_FALSE(judge(plain(), has_efficiency(mass, above(plain()))).holds);
}

TEST_CASE("is_deterministic: counts make a budget that reproduces, seconds do not") {
  CHECK(judge(guided(), is_deterministic()).holds);
  const Trial timed = trial_of("timed", rrt({{"seconds", 0.02}, {"proposals", 1e9}}), 4, prison());
  const Said said = judge(timed, is_deterministic());
  CHECK_FALSE(said.holds);
  CHECK_THAT(said.text, Contains("timed is deterministic: made again on "));
}

TEST_CASE("trials that cannot be compared are an error") {
  const Trial shorter = trial_of("plain", rrt(), 5);
  CHECK_THROWS_WITH(judge(guided(), spends(below(shorter).nodes())), Contains("their seeds differ"));
  const Trial elsewhere = trial_of("plain", rrt(), 12, test::cup_problem());
  CHECK_THROWS_WITH(judge(guided(), spends(below(elsewhere).nodes())), Contains("they are on different problems"));
}

TEST_CASE("criteria that mean nothing for a matcher are refused") {
  CHECK_THROWS_WITH(solves(at_least(95)), "solves: a share is in [0, 1], got 95");
  CHECK_THROWS_WITH(solves(at_least(0.5).nodes()), "solves: takes a share of the seeds, as solves(at_least(0.95))");
  CHECK_THROWS_WITH(spends(at_most(5)), StartsWith("spends: of what? Write one of .validity_checks()"));
  CHECK_THROWS_WITH(spends(below(plain()).nodes().by(1.5)), StartsWith("spends: by(x) is a share"));
  CHECK_NOTHROW(spends(above(plain()).nodes().by(1.5)));
  CHECK_THROWS_WITH(at_most(5).by(0.1), "by: 'at most 5' compares with no other trial");
  CHECK_THROWS_WITH(at_most(5).with_confidence(95), StartsWith("with_confidence: a confidence is a number"));
  CHECK_THROWS_WITH(has_efficiency("root", exactly(2)), StartsWith("has_efficiency: an estimate is nothing exactly"));
  CHECK_THROWS_WITH(has_efficiency("root", above(2).nodes()), StartsWith("has_efficiency: takes nats"));
  for (const Criterion& least : {below(2), at_most(2), below(plain())}) {
    CHECK_THROWS_WITH(has_efficiency("root", least), Contains("nats above uniform, of which more is better"));
  }
  CHECK_THROWS_WITH(finds_paths(exactly(2)), StartsWith("finds_paths: no two paths"));
}

TEST_CASE("a run is seen again by a command where its script is known") {
  Setup setup{.name = "it's", .strategy = rrt(), .problem = test::cup_problem(), .script = "my script.lua"};
  CHECK(Trial(setup).replay(17) == R"(trellis run 'my script.lua' --strategy 'it'\''s' --problem cup --only 17)");
}

TEST_CASE("what differs between two runs is named") {
  const RunResult& run = guided().runs().front();
  const auto changed = [&](const auto& change) {
    RunResult other = run;
    change(other);
    return difference_text(run, other);
  };
  CHECK(changed([](RunResult& r) { r.run.seconds += 1.0; }).empty());
  CHECK_THAT(changed([](RunResult& r) { ++r.run.motion_checks; }), StartsWith("motion checks: "));
  CHECK(changed([](RunResult& r) { r.run.path[0][0] += 1e-12; }) == "the paths differ");
  CHECK(changed([](RunResult& r) { r.levels[1].record.search.nodes[3][1] += 1e-12; }) ==
        "the nodes of level 1 (skeleton()) differ");
  CHECK(changed([](RunResult& r) { r.levels[0].record.search.added[5] += 1; }) ==
        "what became of the proposals of level 0 (root) differs");
}
