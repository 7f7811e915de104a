// SPDX-License-Identifier: GPL-3.0-or-later
// Malicious or faulty scripts, each in its own process: golden/hostile/*.cases are rejected or ended with their
// messages.
#include <regex>
#include <string>

#include "support/cases.hpp"
#include "support/process.hpp"

namespace {

constexpr long mebibyte = 1024;  // in KiB
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr long most_memory = 8192 * mebibyte;  // the sanitizer's own is most of it
#else
constexpr long most_memory = 256 * mebibyte;
#endif

/// Returns the first line: the traceback depends on where the script was ended. Whether the instruction limit or the
/// time limit comes first depends on the machine.
std::string message_of(const std::string& err) {
  const std::string line = err.substr(0, err.find('\n')) + "\n";
  return std::regex_replace(line, std::regex("has (spent [0-9]+ instructions|worked for [0-9.]+ s) and does not"),
                            "(has done enough) and does not");
}

}  // namespace

TEST_CASE("no script crashes, fails to terminate, reads forbidden files, or takes all memory", "[slow]") {
  const trellis::test::Place place;
  trellis::test::check_cases("hostile", 54, [&](const trellis::test::Case& one) {
    place.script(one.name + ".lua", one.script);
    const auto outcome = place.run({"check", one.name + ".lua", "--memory", "64", "--instructions", "20000000"});
    INFO(outcome.err.substr(0, 2000));
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    CHECK(outcome.most_memory < most_memory);
    return message_of(outcome.err);
  });
}
