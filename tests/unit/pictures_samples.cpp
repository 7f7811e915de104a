// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds, robots and samples of results as plain data.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/pictures/base64.hpp>
#include <trellis/pictures/packed_run.hpp>
#include <trellis/pictures/packing.hpp>
#include <trellis/pictures/scenery.hpp>
#include <trellis/pictures/stored_samples.hpp>

#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Json = nlohmann::ordered_json;

namespace {

Experiment nested_and_plain() {
  Experiment experiment;
  experiment.problems = {test::cup_problem(), test::cup_problem()};
  experiment.problems[1].name = "again";
  experiment.strategies = {{"rrt", fixture::plain()}, {"nested", fixture::nested()}};
  experiment.seeds = {1, 2};
  experiment.measure.reset();
  return experiment;
}

}  // namespace

TEST_CASE("base 64 gives back the bytes, and refuses other texts", "[pictures]") {
  std::string bytes;
  for (int i = 0; i < 300; ++i) {
    CHECK(from_base64(base64(bytes)) == bytes);
    bytes += static_cast<char>(i * 37);
  }
  CHECK_THROWS_AS(from_base64("ab!d"), Error);
}

TEST_CASE("problems of one world and robot share them in the scenery", "[pictures]") {
  Experiment experiment = nested_and_plain();
  experiment.problems.push_back(test::make_problem("other", test::rectangle_world({{4, 0, 6, 4}}),
                                                   test::rectangle_robot(), {1, 8.5, 0}, {9, 1.5, 0}));
  const Scenery scenery = scenery_of(experiment);
  const Json worlds = Json::parse(scenery.worlds);
  const Json scenes = Json::parse(scenery.scenes);
  REQUIRE(worlds.size() == 2);
  REQUIRE(scenes.size() == 3);
  CHECK(scenes[0]["world"] == scenes[1]["world"]);
  CHECK(scenes[2]["world"] != scenes[0]["world"]);
  CHECK(worlds[scenes[2]["world"].get<std::size_t>()]["obstacles"] ==
        Json::parse("[[4.0,0.0,6.0,0.0,6.0,4.0,4.0,4.0]]"));
  CHECK(scenes[0]["position"] == Json::parse("[0,1]"));
  CHECK(scenes[0]["axes"].size() == experiment.problems[0].space.dimension());
  CHECK(Json::parse(scenery.robots)[scenes[0]["robot"].get<std::size_t>()]["kind"] == "planar");
}

TEST_CASE("stored samples are those in memory, for every run", "[pictures]") {
  const Experiment experiment = nested_and_plain();
  const ExperimentResult result = run(experiment);
  const ExperimentFacts facts = facts_of(experiment, result);
  const test::Folder folder;
  write_packed_samples(experiment, result, folder.path().string());
  StoredSamples stored(folder.path().string(), facts);
  PackedRuns packed(experiment, result);
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    const Json read = Json::parse(stored.run(i));
    CHECK(read == Json::parse(packed.run(i)));
    for (std::size_t k = 0; k < read["levels"].size(); ++k) {
      const Search& search = result.runs[i].levels[k].record.search;
      const Json& level = read["levels"][k];
      CHECK(from_base64(level["fates"].get<std::string>()).size() == search.proposals.size());
      // Each coordinate within a 16-bit step of its axis.
      const std::string nodes = from_base64(level["nodes"].get<std::string>());
      REQUIRE(nodes.size() == 2 * search.nodes.values().size());
      for (std::size_t j = 0; j < search.nodes.values().size(); ++j) {
        const Json& axis = level["axes"][j % level["axes"].size()];
        const double lo = axis[1].get<double>();
        const double extent = axis[2].get<double>() - lo;
        const unsigned share =
            static_cast<unsigned char>(nodes[2 * j]) + 256U * static_cast<unsigned char>(nodes[2 * j + 1]);
        REQUIRE(std::abs(lo + extent * share / 65535.0 - search.nodes.values()[j]) <= extent / 65535.0);
      }
    }
  }
  CHECK(Json::parse(stored.robots()) == Json::parse(packed.robots()));
  // The robots of the document come first, so that its indices hold here too.
  const Json robots = Json::parse(scenery_of(experiment).robots);
  for (std::size_t i = 0; i < robots.size(); ++i) CHECK(Json::parse(stored.robots())[i] == robots[i]);

  // A damaged file is named.
  for (const char* text : {"", "{\"levels\": []}", "[1, 2]", "{\"levels\": [], \"turns\": [], \"path\": null"}) {
    const auto file =
        folder.path() / Json::parse(std::ifstream(folder.path() / "index.json"))["runs"][0]["file"].get<std::string>();
    std::ofstream(file) << text;
    CHECK_THROWS_WITH(stored.run(0), Catch::Matchers::Contains("run.json: these are no samples"));
  }
  std::filesystem::remove(folder.path() / "index.json");
  CHECK_THROWS_AS(StoredSamples(folder.path().string(), facts), Error);
}

TEST_CASE("a thinned run has a share of its samples, and refuses damaged ones", "[pictures]") {
  const Experiment experiment = nested_and_plain();
  const ExperimentResult result = run(experiment);
  PackedRuns packed(experiment, result);
  const Json whole = Json::parse(packed.run(2));
  CHECK(thinned_run(whole, 1.0) == whole);
  const Json part = thinned_run(whole, 0.25);
  for (std::size_t k = 0; k < whole["levels"].size(); ++k) {
    const auto count = [&](const Json& run) {
      return from_base64(run["levels"][k]["fates"].get<std::string>()).size();
    };
    CHECK(std::abs(static_cast<double>(count(part)) - 0.25 * static_cast<double>(count(whole))) <= 2.0);
    CHECK(part["levels"][k]["all"] == whole["levels"][k]["all"]);
  }
  Json damaged = whole;
  damaged["levels"][0]["nodes"] = "";
  CHECK_THROWS_AS(thinned_run(damaged, 0.5), Error);
  damaged = whole;
  for (const char* part : {"near", "added", "parents", "edges", "source"}) {
    // The largest number, one that does not end, and none.
    for (const char* text : {"/////////////wE=", "//8=", "no"}) {
      CAPTURE(part, text);
      damaged = whole;
      damaged["levels"][0][part] = text;
      CHECK_THROWS_AS(thinned_run(damaged, 0.5), Error);
    }
    damaged["levels"][0].erase(part);
    CHECK_THROWS_AS(thinned_run(damaged, 0.5), Error);
  }
  damaged = whole;
  damaged["turns"][0][0] = 99;
  CHECK_THROWS_AS(thinned_run(damaged, 0.5), Error);
}
