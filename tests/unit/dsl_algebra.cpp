// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "support/catch.hpp"
#include "support/script.hpp"

#include <trellis/strategy/registry.hpp>

using namespace trellis;
using test::failure;
using test::value;
using test::values;

TEST_CASE("every planner and guide of the registry is a constructor") {
  for (const Component* component : components()) {
    if (component->kind != Component::Kind::planner && component->kind != Component::Kind::guide) continue;
    INFO(component->name);
    CHECK(value("tostring(" + component->name + "()):match('^[%w_]+')") == component->name);
    CHECK(value("tostring(" + component->name + "):match('^[%w_]+')") == component->name);
    CHECK(value(component->name + "() == " + component->name + " {}") == "true");
  }
}

TEST_CASE("a spec reads as it is written") {
  CHECK(value("skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 }") ==
        value("tostring(skeleton() >> (shrink { scale = 0.5 } >> (lazy {} >> rrt { step = 0.5 })))"));
  for (const std::string spec :
       {"skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.25 }", "(0.7*skeleton() + 0.3*goal_bias(0.2)) >> prm()",
        "(skeleton() .. lazy()) >> rrt { step = 0.25 }"}) {
    INFO(spec);
    CHECK(value("(" + spec + ") == load('return ' .. tostring(" + spec + "))()") == "true");
  }
}

TEST_CASE("names of obstacles are a list, with or without the option's name") {
  CHECK(value("drop { 'a', 'b' } == drop { obstacles = { 'a', 'b' } }") == "true");
  CHECK(value("drop('a', 'b') == drop { 'a', 'b' }") == "true");
  CHECK(value("drop {} == drop { obstacles = {} }") == "true");
  CHECK(value("tostring(drop { 'a', 'b', evidence = 5 })") == "drop { \"a\", \"b\", evidence = 5 }");
  CHECK(value("tostring(drop { 'a', 'b' })") == "drop(\"a\", \"b\")");
  CHECK(value("drop { 'a', 3 } == drop { obstacles = { 'a', '3' } }") == "true");
  CHECK_THAT(failure("drop { 'a', 3.5 }"), Catch::Contains("expected a name, got 3.5"));
  CHECK_THAT(failure("drop { obstacles = { 1.5 } }"), Catch::Contains("must be a list of names"));
  CHECK_THAT(failure("drop { 'a', 'a' }"), Catch::Contains("one is there twice"));
  CHECK_THAT(failure("drop { 'a', obstacles = { 'b' } }"), Catch::Contains("given twice"));
}

TEST_CASE("composition is associative") {
  const std::string parts = "local a, b, c, p = skeleton(), shrink(0.5), lazy(), rrt { step = 0.5 } return ";
  const auto holds = [&](const std::string& law) { return values(parts + law) == std::vector<std::string>{"true"}; };
  CHECK(holds("(a >> b) >> c == a >> (b >> c)"));
  CHECK(holds("(a >> b) >> p == a >> (b >> p)"));
  CHECK(holds("a >> b >> c >> p == a >> (b >> (c >> p))"));
  CHECK(holds("(a + b) + c == a + (b + c)"));
  CHECK(holds("(a .. b) .. c == a .. (b .. c)"));
  CHECK(holds("a .. b .. c == sequence { a, b, c }"));
  CHECK(holds("a .. b == sequence(a, b)"));
}

TEST_CASE("nesting distributes over mixtures and sequences") {
  const std::string parts = "local a, b, c, p = skeleton(), shrink(0.5), lazy(), rrt {} return ";
  const auto holds = [&](const std::string& law) { return values(parts + law) == std::vector<std::string>{"true"}; };
  CHECK(holds("a >> (b + c) == (a >> b) + (a >> c)"));
  CHECK(holds("a >> (0.7*b + 0.3*c) == 0.7*(a >> b) + 0.3*(a >> c)"));
  CHECK(holds("a >> (b .. c) == (a >> b) .. (a >> c)"));
  CHECK(holds("(a + b) >> p == 0.5*a + 0.5*b >> p"));
}

