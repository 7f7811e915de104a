// SPDX-License-Identifier: GPL-3.0-or-later
// trellis sweep and trellis merge: runs are stored one by one, survive the death of the program, and join.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "support/catch.hpp"
#include "support/process.hpp"

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

void remove_times(Json& json) {
  if (json.is_object()) {
    json.erase("time_s");
    json.erase("cpu_s");
  }
  if (json.is_structured()) {
    for (Json& part : json) remove_times(part);
  }
}

/// The bytes of results or of one record, without times.
std::string timeless(const std::string& text) {
  Json json = Json::parse(text);
  remove_times(json);
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

TEST_CASE("the results of a sweep can be compared and verified") {
  const Sweeps it;
  REQUIRE(it.sweep("swept").status == 0);
  CHECK(it.place.run({"compare", "swept/results.json", "--baseline", "plain"}).status == 0);
  CHECK(it.place.run({"verify", "swept/results.json"}).status == 0);
}
