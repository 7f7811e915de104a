// SPDX-License-Identifier: GPL-3.0-or-later
// scripts/pays, trellis report --report costs, the module worlds and examples/pays: their output is complete.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"

namespace fs = std::filesystem;
using trellis::test::content;
using trellis::test::Place;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// A script that has the module of examples/pays beside it.
void script_with_pays(const Place& place, const std::string& name, const std::string& text) {
  fs::create_directories(place / "pays");
  fs::copy_file(fs::path(TRELLIS_SOURCE) / "examples/pays/experiment.lua", place / "pays/experiment.lua");
  place.script(name, "local pays = require 'pays.experiment'\n" + text);
}

/// scripts/pays with the built program; its exit status.
int pays(const Place& place, const std::string& options) {
  const std::string command = "TRELLIS_PROGRAM='" + std::string(TRELLIS_BINARY) + "' bash '" +
                              (fs::path(TRELLIS_SOURCE) / "scripts/pays").string() + "' " + options + " >'" +
                              (place / "pays.out") + "' 2>'" + (place / "pays.err") + "'";
  return std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe,cert-env33-c): the script is the test's subject
}

}  // namespace

TEST_CASE("scripts/pays writes tables and figures of the worlds and strategies that were asked for", "[pays][slow]") {
  const Place place;
  const std::string out = place / "pays";
  const int status = pays(place, "--seeds 1 --only cup --strategies 'skeleton >> rrt,shrink>>rrt' --out '" + out + "'");
  INFO(content(place / "pays.err"));
  REQUIRE(status == 0);

  const std::string table = content(out + "/table.md");
  for (const std::string title : {"# Costs beside rrt", "## All worlds together",
                                  "## Beside the planner without guides", "## World by world", "### paper, tuned on"}) {
    INFO(title);
    CHECK(table.find(title) != std::string::npos);
  }
  for (const std::string strategy : {"rrt", "lazy_prm", "skeleton >> rrt", "shrink >> rrt"}) {
    INFO(strategy);
    CHECK(table.find("\n| `" + strategy + "` | 1/1 | ") != std::string::npos);
  }
  CHECK(table.find("lazy >> rrt") == std::string::npos);
  // A header; four strategies beside the baseline and two beside their planner, each with checks and time.
  CHECK(lines_of(content(out + "/table.csv")).size() == 1 + 2 * 4 + 2 * 2);
  CHECK(fs::exists(out + "/results/cup.json"));
  for (const std::string format : {"svg", "png"}) {
    CHECK(fs::exists(out + "/figures/ratios." + format));
    CHECK(fs::exists(out + "/figures/ratios-own_planner." + format));
  }
  CHECK(content(place / "pays.out").find("costs divided by those of rrt_connect, 1 problem, 1 seed") !=
        std::string::npos);
}

TEST_CASE("scripts/pays --once has costs with shared set-ups beside those with all set-up in each run",
          "[pays][slow]") {
  const Place place;
  const std::string out = place / "pays";
  const int status = pays(place, "--once --seeds 1 --only cup --strategies 'skeleton >> rrt' --out '" + out + "'");
  INFO(content(place / "pays.err"));
  REQUIRE(status == 0);
  const std::vector<std::string> lines = lines_of(content(out + "/both.md"));
  // A header, a rule, and three strategies beside the baseline.
  REQUIRE(lines.size() == 2 + 3);
  CHECK(lines[0].starts_with(
      "| strategy | solved, tuned on | checks: shared | in each run | CPU time: shared | worst |"));
  for (const std::string& line : lines) CHECK(std::ranges::count(line, '|') == std::ranges::count(lines[0], '|'));
  CHECK(lines.back().starts_with("| `skeleton >> rrt` | 1/1 | "));
  CHECK(content(out + "/results/cup.json").find("\"queries\":1.0") == std::string::npos);
  CHECK(content(out + "/once/cup.json").find("\"queries\":1.0") != std::string::npos);
}

TEST_CASE("scripts/pays says what it does not know", "[pays]") {
  const Place place;
  const std::string out = " --out '" + (place / "pays") + "'";
  CHECK(pays(place, "--seeds 0" + out) != 0);
  CHECK(pays(place, "--only cupp" + out) != 0);
  CHECK(content(place / "pays.err").find("there is no 'cupp'; there are: paper, simple_passage") != std::string::npos);
  CHECK(pays(place, "--strategies 'skeleton >> rt'" + out) != 0);
  CHECK(content(place / "pays.err").find("there is no 'skeleton >> rt'") != std::string::npos);
  CHECK(pays(place, "--frobnicate") != 0);
}

