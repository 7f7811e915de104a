// SPDX-License-Identifier: GPL-3.0-or-later
// Libraries of solved problems and learnt heuristics, as users create and use them.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/image.hpp"
#include "support/process.hpp"
#include "support/timeless.hpp"

using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

const std::string solve =
    "return experiment { problems = { scenes.cup() }, strategies = { connect = rrt_connect {} }, seeds = 3, measure = "
    "false }\n";
const std::string go_by =
    "return experiment { problems = { scenes.cup() }, strategies = { lightning = experience { db = 'paths.db' } >> rrt "
    "{} }, seeds = 3, measure = false }\n";

std::string without_times(const std::string& text) {
  nlohmann::json json = nlohmann::json::parse(text);
  trellis::test::remove_times(json);
  return json.dump(1);
}

/// A family of worlds: a wall with a gap, elsewhere in each.
void draw_family(const fs::path& folder) {
  for (const auto& [split, count] : {std::pair("train", 8), std::pair("validation", 4)}) {
    fs::create_directories(folder / split);
    for (int i = 0; i < count; ++i) {
      const std::size_t gap = 5U + 4U * static_cast<std::size_t>(i);
      trellis::test::write_image((folder / split / (std::to_string(i) + ".png")).string(), 60, 60,
                                 [&](std::size_t column, std::size_t row) {
                                   return column >= 28 && column < 32 && (row < gap || row >= gap + 6);
                                 });
    }
  }
}

}  // namespace

TEST_CASE("paths are learnt, listed and gone by") {
  const Place place;
  place.script("solve.lua", solve);
  place.script("use.lua", go_by);
  const auto missing = place.run({"run", "use.lua"});
  CHECK(missing.status == 2);
  CHECK_THAT(missing.err, Contains("use.lua:1: ") && Contains("there is no file 'paths.db'"));

  const auto learnt = place.run({"run", "solve.lua", "--learn", "paths.db", "--novelty", "0"});
  CHECK(learnt.status == 0);
  CHECK_THAT(learnt.err, Contains("paths.db: 3 of 3 paths found were new and added"));
  const auto again = place.run({"run", "solve.lua", "--learn", "paths.db"});
  CHECK_THAT(again.err, Contains("paths.db: 0 of 3 paths found were new and added"));

  const auto listed = place.run({"experience", "paths.db"});
  CHECK(listed.status == 0);
  CHECK_THAT(listed.out, Contains("paths.db: 3 paths") && Contains("cup") && Contains("SE(2)"));
  const auto each = place.run({"experience", "paths.db", "--list"});
  CHECK(std::count(each.out.begin(), each.out.end(), '\n') == 2 + 1 + 3);

  const std::vector<std::string> use = {"run", "use.lua", "--json", "one.json"};
  CHECK(place.run(use).status == 0);
  CHECK(place.run({"run", "use.lua", "--json", "two.json", "--jobs", "3", "--learn", "paths.db", "--novelty", "0"})
            .status == 0);
  CHECK(without_times(content(place / "one.json")) == without_times(content(place / "two.json")));
  CHECK_THAT(content(place / "one.json"), Contains("experience(\\\"paths.db\\\")"));
}

TEST_CASE("a script may go by the library that its own run makes") {
  const Place place;
  place.script("use.lua", go_by);
  const auto first = place.run({"run", "use.lua", "--learn", "paths.db"});
  CHECK(first.status == 0);
  CHECK_THAT(first.err, Contains("new and added"));
}

TEST_CASE("unusable libraries are reported before the first run") {
  const Place place;
  place.script("solve.lua", solve);
  place.script("use.lua", go_by);
  place.script("paths.db", "this is no database, however long it may be");
  const std::string before = content(place / "paths.db");
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"run", "solve.lua", "--learn", "paths.db"},
                                                                     {"run", "use.lua"},
                                                                     {"check", "use.lua"},
                                                                     {"experience", "paths.db"}}) {
    const auto outcome = place.run(arguments);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, Contains("is no library of paths"));
  }
  CHECK(content(place / "paths.db") == before);
  CHECK_THAT(place.run({"experience", "none.db"}).err, Contains("there is no such library of paths"));
  CHECK_THAT(place.run({"run", "solve.lua", "--learn", "no/such/folder.db"}).err, Contains("no/such/folder.db"));
  CHECK_THAT(place.run({"run", "solve.lua", "--novelty", "1"}).err, Contains("--novelty: nothing is learnt"));
  CHECK_THAT(place.run({"run", "solve.lua", "--learn", "a.db", "--novelty", "far"}).err,
             Contains("--novelty must be a number of at least 0, got 'far'"));
}

