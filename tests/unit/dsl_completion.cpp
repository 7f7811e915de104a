// SPDX-License-Identifier: GPL-3.0-or-later
// What may follow a text that is not finished, and what a text declares.
#include <algorithm>
#include <dsl/language/completion.hpp>
#include <dsl/language/tokens.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"

using trellis::dsl::completions;
using trellis::dsl::locals_outside;
using Words = std::vector<std::string>;

namespace {

bool has(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

TEST_CASE("a name is completed by the words of the language") {
  CHECK(completions("shr") == Words{"shrink"});
  CHECK(completions("x = rrt_") == Words{"rrt_connect"});
  CHECK(has(completions(""), "skeleton"));
  CHECK(has(completions("skeleton() >> "), "shrink"));
  CHECK(has(completions("scen"), "scenes"));
  CHECK(completions("nothing_like_it").empty());
}

TEST_CASE("behind a module's dot stands what it has") {
  CHECK(completions("robot.d") == Words{"disc"});
  CHECK(has(completions("robot."), "rectangle"));
  CHECK(completions("other.d").empty());
}

TEST_CASE("in a constructor's table stand its options and nothing else") {
  CHECK(completions("rrt { st") == Words{"step = "});
  CHECK(completions("rrt { step = 0.5, goal_b") == Words{"goal_bias = "});
  CHECK(completions("rrt({ st") == Words{"step = "});
  CHECK(completions("shrink { 0.5, pl") == Words{"planner = "});
  CHECK(has(completions("problem { "), "world = "));
  CHECK_FALSE(has(completions("problem { "), "world"));
  // Elsewhere a table holds values.
  CHECK(completions("rrt { step = 0.5 }, sh") == Words{"shrink"});
  CHECK(completions("x = { shr") == Words{"shrink"});
  CHECK(completions("rrt { step = shr") == Words{"shrink"});
  CHECK(completions("f(shr") == Words{"shrink"});
}

TEST_CASE("a table of elements takes options beside them") {
  const Words words = completions("blend { sk");
  CHECK(words == Words{"skeleton"});
  CHECK(completions("blend { skeleton(), flo") == Words{"floor = "});
  CHECK(completions("world { bou") == Words{"bounds = "});
}

TEST_CASE("nothing is completed within texts and comments") {
  CHECK(completions("print(\"shr").empty());
  CHECK(completions("x = [[shr").empty());
  CHECK(completions("-- shr").empty());
  CHECK(completions("x = \"a\\\"\" shr") == Words{"shrink"});
}

TEST_CASE("locals are found outside of blocks only") {
  CHECK(locals_outside("local x = 1") == Words{"x"});
  CHECK(locals_outside("local a <const>, b = 1, 2; local function f() local c end") == Words{"a", "b", "f"});
  CHECK(locals_outside("do local x = 1 end").empty());
  CHECK(locals_outside("for i = 1, 3 do local x = i end; function f() local y end").empty());
  CHECK(locals_outside("if a then local x elseif b then local y else local z end").empty());
  CHECK(locals_outside("repeat local x = 1 until x").empty());
  CHECK(locals_outside("while true do local x end local y") == Words{"y"});
  CHECK(locals_outside("x = 'local y' -- local z\n--[[ local\nw ]]").empty());
}
