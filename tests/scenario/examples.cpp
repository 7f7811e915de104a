// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the examples as users do, and tests their claims.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include <trellis/testing.hpp>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/results.hpp"
#include "support/scenes.hpp"

using Json = nlohmann::json;
using namespace trellis::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;
using trellis::GuideSpec;
using trellis::PlannerSpec;
using trellis::Problem;
using trellis::StrategySpec;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

std::string example(const std::string& name) { return (fs::path(TRELLIS_SOURCE) / "examples" / name).string(); }

struct Result {
  trellis::test::Outcome outcome;
  Json document;
};

/// Each example runs once for all THENs.
const Result& run(const std::string& name) {
  static std::map<std::string, Result> done;
  if (const auto it = done.find(name); it != done.end()) return it->second;
  const Place place;
  Result& result = done[name];
  std::vector<std::string> command = {"run", example(name), "--json", "all.json", "--jobs", "2"};
  // They take minutes with the seeds of their figures.
  for (const auto* longer : {"bounded_loss.lua", "second_guide.lua"}) {
    if (name == longer) command.insert(command.end(), {"--seeds", "3"});
  }
  if (name.starts_with("correlation")) command.insert(command.end(), {"--seeds", "1"});
  result.outcome = place.run(command);
  const std::string text = trellis::test::content(place / "all.json");
  if (!text.empty()) result.document = trellis::test::with_levels(Json::parse(text));
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

/// The examples that no other scenario runs, in two parts: each takes minutes.
std::vector<std::string> other_examples(bool second) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(TRELLIS_SOURCE) / "examples")) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".lua") && !name.ends_with("_test.lua")) names.push_back(name);
  }
  // scripts/pays runs pays.lua, for a quarter of an hour; the tests of the command line run it in part.
  for (const auto* elsewhere : {"nested.lua", "guiding_space.lua", "paper.lua", "parasol.lua", "kinodynamic.lua",
                                "controls.lua", "pays.lua", "warehouse.lua"}) {
    REQUIRE(std::erase(names, elsewhere) == 1);
  }
  std::sort(names.begin(), names.end());
  const auto half = names.begin() + static_cast<std::ptrdiff_t>(names.size() / 2);
  return second ? std::vector<std::string>(half, names.end()) : std::vector<std::string>(names.begin(), half);
}

/// Runs an example, and requires that it ends with solved runs.
void require_end(const std::string& name) {
  const Result& result = run(name);
  INFO(result.outcome.err);
  CHECK(result.outcome.status == 0);
  REQUIRE(result.document["runs"].size() >= 1);
  const auto& runs = result.document["runs"];
  const auto solved = std::count_if(runs.begin(), runs.end(), [](const Json& run) { return run["solved"] == true; });
  // These show problems that planners without guides do not solve.
  if (name.starts_with("many_robots") || name == "team_of_cars.lua" || name == "warehouse.lua" ||
      name == "crossing.lua") {
    const auto prioritised = std::count_if(runs.begin(), runs.end(), [](const Json& run) {
      return run["solved"] == true && run["strategy"] == "prioritise";
    });
    CHECK(prioritised >= (name == "warehouse.lua" ? 5 : name == "crossing.lua" ? 18 : 11));
    return;
  }
  CHECK(solved * 10 >= static_cast<std::ptrdiff_t>(runs.size()) * 9);
}

}  // namespace