TEST_CASE("a script reaches the libraries in its folder, and others where it is trusted") {
  const Place place;
  fs::create_directories(place / "scripts");
  place.script("solve.lua", solve);
  REQUIRE(place.run({"run", "solve.lua", "--learn", "paths.db"}).status == 0);
  const std::string above = "return experience { db = '../paths.db' } >> rrt {}, scenes.cup()\n";
  const std::string absolute = "return experience { db = '" + (place / "paths.db") + "' } >> rrt {}, scenes.cup()\n";
  for (const std::string& text : {above, absolute}) {
    std::ofstream(place / "scripts/use.lua") << text;
    const auto held = place.run({"check", "scripts/use.lua"});
    CHECK(held.status == 2);
    CHECK_THAT(held.err, Contains("does not lie in the script's folder; --trust"));
    CHECK(place.run({"check", "scripts/use.lua", "--trust"}).status == 0);
  }
  // Relative to the script, for every working directory.
  std::ofstream(place / "scripts/use.lua") << "return experience { db = 'paths.db' } >> rrt {}, scenes.cup()\n";
  fs::copy_file(place / "paths.db", place / "scripts/paths.db");
  CHECK(place.run({"check", "scripts/use.lua"}).status == 0);
}

TEST_CASE("a heuristic is trained on worlds drawn as images, and used", "[slow]") {
  const Place place;
  draw_family(place / "data/gaps");
  const std::vector<std::string> train = {"experience", "--data", "data", "--out", "gaps.model", "--samples", "200"};
  const auto trained = place.run(train);
  INFO(trained.err);
  REQUIRE(trained.status == 0);
  CHECK_THAT(trained.out,
             Contains("trained on 8 worlds of gaps, 200 cells each, seed 1") && Contains("validation, nats"));
  const std::string model = content(place / "gaps.model");
  REQUIRE(place.run(train).status == 0);
  CHECK(content(place / "gaps.model") == model);

  place.script("use.lua",
               "local world = scenes.load('data/gaps/validation/1.png')\n"
               "return experiment { problems = world, strategies = { learned { model = 'gaps.model' } >> rrt {} }, "
               "measure = tube {} }\n");
  CHECK(place.run({"check", "use.lua"}).status == 0);
  const auto used = place.run({"run", "use.lua"});
  INFO(used.err);
  CHECK(used.status == 0);
}

