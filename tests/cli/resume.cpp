// SPDX-License-Identifier: GPL-3.0-or-later
// trellis run --out: runs and scores are stored one by one, survive the death of the program, and the same command
// continues.
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill is POSIX's
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/timeless.hpp"

using Json = nlohmann::json;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

constexpr const char* script = R"(
local mine = require "mine"
return experiment {
  problems = { scenes.cup(), scenes.trap() },
  strategies = { guided = skeleton() >> rrt { step = mine.step }, plain = rrt { step = 0.5, proposals = 20000 } },
  seeds = 3,
  measure = tube { points = 128, pool = 128 },
}
)";
constexpr const char* module = "return { step = 0.5 }\n";

/// The runs of a folder without times, in their order.
std::string runs(const std::string& folder) {
  Json all = Json::parse(content(folder + "/results.json")).at("runs");
  trellis::test::remove_times(all);
  return all.dump();
}

struct Runs {
  Runs() {
    place.script("it.lua", script);
    place.script("mine.lua", module);
  }
  [[nodiscard]] Outcome run(const std::string& folder, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run", "it.lua", "--quiet", "--out", folder};
    words.insert(words.end(), more.begin(), more.end());
    return place.run(words);
  }
  [[nodiscard]] std::string text(const std::string& file) const { return content(place / file); }
  /// Requires that every byte of a folder is that of an uninterrupted run with the same times: one that plans and
  /// scores all runs, and reads the records for their times only.
  void require_uninterrupted(const std::string& folder) const {
    const std::string fresh = folder + "-fresh";
    fs::create_directories(place / fresh);
    for (const char* name : {"/manifest.json", "/runs.jsonl"})
      fs::copy_file(place / folder + name, place / fresh + name);
    REQUIRE(run(fresh).status == 0);
    const Outcome same = place.shell("diff -r '" + folder + "' '" + fresh + "'");
    INFO(same.out);
    REQUIRE(same.status == 0);
    fs::remove_all(place / fresh);
  }

  Place place;
};

}  // namespace

TEST_CASE("a run that is killed at random ends with the bytes of one that is not", "[slow]") {
  const char* const wanted = std::getenv("TRELLIS_KILLS");      // NOLINT(concurrency-mt-unsafe)
  const int kills = wanted != nullptr ? std::atoi(wanted) : 6;  // NOLINT(cert-err34-c)
  const Runs it;
  const auto begin = std::chrono::steady_clock::now();
  REQUIRE(it.run("whole").status == 0);
  const auto duration = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - begin);
  const std::string expected = runs(it.place / "whole");
  std::mt19937 random(1);
  int killed = 0;
  int by_signal = 0;  // the last kill's: KILL, INT and TERM in turn
  for (int turn = 0; killed < kills; ++turn) {
    REQUIRE(turn < 20 * kills);
    const std::string folder = "killed" + std::to_string(turn);
    for (bool ended = false; !ended;) {
      const std::string jobs = turn % 2 == 0 ? "1" : "2";
      const pid_t child = it.place.start({"run", "it.lua", "--quiet", "--out", folder, "--jobs", jobs});
      if (killed < kills) {
        ::usleep(static_cast<useconds_t>(random() % static_cast<unsigned>(duration.count())));
        ::kill(child, by_signal % 4 == 3 ? SIGINT : SIGKILL);
      }
      int status = 0;
      ::waitpid(child, &status, 0);
      ended = WIFEXITED(status) && WEXITSTATUS(status) == 0;
      if (ended) continue;
      REQUIRE((WIFSIGNALED(status) || WEXITSTATUS(status) == 130));
      ++killed;
      ++by_signal;
    }
    REQUIRE(runs(it.place / folder) == expected);
    it.require_uninterrupted(folder);
    fs::remove_all(it.place / folder);
  }
}

