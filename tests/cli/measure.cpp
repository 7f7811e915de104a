// SPDX-License-Identifier: GPL-3.0-or-later
// `trellis measure`: the values for samples of other programs, and the diagnostics of invalid input.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/process.hpp"
#include "support/scenes.hpp"

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

/// Uniform numbers in [0, 1) that are the same everywhere.
class Numbers {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<double>(state_ >> 40U) * 0x1.0p-24;
  }

 private:
  std::uint64_t state_ = 7;
};

/// The tube of 0.5 about a straight path of 6 in a square of 10 x 10: |A| = 6 + pi / 4.
Json capsule() {
  return {{"dim", 2},
          {"coords", {"x", "y"}},
          {"weights", {1, 1}},
          {"lo", {0, 0}},
          {"hi", {10, 10}},
          {"periodic", {false, false}},
          {"path", {{2, 5}, {8, 5}}},
          {"delta", 0.5},
          {"samples", "samples.csv"}};
}
const double capsule_uniform = std::log(100.0) - std::log(6.0 + std::numbers::pi / 4.0);

/// SE(2) on the paper's simple passage, with its path in the middle of the corridor.
Json passage() {
  return {{"dim", 3},
          {"coords", {"x", "y", "theta"}},
          {"weights", {1, 1, 1 / std::numbers::pi}},
          {"lo", {0, 0, -std::numbers::pi}},
          {"hi", {10, 10, std::numbers::pi}},
          {"periodic", {false, false, true}},
          {"path", {{1, 8.5, 0}, {3, 5, 0}, {7, 5, 0}, {9, 1.5, 0}}},
          {"delta", 0.5},
          {"samples", "samples.csv"},
          {"distance", "planar"},
          {"free", "simple_passage"}};
}

std::string line(const std::vector<double>& row) {
  std::string text;
  for (const double x : row) {
    char number[32];
    std::snprintf(number, sizeof number, "%.6f", x);
    if (!text.empty()) text += ',';
    text += number;
  }
  return text + "\n";
}

std::string uniform_csv(std::size_t count, bool turning = false) {
  Numbers numbers;
  std::string text = turning ? "x,y,theta\n" : "x,y\n";
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> row = {10.0 * numbers(), 10.0 * numbers()};
    if (turning) row.push_back((2.0 * numbers() - 1.0) * std::numbers::pi);
    text += line(row);
  }
  return text;
}

/// Samples that crowd about the left half of the capsule's path.
std::string left_csv(std::size_t count) {
  Numbers numbers;
  std::string text = "x,y\n";
  for (std::size_t i = 0; i < count; ++i) text += line({1.0 + 5.0 * numbers(), 4.0 + 2.0 * numbers()});
  return text;
}

Json measured(const Place& place, const Json& c, const std::string& csv, std::vector<std::string> options = {}) {
  place.script("case.json", c.dump());
  place.script("samples.csv", csv);
  std::vector<std::string> arguments = {"measure", "case.json", "--json", "-"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome outcome = place.run(arguments);
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  REQUIRE(outcome.err.empty());
  return Json::parse(outcome.out);
}

}  // namespace

TEST_CASE("uniform samples of a capsule gain nothing over uniform sampling") {
  const Place place;
  const Json figures = measured(place, capsule(), uniform_csv(20000));
  CHECK(figures["N"] == 20000);
  CHECK(figures["vol_T"].get<double>() == Approx(6.0 + std::numbers::pi / 4.0).epsilon(0.005));
  CHECK(figures["log_vol_C"].get<double>() == Approx(std::log(100.0)));
  CHECK(figures["D_uniform"].get<double>() == Approx(capsule_uniform).margin(0.005));
  CHECK(figures["above_uniform"].get<double>() == Approx(0.0).margin(0.05));
  CHECK(figures["D"].get<double>() == Approx(capsule_uniform).margin(0.05));
  const double share = std::exp(-capsule_uniform);
  CHECK(figures["share_in_target"].get<double>() == Approx(share).margin(0.006));
  CHECK(figures["share_in_target"].get<double>() == Approx(figures["n"].get<double>() / 20000));
  CHECK(figures["D_mass"].get<double>() == Approx(-std::log(figures["share_in_target"].get<double>())));
  CHECK(figures["D_mass_lower95"].get<double>() < figures["D_mass"].get<double>());
  CHECK(figures["along"]["D"].get<double>() == Approx(0.0).margin(0.02));
  CHECK(figures["along"]["empty_share"] == 0.0);
  CHECK(figures["coverage"].get<double>() == Approx(1.0).margin(0.01));
  CHECK(figures["estimator"] == "knn");
  CHECK(figures["flags"].empty());
  CHECK(figures["free_share"] == 1.0);
  CHECK(figures["along"]["length"].get<double>() == Approx(6.0));
  CHECK(figures["outside"] == 0);
  CHECK(figures["along"]["target"].size() == 12);
  CHECK(figures["along"]["samples"].size() == 12);
}

