// SPDX-License-Identifier: GPL-3.0-or-later
// What may follow a text that is not finished.
#include <algorithm>
#include <dsl/language/offers.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"

using trellis::dsl::offers;
using Words = std::vector<std::string>;

namespace {

bool has(const Words& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

TEST_CASE("a name is completed by the words of the language") {
  CHECK(offers("shr") == Words{"shrink"});
  CHECK(offers("x = rrt_") == Words{"rrt_connect"});
  CHECK(has(offers(""), "skeleton"));
  CHECK(has(offers("skeleton() >> "), "shrink"));
  CHECK(has(offers("scen"), "scenes"));
  CHECK(offers("nothing_like_it").empty());
}

TEST_CASE("behind a module's dot stands what it has") {
  CHECK(offers("robot.d") == Words{"disc"});
  CHECK(has(offers("robot."), "rectangle"));
  CHECK(offers("other.d").empty());
}

TEST_CASE("in a constructor's table stand its options and nothing else") {
  CHECK(offers("rrt { st") == Words{"step = "});
  CHECK(offers("rrt { step = 0.5, goal_b") == Words{"goal_bias = "});
  CHECK(offers("rrt({ st") == Words{"step = "});
  CHECK(offers("shrink { 0.5, pl") == Words{"planner = "});
  CHECK(has(offers("problem { "), "world = "));
  CHECK_FALSE(has(offers("problem { "), "world"));
  // Elsewhere a table holds values.
  CHECK(offers("rrt { step = 0.5 }, sh") == Words{"shrink"});
  CHECK(offers("x = { shr") == Words{"shrink"});
  CHECK(offers("rrt { step = shr") == Words{"shrink"});
  CHECK(offers("f(shr") == Words{"shrink"});
}

TEST_CASE("a table of elements takes options beside them") {
  const Words words = offers("blend { sk");
  CHECK(words == Words{"skeleton"});
  CHECK(offers("blend { skeleton(), flo") == Words{"floor = "});
  CHECK(offers("world { bou") == Words{"bounds = "});
}

TEST_CASE("nothing is completed within texts and comments") {
  CHECK(offers("print(\"shr").empty());
  CHECK(offers("x = [[shr").empty());
  CHECK(offers("-- shr").empty());
  CHECK(offers("x = \"a\\\"\" shr") == Words{"shrink"});
}