TEST_CASE("a search heuristic is trained on worlds drawn as images, and searches the grid of a workspace") {
  const Place place;
  draw_family(place / "data/gaps");
  const std::vector<std::string> train = {"experience", "--search", "--data",   "data", "--out",     "gaps.model",
                                          "--cells",    "30",       "--rounds", "2",    "--samples", "20"};
  const auto trained = place.run(train);
  INFO(trained.err);
  REQUIRE(trained.status == 0);
  CHECK_THAT(trained.out, Contains("trained on searches of 8 worlds of gaps, 30 cells along the longer side, 2 rounds, "
                                   "20 vertices of each search, seed 1") &&
                              Contains("Euclidean"));
  const std::string model = content(place / "gaps.model");
  REQUIRE(place.run(train).status == 0);
  CHECK(content(place / "gaps.model") == model);

  const auto script = [](const std::string& planner) {
    return "local world = scenes.load('data/gaps/validation/1.png')\n"
           "return experiment { problems = world, strategies = { workspace { planner = " +
           planner + " } >> rrt { step = 0.2 } }, measure = false }\n";
  };
  place.script("use.lua", script("best_first { model = 'gaps.model' }"));
  CHECK(place.run({"check", "use.lua"}).status == 0);
  const auto used = place.run({"run", "use.lua"});
  INFO(used.err);
  CHECK(used.status == 0);
  CHECK_THAT(used.out, Contains("best_first"));

  // The guide requires another kind of model than the planner.
  place.script("wrong.lua", "return learned { model = 'gaps.model' } >> rrt {}, scenes.cup()\n");
  CHECK_THAT(place.run({"run", "wrong.lua"}).err,
             Contains("the model is a search heuristic") && Contains("expected a classifier of cells"));
  REQUIRE(place.run({"experience", "--data", "data", "--out", "cells.model", "--samples", "50"}).status == 0);
  place.script("wrong.lua", script("best_first { model = 'cells.model' }"));
  CHECK_THAT(place.run({"run", "wrong.lua"}).err,
             Contains("the model is a classifier of cells") && Contains("trellis experience --search"));
  place.script("wrong.lua", script("best_first { model = 'none.model' }"));
  CHECK_THAT(place.run({"check", "wrong.lua"}).err,
             Contains("best_first: option 'model': there is no file") && Contains("trellis experience --search"));
  // A planner's file, too, lies relative to the script, in its folder unless the script is trusted.
  fs::create_directories(place / "scripts");
  std::ofstream(place / "scripts/use.lua")
      << "return workspace { planner = best_first '../gaps.model' } >> rrt {}, scenes.cup()\n";
  CHECK_THAT(place.run({"check", "scripts/use.lua"}).err, Contains("does not lie in the script's folder"));
  CHECK(place.run({"check", "scripts/use.lua", "--trust"}).status == 0);
  CHECK_THAT(place.run({"experience", "--data", "data", "--out", "a.model", "--rounds", "3"}).err,
             Contains("--rounds") && Contains("--search"));
  CHECK_THAT(place.run({"experience", "--search", "--data", "data", "--out", "a.model", "--cells", "1"}).err,
             Contains("--cells"));
}

TEST_CASE("unusable training data are reported") {
  const Place place;
  CHECK_THAT(place.run({"experience", "--data", "none", "--out", "a.model"}).err,
             Contains("there is no folder 'none'"));
  fs::create_directories(place / "data");
  CHECK_THAT(place.run({"experience", "--data", "data", "--out", "a.model"}).err,
             Contains("there is no family in 'data'"));
  draw_family(place / "data/gaps");
  CHECK_THAT(place.run({"experience", "--data", "data", "--out", "a.model", "--family", "gasp"}).err,
             Contains("there is no family 'gasp'") && Contains("did you mean 'gaps'?"));
  std::ofstream(place / "data/gaps/train/9.png") << "\x89PNG\r\n\x1a\nbut no more";
  const auto damaged = place.run({"experience", "--data", "data", "--out", "a.model"});
  CHECK(damaged.status == 2);
  CHECK_THAT(damaged.err, Contains("9.png: the image cannot be read"));
  CHECK_FALSE(fs::exists(place / "a.model"));
  place.script("use.lua", "return learned { model = 'a.model' } >> rrt {}, scenes.cup()\n");
  CHECK_THAT(place.run({"check", "use.lua"}).err, Contains("there is no file 'a.model'"));
  place.script("a.model", "no model");
  CHECK_THAT(place.run({"check", "use.lua"}).err, Contains("a.model: is no model of trellis experience"));
}

TEST_CASE("killed while it learns, a run leaves a library that opens") {
  const Place place;
  place.script("solve.lua", solve);
  for (int round = 0; round < 6; ++round) {
    const pid_t child = place.start({"run", "solve.lua", "--quiet", "--learn", "paths.db", "--novelty", "0"});
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + 60 * round));
    ::kill(child, SIGKILL);
    static_cast<void>(place.finish(child));
    if (!fs::exists(place / "paths.db")) continue;
    const auto listed = place.run({"experience", "paths.db"});
    CAPTURE(round, listed.err);
    CHECK(listed.status == 0);
  }
}