TEST_CASE("the intervals of mass and spread contain the parts of the headline") {
  const Place place;
  for (const std::string& csv : {uniform_csv(3000), left_csv(3000)}) {
    const Json figures = measured(place, capsule(), csv);
    const Json& parts = figures["SE_parts"];
    for (const std::string part : {"mass", "spread"}) {
      INFO(part << figures.dump());
      CHECK(parts[part + "_lo"].get<double>() <= parts[part].get<double>());
      CHECK(parts[part].get<double>() <= parts[part + "_hi"].get<double>());
    }
    // The mass of the mixture with 5 % uniform samples, at the ends of the interval of the mass.
    const double blurred = -std::log(0.95 * std::exp(-figures["D_mass_lo"].get<double>()) +
                                     0.05 * std::exp(-figures["D_uniform"].get<double>()));
    CHECK(parts["mass_lo"].get<double>() == Approx(blurred));
  }
}

TEST_CASE("samples drawn from the target itself reach a divergence near 0") {
  const Place place;
  Numbers numbers;
  std::string csv = "x,y\n";
  for (int i = 0; i < 5000;) {
    const double x = 1.5 + 7.0 * numbers(), y = 4.5 + numbers();
    const double beyond = std::max({2.0 - x, x - 8.0, 0.0});
    if (std::hypot(beyond, y - 5.0) >= 0.5) continue;
    csv += line({x, y});
    ++i;
  }
  const Json figures = measured(place, capsule(), csv);
  CHECK(figures["share_in_target"] == 1.0);
  CHECK(figures["D"].get<double>() == Approx(0.0).margin(0.06));
  CHECK(figures["D_mass"] == 0.0);
}

TEST_CASE("a scene decides what is valid, by name, by file and by script") {
  const Place place;
  const std::string csv = uniform_csv(20000, true);
  const Json named = measured(place, passage(), csv);
  CHECK(named["free_share"].get<double>() > 0.2);
  CHECK(named["free_share"].get<double>() < 0.95);
  CHECK(named["above_uniform"].get<double>() == Approx(0.0).margin(0.1));

  place.script("scene.lua", "return scenes.simple_passage { resolution = 0.1 }\n");
  Json by_script = passage();
  by_script["free"] = "scene.lua";
  CHECK(measured(place, by_script, csv) == named);
  // Paths are relative to the case file's folder.
  fs::create_directories(place / "deep");
  fs::copy(place / "scene.lua", place / "deep/other.lua");
  place.script("deep/samples.csv", csv);
  by_script["free"] = "other.lua";
  place.script("deep/case.json", by_script.dump());
  CHECK(Json::parse(place.run({"measure", "deep/case.json", "--json", "-"}).out) == named);

  Json all = passage();
  all.erase("free");
  const Json tube = measured(place, all, csv);
  CHECK(tube["free_share"] == 1.0);
  CHECK(tube["vol_T"].get<double>() > named["vol_T"].get<double>());

  if (trellis::test::scene("ompl_tests/circle_obstacles.txt").empty()) return;
  Json circles = capsule();
  circles["free"] = "ompl_tests/circle_obstacles.txt";
  circles["lo"] = {0, 0};
  circles["hi"] = {100, 100};
  circles["path"] = {{10, 10}, {90, 90}};
  circles["delta"] = 5;
  CHECK(measured(place, circles, uniform_csv(2000))["free_share"].get<double>() < 1.0);
}

TEST_CASE("a path in an obstacle is pointed at, and samples elsewhere are censored") {
  const Place place;
  Json blocked = passage();
  blocked["path"] = {{1, 8.5, 0}, {5, 2, 0}, {9, 1.5, 0}};
  CHECK(measured(place, blocked, uniform_csv(2000, true))["flags"] == Json({"invalid path"}));

  const Json away = measured(place, capsule(), "x,y\n1,9\n2,9\n3,9.5\n4,9\n11,5\n");
  CHECK(away["n"] == 0);
  CHECK(away["D"] == "inf");
  CHECK(away["D_mass"] == "inf");
  CHECK(away["SE"].is_number());
  CHECK(away["along"]["D"].is_null());
  CHECK(away["along"]["empty_share"] == 1.0);
  CHECK(away["outside"] == 1);
  const auto flags = away["flags"];
  CHECK(std::find(flags.begin(), flags.end(), "censored") != flags.end());
}

