// SPDX-License-Identifier: GPL-3.0-or-later
// Every message for bad input: golden/bad_input/*.cases.
#include <regex>
#include <string>

#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>

#include "support/cases.hpp"

using namespace trellis;

TEST_CASE("bad input gives one clear message with the script's line") {
  test::check_cases("bad_input", 169, [](const test::Case& one) -> std::string {
    // Enough for the deepest recursion; the script that allocates all memory must not get a gigabyte in a test.
    dsl::Session session("bad_input", {.memory = std::size_t{256} << 20U});
    try {
      session.load(one.script, one.name + ".lua");
    } catch (const Error& error) {
      // Lua determines the limit of recursion.
      return std::regex_replace(error.what(), std::regex("skipping [0-9]+ levels"), "skipping N levels") + "\n";
    }
    FAIL_CHECK("no error");
    return "";
  });
}