TEST_CASE("a blend composes with every operator") {
  const std::string parts = "local a, b, c, p = skeleton(), shrink(0.5), lazy(), rrt {} return ";
  const auto holds = [&](const std::string& law) { return values(parts + law) == std::vector<std::string>{"true"}; };
  CHECK(holds("a >> blend { b, c } == blend { a >> b, a >> c }"));
  CHECK(holds("a >> blend { b, c } >> p == (a >> blend { b, c }) >> p"));
  CHECK(holds("blend { a, b } >> c >> p == blend { a, b } >> (c >> p)"));
  CHECK(holds("blend { a, b } >> (b + c) == (blend { a, b } >> b) + (blend { a, b } >> c)"));
  CHECK(holds("(blend { a, b } + b) + c == blend { a, b } + (b + c)"));
  CHECK(holds("(blend { a, b } .. b) .. c == blend { a, b } .. (b .. c)"));
  CHECK(holds("blend(a, b) == blend { a, b }"));
  CHECK(holds("blend { a, b } ~= blend { b, a }"));
  // The parts of a blend have equal standing, so a blend in a blend is one part.
  CHECK(holds("blend { blend { a, b }, c } ~= blend { a, b, c }"));
  CHECK(holds("blend { a, b, floor = 0.5 } ~= blend { a, b }"));
  CHECK(holds("blend { a, b, floor = 0.2 } == blend { a, b }"));
  CHECK(
      holds("load('return ' .. tostring(blend { a, b + c, floor = 0.3, credit = 'reach' } >> p))() == "
            "blend { a, b + c, floor = 0.3, credit = 'reach' } >> p"));
  CHECK(
      holds("load('return ' .. tostring((0.7 * blend { a, b } + 0.3 * c) >> b))() == "
            "(0.7 * blend { a, b } + 0.3 * c) >> b"));
}

TEST_CASE("weights are shares") {
  CHECK(value("7*lazy() + 3*skeleton() == 0.7*lazy() + 0.3*skeleton()") == "true");
  CHECK(value("lazy()*0.7 + skeleton()*0.3 == 0.7*lazy() + 0.3*skeleton()") == "true");
  CHECK(value("lazy() + skeleton() == 0.7*lazy() + 0.3*skeleton()") == "false");
}

TEST_CASE("equal specs are equal, others are not, and neither is a spec equal to anything else") {
  CHECK(value("rrt { step = 0.5 } == rrt { step = 0.5 }") == "true");
  CHECK(value("rrt { step = 0.5 } == rrt { step = 0.25 }") == "false");
  CHECK(value("rrt {} == prm {}") == "false");
  CHECK(value("rrt {} == lazy()") == "false");
  CHECK(value("lazy() == 'lazy()'") == "false");
  CHECK(value("graph_search {} == graph_search {}") == "true");
}

TEST_CASE("a strategy shows its tree, its JSON and a stable hash") {
  const std::string strategy = "(skeleton() >> shrink(0.5) >> rrt { step = 0.5 })";
  CHECK(value(strategy + ":tree()").find("shrink") != std::string::npos);
  CHECK(value(strategy + ":json()").find("\"rrt\"") != std::string::npos);
  CHECK(value(strategy + ":hash()").size() == 16);
  CHECK(value(strategy + ":hash() == " + strategy + ":hash()") == "true");
  CHECK(value("rrt { step = 0.5 }:hash() == rrt { step = 0.25 }:hash()") == "false");
  CHECK(failure("rrt {}:tre()").find("did you mean 'tree'?") != std::string::npos);
}

TEST_CASE("a function and a loop compute families of spaces") {
  CHECK(value("(function() local s = rrt {} for i = 1, 3 do s = shrink(i / 4) >> s end return s end)() == "
              "shrink(0.75) >> shrink(0.5) >> shrink(0.25) >> rrt {}") == "true");
}

TEST_CASE("an error can be caught, and says the line of the call") {
  CHECK(values("local ok, message = pcall(rrt, { step = -1 })\nreturn ok, message")[0] == "false");
  CHECK(failure("\n\nlocal make = rrt\nmake { step = -1 }").starts_with("test.lua:4: rrt: option 'step' must be"));
  // Lua itself puts the line that resumed the coroutine in front.
  CHECK(failure("local s = coroutine.wrap(function()\n coroutine.yield(shrink(7)) end)\ns()")
            .starts_with("test.lua:3: test.lua:2: shrink: option 'scale'"));
}

TEST_CASE("an error in the standard library is blamed on the script") {
  CHECK(failure("local s = require 'strategies'\n\ns.nested {\n  scale = 2 }")
            .starts_with("test.lua:3: strategies.nested: option 'scale'"));
  CHECK(failure("scenes.cup { start = {1} }").starts_with("test.lua:1: problem: field 'start'"));
}