TEST_CASE("each estimator can be asked, or all of them") {
  const Place place;
  const Json knn = measured(place, capsule(), uniform_csv(3000), {"--estimator", "knn"});
  CHECK(knn["estimator"] == "knn");
  CHECK(knn["D"].get<double>() == Approx(capsule_uniform).margin(0.2));
  CHECK_FALSE(knn.contains("estimators"));

  const Json all = measured(place, capsule(), uniform_csv(3000), {"--estimator", "all"});
  CHECK(all["estimator"] == "knn");
  const auto& one = all["estimators"]["knn"];
  for (const char* figure : {"D", "SE", "above_uniform"}) CHECK(one[figure].is_number());
  CHECK_FALSE(one.contains("reason"));
  CHECK(all["estimators"]["knn"]["SE"] == all["SE"]);
  CHECK(all["estimators"]["exact"]["D"].is_null());
  CHECK(all["estimators"]["exact"]["reason"].get<std::string>().find("density") != std::string::npos);
  CHECK(all["estimators"]["arc"]["reason"] == "the space has 2 dimensions, fewer than 5");
}

TEST_CASE("columns are found by name, and variants of the format are read") {
  const Place place;
  const Json plain = measured(place, capsule(), "x,y\n1,9\n2,5\n3,5\n4,5.25\n");
  for (const std::string csv :
       {"\xef\xbb\xbfx,y\r\n1,9\r\n2,5\r\n3,5\r\n4,5.25\r\n", "y,x\n9,1\n5,2\n5,3\n5.25,4",
        "\"x\" , \"y\"\n 1 ,\t9 \n+2,5.0\n3e0,5\n4,5.25  \n\n\n", "x,y\n1,9\n2,5\n3,5\n4,525e-2\n   \n"}) {
    CHECK(measured(place, capsule(), csv) == plain);
  }
}

TEST_CASE("the table is printed, and the document written beside it") {
  const Place place;
  place.script("case.json", capsule().dump());
  place.script("samples.csv", left_csv(400));
  const auto outcome = place.run({"measure", "case.json", "--estimator", "all", "--json", "all.json"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(outcome.err.empty());
  trellis::test::check_golden("measure.txt", outcome.out);
  CHECK(Json::parse(content(place / "all.json"))["N"] == 400);

  place.script("case.json", passage().dump());
  place.script("samples.csv", "x,y,theta\n1,1,0\n2,2,0\n9,9,0\n8,8,0\n0.1,20,0\n");
  const auto few = place.run({"measure", "case.json"});
  CHECK(few.status == 0);
  trellis::test::check_golden("measure_censored.txt", few.out);
  CHECK(place.run({"measure", "case.json", "--json", "-"}).out.starts_with("{\n"));
}

TEST_CASE("possible mistakes in the samples are reported beside the values") {
  const Place place;
  std::string twice = uniform_csv(300);
  const std::string once = twice.substr(twice.find('\n') + 1);
  twice += once.substr(0, once.find('\n', once.size() / 2) + 1);
  const Json repeated = measured(place, capsule(), twice);
  CHECK(measured(place, capsule(), uniform_csv(300))["repeated"] == 0);
  CHECK(repeated["repeated"] == 2 * (repeated["N"].get<int>() - 300));
  CHECK(repeated["repeated"] > 200);
  CHECK(repeated["notes"].empty());
  place.script("samples.csv", twice);
  CHECK(place.run({"measure", "case.json"}).out.find(" of the samples occur more than once") != std::string::npos);

  std::string degrees = "x,y,theta\n";
  Numbers numbers;
  for (int i = 0; i < 100; ++i) degrees += line({10.0 * numbers(), 10.0 * numbers(), 360.0 * numbers()});
  const Json notes = measured(place, passage(), degrees)["notes"];
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].get<std::string>().starts_with("theta goes from "));
  CHECK(notes[0].get<std::string>().ends_with(" times around [-3.14159, 3.14159]: is it in other units?"));
}

