// SPDX-License-Identifier: GPL-3.0-or-later
// Every message for bad input, as a golden file: golden/bad_input/NAME.lua gives NAME.txt. With the environment
// variable TRELLIS_UPDATE_GOLDEN set the texts are written instead, to be read before they are kept.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include <dsl/language/session.hpp>
#include <trellis/base/error.hpp>

#include "support/catch.hpp"

namespace fs = std::filesystem;
using namespace trellis;

namespace {

std::string content(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string message_of(const fs::path& script) {
  // Enough for the deepest recursion; the script that allocates all memory must not get a gigabyte in a test.
  dsl::Session session("bad_input", {.memory = std::size_t{256} << 20U});
  try {
    session.load(content(script), script.filename().string());
  } catch (const Error& error) {
    // Lua determines the limit of recursion.
    return std::regex_replace(error.what(), std::regex("skipping [0-9]+ levels"), "skipping N levels") + "\n";
  }
  return "no error\n";
}

}  // namespace

TEST_CASE("bad input gives one clear message with the script's line") {
  std::vector<fs::path> scripts;
  for (const auto& entry : fs::directory_iterator(fs::path(TRELLIS_GOLDEN) / "bad_input")) {
    if (entry.path().extension() == ".lua") scripts.push_back(entry.path());
  }
  std::sort(scripts.begin(), scripts.end());
  REQUIRE(scripts.size() > 50);
  const bool update = std::getenv("TRELLIS_UPDATE_GOLDEN") != nullptr;
  for (const auto& script : scripts) {
    const std::string message = message_of(script);
    const fs::path golden = fs::path(script).replace_extension(".txt");
    INFO(script.filename().string());
    CHECK(message != "no error\n");
    if (update) {
      std::ofstream(golden) << message;
    } else {
      CHECK(message == content(golden));
    }
  }
}