TEST_CASE("no strategy and no group disappears from pays.experiment", "[pays]") {
  const Place place;
  script_with_pays(place, "groups.lua",
                   "for _, group in ipairs(pays.groups()) do print(group[1], #group[2], group.tuned) end\n"
                   "return pays.experiment { seeds = 1 }");
  const auto outcome = place.run({"check", "groups.lua"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  for (const std::string group :
       {"paper\t3\ttrue", "mazes\t3\ttrue", "gaps\t5\tfalse", "rooms\t3\tfalse", "other\t7\tfalse"}) {
    INFO(group);
    CHECK(outcome.out.find(group + "\n") != std::string::npos);
  }
  for (const std::string strategy :
       {"rrt_connect", "rrt", "lazy_prm", "skeleton >> rrt", "shrink >> rrt", "lazy >> rrt",
        "skeleton >> shrink >> rrt", "skeleton >> lazy >> rrt", "lazy >> lazy >> rrt",
        "skeleton >> shrink >> lazy >> rrt", "skeleton >> rrt_connect", "shrink >> rrt_connect", "lazy >> rrt_connect",
        "skeleton >> shrink >> rrt_connect", "skeleton >> lazy_prm"}) {
    INFO(strategy);
    CHECK(outcome.out.find("\n  " + strategy + ": ") != std::string::npos);
  }
}

TEST_CASE("pays.experiment runs in space, with steps that suit the world", "[pays]") {
  const Place place;
  script_with_pays(place, "space.lua", "return pays.experiment { space = true, only = {'slot'}, seeds = 1 }");
  const auto outcome = place.run({"check", "space.lua"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  for (const std::string strategy : {"rrt_connect", "workspace >> rrt_connect", "skeleton >> shrink >> rrt_connect",
                                     "workspace >> shrink >> lazy >> rrt_connect"}) {
    INFO(strategy);
    CHECK(outcome.out.find("\n  " + strategy + ": ") != std::string::npos);
  }
  CHECK(outcome.out.find("step = 0.333333") != std::string::npos);
}

TEST_CASE("every guide of the catalogue that searches a space or samples is in pays.catalogue", "[pays]") {
  const Place place;
  script_with_pays(place, "catalogue.lua", "return pays.experiment { catalogue = true, seeds = 1 }");
  const auto outcome = place.run({"check", "catalogue.lua"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  std::vector<std::string> missing;
  std::istringstream catalogue(content(fs::path(TRELLIS_SOURCE) / "docs/catalogue.md"));
  for (std::string line; std::getline(catalogue, line);) {
    if (!line.starts_with("| [")) continue;
    const std::string guide = line.substr(3, line.find(']') - 3);
    if (outcome.out.find("  " + guide) == std::string::npos) missing.push_back(guide);
  }
  // These require a file, functions of a script or a team.
  std::erase_if(missing, [](const std::string& guide) {
    return guide == "team" || guide == "decouple" || guide == "prioritise" || guide == "couple" ||
           guide == "experience" || guide == "path_database" || guide == "learned" || guide == "guiding_space";
  });
  INFO(missing.size() << " missing, the first: " << (missing.empty() ? "" : missing.front()));
  CHECK(missing.empty());
}

TEST_CASE("worlds are the same in every run, and every one has a path", "[pays][slow][worlds]") {
  const Place place;
  script_with_pays(
      place, "worlds.lua",
      "return experiment { problems = { worlds.maze { cells = 6 }, worlds.false_gaps { rows = 2 }, "
      "worlds.rooms { rooms = 3 }, worlds.slalom { gates = 3 }, worlds.dead_ends(), worlds.bug_trap(), "
      "pays.groups({ catalogue = true, only = { 'misleading' } })[1][2] }, "
      "strategies = { connect = rrt_connect { step = 0.5, proposals = 200000 } }, measure = false, seeds = 1 }");
  for (const std::string seed : {"1", "5"}) {
    const auto outcome = place.run({"run", "worlds.lua", "--seed", seed, "--json", seed + ".json", "--quiet"});
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    const std::string json = content(place / (seed + ".json"));
    CHECK(json.find("\"status\":\"budget_spent\"") == std::string::npos);
  }
  place.script("refused.lua", "return rrt {}, worlds.false_gaps { kind = 'wide' }");
  CHECK(place.run({"check", "refused.lua"}).err.find("field 'kind' must be \"narrow\", \"bent\" or \"mixed\"") !=
        std::string::npos);
  CHECK(place.run({"run", "worlds.lua", "--quiet", "--problem", "detour", "--json", "a.json"}).status == 0);
  CHECK(place.run({"report", "a.json", "--report", "costs"}).err ==
        "trellis: --report costs: the files have one strategy, so there is nothing to compare it with\n");
  CHECK(place.run({"report", "nothing.json"}).status == 2);
  CHECK(place.run({"report", "a.json", "--report", "costs", "--baseline", "conect"}).err ==
        "trellis: there is no strategy 'conect' (did you mean 'connect'?); there are: connect\n");
}

TEST_CASE("worlds of space are the same in every run, and every one has a path", "[pays][slow][worlds]") {
  const Place place;
  script_with_pays(
      place, "space.lua",
      "return experiment { problems = { worlds.slot(), worlds.windows { walls = 1 }, "
      "worlds.floating_boxes { seed = 3 }, pays.groups({ space = true, only = { 'open_space' } })[1][2] }, "
      "strategies = { connect = rrt_connect { step = 0.5, proposals = 200000 } }, measure = false, seeds = 1 }");
  for (const std::string seed : {"1", "5"}) {
    const auto outcome = place.run({"run", "space.lua", "--seed", seed, "--json", seed + ".json", "--quiet"});
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK(content(place / (seed + ".json")).find("\"status\":\"budget_spent\"") == std::string::npos);
  }
  place.script("hashes.lua",
               "print(worlds.windows {}.world, worlds.floating_boxes { boxes = 20 }.world) "
               "return rrt {}, worlds.slot {}");
  const auto first = place.run({"check", "hashes.lua"});
  CHECK(first.status == 0);
  CHECK(place.run({"check", "hashes.lua"}).out == first.out);
}

TEST_CASE("a false window is one: a body of less than half the size passes, the plank does not",
          "[pays][slow][worlds]") {
  const Place place;
  place.script("window.lua", R"(
    local function wall(name, size)
      return problem {
        name = name,
        world = world {
          bounds = {0, 0, 0, 6, 2.5, 2.5},
          box {2.75, 0, 0, 3.25, 0.9, 2.5}, box {2.75, 1.6, 0, 3.25, 2.5, 2.5},
          box {2.75, 0.9, 0, 3.25, 1.6, 1.05}, box {2.75, 0.9, 1.45, 3.25, 1.6, 2.5},
        },
        robot = robot.rigid { box {-0.8 * size, -0.5 * size, -0.1 * size, 0.8 * size, 0.5 * size, 0.1 * size} },
        start = pose {1, 1.25, 1.25}, goal = pose {5, 1.25, 1.25},
      }
    end
    return experiment {
      problems = { wall("whole", 1), wall("small", 0.45) },
      strategies = { connect = rrt_connect { step = 0.3, proposals = 20000 } }, measure = false, seeds = 2,
    }
  )");
  REQUIRE(place.run({"run", "window.lua", "--json", "window.json", "--quiet"}).status == 0);
  const std::string json = content(place / "window.json");
  const auto ended = [&](const std::string& name, const std::string& status) {
    return json.find("\"problem\":\"" + name + "\",\"strategy\":\"connect\",\"seed\":1,\"status\":\"" + status +
                     "\"") != std::string::npos;
  };
  CHECK(ended("whole", "budget_spent"));
  CHECK(ended("small", "solved"));
}

TEST_CASE("a false gap is one: half the robot passes, the robot does not", "[pays][slow][worlds]") {
  const Place place;
  // The wall of one row, without its true gap.
  place.script("bent.lua", R"(
    local function wall(name, size, width)
      local x, y = 3, 2
      return problem {
        name = name,
        world = world {
          bounds = {0, 0, 7.2, 6},
          box {x, 0, x + 0.45, y}, box {x, y + width, x + 0.45, 6},
          box {x + 0.45, 0, x + 0.75, y}, box {x + 0.45, y + 0.9 + width, x + 0.75, 6},
          box {x + 0.75, 0, x + 1.2, y + 0.9}, box {x + 0.75, y + 0.9 + width, x + 1.2, 6},
        },
        robot = robot.rectangle(0.6 * size, 0.2 * size), start = {1, 3, 0}, goal = {6.2, 3, 0},
      }
    end
    return experiment {
      problems = { wall("whole", 1, 0.3), wall("half", 0.5, 0.3) },
      strategies = { connect = rrt_connect { step = 0.2, proposals = 60000 } }, measure = false, seeds = 2,
    }
  )");
  REQUIRE(place.run({"run", "bent.lua", "--json", "bent.json", "--quiet"}).status == 0);
  const std::string json = content(place / "bent.json");
  const auto solved = [&](const std::string& name, const std::string& status) {
    return json.find("\"problem\":\"" + name + "\",\"strategy\":\"connect\",\"seed\":1,\"status\":\"" + status +
                     "\"") != std::string::npos;
  };
  CHECK(solved("whole", "budget_spent"));
  CHECK(solved("half", "solved"));
}
