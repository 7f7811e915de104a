// SPDX-License-Identifier: GPL-3.0-or-later
// Completions at a prompt.
#include <algorithm>
#include <string>
#include <vector>

#include "support/catch.hpp"

#include <dsl/language/tools/completion.hpp>
#include <dsl/language/tools/words.hpp>

using namespace trellis;
using Words = std::vector<std::string>;

namespace {

Words next(const std::string& text) { return dsl::completions(text).words; }

bool offers(const std::string& text, const std::string& word) {
  const Words all = next(text);
  return std::find(all.begin(), all.end(), word) != all.end();
}

}  // namespace

TEST_CASE("a name is completed to globals, keywords and the names of the session") {
  CHECK(next("shr") == Words{"shrink"});
  CHECK(next("local g = skel") == Words{"skeleton"});
  CHECK(next("ret") == Words{"return"});
  CHECK(next("rob") == Words{"robot", "robots"});
  // After `>>` come guides and planners, and functions that return one.
  CHECK(next("skeleton() >> sc") == Words{"schedule"});
  CHECK(offers("skeleton() >> ", "rrt"));
  CHECK(offers("skeleton() >> ", "strategies"));
  CHECK_FALSE(offers("skeleton() >> ", "world"));
  CHECK_FALSE(offers("skeleton() >> ", "print"));
  CHECK(offers("", "experiment"));
  CHECK(offers("rrt { step = 0.5 }\n", "strategies"));
  CHECK(offers("pri", "print"));
  CHECK(next("nothing_like_it").empty());
  const Words mine = {"my_guide", "my_world"};
  CHECK(dsl::completions("my_g", mine).words == Words{"my_guide"});
}

TEST_CASE("a completion reports the position where it begins") {
  CHECK(dsl::completions("local g = shr").begin == 10);
  CHECK(dsl::completions("scenes.tr").begin == 7);
  CHECK(dsl::completions("rrt { ").begin == 6);
  CHECK(dsl::completions("tube { distance = \"pl").begin == 19);
}

TEST_CASE("after a dot come the fields of a module or a library") {
  CHECK(next("scenes.tr") == Words{"trap"});
  CHECK(next("scenes.") == Words{"cup", "exists", "load", "robot", "simple_passage", "trap"});
  CHECK(next("return robot. rec") == Words{"rectangle"});
  CHECK(next("strategies.relaxati") == Words{"relaxation"});
  CHECK(next("math.sqr") == Words{"sqrt"});
  CHECK(next("unknown.").empty());
  CHECK(next("scenes.trap().").empty());
  CHECK(next("scenes.trap.x").empty());
  // A sequence, and a number, have dots too.
  CHECK(next("skeleton() .. shr") == Words{"shrink"});
  CHECK(next("0.").empty());
}

TEST_CASE("after a colon comes what can be asked of a value") {
  CHECK(next("strategy:") == Words{"attach", "clearance", "drive", "hash", "ik", "json", "nearest_obstacle", "pose",
                                   "recentred", "scaled", "tree", "valid"});
  CHECK(next("(skeleton() >> rrt {}):tr") == Words{"tree"});
}

TEST_CASE("inside a word's table come the options that are not given yet") {
  CHECK(next("goal_bias { ") == Words{"share"});
  CHECK(dsl::completions("goal_bias { ").options);
  CHECK_FALSE(dsl::completions("goal_b").options);
  CHECK(next("rrt { st") == Words{"step"});
  CHECK(next("rrt { step = 0.5, st").empty());
  CHECK(offers("rrt { step = 0.5, ", "goal_bias"));
  CHECK_FALSE(offers("rrt { step = 0.5, ", "step"));
  CHECK_FALSE(offers("rrt { ", "experiment"));
  CHECK(next("shrink(0.5) >> rrt {\n  step = 0.5,\n  goal") == Words{"goal_bias"});
  CHECK(next("shrink { 0.5, plan") == Words{"planner"});
  CHECK(next("shrink(0.5, { ev") == Words{"evidence"});
  CHECK(next("strategies.irc { sca") == Words{"scales"});
  CHECK(next("scenes.load(\"file.txt\", { col") == Words{"collision"});
  CHECK(next("experiment { strategies = { a = rrt {}, b = lazy { mar") == Words{"margin"});
  CHECK(next("experiment { strategies = { a = rrt {} }, prob") == Words{"problems"});
  // Elements stand beside fields.
  CHECK(offers("world { bo", "bounds"));
  CHECK(offers("world { bo", "box"));
  // A table in a field is the script's own.
  CHECK(offers("experiment { strategies = { ", "rrt"));
  CHECK_FALSE(offers("experiment { strategies = { ", "seeds"));
}

TEST_CASE("after an option's equals sign come the values that are known") {
  CHECK(next("tube { distance = ") == Words{"\"full\"", "\"planar\""});
  CHECK(next("tube { distance = \"") == Words{"full", "planar"});
  CHECK(next("tube { distance = 'pl") == Words{"planar"});
  CHECK(next("knn { blend = ") == Words{"false", "true"});
  CHECK(offers("shrink { planner = rr", "rrt_connect"));
}

TEST_CASE("help and require are completed in their strings") {
  CHECK(next("help \"shr") == Words{"shrink"});
  CHECK(next("help('strategies.relaxati") == Words{"strategies.relaxation"});
  CHECK(next("require 'str") == Words{"strategies"});
}

TEST_CASE("nothing is offered inside comments and other strings") {
  CHECK(next("-- shr").empty());
  CHECK(next("--[[ shr").empty());
  CHECK(next("local s = \"shr").empty());
  CHECK(next("local s = [[shr").empty());
  CHECK(next("--[[ a comment ]] shr") == Words{"shrink"});
  CHECK(next("-- a comment\nshr") == Words{"shrink"});
  CHECK(next("local s = \"a \\\" quote\" .. shr") == Words{"shrink"});
}

TEST_CASE("every option of every word is offered in its table") {
  for (const dsl::Word& word : dsl::words()) {
    if (word.named().empty()) continue;
    INFO(word.name);
    for (const auto& name : word.named()) CHECK(offers(word.name + " { ", name));
  }
}
