// SPDX-License-Identifier: GPL-3.0-or-later
// Tokens of Lua texts.
#include <dsl/language/core/tokens.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"

using trellis::dsl::locals_outside;
using trellis::dsl::Token;
using trellis::dsl::tokens;
using Words = std::vector<std::string>;

TEST_CASE("a text falls into its tokens") {
  const auto texts = [](const std::string& text) {
    Words words;
    for (const Token& token : tokens(text)) words.emplace_back(token.text);
    return words;
  };
  CHECK(texts("a>>b..0.5 *x") == Words{"a", ">>", "b", "..", "0.5", "*", "x"});
  CHECK(texts("1..2") == Words{"1", "..", "2"});
  CHECK(texts("f{x=1e3,0xFF}") == Words{"f", "{", "x", "=", "1e3", ",", "0xFF", "}"});
  CHECK(texts("'it''s' \"a\\\"b\"") == Words{"'it'", "'s'", "\"a\\\"b\""});
  CHECK(texts("[==[ ]] ]==] -- c\nd") == Words{"[==[ ]] ]==]", "-- c", "d"});
  CHECK(tokens("x = 'a").back().unfinished);
  CHECK(tokens("--[[ a").back().unfinished);
  CHECK_FALSE(tokens("x = 'a'").back().unfinished);
  CHECK(tokens("end").front().kind == Token::Kind::keyword);
  CHECK(tokens("").empty());
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
