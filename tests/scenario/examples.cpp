// SPDX-License-Identifier: GPL-3.0-or-later
// The examples, run as their readers run them, and what they are meant to show.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"

using Json = nlohmann::json;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

std::string example(const std::string& name) { return (fs::path(TRELLIS_SOURCE) / "examples" / name).string(); }

struct Result {
  trellis::test::Outcome outcome;
  Json document;
};

/// Each example runs once, however many THENs look at it.
const Result& run(const std::string& name) {
  static std::map<std::string, Result> done;
  if (const auto it = done.find(name); it != done.end()) return it->second;
  const Place place;
  Result& result = done[name];
  result.outcome = place.run({"run", example(name), "--json", "all.json", "--jobs", "2"});
  const std::string text = trellis::test::content(place / "all.json");
  if (!text.empty()) result.document = Json::parse(text);
  return result;
}

std::vector<Json> runs_of(const Json& document, const std::string& strategy) {
  std::vector<Json> runs;
  for (const auto& run : document["runs"]) {
    if (run["strategy"] == strategy) runs.push_back(run);
  }
  return runs;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::vector<double> field(const std::vector<Json>& runs, const std::string& name) {
  std::vector<double> values;
  for (const auto& run : runs) values.push_back(run[name].get<double>());
  return values;
}

bool scenes_are_here() {
  const char* named = std::getenv("TRELLIS_SCENES");
  if (fs::is_directory(named != nullptr ? named : TRELLIS_SCENES_DEFAULT)) return true;
  WARN("skipped: the folder of scenes made by others is not here (TRELLIS_SCENES)");
  return false;
}

}  // namespace