TEST_CASE("a run takes stored scores, and only what is missing is made again", "[slow]") {
  const Runs it;
  REQUIRE(it.run("made").status == 0);
  const std::string before = it.text("made/results.json");
  const std::string page = it.text("made/report.html");
  REQUIRE(it.run("made").status == 0);
  CHECK(it.text("made/results.json") == before);
  CHECK(it.text("made/report.html") == page);

  // A stored score is not computed again.
  std::string scores = it.text("made/scores.jsonl");
  const std::string field = "\"coverage\":1.0";
  const std::size_t at = scores.find(field);
  REQUIRE(at != std::string::npos);
  scores.replace(at, field.size(), "\"coverage\":0.123456789");
  std::ofstream(it.place / "made/scores.jsonl") << scores;
  REQUIRE(it.run("made").status == 0);
  CHECK(it.text("made/results.json").find("0.1234568,") != std::string::npos);
  REQUIRE(it.run("made", {"--restart"}).status == 0);
  CHECK(it.text("made/results.json").find("0.1234568,") == std::string::npos);
}

TEST_CASE("a folder of other runs is refused, and the difference is named", "[slow]") {
  const Runs it;
  REQUIRE(it.run("made").status == 0);
  const std::string end = "; name another folder, or start again with --restart, which deletes their records\n";
  CHECK(it.run("made", {"--seeds", "2"}).err ==
        "trellis: --out: 'made' holds other runs: the options differ (run and run --seeds 2)" + end);
  CHECK(it.place.run({"sweep", "it.lua", "--out", "made"}).err ==
        "trellis: --out: 'made' holds other runs: the options differ (run and sweep)" + end);
  it.place.script("mine.lua", std::string(module) + "-- changed\n");
  CHECK(it.run("made").err ==
        "trellis: --out: 'made' holds other runs: the content of 'mine.lua', which the script reads, differs" + end);
  REQUIRE(it.run("made", {"--restart"}).status == 0);
  CHECK(it.place.run({"run", "it.lua", "--restart"}).err == "trellis: --restart: nothing is stored without --out\n");

  // A run that does not repeat is reported, not mixed with the others.
  std::string changed = it.text("made/runs.jsonl");
  changed.insert(changed.find("\"validity_checks\":") + 18, "1");
  std::ofstream(it.place / "made/runs.jsonl") << changed;
  const Outcome differs = it.run("made");
  CHECK(differs.status == 2);
  CHECK(differs.err ==
        "trellis: made/runs.jsonl: 'guided' on 'cup', seed 1 differs from its record when it is planned again; the "
        "program, the machine or a file that the script reads has changed: name another folder, or start again with "
        "--restart\n");
}

TEST_CASE("a run continues after a full disk", "[slow]") {
  const Runs it;
  const Outcome full = it.place.shell("ulimit -f 64; exec \"$T\" run it.lua --quiet --out made");
  CHECK(full.status == 2);
  CHECK(full.err ==
        "trellis: cannot write 'made/scores.jsonl': File too large; the records before remain, and the same "
        "command continues\n");
  const std::string before = it.text("made/runs.jsonl");
  REQUIRE_FALSE(before.empty());
  const std::string records = it.text("made/runs.jsonl");
  const auto held = std::count(records.begin(), records.end(), '\n');
  const Outcome rest = it.place.run({"run", "it.lua", "--out", "made"});
  REQUIRE(rest.status == 0);
  CHECK(rest.err.find("trellis: continues 'made', which holds " + std::to_string(held) +
                      " of 12 runs; --restart starts again\n") != std::string::npos);
  it.require_uninterrupted("made");
}

TEST_CASE("a target of the script is scored again, as its functions may depend on earlier calls") {
  const Place place;
  place.script("own.lua", R"(
local calls = 0
return experiment {
  problems = scenes.cup(), strategies = { plain = rrt { step = 0.5 } }, seeds = 2,
  measure = target { points = 64, pool = 64, sample = function(c) calls = calls + 1; return c.path[1 + calls % 2] end,
                     log_density = function() return 0.5 end },
}
)");
  const auto run = [&] { return place.run({"run", "own.lua", "--quiet", "--out", "made"}); };
  const Outcome first = run();
  REQUIRE(first.status == 0);
  const std::string before = content(place / "made/results.json");
  const Outcome second = run();
  REQUIRE(second.status == 0);
  CHECK(content(place / "made/results.json") == before);
  CHECK(second.err == first.err);
}
