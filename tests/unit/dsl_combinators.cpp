// SPDX-License-Identifier: GPL-3.0-or-later
// Schedules, races and splits in scripts.
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/random_specs.hpp"
#include "support/script.hpp"

using namespace trellis;
using test::failure;
using test::value;
using test::values;

namespace {

bool holds(const std::string& law) {
  const std::string parts = "local a, b, c, p = skeleton(), shrink(0.5), lazy(), rrt {} return ";
  return values(parts + law) == std::vector<std::string>{"true"};
}

}  // namespace

TEST_CASE("a schedule of one constructor is that of its guides") {
  CHECK(holds("schedule { shrink, scale = {0.3, 0.6} } == schedule { shrink(0.3), shrink(0.6) }"));
  CHECK(
      holds("schedule { shrink, scale = {0.3, 0.6}, evidence = 50, rounds = 2 } == "
            "schedule { shrink { 0.3, evidence = 50 }, shrink { 0.6, evidence = 50 }, rounds = 2 }"));
  CHECK(
      holds("schedule { shrink, scale = {0.3, 0.6}, evidence = {50, 70} } == "
            "schedule { shrink { 0.3, evidence = 50 }, shrink { 0.6, evidence = 70 } }"));
  CHECK(
      holds("schedule { shrink, scale = {0.3, 0.6}, planner = prm {} } == "
            "schedule { shrink { 0.3, planner = prm {} }, shrink { 0.6, planner = prm {} } }"));
  CHECK(
      holds("schedule { lazy, margin = {0.1, 0.2, 0.3}, turn = 90 } == "
            "schedule { lazy { margin = 0.1 }, lazy { margin = 0.2 }, lazy { margin = 0.3 }, turn = 90 }"));
  CHECK(holds("schedule { shrink, scale = {0.3} } == shrink(0.3)"));
}

TEST_CASE("schedules, races and splits compose with every operator") {
  CHECK(holds("schedule { a } == a"));
  CHECK(holds("race { a } == a"));
  CHECK(holds("a >> schedule { b, c } == schedule { a >> b, a >> c }"));
  CHECK(holds("a >> race { b, c } == race { a >> b, a >> c }"));
  CHECK(holds("a >> race { b, c } >> p == (a >> race { b, c }) >> p"));
  CHECK(holds("race { a, b } >> c >> p == race { a, b } >> (c >> p)"));
  CHECK(holds("schedule { schedule { a, b }, c } == schedule { a, b, c }"));
  CHECK(holds("race { race { a, b }, c } ~= race { a, b, c }"));
  CHECK(holds("schedule(a, b) == schedule { a, b }"));
  CHECK(holds("split { a >> p } == a >> split { p }"));
  CHECK(holds("split { b >> split { p } } == b >> split { p, depth = 2 }"));
  CHECK(holds("split { p } ~= p"));
  CHECK(holds("split(p) == split { p }"));
  CHECK(value("tostring(split { rrt { step = 0.25 }, depth = 2, effort = 500 })") ==
        "split { rrt { step = 0.25 }, depth = 2, effort = 500 }");
  CHECK(value("shrink { 0.5, planner = split { prm {} } }") == "shrink { 0.5, planner = split { prm() } }");
}

TEST_CASE("a composition of any kinds reads as it is written") {
  test::RandomSpecs random(11);
  for (int i = 0; i < 300; ++i) {
    const StrategySpec strategy = random.strategy(1 + i % 5);
    CAPTURE(strategy.text());
    const auto read =
        values("local s = " + strategy.text() + " return s == load('return ' .. tostring(s))(), tostring(s), s:json()");
    REQUIRE(read.size() == 3);
    CHECK(read[0] == "true");
    // Weights are normalised as they are written, which may cost them their last bit.
    if (strategy.text().find('*') != std::string::npos) continue;
    CHECK(read[1] == strategy.text());
    CHECK(read[2] == strategy.json());
  }
}

TEST_CASE("numbers read as they are written") {
  CHECK(value("shrink(0.123456789012)") == "shrink(0.123456789012)");
  CHECK(value("shrink(0.1)") == "shrink(0.1)");
  CHECK(value("rrt { proposals = 1e6 }") == "rrt { proposals = 1e+06 }");
  CHECK(value("shrink(1/3) == load('return ' .. tostring(shrink(1/3)))()") == "true");
  CHECK(value("rrt { checks = 5 }:json() == load('return ' .. tostring(rrt { checks = 5 }))():json()") == "true");
}

TEST_CASE("what the combinators refuse names what is wrong") {
  CHECK(failure("schedule { shrink, scale = {} }").find("empty list") != std::string::npos);
  CHECK(failure("schedule { shrink, scale = {0.3, 'x'} }").find("option 'scale' must be a number") !=
        std::string::npos);
  CHECK(failure("split { skeleton() }").find("split { skeleton() >> rrt {} }") != std::string::npos);
  CHECK(failure("schedule { experience, db = {'../a.db', '../b.db'} }").find("does not lie in the script's folder") !=
        std::string::npos);
  CHECK(failure("race {}").find("needs at least one guide") != std::string::npos);
}
