// SPDX-License-Identifier: GPL-3.0-or-later
// trellis run --trajectory: the path of an arm as a motion in time, in YAML and CSV.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/manipulators.hpp"
#include "support/process.hpp"

using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

std::string script(const std::string& goal) {
  return "local arm = robot.urdf('six.urdf', { srdf = 'six.srdf', group = 'arm' })\n"
         "local w = world { bounds = {-2, -2, -2, 2, 2, 2}, sphere {0.5, 0.6, 0.7, 0.15, name = 'lamp'} }\n"
         "return experiment { problems = { problem { name = 'lamp', world = w, robot = arm, start = 'ready', goal = " +
         goal +
         " } }, strategies = { { 'a', rrt_connect {} }, { 'b', rrt_connect { step = 0.3 } } }, seeds = 2, measure = "
         "false }\n";
}

/// Writes the robot, whose lift has a limit of speed, and the script.
void write_robot(const Place& place, const std::string& goal) {
  std::string urdf = trellis::test::six_joints;
  const std::string limit = "<limit lower=\"0\" upper=\"0.4\"/>";
  urdf.replace(urdf.find(limit), limit.size(), "<limit lower=\"0\" upper=\"0.4\" velocity=\"0.05\"/>");
  place.script("six.urdf", urdf);
  place.script("six.srdf", trellis::test::six_joints_srdf);
  place.script("arm.lua", script(goal));
}

std::vector<std::vector<double>> rows(const std::string& csv) {
  std::vector<std::vector<double>> all;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);  // the header
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    all.emplace_back();
    while (std::getline(cells, cell, ',')) all.back().push_back(std::stod(cell));
  }
  return all;
}

}  // namespace

TEST_CASE("a trajectory has the path's ends, the names of its joints, and keeps their limits") {
  const Place place;
  write_robot(place, "'aside'");
  const Outcome outcome =
      place.run({"run", "arm.lua", "--trajectory", "a.csv", "--json", "all.json", "--acceleration", "0.5"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK_THAT(outcome.err, Contains("a.csv: problem lamp, strategy a, seed 1, "));
  const std::string csv = content(place / "a.csv");
  CHECK(csv.starts_with("time,turn,lift,elbow,roll,wrist,flange,turn velocity,lift velocity,"));
  const auto all = rows(csv);
  REQUIRE(all.size() > 10);
  CHECK(all.front() == std::vector<double>{0, 0, 0.1, 0.5, 0, 0.3, 0, 0, 0, 0, 0, 0, 0});
  const std::vector<double> end(all.back().begin() + 1, all.back().end());
  CHECK(end == std::vector<double>{2, 0.2, 0.4, 0.2, 0.3, 0, 0, 0, 0, 0, 0, 0});
  for (std::size_t i = 1; i < all.size(); ++i) {
    const double h = all[i][0] - all[i - 1][0];
    CHECK(h > 0.0);
    CHECK(h < 0.0501);
    for (std::size_t j = 0; j < 6; ++j) {
      CHECK(std::abs(all[i][7 + j]) <= (j == 1 ? 0.05 : 1.0) + 1e-8);
      CHECK(std::abs(all[i][7 + j] - all[i - 1][7 + j]) <= 0.5 * h + 1e-7);
    }
  }
  const auto problem = nlohmann::json::parse(content(place / "all.json")).at("experiment").at("problems").at(0);
  CHECK(problem.at("coordinates") == nlohmann::json::array({"turn", "lift", "elbow", "roll", "wrist", "flange"}));

  // The same motion for ROS, of another strategy.
  REQUIRE(place.run({"run", "arm.lua", "--quiet", "--strategy", "b", "--trajectory", "b.yaml"}).status == 0);
  const std::string yaml = content(place / "b.yaml");
  CHECK(yaml.starts_with("# problem lamp, strategy b, seed 1: "));
  CHECK_THAT(yaml, Contains("stops wherever the path bends"));
  CHECK_THAT(yaml,
             Contains("joint_names: [\"turn\", \"lift\", \"elbow\", \"roll\", \"wrist\", \"flange\"]\npoints:\n  - "
                      "positions: [0.000000000, 0.100000000, 0.500000000,"));
  CHECK_THAT(yaml, Contains("time_from_start: {sec: 0, nanosec: 0}"));
}

TEST_CASE("a trajectory without a path, or of a name without a form, is an error and no file") {
  const Place place;
  write_robot(place, "{ turn = 3, lift = 0.2, elbow = 0.4, roll = 0, wrist = 0.3, flange = 0 }");
  place.script("none.lua",
               "return experiment { problems = { problem { world = world { bounds = {0, 0, 9, 9}, box {4, 0, 5, 9} }, "
               "robot = robot.point(), start = {1, 1}, goal = {8, 8} } }, strategies = { rrt { proposals = 50 } }, "
               "seeds = 1, measure = false }\n");
  const Outcome unsolved = place.run({"run", "none.lua", "--trajectory", "none.csv"});
  CHECK(unsolved.status != 0);
  CHECK_THAT(unsolved.err, Contains("no trajectory: no run found a path"));
  CHECK_FALSE(fs::exists(place / "none.csv"));
  const Outcome name = place.run({"run", "arm.lua", "--trajectory", "a.txt"});
  CHECK(name.status != 0);
  CHECK_THAT(name.err, Contains("--trajectory: a trajectory's name ends with .yaml"));
  const Outcome alone = place.run({"run", "arm.lua", "--velocity", "2"});
  CHECK(alone.status != 0);
  CHECK_THAT(alone.err, Contains("--velocity: nothing is timed without --trajectory or --gltf"));
}
