// SPDX-License-Identifier: GPL-3.0-or-later
// Malicious or faulty scripts, each in its own process: golden/hostile/NAME.lua is rejected or ended with the message
// NAME.txt. With TRELLIS_UPDATE_GOLDEN set the test writes the messages instead; read them before committing.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"

namespace fs = std::filesystem;
using trellis::test::content;
using trellis::test::Place;

namespace {

constexpr long mebibyte = 1024;  // in KiB
#ifdef __SANITIZE_ADDRESS__
constexpr long most_memory = 8192 * mebibyte;  // the sanitizer's own is most of it
#else
constexpr long most_memory = 512 * mebibyte;
#endif

/// Returns the first line: the traceback depends on where the script was ended. Whether the instruction limit or the
/// time limit comes first depends on the machine.
std::string message_of(const std::string& err) {
  const std::string line = err.substr(0, err.find('\n')) + "\n";
  return std::regex_replace(line, std::regex("has (spent [0-9]+ instructions|worked for [0-9.]+ s) and does not"),
                            "(has done enough) and does not");
}

}  // namespace

TEST_CASE("no script crashes, fails to terminate, reads forbidden files, or takes all memory") {
  std::vector<fs::path> scripts;
  for (const auto& entry : fs::directory_iterator(fs::path(TRELLIS_SOURCE) / "tests/golden/hostile")) {
    if (entry.path().extension() == ".lua") scripts.push_back(entry.path());
  }
  std::sort(scripts.begin(), scripts.end());
  REQUIRE(scripts.size() > 40);
  const bool update = std::getenv("TRELLIS_UPDATE_GOLDEN") != nullptr;
  const Place place;
  for (const auto& script : scripts) {
    const std::string name = script.filename().string();
    place.script(name, content(script));
    const auto outcome = place.run({"check", name, "--memory", "256", "--instructions", "20000000"});
    const std::string message = message_of(outcome.err);
    const fs::path golden = fs::path(script).replace_extension(".txt");
    INFO(name << "\n" << outcome.err.substr(0, 2000));
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    CHECK(outcome.most_memory < most_memory);
    if (update) {
      std::ofstream(golden) << message;
    } else {
      CHECK(message == content(golden));
    }
  }
}
