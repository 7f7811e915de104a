// SPDX-License-Identifier: GPL-3.0-or-later
// `trellis test`: its output, its exit status, and its reports for other programs.
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill is POSIX's

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/process.hpp"

using boost::property_tree::ptree;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;
using trellis::test::content;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

/// Two strategies of which one hardly begins.
constexpr const char* pair_script = R"(
return experiment {
  problems = { scenes.cup(), scenes.simple_passage() },
  strategies = { plain = rrt { step = 0.5 }, hopeless = rrt { step = 0.5, proposals = 20 } },
  measure = tube { points = 256, pool = 2048 },
}
)";

std::string scenario(const std::string& name, const std::string& body) {
  return "scenario \"" + name + "\" (function()\n" + body + "\nend)\n";
}

std::string two_trials(const std::string& seeds = "6") {
  return "local it = given { script = \"pair.lua\", problem = \"cup\" }\n"
         "local plain, hopeless = when { it.plain, it.hopeless, seeds = " +
         seeds + " }\n";
}

/// Removes times, which differ between runs, from the last column of the tables, and the effects of its width on the
/// others.
std::string without_times(const std::string& text) {
  const std::string rows = std::regex_replace(text, std::regex(" {2,}[0-9]+(\\.[0-9]+)?(?=\n)"), " T");
  const std::string head = std::regex_replace(rows, std::regex(" +(time|ms)(?=\n)"), " $1");
  return std::regex_replace(head, std::regex("(─)+"), "─");
}

ptree parsed(const std::string& path) {
  std::ifstream file(path);
  ptree tree;
  boost::property_tree::read_xml(file, tree);
  return tree;
}

}  // namespace