SCENARIO("skeletons feed shrunken robots that feed lazy checks", "[examples]") {
  GIVEN("the nested strategy beside a plain RRT on the simple passage, 15 seeds") {
    const Result& result = run("nested.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    const auto nested = runs_of(result.document, "nested");
    const auto plain = runs_of(result.document, "rrt");
    REQUIRE(nested.size() == 15);
    REQUIRE(plain.size() == 15);

    THEN("every run has a path from start to goal") {
      for (const auto& run : result.document["runs"]) {
        CHECK(run["solved"] == true);
        CHECK(run["path"].front() == Json({1.0, 8.5, 0.0}));
        CHECK(run["path"].back() == Json({9.0, 1.5, 0.0}));
      }
    }
    THEN("each nested run has four levels, each with its space, its counts and its efficiency") {
      const std::vector<std::string> names = {"root", "lazy()", "shrink(0.5)", "skeleton()"};
      for (const auto& run : nested) {
        REQUIRE(run["levels"].size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
          const auto& level = run["levels"][i];
          CHECK(level["level"] == i);
          CHECK(level["name"] == names[i]);
          CHECK(level["dimension"] == (i == 3 ? 2 : 3));
          CHECK(level["solves"] >= 1);
          CHECK(level["efficiency"]["tree"]["value"].is_number());
          CHECK(level["root_efficiency"]["tree"]["value"].is_number());
        }
        // What presumes checks nothing; what is searched exactly proposes nothing, and has no figure for it.
        CHECK(run["levels"][1]["validity_checks"] == 0);
        CHECK(run["levels"][3]["proposals"] == 0);
        CHECK(run["levels"][3]["efficiency"]["expansion"]["value"].is_null());
      }
    }
    THEN("the nested strategy spends fewer validity checks and samples more efficiently") {
      CHECK(median(field(nested, "validity_checks")) < median(field(plain, "validity_checks")));
      const auto tree = [](const std::vector<Json>& runs) {
        std::vector<double> values;
        for (const auto& run : runs) values.push_back(run["levels"][0]["efficiency"]["tree"]["value"].get<double>());
        return median(values);
      };
      CHECK(tree(nested) < tree(plain));
    }
    THEN("the report names every level and both strategies") {
      for (const auto* word : {"root", "lazy()", "shrink(0.5)", "skeleton()", "rrt", "nested", "summary", "uniform"}) {
        CHECK(result.outcome.out.find(word) != std::string::npos);
      }
    }
  }
}

SCENARIO("the other examples run to their end", "[examples]") {
  for (const auto* name : {"minimal.lua", "mixtures.lua", "own_scene.lua", "pca.lua", "two_joint_arm.lua"}) {
    GIVEN(name) {
      const Result& result = run(name);
      INFO(result.outcome.err);
      CHECK(result.outcome.status == 0);
      REQUIRE(result.document["runs"].size() >= 1);
      const auto& runs = result.document["runs"];
      const auto solved =
          std::count_if(runs.begin(), runs.end(), [](const Json& run) { return run["solved"] == true; });
      CHECK(solved * 10 >= static_cast<std::ptrdiff_t>(runs.size()) * 9);
    }
  }
}

SCENARIO("the methods of the paper and those beyond it, on its three scenes, with nothing tuned to a scene",
         "[examples][methods]") {
  GIVEN("every method, three seeds") {
    const auto results_of = [](const std::string& script) {
      const Place place;
      const auto outcome = place.run(
          {"run", example(script), "--seeds", "3", "--cross", "0", "--json", "all.json", "--jobs", "2", "--quiet"});
      INFO(outcome.err);
      REQUIRE(outcome.status == 0);
      return Json::parse(trellis::test::content(place / "all.json"));
    };
    // The library's presets bear the methods' own names in their script.
    static const Json document = [&] {
      Json all = results_of("paper.lua");
      const Json presets = results_of("parasol.lua");
      for (auto run : presets["runs"]) {
        run["strategy"] = "parasol_" + run["strategy"].get<std::string>();
        all["runs"].push_back(run);
      }
      for (auto strategy : presets["experiment"]["strategies"]) {
        strategy["name"] = "parasol_" + strategy["name"].get<std::string>();
        all["experiment"]["strategies"].push_back(strategy);
      }
      return all;
    }();
    const auto levels_of = [&](const std::string& strategy) {
      std::vector<Json> levels;
      for (const auto& run : runs_of(document, strategy)) {
        for (const auto& level : run["levels"]) levels.push_back(level);
      }
      return levels;
    };
    const auto checks = [&](const std::string& strategy) {
      return median(field(runs_of(document, strategy), "validity_checks"));
    };

    THEN("each method solves most of its nine runs") {
      REQUIRE(document["experiment"]["strategies"].size() == 13);
      for (const auto& strategy : document["experiment"]["strategies"]) {
        const std::string name = strategy["name"];
        CAPTURE(name);
        const auto runs = runs_of(document, name);
        REQUIRE(runs.size() == 9);
        // A roadmap of uniform nodes alone seldom finds a narrow passage within its budget.
        const int least = name == "parasol_lazy_prm" ? 3 : 6;
        CHECK(std::count_if(runs.begin(), runs.end(), [](const Json& run) { return run["solved"] == true; }) >= least);
      }
    }
    THEN("a lazy roadmap's tree is the nodes that were looked at, and expansion does not apply to it") {
      for (const auto* name : {"lazy_prm", "parasol_lazy_prm"}) {
        for (const auto& level : levels_of(name)) {
          if (level["solved"] != true) continue;
          const auto& tree = level["efficiency"]["tree"];
          CHECK(tree["n"].get<double>() < level["nodes"].get<double>());
          CHECK(tree["n"].get<double>() <= level["validity_checks"].get<double>());
          CHECK(level["efficiency"]["expansion"]["value"].is_null());
        }
      }
    }
    THEN("presets of the library propose no goals, the others do") {
      const auto goals = [&](const std::string& strategy) {
        double sum = 0.0;
        for (const auto& level : levels_of(strategy)) {
          for (const auto& source : level["sources"]) {
            if (source["name"] == "goal") sum += source["proposals"].get<double>();
          }
        }
        return sum;
      };
      for (const auto* name : {"rrt", "dr_rrt", "irc"}) {
        CHECK(goals(name) > 0.0);
        CHECK(goals(std::string("parasol_") + name) == 0.0);
      }
    }
    THEN("relaxation has a level for each scale, half of whose guided proposals are uniform") {
      double uniform = 0.0;
      double all = 0.0;
      for (const auto& run : runs_of(document, "parasol_irc")) {
        REQUIRE(run["levels"].size() == 4);
        for (std::size_t i = 0; i < 3; ++i) {
          for (const auto& source : run["levels"][i]["sources"]) {
            if (source["name"] == "uniform") uniform += source["proposals"].get<double>();
          }
          all += run["levels"][i]["proposals"].get<double>();
        }
      }
      CHECK(uniform / all == Approx(0.5).margin(0.03));
    }
    THEN("the densities of what regions, relaxation, their mixture and their blend proposed are known") {
      for (const auto* name : {"rrt", "dr_rrt", "irc", "vonasek", "hybrid", "blend"}) {
        CAPTURE(name);
        for (const auto& level : levels_of(name)) {
          const auto& expansion = level["efficiency"]["expansion"];
          if (expansion["value"].is_null()) continue;
          CHECK(expansion["estimator"] == "exact");
        }
      }
    }
    THEN("guidance by the skeleton and by relaxation costs fewer checks than none") {
      CHECK(checks("dr_rrt") < checks("rrt"));
      CHECK(checks("nested") < checks("rrt"));
    }
  }
}

SCENARIO("the circle world that others made, with its 100 queries", "[examples][real]") {
  if (!scenes_are_here()) return;
  GIVEN("RRT, RRT-Connect, PRM and a skeleton-guided RRT") {
    const Result& result = run("real/circles.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    for (const auto* strategy : {"rrt", "rrt_connect", "prm", "skeleton"}) {
      THEN(std::string(strategy) + " solves at least 95 % of the queries, with a mean length under 100 m") {
        const auto runs = runs_of(result.document, strategy);
        REQUIRE(runs.size() == 100);
        double length = 0.0;
        int solved = 0;
        for (const auto& run : runs) {
          if (run["solved"] != true) continue;
          ++solved;
          length += run["length"].get<double>();
        }
        CHECK(solved >= 95);
        CHECK(length / solved < 100.0);
      }
    }
    THEN("guidance by the skeleton costs fewer checks than none") {
      CHECK(median(field(runs_of(result.document, "skeleton"), "validity_checks")) <
            median(field(runs_of(result.document, "rrt"), "validity_checks")));
    }
  }
}

SCENARIO("planar arms with 6 and 20 links that others made", "[examples][real]") {
  if (!scenes_are_here()) return;
  GIVEN("the three arms of SBPL") {
    const Result& result = run("real/sbpl.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    THEN("RRT-Connect finds a path for one of 6 links and for that of 20, with every seed") {
      const auto runs = runs_of(result.document, "rrt_connect");
      REQUIRE(runs.size() == 9);
      for (const auto& run : runs) {
        const std::string problem = run["problem"];
        CAPTURE(problem);
        if (problem.starts_with("robarm/env1")) CHECK(run["solved"] == true);
      }
    }
  }
}

SCENARIO("every dynobench scene is solved by a nested strategy", "[examples][real]") {
  if (!scenes_are_here()) return;
  GIVEN("the eight scenes, robots with and without a trailer") {
    const Result& result = run("real/dynobench.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    std::map<std::string, int> solved;
    for (const auto& run : runs_of(result.document, "nested")) {
      solved[run["problem"].get<std::string>()] += run["solved"] == true ? 1 : 0;
    }
    THEN("each of them is solved at least once") {
      CHECK(solved.size() == 8);
      for (const auto& [problem, times] : solved) {
        CAPTURE(problem);
        CHECK(times >= 1);
      }
    }
  }
}
