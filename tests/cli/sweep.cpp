// SPDX-License-Identifier: GPL-3.0-or-later
// trellis sweep and trellis merge: runs are stored one by one, survive the death of the program, and join.
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill is POSIX's
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <string>
#include <trellis/memory/database.hpp>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/timeless.hpp"

using Json = nlohmann::json;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

constexpr const char* script = R"(
return experiment {
  problems = { scenes.cup(), scenes.trap() },
  strategies = { guided = skeleton() >> rrt { step = 0.5 }, plain = rrt { step = 0.5, proposals = 20000 } },
  seeds = 8,
}
)";

/// The bytes of results or of one record, without times.
std::string timeless(const std::string& text) {
  Json json = Json::parse(text);
  trellis::test::remove_times(json);
  return json.dump();
}

std::string records(const std::string& text) {
  std::string all;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    REQUIRE(end != std::string::npos);
    all += timeless(text.substr(begin, end - begin)) + '\n';
    begin = end + 1;
  }
  return all;
}

struct Sweeps {
  Sweeps() { place.script("it.lua", script); }
  [[nodiscard]] Outcome sweep(const std::string& folder, const std::string& shard = "1/1") const {
    return place.run({"sweep", "it.lua", "--out", folder, "--shard", shard});
  }
  [[nodiscard]] std::string text(const std::string& file) const { return content(place / file); }
  void require_equal(const std::string& a, const std::string& b) const {
    CHECK(records(text(a + "/runs.jsonl")) == records(text(b + "/runs.jsonl")));
    CHECK(timeless(text(a + "/results.json")) == timeless(text(b + "/results.json")));
    CHECK(text(a + "/manifest.json") == text(b + "/manifest.json"));
  }

  Place place;
};

}  // namespace