TEST_CASE("an option that is none is named, with the one that may be meant") {
  const Place place;
  const auto outcome = place.run({"measure", "case.json", "--estimater", "kde"});
  CHECK(outcome.status == 2);
  CHECK(outcome.err ==
        "trellis: no option --estimater (did you mean '--estimator'?); 'trellis help' shows the usage\n");
}

TEST_CASE("bad input gives one message with what and where, and no figure", "[slow]") {
  struct Bad {
    const char* what;
    Json changes;      // of the capsule's case; null takes a key out
    std::string csv;   // "" for good samples
    std::string says;  // behind "trellis: "
    std::vector<std::string> options = {};
  };
  const std::string good = uniform_csv(50);
  const std::vector<Bad> all = {
      {"no dim", {{"dim", nullptr}}, "", "case.json: the key 'dim' is missing: the number of coordinates, an integer"},
      {"text for dim",
       {{"dim", "2"}},
       "",
       "case.json: dim must be the number of coordinates, an integer in [1, 100], got \"2\""},
      {"no dimension", {{"dim", 0}}, "", "case.json: dim must be the number of coordinates"},
      {"another dim", {{"dim", 3}}, "", "case.json: coords must be a list of 3 names (dim), got 2: [\"x\",\"y\"]"},
      {"misspelt key",
       {{"detla", 0.5}},
       "",
       "case.json: unknown key 'detla' (did you mean 'delta'?); the keys are: dim, coords"},
      {"names that repeat", {{"coords", {"x", "x"}}}, "", "case.json: coords holds 'x' twice"},
      {"numbers for names",
       {{"coords", {1, 2}}},
       "",
       "case.json: coords must hold names without commas and quotes, got 1 as number 1"},
      {"weight 0",
       {{"weights", {1, 0}}},
       "",
       "case.json: weights must be greater than 0 (metres of the metric per unit), got 0 for y"},
      {"one weight", {{"weights", {1}}}, "", "case.json: weights must be a list of 2 numbers (dim), got 1: [1]"},
      {"text for a weight",
       {{"weights", {1, "1"}}},
       "",
       "case.json: weights must hold finite numbers, got \"1\" as number 2"},
      {"a huge bound",
       {{"hi", {10, 1e308}}},
       "",
       "case.json: lo, hi and weights must keep y within 1e+09 m of 0 in the metric, got 1e+308 m"},
      {"a huge weight",
       {{"weights", {1e300, 1}}},
       "",
       "case.json: lo, hi and weights must keep x within 1e+09 m of 0 in the metric, got 1e+301 m"},
      {"a tiny delta",
       {{"delta", 5e-324}},
       "",
       "case.json: delta is 4.94066e-324 m, which divides the 14.1 m of the space into more than 1e+06 parts"},
      {"a long path",
       {{"path", Json(std::vector<std::vector<double>>(10001, {2, 5}))}},
       "",
       "case.json: path must hold 10000 configurations at most, got 10001"},
      {"a path of many radii",
       {{"delta", 1e-3}, {"path", {{0, 0}, {10, 10}, {0, 0}, {10, 10}}}},
       "",
       "case.json: path is 42.43 m long, 42426 times delta; expected at most 20000 times"},
      {"lo above hi", {{"lo", {0, 10}}}, "", "case.json: lo must be below hi, got lo = 10 and hi = 10 for y"},
      {"null in lo", {{"lo", {0, nullptr}}}, "", "case.json: lo must hold finite numbers, got null as number 2"},
      {"number for a boolean",
       {{"periodic", {0, false}}},
       "",
       "case.json: periodic must hold booleans, got 0 as number 1"},
      {"no periodic", {{"periodic", nullptr}}, "", "case.json: the key 'periodic' is missing: a list of 2 booleans"},
      {"path of one", {{"path", {{2, 5}}}}, "", "case.json: path must hold two configurations at least, got 1"},
      {"no path", {{"path", Json::array()}}, "", "case.json: path must hold two configurations at least, got 0"},
      {"flat path",
       {{"path", {2, 5}}},
       "",
       "case.json: path: configuration 1 of 2 must be a list of 2 numbers (x, y), got 2"},
      {"path of three",
       {{"path", {{2, 5}, {3, 5, 0}}}},
       "",
       "case.json: path: configuration 2 of 2 must be a list of 2 numbers (x, y), got [3,5,0]"},
      {"path outside",
       {{"path", {{2, 5}, {12, 5}}}},
       "",
       "case.json: path: configuration 2 of 2 lies outside of the space: x = 12 is not in [0, 10]"},
      {"path without length",
       {{"path", {{2, 5}, {2, 5}}}},
       "",
       "case.json: path has no length: a tube needs two configurations that differ"},
      {"delta 0", {{"delta", 0}}, "", "case.json: delta must be a number greater than 0 (metres of the metric), got 0"},
      {"delta below 0",
       {{"delta", -1}},
       "",
       "case.json: delta must be a number greater than 0 (metres of the metric), got -1"},
      {"text for delta",
       {{"delta", "wide"}},
       "",
       "case.json: delta must be a number greater than 0 (metres of the metric), got \"wide\""},
      {"wrong distance",
       {{"distance", "planer"}},
       "",
       "case.json: distance must be \"planar\" or \"full\", got \"planer\""},
      {"seed below 0", {{"seed", -1}}, "", "case.json: seed must be an integer of at least 0, got -1"},
      {"number for samples", {{"samples", 3}}, "", "case.json: samples must be the name of a CSV file, got 3"},
      {"no such samples",
       {{"samples", "none.csv"}},
       "",
       "case.json: samples: cannot read 'none.csv': No such file or directory"},
      {"samples are a folder", {{"samples", "."}}, "", "case.json: samples: cannot read '.': it is a folder"},
      {"no such scene",
       {{"free", "simple_pasage"}},
       "",
       "case.json: free: no scene is called 'simple_pasage' (did you mean 'simple_passage'?); there are: cup, "
       "simple_passage, trap; "},
      {"no such file", {{"free", "none.txt"}}, "", "case.json: free: no file 'none.txt' (looked for "},
      {"no such script",
       {{"free", "none.lua"}},
       "",
       "case.json: free: cannot read 'none.lua': No such file or directory"},
      {"script that fails",
       {{"free", "fails.lua"}},
       "",
       "case.json: free: fails.lua:1: attempt to index a nil value (local 'nothing')\n"},
      {"script without a problem",
       {{"free", "three.lua"}},
       "",
       "case.json: free: three.lua:1: what the script returns must be a problem or a list of problems, got 3"},
      {"script of two worlds",
       {{"free", "two.lua"}},
       "",
       "case.json: free: 'two.lua' holds 2 problems in different worlds"},
      {"scene of another dimension",
       {{"free", "cup"}},
       "",
       "case.json: free: a configuration of 'cup' has 3 coordinates (x, y, theta), one of the case has 2 (x, y)"},
      {"scene of another order",
       {{"free", "point.lua"}, {"coords", {"y", "x"}}},
       "",
       "case.json: free: the coordinates of 'problem' are in another order: (x, y), those of the case are (y, x)"},
      {"nothing valid",
       {{"free", "point.lua"}, {"path", {{4.5, 5}, {5.5, 5}}}, {"delta", 0.2}},
       "",
       "case.json: no valid configuration lies within 0.2 of the path: there is no target; examine 'free' "
       "('point.lua')"},
      {"empty file", {}, " \n", "samples.csv: the file is empty; expected the header 'x,y' and a line for each sample"},
      {"header only", {}, "x,y\n", "samples.csv: there is no sample below the header"},
      {"no header", {}, "1.5,2\n3,4\n", "samples.csv:1:1: expected the header 'x,y', got the number 1.5"},
      {"misspelt column",
       {{"coords", {"x", "theta"}}},
       "x,thtea\n1,2\n",
       "samples.csv:1:3: no coordinate is called 'thtea' (did you mean 'theta'?); expected the header 'x,theta'"},
      {"column of no coordinate",
       {},
       "x,y,cost\n1,2,3\n",
       "samples.csv:1:5: no coordinate is called 'cost'; expected the header 'x,y'"},
      {"column twice", {}, "x,y,x\n1,2,3\n", "samples.csv:1:5: the column 'x' is there twice"},
      {"column missing", {}, "x\n1\n", "samples.csv:1:2: the column 'y' is missing; expected the header 'x,y'"},
      {"semicolons",
       {},
       "x;y\n1;2\n",
       "samples.csv:1:1: no coordinate is called 'x;y'; expected the header 'x,y'; columns are separated by ',', not "
       "';'"},
      {"UTF-16", {}, "\xff\xfex", "samples.csv: the file is in UTF-16; save it as UTF-8"},
      {"text for a number", {}, "x,y\n1,2\n3, abc\n", "samples.csv:3:4: y must be a finite number, got 'abc'"},
      {"number with a tail", {}, "x,y\n1,2m\n", "samples.csv:2:3: y must be a finite number, got '2m'"},
      {"nan", {}, "x,y\n1,2\nnan,2\n", "samples.csv:3:1: x must be a finite number, got 'nan'"},
      {"inf", {}, "x,y\n1,-inf\n", "samples.csv:2:3: y must be a finite number, got '-inf'"},
      {"too large",
       {},
       "x,y\n1,1e999\n",
       "samples.csv:2:3: y must be a finite number that a double can hold, got '1e999'"},
      {"empty cell", {}, "x,y\n1,\n", "samples.csv:2:3: y must be a finite number, got an empty cell"},
      {"too few columns", {}, "x,y\n1,2\n3\n", "samples.csv:3:2: too few columns: 1, expected 2 (x,y)"},
      {"too many columns", {}, "x,y\n1,2,3,4\n", "samples.csv:2:4: too many columns: 4, expected 2 (x,y)"},
      {"empty line", {}, "x,y\n1,2\n\n3,4\n", "samples.csv:3:1: an empty line between samples"},
      {"too few samples",
       {},
       "x,y\n1,2\n3,4\n",
       "samples.csv: knn gives no figure: too few samples: 2 that occur once, k = 3 are needed"},
      {"all equal",
       {},
       "x,y\n2,5\n2,5\n2,5\n2,5\n",
       "samples.csv: knn gives no figure: all samples occur more than once: they have no density"},
      {"too few for all",
       {},
       "x,y\n1,2\n3,4\n",
       "samples.csv: knn gives no figure: too few samples",
       {"--estimator", "all"}},
      {"no such estimator",
       {},
       "",
       "--estimator: no estimator 'kn' (did you mean 'knn'?); estimators are knn, exact, arc; all is each of them",
       {"--estimator", "kn"}},
      {"exact",
       {},
       "",
       "--estimator: exact: the density that the samples were drawn from is not known",
       {"--estimator", "exact"}},
      {"no estimator", {}, "", "--estimator is empty", {"--estimator", ""}},
      {"no such folder", {}, "", "cannot write 'no/all.json'", {"--json", "no/all.json"}},
  };
  const Place place;
  place.script("fails.lua", "local nothing return nothing.scene\n");
  place.script("three.lua", "return 3\n");
  place.script("two.lua", "return { scenes.cup(), scenes.trap() }\n");
  place.script("point.lua",
               "return problem { world = world { bounds = {0, 0, 10, 10}, box {4, 2, 6, 8} }, robot = robot.point(), "
               "start = {1, 1}, goal = {9, 9} }\n");
  for (const Bad& bad : all) {
    Json c = capsule();
    for (const auto& [key, value] : bad.changes.items()) {
      c[key] = value;
      if (value.is_null()) c.erase(key);
    }
    place.script("case.json", c.dump());
    place.script("samples.csv", bad.csv.empty() ? good : bad.csv);
    std::vector<std::string> arguments = {"measure", "case.json"};
    arguments.insert(arguments.end(), bad.options.begin(), bad.options.end());
    const auto outcome = place.run(arguments);
    INFO(bad.what << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.starts_with("trellis: " + bad.says));
    CHECK(outcome.err.ends_with("\n"));
  }
}

TEST_CASE("a case that is no JSON object is an error") {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "case.json: the file is empty; expected a JSON object"},
      {"[1, 2]", "case.json: a case must be a JSON object, got [1,2]"},
      {"{\n  \"dim\": 2,\n  \"lo\": [0, NaN]\n}", "case.json:3:13: this is not JSON: syntax error while parsing value"},
      {"{\"dim\": 2", "case.json:1:10: this is not JSON: syntax error"},
      {"{\"dim\": 2, \"dim\": 3}", "case.json: the key 'dim' is there twice"},
      {"{\"dim\": 2, \"delta\": 1e999}", "case.json: number overflow parsing '1e999'"},
  };
  const Place place;
  for (const auto& [text, says] : wrong) {
    place.script("case.json", text);
    const auto outcome = place.run({"measure", "case.json"});
    INFO(text << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.starts_with("trellis: " + says));
  }
  const auto missing = place.run({"measure", "missing.json"});
  CHECK(missing.status == 2);
  CHECK(missing.err == "trellis: cannot read 'missing.json': No such file or directory\n");
  CHECK(place.run({"measure"}).status == 2);
  CHECK(place.run({"measure", "case.json", "--estimater", "knn"}).status == 2);
}
