// SPDX-License-Identifier: GPL-3.0-or-later
// Whole files only: where a disk is full, a folder is read-only, a pipe is closed or a signal arrives, each output has
// its old content or its new one, the exit status shows it, and one line says what failed.
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill is POSIX's

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/image.hpp"
#include "support/process.hpp"
#include "support/results.hpp"

using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

constexpr const char* quick = "return rrt { step = 0.5 }, scenes.cup()\n";
constexpr const char* solve =
    "return experiment { problems = scenes.cup(), strategies = { rrt_connect {} }, seeds = 20, measure = false }\n";
// No path to the goal: a run that lasts until its budget is spent.
constexpr const char* endless = R"(
return experiment {
  problems = problem {
    world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, robot = robot.point(), start = {1, 1}, goal = {9, 9},
  },
  strategies = { rrt = rrt { step = 0.001, proposals = 1e6 } },
  seeds = 1000,
}
)";

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Names of the files of a folder, less the streams of the program.
std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  names.erase("out");
  names.erase("err");
  return names;
}

bool is_root() { return ::geteuid() == 0; }

}  // namespace

TEST_CASE("a stdout that takes nothing is an error of every verb") {
  const Place place;
  place.script("quick.lua", quick);
  place.script("print.lua", std::string("print 'a line'\n") + quick);
  place.script("help.lua", std::string("help 'rrt'\n") + quick);
  place.script("holds_test.lua",
               "scenario 'holds' (function() expect(when { rrt { step = 0.5 }, problem = scenes.cup(), seeds = 2 }, "
               "is_deterministic()) end)\n");
  for (const std::string command :
       {"run quick.lua", "run print.lua --quiet", "run help.lua --quiet", "check quick.lua", "explain quick.lua",
        "test holds_test.lua", "version", "--help", "run --help", "help", "help rrt", "reference markdown",
        "reference man", "repl <<< '1 + 1'", "repl <<< 'print(1)'"}) {
    const Outcome outcome = place.shell("$T " + command + " > /dev/full");
    INFO(command << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, Contains("cannot write 'standard output': "));
  }
  // The files are written nevertheless, also if stdout is closed: no file takes its number.
  for (const std::string to : {"> /dev/full", ">&-"}) {
    const Outcome outcome = place.shell("$T run quick.lua --json all.json --html page.html " + to);
    INFO(to << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK(lines(outcome.err) == 1);
    CHECK_THAT(content(place / "all.json"), Catch::Matchers::StartsWith("{") && Catch::Matchers::EndsWith("}\n"));
    CHECK_THAT(content(place / "page.html"),
               Catch::Matchers::StartsWith("<!DOCTYPE html>") && Catch::Matchers::EndsWith("</html>\n"));
    fs::remove(place / "all.json");
    fs::remove(place / "page.html");
  }
}

TEST_CASE("a reader that closes the pipe ends a command with 141, after its files are written") {
  const Place place;
  place.script("quick.lua", quick);
  // The reader has gone before the program starts, so that no buffer of the system takes the text.
  const auto piped = [&](const std::string& command) {
    return place.shell("mkfifo pipe; sleep 0 < pipe & exec 3> pipe; wait $!; " + command + " >&3");
  };
  for (const std::string command : {"$T run quick.lua --json all.json", "$T help", "$T reference man",
                                    "yes 1 + 1 | $T repl", "$T check quick.lua"}) {
    const Outcome outcome = piped(command);
    INFO(command << "\n" << outcome.err);
    CHECK(outcome.status == 141);
    CHECK(outcome.err == "trellis: cannot write 'standard output': Broken pipe\n");
    fs::remove(place / "pipe");
  }
  CHECK_THAT(content(place / "all.json"), Catch::Matchers::EndsWith("}\n"));
}

TEST_CASE("an output that the system refuses leaves the old file and no other") {
  const Place place;
  place.script("quick.lua", quick);
  place.script("all.json", "old json");
  place.script("page.html", "old page");
  const auto before = names_in(place / "");
  const Outcome limited = place.shell("ulimit -f 1; $T run quick.lua --quiet --json all.json --html page.html");
  INFO(limited.err);
  CHECK(limited.status == 2);
  CHECK(limited.err == "trellis: cannot write 'all.json': File too large\n");
  CHECK(content(place / "all.json") == "old json");
  CHECK(content(place / "page.html") == "old page");
  CHECK(names_in(place / "") == before);
  const Outcome device = place.run({"run", "quick.lua", "--quiet", "--html", "/dev/full"});
  CHECK(device.status == 2);
  CHECK(device.err == "trellis: cannot write '/dev/full': No space left on device\n");
  // What a session saves, and new scripts.
  const Outcome saved =
      place.shell("ulimit -f 1; { printf 'x = \"%2000s\"\\n' y; echo 'save \"session.lua\"'; } | $T repl > /dev/null");
  CHECK(saved.status == 2);
  CHECK_THAT(saved.err, Contains("cannot write 'session.lua': File too large"));
  const Outcome fresh = place.shell("ulimit -f 1; $T new mine");
  CHECK(fresh.status == 2);
  CHECK(fresh.err == "trellis: cannot write 'mine.lua': File too large\n");
  CHECK(names_in(place / "") == before);
}

TEST_CASE("a new file keeps the permissions and the link of the old one") {
  const Place place;
  place.script("quick.lua", quick);
  place.script("real.json", "old");
  fs::permissions(place / "real.json", fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  fs::create_symlink("real.json", place / "link.json");
  REQUIRE(place.run({"run", "quick.lua", "--quiet", "--json", "link.json"}).status == 0);
  CHECK(fs::is_symlink(place / "link.json"));
  CHECK_THAT(content(place / "real.json"), Catch::Matchers::EndsWith("}\n"));
  CHECK(fs::status(place / "real.json").permissions() ==
        (fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read));
}

TEST_CASE("a full disk leaves the old files, and a library that opens", "[slow]") {
  const Place place;
  place.script("quick.lua", quick);
  place.script("solve.lua", solve);
  fs::create_directories(place / "disk");
  if (place.shell("unshare -m mount -t tmpfs -o size=32k none disk").status != 0) {
    WARN("skipped: only a privileged user can mount a small file system");
    return;
  }
  const Outcome outcome = place.shell(R"(unshare -m bash -c '
    mount -t tmpfs -o size=32k none disk
    for file in page.html all.json train.model; do echo old > disk/$file; done
    '$T' run quick.lua --quiet --html disk/page.html; echo html $?
    '$T' run quick.lua --quiet --out disk/folder; echo out $?
    rm -r disk/folder
    '$T' run solve.lua --quiet --novelty 0 --learn disk/paths.db; echo learn $?
    '$T' experience disk/paths.db > listed; echo experience $?
    '$T' run quick.lua --quiet --json disk/all.json; echo json $?
    '$T' new disk/mine > /dev/null; echo new $?
    cat disk/page.html disk/all.json
    ls -A disk')");
  INFO(outcome.err);
  CHECK(outcome.out ==
        "html 2\nout 2\nlearn 2\nexperience 0\njson 2\nnew 2\nold\nold\nall.json\npage.html\npaths.db\ntrain.model\n");
  CHECK(lines(outcome.err) == 5);
  CHECK_THAT(outcome.err, Contains("cannot write 'disk/page.html': No space left on device") &&
                              Contains("disk/paths.db: there is no room left on the disk"));
}

TEST_CASE("a read-only folder is refused before the run, and an unprivileged user needs no other") {
  const Place place;
  place.script("endless.lua", endless);
  place.script("quick.lua", quick);
  // The program may lie in a folder that others cannot reach.
  fs::copy_file(TRELLIS_BINARY, place / "program");
  fs::create_directories(place / "folder");
  fs::permissions(place / "folder", fs::perms::owner_write, fs::perm_options::remove);
  fs::permissions(place / "", fs::perms::owner_all | fs::perms::group_all | fs::perms::others_all);
  const std::string user = is_root() ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
  if (is_root() && place.shell(user + "true").status != 0) {
    WARN("skipped: setpriv is not installed");
    return;
  }
  for (const std::string output :
       {"--json folder/all.json", "--html folder/page.html", "--out folder/new", "--samples folder",
        "--figures folder/new", "--gltf folder/new", "--learn folder/paths.db"}) {
    const Outcome outcome = place.shell(user + "./program run endless.lua " + output);
    INFO(output << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK(lines(outcome.err) == 1);
    CHECK_THAT(outcome.err, Contains("folder"));
  }
  CHECK(place.shell(user + "./program new folder/mine").status == 2);
  CHECK(fs::is_empty(place / "folder"));
  // The installation is read-only and the home does not exist: the results are the same bytes.
  const Outcome mine = place.run({"run", "quick.lua", "--quiet", "--samples", "mine"});
  const Outcome theirs = place.shell("HOME=/nowhere " + user + "./program run quick.lua --quiet --samples theirs");
  INFO(mine.err << theirs.err);
  CHECK(theirs.status == 0);
  const std::string samples = content(place / "mine/cup/strategy/seed-1/samples.csv");
  CHECK_FALSE(samples.empty());
  CHECK(content(place / "theirs/cup/strategy/seed-1/samples.csv") == samples);
}

TEST_CASE("SIGINT, SIGTERM and SIGHUP end a run and a script with 128 + signal, one line and no file") {
  const Place place;
  place.script("endless.lua", endless);
  place.script("loop.lua", "while true do end\n");
  const auto before = names_in(place / "");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    for (const std::string script : {"endless.lua", "loop.lua"}) {
      const pid_t child = place.start({"run", script, "--json", "all.json", "--samples", "samples"});
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      ::kill(child, signal);
      const Outcome outcome = place.finish(child);
      INFO(script << " " << signal << "\n" << outcome.err);
      CHECK(outcome.status == 128 + signal);
      CHECK(outcome.out.empty());
      CHECK(outcome.err.ends_with("\n"));
      // One line, perhaps after an empty one or the warning of the closed world.
      const std::size_t line = outcome.err.rfind('\n', outcome.err.size() - 2) + 1;
      CHECK(outcome.err.substr(line).starts_with("trellis: "));
      CHECK((line <= 1 || outcome.err.substr(0, line).starts_with("trellis: warning: ")));
      CHECK(names_in(place / "") == before);
    }
  }
}

TEST_CASE("a signal that the caller ignores is ignored: nohup") {
  const Place place;
  place.script("quick.lua", quick);
  const Outcome outcome = place.shell("trap '' HUP; (sleep 0.05; kill -HUP $$) & exec $T run quick.lua --seeds 200");
  CHECK(outcome.status == 0);
}

TEST_CASE("two processes learn into one library at once, and lose nothing", "[slow]") {
  const Place place;
  place.script("solve.lua", solve);
  const Outcome both = place.shell(
      "for first in 1 21 41 61; do $T run solve.lua --quiet --seed $first --novelty 0 --learn paths.db & all+=($!); "
      "done; for one in ${all[@]}; do wait $one || exit 1; done");
  INFO(both.err);
  CHECK(both.status == 0);
  CHECK_THAT(place.run({"experience", "paths.db"}).out, Contains("paths.db: 80 paths\n"));
}

TEST_CASE("a library that was cut short is refused at every length, and left as it is", "[slow]") {
  const Place place;
  place.script("solve.lua", solve);
  REQUIRE(place.run({"run", "solve.lua", "--quiet", "--novelty", "0", "--learn", "paths.db"}).status == 0);
  const std::string whole = content(place / "paths.db");
  REQUIRE(whole.size() > 4096);
  for (std::size_t size = 1; size < whole.size(); size = size * 3 / 2 + 7) {
    CAPTURE(size);
    for (const std::string command : {"experience", "run"}) {
      std::ofstream(place / "cut.db", std::ios::binary) << whole.substr(0, size);
      const Outcome outcome = command == "run"
                                  ? place.run({"run", "solve.lua", "--quiet", "--novelty", "0", "--learn", "cut.db"})
                                  : place.run({"experience", "cut.db"});
      INFO(command << " " << size << "\n" << outcome.err);
      CHECK(outcome.status == 2);
      CHECK(lines(outcome.err) == 1);
      const bool unchanged = content(place / "cut.db") == whole.substr(0, size);
      CHECK(unchanged);
    }
  }
  // A journal of another library changes nothing.
  std::ofstream(place / "paths.db-journal") << "no journal at all";
  CHECK(place.run({"experience", "paths.db"}).status == 0);
}

TEST_CASE("a library of another robot has no path to guide by") {
  const Place place;
  place.script("solve.lua", solve);
  REQUIRE(place.run({"run", "solve.lua", "--quiet", "--learn", "paths.db"}).status == 0);
  place.script("other.lua",
               "return experience { db = 'paths.db' } >> rrt { bound = 0 }, problem { world = world { bounds = {0, 0, "
               "10, 10} }, "
               "robot = robot.point(), start = {1, 1}, goal = {9, 9} }\n");
  const Outcome outcome = place.run({"run", "other.lua", "--quiet", "--json", "all.json"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const auto document = trellis::test::with_levels(nlohmann::json::parse(content(place / "all.json")));
  const auto& levels = document.at("runs").at(0).at("levels");
  CHECK(levels.at(0).at("solved").get<bool>());
  CHECK_FALSE(levels.at(1).at("solved").get<bool>());
}

TEST_CASE("a failing --out loses no other output") {
  const Place place;
  place.script("quick.lua", quick);
  // A folder where a file belongs: the last outputs of --out fail.
  fs::create_directories(place / "results/report.html");
  const Outcome outcome = place.run({"run", "quick.lua", "--quiet", "--out", "results", "--json", "all.json", "--html",
                                     "page.html", "--samples", "samples"});
  INFO(outcome.err);
  CHECK(outcome.status == 2);
  CHECK(outcome.err == "trellis: cannot write 'results/report.html': Is a directory\n");
  CHECK_THAT(content(place / "all.json"), Catch::Matchers::EndsWith("}\n"));
  CHECK_THAT(content(place / "page.html"), Catch::Matchers::EndsWith("</html>\n"));
  CHECK_FALSE(fs::is_empty(place / "samples"));
  // Alone it ends the command, and the next one continues.
  const Outcome alone = place.run({"run", "quick.lua", "--quiet", "--out", "results"});
  CHECK(alone.status == 2);
  fs::remove(place / "results/report.html");
  CHECK(place.run({"run", "quick.lua", "--quiet", "--out", "results"}).status == 0);
}

TEST_CASE("a disk that fills up under --out loses no other output", "[slow]") {
  const Place place;
  place.script("quick.lua", quick);
  fs::create_directories(place / "disk");
  if (place.shell("unshare -m mount -t tmpfs -o size=32k none disk").status != 0) {
    WARN("skipped: only a privileged user can mount a small file system");
    return;
  }
  for (const std::string size : {"4k", "16k", "64k", "128k"}) {
    const Outcome outcome = place.shell("unshare -m bash -c \"mount -t tmpfs -o size=" + size +
                                        " none disk; '$T' run quick.lua --seeds 3 --quiet --out disk/out --json "
                                        "all.json --html page.html\"");
    INFO(size << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, Contains("cannot write 'disk/out/") && Contains("No space left on device"));
    CHECK_THAT(content(place / "all.json"), Catch::Matchers::EndsWith("}\n"));
    CHECK_THAT(content(place / "page.html"), Catch::Matchers::EndsWith("</html>\n"));
    fs::remove(place / "all.json");
    fs::remove(place / "page.html");
  }
}

TEST_CASE("SIGINT while runs are scored ends the run by itself, with what was planned") {
  const Place place;
  // Scoring takes minutes: the pool of each run's target is as large as it may be.
  const std::string scored =
      "return experiment { problems = scenes.cup(), strategies = { skeleton() >> rrt { step = 0.5 } }, seeds = 2, "
      "cross = 0, measure = ";
  place.script("tube.lua", scored + "tube { pool = 1e7, points = 1e7 } }\n");
  place.script("near.lua", scored + "near_optimal { nodes = 1e6 } }\n");
  for (const std::string script : {"tube.lua", "near.lua"}) {
    for (const std::string more : {"", " --ablate"}) {
      // The planning takes milliseconds.
      const Outcome outcome =
          place.shell("(sleep 3; kill -INT $$) & exec $T run " + script + more + " --jobs 2 --json all.json");
      INFO(script << more << "\n" << outcome.err);
      CHECK(outcome.status == 130);
      CHECK_THAT(outcome.err, Contains("interrupted; what is finished, and is kept: all runs, without their "
                                       "efficiencies"));
      CHECK_THAT(content(place / "all.json"), Catch::Matchers::EndsWith("}\n"));
      fs::remove(place / "all.json");
    }
  }
}

TEST_CASE("signals, closed pipes and full disks end training, merge, ablations and sessions as other commands",
          "[slow]") {
  const Place place;
  place.script("solve.lua", solve);
  place.script("endless.lua", endless);
  place.script("ablated.lua",
               "return experiment { problems = problem { world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, "
               "robot = robot.point(), start = {1, 1}, goal = {9, 9} }, measure = false, seeds = 1000, strategies = { "
               "both = (goal_bias(0.1) + bridge_test()) >> rrt { step = 0.001, proposals = 1e6 } } }\n");
  place.script(
      "inputs",
      "closed = problem { world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, robot = robot.point(), "
      "start = {1, 1}, goal = {9, 9} }\nplan(rrt { step = 0.001, proposals = 1e9 }, closed)\n");
  REQUIRE(place.shell("for k in 1 2; do $T sweep solve.lua --out shard-$k --shard $k/2; done").status == 0);
  for (const char* split : {"train", "validation"}) {
    fs::create_directories(place / ("data/family/" + std::string(split)));
    for (int i = 0; i < 4; ++i) {
      trellis::test::write_image((place / ("data/family/" + std::string(split) + "/" + std::to_string(i) + ".png")), 60,
                                 60, [&](std::size_t column, std::size_t row) {
                                   return column >= 28 && column < 32 && row / 12 != static_cast<std::size_t>(i);
                                 });
    }
  }
  const auto before = names_in(place / "");
  for (const auto& [name, number] : {std::pair{"INT", SIGINT}, std::pair{"TERM", SIGTERM}, std::pair{"HUP", SIGHUP}}) {
    for (const std::string command :
         {"run ablated.lua --ablate --json all.json", "experience --data data --out a.model --samples 1000000",
          "experience --data data --search --out a.model --rounds 1000", "repl < inputs"}) {
      const Outcome outcome = place.shell(std::string("(sleep 0.5; kill -") + name + " $$) & exec $T " + command);
      INFO(command << " " << name << "\n" << outcome.err);
      CHECK(outcome.status == 128 + number);
      CHECK(names_in(place / "") == before);
    }
  }
  const std::string train = "experience --data data --samples 50 --out ";
  REQUIRE(place.shell("$T " + train + "good.model").status == 0);
  for (const std::string& command : {train + "good.model", std::string("merge shard-1 shard-2 --sqlite all.sqlite"),
                                     std::string("run solve.lua --seeds 2")}) {
    const Outcome full = place.shell("$T " + command + " > /dev/full");
    INFO(command << "\n" << full.err);
    CHECK(full.status == 2);
    CHECK(full.err == "trellis: cannot write 'standard output': No space left on device\n");
    const Outcome closed = place.shell("mkfifo pipe; sleep 0 < pipe & exec 3> pipe; wait $!; $T " + command + " >&3");
    CHECK(closed.status == 141);
    CHECK(closed.err == "trellis: cannot write 'standard output': Broken pipe\n");
    fs::remove(place / "pipe");
  }
  const std::string model = content(place / "good.model");
  const auto kept = names_in(place / "");
  for (const std::string& command :
       {train + "good.model", std::string("merge shard-1 shard-2 --out merged"),
        std::string("merge shard-1 shard-2 --pdt pdt"), std::string("merge shard-1 shard-2 --sqlite new.sqlite")}) {
    const Outcome limited = place.shell("ulimit -f 1; $T " + command);
    INFO(command << "\n" << limited.err);
    CHECK(limited.status == 2);
    CHECK(lines(limited.err) == 1);
    CHECK(names_in(place / "") == kept);
  }
  CHECK(content(place / "good.model") == model);
}
