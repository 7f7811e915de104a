// SPDX-License-Identifier: GPL-3.0-or-later
// A strategy on the problems of MotionBenchMaker, a line for each scenario: solved, CPU time, checks, length.
//
//   bench_arms ROBOT.urdf ROBOT.srdf GROUP FOLDER [STRATEGY [RESOLUTION]]
//
// FOLDER has a folder for each scenario, with scenes and requests of MoveIt. STRATEGY is shrink, lazy, or "" for none;
// its planner is rrt_connect.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

#include "se3_bench.hpp"

namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

struct Scenario {
  int problems = 0;
  int valid = 0;
  int solved = 0;
  std::vector<double> us;
  std::vector<double> path_us;  ///< of the path's certificate
  std::vector<double> path_checks;
  std::vector<double> checks;
  std::vector<double> proposals;
  std::vector<double> lengths;
};

}  // namespace

int main(int count, char** arguments) {
  using namespace trellis;
  try {
    const std::vector<std::string> given(arguments + 1, arguments + count);
    if (given.size() < 4) throw std::invalid_argument("needs ROBOT.urdf ROBOT.srdf GROUP FOLDER");
    const UrdfFile urdf = read_urdf(given[0]);
    const SrdfFile srdf = read_srdf(given[1], urdf.tree);
    const auto group =
        std::find_if(srdf.groups.begin(), srdf.groups.end(), [&](const auto& g) { return g.name == given[2]; });
    if (group == srdf.groups.end()) throw std::invalid_argument("no group " + given[2]);
    const Manipulator robot(urdf.tree, group->joints);
    const SphereModel model(robot, self_collision_pairs(robot, srdf.disabled));
    const std::string guide = given.size() > 4 ? given[4] : "";
    const double resolution = given.size() > 5 ? std::stod(given[5]) : 0.05;
    const double step = given.size() > 6 ? std::stod(given[6]) : 1.0;
    const PlannerSpec planner = PlannerSpec::make("rrt_connect", {{"step", step}, {"seconds", 10.0}, {"proposals", 1e7}});
    StrategySpec strategy(planner);
    if (!guide.empty()) strategy = GuideSpec::make(guide, {}) >> planner;
    std::map<std::string, Scenario> scenarios;
    std::map<std::string, std::filesystem::path> scenes;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(given[3])) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("scene") && name.ends_with(".yaml")) scenes[entry.path().string()] = entry.path();
    }
    for (const auto& [text, path] : scenes) {
      Scenario& scenario = scenarios[path.parent_path().filename().string()];
      const MoveitFile file = read_moveit(text, robot, model.bounding_radius());
      Problem problem;
      problem.name = path.stem().string();
      problem.scene = std::make_shared<ManipulatorScene>(file.world, model);
      problem.space = problem.scene->default_space(1.0);
      problem.start = file.start;
      problem.goals = {file.goal};
      problem.resolution = resolution;
      problem.collision = "spheres";
      ++scenario.problems;
      const auto checker = make_checker("spheres", problem.scene, problem.space, resolution);
      if (!checker->valid(problem.start) || !checker->valid(problem.goal())) continue;
      if (!problem.space.contains(problem.start) || !problem.space.contains(problem.goal())) {
        std::printf("# beyond the limits: %s\n", text.c_str());
        continue;
      }
      ++scenario.valid;
      const double before = bench::cpu_seconds();
      const RunRecord run = execute(strategy, problem, 1);
      const double after = bench::cpu_seconds();
      if (!run.solved) {
        std::printf("# not solved: %s %s\n", path.parent_path().filename().c_str(), problem.name.c_str());
        continue;
      }
      ++scenario.solved;
      scenario.us.push_back(1e6 * (after - before));
      scenario.path_us.push_back(1e6 * run.path_seconds);
      scenario.path_checks.push_back(static_cast<double>(run.path_checks));
      scenario.checks.push_back(static_cast<double>(run.validity_checks));
      double proposals = 0.0;
      for (const auto& level : run.levels) proposals += static_cast<double>(level.search.proposals.size());
      scenario.proposals.push_back(proposals);
      scenario.lengths.push_back(run.length);
    }
    std::printf("%-28s %8s %6s %6s %10s %10s %8s %8s %10s %10s %8s %8s\n", "scenario", "problems", "valid", "solved",
                "us median", "us 95 %", "cert us", "cert chk", "checks", "checks95", "props", "length");
    Scenario all;
    const auto print = [](const std::string& name, const Scenario& s) {
      std::printf("%-28s %8d %6d %6d %10.0f %10.0f %8.0f %8.0f %10.0f %10.0f %8.0f %8.2f\n", name.c_str(), s.problems,
                  s.valid, s.solved, quantile(s.us, 0.5), quantile(s.us, 0.95), quantile(s.path_us, 0.5),
                  quantile(s.path_checks, 0.5), quantile(s.checks, 0.5), quantile(s.checks, 0.95),
                  quantile(s.proposals, 0.5), quantile(s.lengths, 0.5));
    };
    for (const auto& [name, s] : scenarios) {
      print(name, s);
      all.problems += s.problems;
      all.valid += s.valid;
      all.solved += s.solved;
      all.us.insert(all.us.end(), s.us.begin(), s.us.end());
      all.path_us.insert(all.path_us.end(), s.path_us.begin(), s.path_us.end());
      all.path_checks.insert(all.path_checks.end(), s.path_checks.begin(), s.path_checks.end());
      all.checks.insert(all.checks.end(), s.checks.begin(), s.checks.end());
      all.proposals.insert(all.proposals.end(), s.proposals.begin(), s.proposals.end());
      all.lengths.insert(all.lengths.end(), s.lengths.begin(), s.lengths.end());
    }
    print("all", all);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_arms: %s\n", error.what());
    return 1;
  }
}