TEST_CASE("a scenario that holds says so, in figures") {
  const Place place;
  place.script("pair.lua", pair_script);
  place.script("it_test.lua", scenario("the plain one gets there", two_trials() + R"(
    expect(plain, solves(at_least(1)))
    expect(plain, has_efficiency("root", above(-50)))
    expect(plain, finds_paths(at_most(100)))
    expect(plain, is_deterministic())
    expect(hopeless, spends(exactly(20).proposals())))"));
  const auto outcome = place.run({"test", "it_test.lua"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  CHECK_THAT(
      outcome.out,
      StartsWith(
          "\nscenario: the plain one gets there\n"
          "  given the problem 'cup' of pair.lua\n"
          "  when  plain, hopeless on 6 seeds (1–6)\n"
          "  ok    plain solves at least 100 % of the seeds: 6 of 6 (100 %)\n"
          "  ok    plain has at the root an efficiency above -50 nats: the samples of all 6 seeds together are "));
  CHECK_THAT(outcome.out, EndsWith("\npassed: 1 scenario, 5 expectations\n"));
}

TEST_CASE("each matcher can fail, and prints its evidence") {
  const Place place;
  place.script("pair.lua", pair_script);
  place.script("it_test.lua", scenario("nothing of this holds", two_trials() + R"(
    expect(hopeless, solves(at_least(0.95)))
    expect(plain, spends(below(hopeless).validity_checks()))
    expect(plain, spends(at_most(10).nodes().with_confidence(0.9)))
    expect(plain, finds_paths(below(1)))
    expect(plain, has_efficiency("root", above(20)))
    expect(plain, has_efficiency("root", above(50), { role = "expansion", target = "root" }))
  )") + scenario("time is no budget that reproduces", R"(
    local walls = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }
    local it = given {
      problem = problem { name = "walls", world = walls, robot = robot.point(), start = {1, 1}, goal = {9, 9} },
      strategies = { timed = rrt { seconds = 0.02, proposals = 1000000 } },
    }
    expect(when { it.timed, seeds = 3 }, is_deterministic())
  )"));
  const auto outcome = place.run({"test", "it_test.lua"});
  CHECK(outcome.status == 1);
  CHECK_THAT(outcome.out, EndsWith("\nFAILED: 2 scenarios (2 failed), 7 expectations (7 failed)\n"));
  const auto timed = outcome.out.find("\nscenario: time is no budget");
  REQUIRE(timed != std::string::npos);
  CHECK_THAT(outcome.out.substr(timed), Contains("  FAIL  timed is deterministic: made again on "));
  trellis::test::check_golden("scenario_failures.txt", without_times(outcome.out.substr(0, timed)));
}

TEST_CASE("what a failure says to run shows the run that failed") {
  const Place place;
  // The world is random: the seed of the runs must not change it.
  place.script("pair.lua", R"(
    local side = 4 + 2 * math.random()
    local house = world { bounds = {0, 0, 10, 10}, box {side, 0, side + 1, 8} }
    return experiment {
      problems = problem { name = "house", world = house, robot = robot.point(), start = {1, 1}, goal = {9, 1} },
      strategies = { ["plain one"] = rrt { step = 0.5 } },
    })");
  place.script("it_test.lua", scenario("it takes no checks", R"(
    local it = given { script = "pair.lua" }
    expect(when { it["plain one"], seeds = {5, 6, 7} }, spends(exactly(1).validity_checks())))"));
  const auto outcome = place.run({"test", "it_test.lua"});
  CHECK(outcome.status == 1);
  const std::regex shape("seed ([0-9]+): spent ([0-9]+) validity checks\n[^]*replay: trellis (run [^\n]*)\n");
  std::smatch found;
  REQUIRE(std::regex_search(outcome.out, found, shape));
  CHECK(found[3] == "run pair.lua --strategy 'plain one' --problem house --only " + found[1].str());
  const auto again =
      place.run({"run", "pair.lua", "--strategy", "plain one", "--problem", "house", "--only", found[1]});
  CHECK(again.status == 0);
  // The report separates thousands.
  std::string checks = found[2].str();
  if (checks.size() > 3) checks.insert(checks.size() - 3, ",");
  CHECK_THAT(again.out, Contains(" " + checks + " "));
}

TEST_CASE("run: one strategy, problem and seed can be chosen by name") {
  const Place place;
  place.script("pair.lua", pair_script);
  const auto one = place.run({"run", "pair.lua", "--strategy", "plain", "--problem", "cup", "--only", "3"});
  CHECK(one.status == 0);
  CHECK_THAT(one.out, StartsWith("cup, seed 3: "));
  CHECK(place.run({"run", "pair.lua", "--strategy", "plane"}).err ==
        "trellis: --strategy: the script has none that is called 'plane' (did you mean 'plain'?); it has: plain, "
        "hopeless\n");
  CHECK(place.run({"run", "pair.lua", "--problem", "cub"}).err ==
        "trellis: --problem: the script has none that is called 'cub' (did you mean 'cup'?); it has: cup, "
        "simple_passage\n");
  CHECK(place.run({"run", "pair.lua", "--only", "3", "--seeds", "3"}).err ==
        "trellis: --only: it is one seed; leave out --seed and --seeds\n");
}

TEST_CASE("an error in a scenario fails that one, and the next ones still run") {
  const Place place;
  place.script("pair.lua", pair_script);
  place.script(
      "it_test.lua",
      scenario("a misspelt strategy",
               "local it = given { script = \"pair.lua\", problem = \"cup\" }\n"
               "when { it.plane }") +
          scenario("a level that there is not", two_trials("5") + "expect(plain, has_efficiency(\"lazy\", above(1)))") +
          scenario("a fault of its own", "local x = nil + 1") + scenario("nothing expected", two_trials()) +
          scenario("all is well", two_trials() + "expect(plain, solves(at_least(1)))"));
  const auto outcome = place.run({"test", "it_test.lua"});
  CHECK(outcome.status == 1);
  CHECK_THAT(outcome.out, Contains("  ERROR it_test.lua:3: what is given has no strategy 'plane' (did you mean "
                                   "'plain'?); it has: plain, hopeless\n"));
  CHECK_THAT(outcome.out, Contains("  ERROR it_test.lua:8: no level is called 'lazy'; the levels are: 0 (root)\n"));
  CHECK_THAT(outcome.out, Contains("  ERROR it_test.lua:11: attempt to perform arithmetic on a nil value\n"));
  CHECK_THAT(outcome.out, Contains(": the scenario expects nothing; write expect(trial, matcher)\n"));
  CHECK_THAT(outcome.out, Contains("  ok    plain solves at least 100 % of the seeds: 6 of 6 (100 %)\n"));
  CHECK_THAT(outcome.out, EndsWith("\nFAILED: 5 scenarios (4 failed), 2 expectations\n"));
}

TEST_CASE("an error in a script is reported on stderr, and the other files run") {
  const Place place;
  place.script("pair.lua", pair_script);
  place.script("good_test.lua", scenario("all is well", two_trials("2") + "expect(plain, solves(at_least(1)))"));
  const auto says = [&](const std::string& text) {
    place.script("bad_test.lua", text);
    const auto outcome = place.run({"test", "bad_test.lua", "good_test.lua"});
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.out, EndsWith("\nFAILED: 1 scenario, 1 expectation\n"));
    return outcome.err;
  };
  CHECK(says("local x = 1") ==
        "trellis: bad_test.lua: the script has no scenario; write scenario \"...\" (function() ... end)\n");
  CHECK(says("scenario \"alone\"") ==
        "trellis: bad_test.lua:1: scenario 'alone' has no function; write scenario \"alone\" (function() ... end)\n");
  CHECK(says("given { script = \"pair.lua\" }") ==
        "trellis: bad_test.lua:1: given: it belongs inside a scenario: scenario \"...\" (function() ... end)\n");
  CHECK(says("scenario 3 (function() end)").starts_with("trellis: bad_test.lua:1: "));
  CHECK(says("scenario \"a\" (function() end)\nscenario \"a\" (function() end)") ==
        "trellis: bad_test.lua:2: scenario: two are called 'a'\n");
  CHECK(says("scenario \"a\" (7)") ==
        "trellis: bad_test.lua:1: scenario 'a': a function belongs behind the name, got 7\n");
  CHECK(place.run({"test", "none.lua"}).err == "trellis: cannot read 'none.lua': No such file or directory\n");
}

TEST_CASE("what scenarios are given is checked", "[slow]") {
  const Place place;
  place.script("pair.lua", pair_script);
  const auto says = [&](const std::string& body) {
    place.script("it_test.lua", scenario("it", body));
    const auto outcome = place.run({"test", "it_test.lua"});
    CHECK(outcome.status == 1);
    const auto begin = outcome.out.find("  ERROR it_test.lua:2: ");
    REQUIRE(begin != std::string::npos);
    const std::string message = outcome.out.substr(begin + 23);
    return message.substr(0, message.find('\n'));
  };
  CHECK(says("given { script = \"pair.lua\" }") ==
        "given: 'pair.lua' has several problems; say which: problem = one of 'cup', 'simple_passage'");
  CHECK(says("given { script = \"pair.lua\", problem = \"cap\" }") ==
        "given: 'pair.lua' has no problem 'cap' (did you mean 'cup'?); it has 'cup', 'simple_passage'");
  CHECK(
      says("given { script = \"../pair.lua\" }") ==
      "given: the script '../pair.lua' does not lie in the test's folder; --trust lets a test that you trust read it");
  CHECK(says("given { script = \"pair.lua\", measure = tube {} }") ==
        "given: field 'measure' is the script's own affair; leave it out, or leave out 'script'");
  CHECK(says("given {}") ==
        "given: what is tried is missing: script = \"...\", or problem = p, strategies = { name = strategy }");
  CHECK(says("given { problem = scenes.cup() }") ==
        "given: field 'strategies' is missing: a table { name = strategy }");
  CHECK(says("given { problem = scenes.cup(), strategies = { a = skeleton() } }")
            .starts_with("given: strategy 'a' has no planner at its root"));
  CHECK(says("when { rrt {} }").starts_with("when: element 1 must be a strategy of what was given, as "));
  CHECK(says("when {}").starts_with("when: nothing is tried; name strategies"));
  CHECK(says("expect(1, solves(at_least(1)))") == "expect: a trial comes first, as `when` makes it, got 1");
  CHECK(says("solves(0.95)") == "solves: a criterion belongs here, as solves(at_least(0.95)), got 0.95");
  CHECK(says("spends(at_most(5))").starts_with("spends: of what? Write one of .validity_checks()"));
  CHECK(says("spends(at_most(5).validity_check())").find("(did you mean 'validity_checks'?)") != std::string::npos);
  CHECK(says("below(rrt {})") == "below: takes a number, or a trial, as `when` makes it, got the planner 'rrt()'");
  CHECK(says("at_least \"much\"") == "at_least: takes a number, got \"much\"");
  CHECK(says("has_efficiency(above(2))").starts_with("has_efficiency: a level belongs first"));
  CHECK(says("has_efficiency(\"root\", above(2), { role = \"three\" })").find("tree") != std::string::npos);
  CHECK(says("local it = given { problem = scenes.cup(), strategies = { a = rrt {} } } "
             "while true do when { it.a, it.a, seeds = 300000 } end") ==
        "when: a scenario has at most 10000 trials with 1000000 runs in all, got 4 with 1200000");
  CHECK(says("while true do end").find("is there an infinite loop?") != std::string::npos);
}

TEST_CASE("scenarios belong to trellis test, and the other verbs say so") {
  const Place place;
  place.script("it_test.lua", scenario("it", ""));
  for (const char* verb : {"run", "check"}) {
    const auto outcome = place.run({verb, "it_test.lua"});
    CHECK(outcome.status == 2);
    CHECK(outcome.err ==
          "trellis: it_test.lua:1: scenario: scenarios are run by `trellis test FILE`, and by nothing else\n");
  }
}

TEST_CASE("test: seeds and names of scenarios can be chosen") {
  const Place place;
  place.script("pair.lua", pair_script);
  place.script("it_test.lua", scenario("one", two_trials() + "expect(plain, solves(at_least(1)))") +
                                  scenario("two", two_trials() + "expect(hopeless, solves(at_least(1)))"));
  const auto outcome = place.run({"test", "it_test.lua", "--filter", "one", "--seeds", "3", "--jobs", "1"});
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.out, Contains("on 3 seeds (1–3)"));
  CHECK_THAT(outcome.out, EndsWith("\npassed: 1 scenario, 1 expectation\n"));
  const auto none = place.run({"test", "it_test.lua", "--filter", "three"});
  CHECK(none.status == 2);
  CHECK(none.err == "trellis: test: no scenario's name contains 'three'\n");
  CHECK(place.run({"test", "it_test.lua", "--seeds", "0"}).status == 2);
}

TEST_CASE("the same test prints the same on any number of threads") {
  const Place place;
  place.script("pair.lua", pair_script);
  place.script("it_test.lua",
               scenario("it", two_trials() + "expect(plain, has_efficiency(\"root\", above(-50)))\n"
                                             "expect(plain, spends(at_most(100000).validity_checks()))"));
  const auto one = place.run({"test", "it_test.lua", "--jobs", "1"});
  const auto several = place.run({"test", "it_test.lua", "--jobs", "5"});
  CHECK(one.status == 0);
  CHECK(one.out == several.out);
}

TEST_CASE("JUnit's XML has a suite for each file and a case for each scenario") {
  const Place place;
  place.script("pair.lua", pair_script);
  place.script("a_test.lua",
               scenario("fine", two_trials("2") + "expect(plain, solves(at_least(1)))") +
                   scenario("a < b & \\\"c\\\" \\1 \\xff", two_trials("2") + "expect(hopeless, solves(at_least(1)))") +
                   scenario("wrong", "error \"]]> <oops>\""));
  place.script("b_test.lua", "nonsense(");
  const auto outcome = place.run({"test", "a_test.lua", "b_test.lua", "--junit", "out.xml"});
  CHECK(outcome.status == 2);
  const ptree tree = parsed(place / "out.xml");
  const ptree& all = tree.get_child("testsuites");
  CHECK(all.get<int>("<xmlattr>.tests") == 4);
  CHECK(all.get<int>("<xmlattr>.failures") == 1);
  CHECK(all.get<int>("<xmlattr>.errors") == 2);
  std::vector<ptree> suites;
  for (const auto& [tag, suite] : all) {
    if (tag == "testsuite") suites.push_back(suite);
  }
  REQUIRE(suites.size() == 2);
  CHECK(suites[0].get<std::string>("<xmlattr>.name") == "a_test.lua");
  CHECK(suites[0].get<int>("<xmlattr>.tests") == 3);
  std::vector<ptree> cases;
  for (const auto& [tag, one] : suites[0]) {
    if (tag == "testcase") cases.push_back(one);
  }
  REQUIRE(cases.size() == 3);
  CHECK(cases[0].get<std::string>("<xmlattr>.name") == "fine");
  CHECK(cases[0].count("failure") == 0);
  CHECK(cases[1].get<std::string>("<xmlattr>.name") == "a < b & \"c\" \xEF\xBF\xBD \xEF\xBF\xBD");
  CHECK(cases[1].get<std::string>("failure.<xmlattr>.message") ==
        "hopeless solves at least 100 % of the seeds: 0 of 2 (0 %)");
  CHECK_THAT(cases[1].get<std::string>("failure"), Contains("replay: trellis run pair.lua --strategy hopeless"));
  CHECK_THAT(cases[2].get<std::string>("error.<xmlattr>.message"), Contains("]]> <oops>"));
  CHECK(suites[1].get<int>("<xmlattr>.errors") == 1);

  CHECK(place.run({"test", "a_test.lua", "--junit", "no/out.xml"}).err ==
        "trellis: cannot write 'no/out.xml': there is no folder 'no'\n");
}

TEST_CASE("Ctrl-C ends a test") {
  const Place place;
  place.script("it_test.lua", scenario("endless", R"(
    local walls = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }
    local it = given {
      problem = problem { world = walls, robot = robot.point(), start = {1, 1}, goal = {9, 9} },
      strategies = { slow = rrt { step = 0.001, proposals = 100000000 } },
    }
    expect(when { it.slow }, solves(at_least(1))))"));
  const auto child = place.start({"test", "it_test.lua"});
  while (content(place / "out").find("when  slow") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ::kill(child, SIGINT);
  const auto outcome = place.finish(child);
  CHECK(outcome.status == 130);
  CHECK(outcome.err == "trellis: interrupted\n");
}