TEST_CASE("a manifest names the commit and the machine, which may differ between shards") {
  const Sweeps it;
  REQUIRE(it.sweep("one", "1/2").status == 0);
  REQUIRE(it.sweep("two", "2/2").status == 0);
  const std::string text = it.text("one/manifest.json");
  const Json manifest = Json::parse(text);
  CHECK(manifest.at("version") == TRELLIS_VERSION);
  CHECK(manifest.at("commit").is_string());
  for (const char* field : {"system", "processor", "cores", "compiler"}) CHECK(manifest.at("machine").contains(field));
  it.place.script("one/manifest.json",
                  std::regex_replace(text, std::regex(R"re("(processor|commit)":"[^"]*")re"), R"("$1":"another one")"));
  CHECK(it.text("one/manifest.json").find("another one") != std::string::npos);
  CHECK(it.place.run({"merge", "one", "two", "--out", "all"}).status == 0);
}

TEST_CASE("shards and a whole sweep with the same runs merge, whatever their times") {
  const Sweeps it;
  REQUIRE(it.sweep("one", "1/2").status == 0);
  REQUIRE(it.sweep("two", "2/2").status == 0);
  REQUIRE(it.sweep("whole").status == 0);
  const Outcome merged = it.place.run({"merge", "one", "two", "whole", "--out", "all", "--csv", "all.csv"});
  CHECK(merged.err.empty());
  CHECK(merged.out == "32 runs of 3 folders in 'all', 'all.csv'\n");
  it.require_equal("all", "whole");
  CHECK(it.text("all/runs.csv") == it.text("all.csv"));
  // The records of the first folder with a run remain.
  CHECK(it.text("all/runs.jsonl").find(it.text("one/runs.jsonl").substr(0, 100)) == 0);
}

TEST_CASE("a sweep that is killed at random ends with the bytes of one that is not", "[slow]") {
  const char* const wanted = std::getenv("TRELLIS_KILLS");  // NOLINT(concurrency-mt-unsafe)
  const int kills = wanted != nullptr ? std::atoi(wanted) : 6;
  const Sweeps it;
  REQUIRE(it.sweep("whole").status == 0);
  std::mt19937 random(1);
  int killed = 0;
  for (int sweep = 0; killed < kills; ++sweep) {
    REQUIRE(sweep < 20 * kills);
    const std::string folder = "killed" + std::to_string(sweep);
    const std::string file = folder + "/runs.jsonl";
    for (bool ended = false; !ended;) {
      const std::size_t before = it.text(file).size();
      const pid_t child = it.place.start({"sweep", "it.lua", "--out", folder});
      int status = 0;
      while (::waitpid(child, &status, WNOHANG) == 0) {
        if (killed >= kills || it.text(file).size() <= before) continue;
        ::usleep(random() % 4000);
        ::kill(child, SIGKILL);
        ::waitpid(child, &status, 0);
        break;
      }
      ended = WIFEXITED(status);
      if (ended) REQUIRE(WEXITSTATUS(status) == 0);
      if (!ended) ++killed;
    }
    it.require_equal("whole", folder);
  }
}

TEST_CASE("an incomplete last record runs again, the complete ones remain byte for byte") {
  const Sweeps it;
  REQUIRE(it.sweep("swept").status == 0);
  const std::string whole = it.text("swept/runs.jsonl");
  const std::size_t half = whole.find('\n', whole.size() / 2) + 1;
  std::ofstream(it.place / "swept/runs.jsonl") << whole.substr(0, half + 20);
  REQUIRE(it.sweep("swept").status == 0);
  const std::string again = it.text("swept/runs.jsonl");
  CHECK(again.substr(0, half) == whole.substr(0, half));
  CHECK(records(again) == records(whole));
  const Outcome nothing = it.sweep("swept");
  CHECK(nothing.out == "32 runs in 'swept', 0 of them new\n");
  CHECK(it.text("swept/runs.jsonl") == again);
}

TEST_CASE("a folder of another sweep, and a damaged record, are refused and named") {
  const Sweeps it;
  REQUIRE(it.sweep("swept").status == 0);
  CHECK(
      it.sweep("swept", "1/2").err ==
      "trellis: --out: 'swept' holds other runs: the shard differs (1/1 and 1/2); name another folder, or start again "
      "with --restart, which deletes their records\n");
  std::ofstream(it.place / "swept/runs.jsonl", std::ios::app) << "{}\n";
  const Outcome damaged = it.sweep("swept");
  CHECK(damaged.status == 2);
  CHECK(damaged.err ==
        "trellis: swept/runs.jsonl:33: this is no record of a run; delete the line, and the same command runs it "
        "again\n");
  it.place.script("it.lua", std::string("-- changed\n") + script);
  CHECK(it.sweep("swept").err.find("the content of the script differs") != std::string::npos);
  CHECK(it.sweep("new", "3/2").status == 2);
  CHECK(it.sweep("new", "0/2").status == 2);
}

TEST_CASE("merged shards equal one sweep, and gaps and contradictions are named") {
  const Sweeps it;
  REQUIRE(it.sweep("whole").status == 0);
  REQUIRE(it.sweep("a", "1/2").status == 0);
  REQUIRE(it.sweep("b", "2/2").status == 0);
  REQUIRE(it.place.run({"merge", "b", "a", "--out", "both"}).status == 0);
  it.require_equal("whole", "both");
  REQUIRE(it.place.run({"merge", "a", "b", "--out", "both"}).status == 0);
  it.require_equal("whole", "both");
  CHECK(it.place.run({"merge", "a", "b", "--out", "a"}).err ==
        "trellis: --out: 'a' holds other runs: the shard differs (1/2 and 1/1); name another folder\n");

  const Outcome gap = it.place.run({"merge", "a", "--out", "gap"});
  CHECK(gap.status == 2);
  CHECK(gap.err ==
        "trellis: merge: 16 of 32 runs are missing, the first is 'guided' on 'cup', seed 2; repeat the sweep of its "
        "shard\n");

  std::string changed = it.text("whole/runs.jsonl");
  const std::size_t at = changed.find("\"validity_checks\":") + 18;
  changed.insert(at, "1");
  std::ofstream(it.place / "whole/runs.jsonl") << changed;
  const Outcome contradiction = it.place.run({"merge", "a", "b", "whole", "--out", "none"});
  CHECK(contradiction.status == 2);
  CHECK(contradiction.err.find("differs from its record in a folder before") != std::string::npos);
}

TEST_CASE("the results of a sweep can be reported, compared and verified") {
  const Sweeps it;
  REQUIRE(it.sweep("swept").status == 0);
  const Outcome report = it.place.run({"report", "swept", "--report", "levels"});
  CHECK(report.status == 0);
  CHECK(report.out.find("0 root") != std::string::npos);
  REQUIRE(it.place.run({"merge", "swept", "--out", "merged"}).status == 0);
  CHECK(it.place.run({"report", "merged", "--report", "levels"}).out == report.out);
  CHECK(it.place.run({"report", "swept/results.json", "--report", "costs", "--baseline", "plain"}).status == 0);
  CHECK(it.place.run({"verify", "swept/results.json"}).status == 0);
}

TEST_CASE("a merge has the table of runs, and exports what it joined") {
  const Sweeps it;
  REQUIRE(it.sweep("a", "1/2").status == 0);
  REQUIRE(it.sweep("b", "2/2").status == 0);
  const Outcome merged =
      it.place.run({"merge", "a", "b", "--out", "both", "--csv", "all.csv", "--sqlite", "all.db", "--pdt", "pdt"});
  REQUIRE(merged.status == 0);
  CHECK(merged.out == "32 runs of 2 folders in 'both', 'all.csv', 'all.db', 'pdt'\n");
  CHECK(it.text("all.csv") == it.text("both/runs.csv"));
  CHECK_THAT(it.text("all.csv"), Catch::Matchers::StartsWith("problem,strategy,seed,status,solved,validity_checks,"));
  const trellis::Database database(it.place / "all.db", trellis::Database::Mode::read, {"database", "database"});
  for (const char* table : {"SELECT count(*) FROM run", "SELECT count(*) FROM runs"}) CHECK(database.ask(table) == 32);
  // Without a folder of its own, too. tests/python/test_export.py has all that is exported.
  REQUIRE(it.place.run({"merge", "a", "b", "--pdt", "other"}).status == 0);
  CHECK(it.text("other/trap.csv") == it.text("pdt/trap.csv"));
}