SCENARIO("skeletons feed shrunken robots that feed lazy checks", "[examples][slow]") {
  GIVEN("the nested strategy beside a plain RRT on the simple passage, 15 seeds") {
    const Result& result = run("nested.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    const auto nested = runs_of(result.document, "nested");
    REQUIRE(nested.size() == 15);

    THEN("each nested run has four levels, each with its space and its efficiency") {
      const std::vector<std::string> names = {"root", "lazy()", "shrink(0.5)", "skeleton()"};
      for (const auto& run : nested) {
        REQUIRE(run["levels"].size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
          const auto& level = run["levels"][i];
          CHECK(level["level"] == i);
          CHECK(level["name"] == names[i]);
          CHECK(level["dimension"] == (i == 3 ? 2 : 3));
          CHECK(level["solves"] >= 1);
          CHECK(level["measure"]["tree"]["self"]["SE"].is_number());
          CHECK(level["measure"].contains("root") == (i > 0));
          if (i > 0) CHECK(level["measure"]["root"]["tree"]["self"]["SE"].is_number());
        }
        // An exact search proposes nothing, so it has no value for proposals.
        CHECK(run["levels"][3]["measure"]["expansion"]["self"]["SE"].is_null());
      }
    }
    THEN("the report names every guide and both strategies, and says what pays and why") {
      for (const auto* word : {"without lazy()", "without shrink(0.5)", "without skeleton()", "rrt", "nested", "pays",
                               "keep it", "verdicts", "as of uniform samples"}) {
        CHECK(result.outcome.out.find(word) != std::string::npos);
      }
    }
  }
}

SCENARIO("nesting pays on the simple passage", "[examples][slow]") {
  GIVEN("the script of the nested strategy") {
    const Script script = load(example("nested.lua"));
    WHEN("it and the plain RRT run on 15 seeds") {
      const Trial nested = script.trial("nested", seeds(15));
      const Trial plain = script.trial("rrt", seeds(15));
      THEN("every run has a valid path from start to goal") {
        for (const Trial& trial : {nested, plain}) {
          CHECK_THAT(trial, Solves(exactly(1.0)));
          CHECK_THAT(trial, FindsPaths());
        }
      }
      THEN(
          "what presumes checks the points of the path that guides it and no more, and what is searched exactly "
          "proposes nothing") {
        CHECK_THAT(nested, Spends(at_most(40).validity_checks().in_level("lazy")));
        CHECK_THAT(nested, Spends(exactly(0).proposals().in_level("skeleton >> shrink >> lazy")));
        CHECK_THAT(nested, !Spends(exactly(0).validity_checks().in_level("shrink(0.5)")));
      }
      THEN("more samples of the nested strategy lie in the target") {
        CHECK_THAT(nested, HasEfficiency(level("root").mass(), above(plain)));
      }
      THEN("the same seed gives the same run") { CHECK_THAT(nested, IsDeterministic()); }
    }
  }
}

SCENARIO("guiding spaces written in a script guide as built-in ones do", "[examples][slow]") {
  GIVEN("the example of guides of one's own") {
    const Result& result = run("guiding_space.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    THEN("shrink written in Lua is the built-in shrink, in every figure of every run") {
      auto own = runs_of(result.document, "half");
      const auto built_in = runs_of(result.document, "shrink");
      REQUIRE(own.size() == 15);
      for (std::size_t i = 0; i < own.size(); ++i) {
        CHECK(own[i]["path"] == built_in[i]["path"]);
        CHECK(own[i]["validity_checks"] == built_in[i]["validity_checks"]);
        REQUIRE(own[i]["levels"].size() == 2);
        for (std::size_t k = 0; k < 2; ++k) {
          CHECK(own[i]["levels"][k]["proposals"] == built_in[i]["levels"][k]["proposals"]);
          const char* const lifted = k == 0 ? "tree" : "root";
          CHECK(own[i]["levels"][k]["measure"][lifted] == built_in[i]["levels"][k]["measure"][lifted]);
        }
      }
    }
    THEN("the point robot searches a space of two axes, and all runs of the composition are solved") {
      const auto& point = runs_of(result.document, "point");
      REQUIRE(point.size() == 15);
      CHECK(point[0]["levels"][1]["dimension"] == 2);
      CHECK(point[0]["levels"][1]["name"] == "point");
      for (const auto& run : runs_of(result.document, "all")) {
        CHECK(run["solved"] == true);
        CHECK(run["levels"].size() == 4);
      }
    }
    THEN("guides that know the passage spend fewer checks than none") {
      const auto plain = median(field(runs_of(result.document, "rrt"), "validity_checks"));
      CHECK(median(field(runs_of(result.document, "half"), "validity_checks")) < plain);
    }
  }
}

SCENARIO("a strategy that was built in C++ is tried as one of a script", "[testing]") {
  GIVEN("a problem of a script, and the algebra") {
    const Problem problem = load(example("nested.lua")).problem("simple_passage");
    const StrategySpec guided =
        GuideSpec::make("skeleton", {}) >> StrategySpec(PlannerSpec::make("rrt", {{"step", 0.5}}));
    WHEN("it runs on 15 seeds beside the plain RRT of the script") {
      // Strategies built in code run again in each section: test only once.
      static const Trial regions = trial("regions", guided, problem, seeds(15));
      const Trial plain = load(example("nested.lua")).trial("rrt", seeds(15));
      THEN("it spends a third less at the least") {
        CHECK_THAT(regions, Solves(at_least(0.9)));
        CHECK_THAT(regions, Spends(below(plain).validity_checks().by(0.33)));
      }
      THEN("its samples lie in the target, and its proposals fill little of it") {
        CHECK_THAT(regions, HasEfficiency(level("root").mass(), above(1.0)));
        CHECK_THAT(regions, HasEfficiency(level("skeleton").lifted().mass(), above(1.0)));
        CHECK_THAT(regions, !HasEfficiency(level("root").expansion(), above(0.0)));
      }
    }
  }
}

SCENARIO("what a test of a strategy says where it fails", "[testing]") {
  GIVEN("a script, and names that it does not have") {
    const Script script = load(example("nested.lua"));
    CHECK_THROWS_WITH(script.trial("nestd"), Contains("no strategy is called 'nestd' (did you mean 'nested'?)"));
    CHECK_THROWS_WITH(script.problem("passage"), Contains("no problem is called 'passage'"));
    CHECK_THROWS_WITH(load("no.lua"), "cannot read 'no.lua': No such file or directory");
  }
  GIVEN("a trial that a matcher does not hold for") {
    const Trial plain = load(example("nested.lua")).trial("rrt", seeds(3));
    const auto matcher = Solves(at_most(0.5));
    CHECK(matcher.describe() == "solves at most 50 % of the seeds");
    REQUIRE_FALSE(matcher.match(plain));
    CHECK_THAT(matcher.describe(),
               StartsWith("solves at most 50 % of the seeds: 3 of 3 (100 %)\nseed 1: found a path\n"));
    CHECK_THAT(matcher.describe(), Contains("0 root"));
    CHECK_THAT(matcher.describe(), EndsWith(" --strategy rrt --problem simple_passage --only 1\n"));
    CHECK(Catch::Detail::stringify(plain) == "rrt on simple_passage, 3 seeds (1–3)");
  }
  GIVEN("the same trial, asked for twice") {
    const Script script = load(example("nested.lua"));
    CHECK(&script.trial("rrt", seeds(3)).runs() == &load(example("nested.lua")).trial("rrt", seeds(3)).runs());
  }
}

SCENARIO("anytime planners, and how little the lazy ones check", "[examples][slow]") {
  GIVEN("a robot beside a block, 3000 proposals, 30 seeds") {
    const Script script = load(example("optimal.lua"));
    const Trial eager = script.trial("prm_star", seeds(30));
    // A point's path around the block has at least 4.83 m, and the robot has to turn.
    THEN("the first paths of RRT and PRM are long, those of the anytime planners short") {
      CHECK_THAT(script.trial("rrt", seeds(30)), FindsPaths(above(7.0)));
      CHECK_THAT(script.trial("prm", seeds(30)), FindsPaths(above(7.0)));
      for (const auto* name : {"rrt_star", "prm_star", "lazy_prm_star", "lazy_rrg_star"}) {
        CHECK_THAT(script.trial(name, seeds(30)), Solves(exactly(1.0)));
        CHECK_THAT(script.trial(name, seeds(30)), FindsPaths(at_most(5.9)));
      }
    }
    THEN("the lazy ones spend a twentieth of the checks of PRM* at the most") {
      for (const auto* name : {"lazy_prm_star", "lazy_rrg_star"}) {
        CHECK_THAT(script.trial(name, seeds(30)), Spends(below(eager).validity_checks().by(0.95)));
      }
    }
    THEN("what a shorter path could pass through leaves the shorter path") {
      for (const auto* name : {"informed_rrt_star", "informed_lazy_prm_star"}) {
        CHECK_THAT(script.trial(name, seeds(30)), FindsPaths(at_most(5.6)));
      }
    }
  }
}

SCENARIO("the other examples run to their end", "[examples][slow]") {
  for (const std::string& name : other_examples(false)) {
    GIVEN(name) { require_end(name); }
  }
}

SCENARIO("the other examples run to their end: the second half", "[examples][slow]") {
  for (const std::string& name : other_examples(true)) {
    GIVEN(name) { require_end(name); }
  }
}

SCENARIO("the warehouse runs to its end", "[examples][slow]") {
  GIVEN("warehouse.lua") { require_end("warehouse.lua"); }
}

SCENARIO("the longer scripts of the study of nats declare their experiments", "[examples]") {
  for (const auto& [name, problem] :
       std::map<std::string, std::string>{{"new", "bug_trap"}, {"space", "floating_boxes_83"}}) {
    GIVEN(name) {
      const Script script = load(example("pays/correlation_" + name + ".lua"));
      CHECK(script.problem(problem).name == problem);
      CHECK(script.strategy("skeleton >> shrink >> rrt").guide() != nullptr);
    }
  }
}

SCENARIO("the methods of the paper and those beyond it, on its three scenes, with nothing tuned to a scene",
         "[examples][slow][methods]") {
  GIVEN("every method, three seeds") {
    const auto results_of = [](const std::string& script) {
      const Place place;
      const auto outcome = place.run(
          {"run", example(script), "--seeds", "3", "--cross", "0", "--json", "all.json", "--jobs", "2", "--quiet"});
      INFO(outcome.err);
      REQUIRE(outcome.status == 0);
      return trellis::test::with_levels(Json::parse(trellis::test::content(place / "all.json")));
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
    THEN("a lazy roadmap's tree contains the validated nodes, and expansion does not apply to it") {
      for (const auto* name : {"lazy_prm", "parasol_lazy_prm"}) {
        for (const auto& level : levels_of(name)) {
          if (level["solved"] != true) continue;
          const auto& tree = level["measure"]["tree"]["self"];
          CHECK(tree["N"].get<double>() < level["nodes"].get<double>());
          CHECK(tree["N"].get<double>() <= level["validity_checks"].get<double>());
          CHECK(level["measure"]["expansion"]["self"]["SE"].is_null());
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
        int known = 0;
        for (const auto& level : levels_of(name)) {
          const Json own = level["measure"].is_null() ? Json() : level["measure"].value("expansion", Json());
          if (own.is_null() || own["self"]["SE"].is_null()) continue;
          CHECK(own["self"]["estimator"] == "exact");
          ++known;
        }
        CHECK(known > 0);
      }
    }
    THEN("guidance by the skeleton costs fewer checks than none where there is a narrow passage") {
      const Script methods = load(example("paper.lua"));
      const Trial plain = methods.trial("rrt", seeds(20), "simple_passage");
      CHECK_THAT(methods.trial("dr_rrt", seeds(20), "simple_passage"), Spends(below(plain).validity_checks()));
    }
  }
}

SCENARIO("the circle world that others made, with its 100 queries", "[examples][slow][real]") {
  if (trellis::test::scene().empty()) return;
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

SCENARIO("planar arms with 6 and 20 links that others made", "[examples][slow][real]") {
  if (trellis::test::scene().empty()) return;
  GIVEN("the three arms of SBPL") {
    const Result& result = run("real/sbpl.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    THEN("RRT-Connect finds a path for those of 6 links and for that of 20, with every seed") {
      const auto runs = runs_of(result.document, "rrt_connect");
      REQUIRE(runs.size() == 9);
      for (const auto& run : runs) {
        const std::string problem = run["problem"];
        CAPTURE(problem);
        CHECK(run["solved"] == true);
      }
    }
  }
}

SCENARIO("every dynobench scene is solved by a nested strategy", "[examples][slow][real]") {
  if (trellis::test::scene().empty()) return;
  GIVEN("the eight scenes, robots with and without a trailer") {
    const Result& result = run("real/dynobench_geometry.lua");
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

SCENARIO("driven robots are guided by what forgets that they are driven", "[examples][slow]") {
  GIVEN("a cart, a sledge and a car among racks, 5 seeds each") {
    const Result& result = run("kinodynamic.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    THEN("every guided run arrives, and says how it was driven") {
      for (const auto* strategy : {"holonomic", "decomposition", "nested"}) {
        const auto runs = runs_of(result.document, strategy);
        REQUIRE(runs.size() == 15);
        for (const auto& run : runs) {
          CAPTURE(strategy, run["problem"].get<std::string>(), run["seed"].get<int>());
          REQUIRE(run["solved"] == true);
          const auto& trajectory = run["trajectory"];
          std::size_t steps = 0;
          for (const auto& held : trajectory["steps"]) steps += held.get<std::size_t>();
          CHECK(run["path"].size() == steps + 1);
          CHECK(trajectory["controls"].size() == trajectory["steps"].size());
          CHECK(trajectory["duration_s"].get<double>() == Approx(0.1 * static_cast<double>(steps)));
        }
      }
    }
  }
}

SCENARIO("a guide draws controls, in Lua and in C++", "[examples][slow]") {
  GIVEN("a cart and a sledge among racks, 10 seeds each") {
    const Result& result = run("controls.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    THEN("every guided run arrives, and is ranked by the controls that it chose") {
      for (const auto* strategy : {"steer", "blossom"}) {
        const auto runs = runs_of(result.document, strategy);
        REQUIRE(runs.size() == 20);
        for (const auto& run : runs) {
          CAPTURE(strategy, run["problem"].get<std::string>(), run["seed"].get<int>());
          CHECK(run["solved"] == true);
          CHECK(run["levels"][0]["measure"]["expansion"]["self"]["SE"].is_number());
        }
      }
    }
  }
}

SCENARIO("the unicycles and the car of dynobench are driven to their goals", "[examples][slow][real]") {
  if (trellis::test::scene().empty()) return;
  GIVEN("six scenes, with and without a guide") {
    const Result& result = run("real/dynobench.lua");
    INFO(result.outcome.err);
    REQUIRE(result.outcome.status == 0);
    THEN("each is solved in three of twelve guided runs at least") {
      std::map<std::string, int> solved;
      for (const auto* strategy : {"holonomic", "decomposition", "nested", "curves"}) {
        for (const auto& run : runs_of(result.document, strategy)) {
          solved[run["problem"].get<std::string>()] += run["solved"] == true ? 1 : 0;
        }
      }
      CHECK(solved.size() == 6);
      for (const auto& [problem, times] : solved) {
        CAPTURE(problem);
        CHECK(times >= 3);
      }
    }
  }
}

SCENARIO("what was learnt in one world guides in others", "[examples][slow][experience]") {
  GIVEN("the scripts of examples/experience in a folder of their own") {
    const Place place;
    for (const char* name : {"learn.lua", "use.lua", "walls.lua"}) {
      fs::copy_file(example(std::string("experience/") + name), place / name);
    }
    const auto learnt = place.run({"run", "learn.lua", "--learn", "paths.db", "--jobs", "2"});
    INFO(learnt.err);
    REQUIRE(learnt.status == 0);
    WHEN("the library is gone by") {
      const auto used = place.run({"run", "use.lua", "--json", "all.json", "--jobs", "2"});
      INFO(used.err);
      REQUIRE(used.status == 0);
      const Json document = Json::parse(trellis::test::content(place / "all.json"));
      const auto checks_on = [&](const std::string& problem, const std::string& strategy) {
        std::vector<Json> runs;
        for (const auto& run : runs_of(document, strategy)) {
          if (run["problem"] == problem) runs.push_back(run);
        }
        REQUIRE(runs.size() == 30);
        return median(field(runs, "validity_checks"));
      };
      THEN("it saves checks where the world is the same, and costs some where it is not") {
        CHECK(checks_on("as learnt", "lightning") < 0.9 * checks_on("as learnt", "rrt"));
        CHECK(checks_on("boxes on the path", "lightning") < 1.2 * checks_on("boxes on the path", "rrt"));
        CHECK(checks_on("gaps elsewhere", "lightning") > checks_on("gaps elsewhere", "rrt"));
      }
    }
  }
}
