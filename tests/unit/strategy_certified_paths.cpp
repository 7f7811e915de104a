// SPDX-License-Identifier: GPL-3.0-or-later
// The law of reported paths: no motion of a path that a run reports as solved touches an obstacle, leaves the boundary
// or brings a self-collision pair in contact, at any configuration. Random worlds that are hard for checks of motions,
// robots, planners, guides and resolutions; another method judges the paths (support/path_judge.hpp).
//
// TRELLIS_PATHS sets the number of paths of each case and prints the counts by world, robot and verdict.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/hard_worlds.hpp"
#include "support/path_judge.hpp"
#include "support/random_specs.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using namespace trellis::test;

namespace {

/// The number of paths that the environment asks for.
std::optional<std::size_t> paths_asked() {
  const char* set = std::getenv("TRELLIS_PATHS");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  if (set == nullptr) return std::nullopt;
  return std::strtoull(set, nullptr, 10);
}

/// A problem with what judges its paths.
struct HardProblem {
  Problem problem;
  std::unique_ptr<PathJudge> judge;
  std::string world;
  std::string robot;
};

/// Draws a start and a goal clear of contact; none where tries find none.
bool draw_ends(Stream& stream, double gap, HardProblem& hard) {
  Problem& problem = hard.problem;
  Configuration q(problem.space.dimension());
  std::vector<Configuration> ends;
  constexpr int tries = 200;
  for (int i = 0; i < tries && ends.size() < 2; ++i) {
    problem.space.sample_uniform(stream, q);
    if (hard.judge->clear(q, gap)) ends.push_back(q);
  }
  if (ends.size() < 2) return false;
  problem.start = ends[0];
  problem.goals = {ends[1]};
  return true;
}

template <class Values>
const auto& one_of(Stream& stream, const Values& values) {
  return values[stream.below(std::size(values))];
}

/// From fine to far coarser than the obstacles.
double draw_resolution(Stream& stream, double scale) {
  return scale * one_of(stream, std::array{0.02, 0.05, 0.25, 2.0});
}

std::optional<HardProblem> planar_problem(std::size_t round) {
  HardProblem hard;
  Stream stream(round, "plane", "hard problem");
  hard.world = one_of(stream, HardWorld::kinds());
  hard.robot = one_of(stream, hard_robot_kinds());
  const Placement placement = random_placement(stream);
  const double scale = placement.scale;
  World world = HardWorld::make(hard.world, stream, placement);
  HardRobot robot = hard_robot(hard.robot, stream, placement);
  Problem& problem = hard.problem;
  problem.space = default_space(robot.robot, world, scale / 3.0);
  problem.scene = std::make_shared<const PlanarScene>(std::move(world), std::move(robot.robot));
  problem.resolution = draw_resolution(stream, scale);
  problem.collision = stream.below(4) == 0 ? "fcl" : "planar";
  hard.judge = std::make_unique<PathJudge>(problem.scene, problem.space, robot.bodies);
  if (!draw_ends(stream, 1e-3 * scale, hard)) return std::nullopt;
  return hard;
}

/// A small rectangle that drives by a motion model. Its path is the states, with straight motions between them.
std::optional<HardProblem> driven_problem(std::size_t round) {
  HardProblem hard;
  Stream stream(round, "plane", "driven problem");
  hard.world = one_of(stream, HardWorld::kinds());
  World world = HardWorld::make(hard.world, stream, {});
  const double width = magnitude_between(stream, -2.5, -1);
  Problem problem = make_problem(hard.world, std::move(world), rectangle_robot(2 * width, width), {5, 5, 0}, {5, 5, 0});
  problem.resolution = draw_resolution(stream, 1.0);
  hard.robot = one_of(stream, std::array{"unicycle1", "unicycle2", "car"});
  hard.problem = driven(problem, hard.robot);
  hard.judge = std::make_unique<PathJudge>(hard.problem.scene, hard.problem.space);
  if (!draw_ends(stream, 1e-3, hard)) return std::nullopt;
  for (Configuration* end : {&hard.problem.start, &hard.problem.goals.front()}) {
    for (std::size_t i = 3; i < end->size(); ++i) (*end)[i] = 0.0;
  }
  return hard;
}

std::optional<HardProblem> spatial_problem(std::size_t round) {
  HardProblem hard;
  Stream stream(round, "space", "hard problem");
  hard.world = one_of(stream, HardWorld3::kinds());
  hard.robot = one_of(stream, hard_body_kinds());
  const Placement placement = random_placement(stream);
  const double scale = placement.scale;
  World3 world = HardWorld3::make(hard.world, stream, placement);
  Robot3 robot = hard_body(hard.robot, stream, scale);
  Problem& problem = hard.problem;
  problem.scene = std::make_shared<const SpatialScene>(std::move(world), std::move(robot));
  problem.space = problem.scene->default_space(std::max(0.3 * scale, problem.scene->bounding_radius()));
  problem.resolution = draw_resolution(stream, scale);
  problem.collision = stream.below(4) == 0 ? "fcl_plain" : "fcl";
  hard.judge = std::make_unique<PathJudge>(problem.scene, problem.space);
  if (!draw_ends(stream, 1e-3 * scale, hard)) return std::nullopt;
  return hard;
}

/// Planners alone, and guided ones.
StrategySpec draw_strategy(Stream& stream, double step) {
  const auto planner = [step](const std::string& name, std::int64_t proposals) {
    std::vector<Options::Entry> options = {{"proposals", proposals}};
    if (name.starts_with("rrt")) options.emplace_back("step", step);
    return PlannerSpec::make(name, options);
  };
  const auto guide = [](const std::string& name) { return GuideSpec::make(name, {}); };
  static constexpr std::array planners = {"rrt", "rrt_connect", "prm", "rrt_star", "lazy_prm"};
  constexpr std::int64_t few = 1000;
  const std::string name = one_of(stream, planners);
  switch (stream.below(12)) {
    case 0: return guide("skeleton") >> planner("rrt", few);
    case 1: return guide("shrink") >> planner("rrt", few);
    case 2: return guide("workspace") >> planner("rrt_connect", few);
    case 3: return guide("lazy") >> planner(name, few);
    case 4: return guide("skeleton") >> guide("shrink") >> planner("rrt_connect", few);
    case 5: return planner("prm_star", few);
    case 6: return planner("lazy_rrg_star", few);
    case 7: return RandomSpecs(stream.bits()).strategy(2);
    case 8: return split(guide("shrink") >> planner("rrt", few), {.depth = 1});
    default: return planner(name, few);
  }
}

struct Counts {
  std::size_t runs = 0;
  std::size_t solved = 0;
  std::size_t hit = 0;
  std::size_t undecided = 0;
};

/// Runs problems until so many paths were judged. Reports each path that is not free.
template <class Draw>
void check_paths(std::size_t wanted, const Draw& draw) {
  std::map<std::string, Counts> by_world, by_robot, by_strategy;
  std::size_t paths = 0, refused = 0;
  std::vector<std::string> differences;
  for (std::size_t round = 0; paths < wanted && round < 40 * wanted; ++round) {
    const std::optional<HardProblem> hard = draw(round);
    if (!hard) continue;
    const Problem& problem = hard->problem;
    Stream stream(round, "", "strategy");
    StrategySpec tried = problem.motion_model != nullptr ? PlannerSpec::make("kinodynamic_rrt", {{"proposals", 3000.0}})
                                                         : draw_strategy(stream, 0.1 * problem.scene->diagonal());
    try {
      check(tried, problem);
    } catch (const Error&) {
      // The guide has no space for this robot.
      tried = tried.planner();
      ++refused;
    }
    INFO(fmt::format("round {}: {} in {}, {}, resolution {}", round, hard->robot, hard->world, tried.text(),
                     problem.resolution));
    const ExecuteOptions options{.shortcut = round % 3 == 0 ? 50 : 0};
    const RunRecord run = execute(tried, problem, round, options);
    const std::string kind = (tried.guide() != nullptr ? tried.guide()->name() + " >> " : "") + tried.planner().name();
    for (Counts* counts : {&by_world[hard->world], &by_robot[hard->robot], &by_strategy[kind]}) ++counts->runs;
    if (!run.solved) continue;
    ++paths;
    CHECK(problem.space.distance(run.path.front(), problem.start) <= problem.goal_tolerance);
    CHECK(problem.space.distance(run.path.back(), problem.goal()) <= problem.goal_tolerance);
    const Judgement judgement = hard->judge->path(run.path);
    for (Counts* counts : {&by_world[hard->world], &by_robot[hard->robot], &by_strategy[kind]}) {
      ++counts->solved;
      counts->hit += judgement.verdict == Verdict::hit ? 1U : 0U;
      counts->undecided += judgement.verdict == Verdict::undecided ? 1U : 0U;
    }
    if (judgement.verdict == Verdict::free) {
      CHECK(run.certified);
      const Judgement nearer = hard->judge->nearer(run.path, run.clearance);
      INFO("leg " << nearer.leg << " is nearer to " << nearer.what << " than the clearance " << run.clearance);
      CHECK(nearer.verdict != Verdict::hit);
      continue;
    }
    differences.push_back(fmt::format(
        "round {}: {} in {}, {}, {}, resolution {}: leg {} of {} at {} {} {}", round, hard->robot, hard->world,
        tried.text(), problem.collision, problem.resolution, judgement.leg, run.path.size() - 1, judgement.at,
        judgement.verdict == Verdict::hit ? "touches" : "is undecided beside", judgement.what));
  }
  if (paths_asked()) {
    for (const auto* table : {&by_world, &by_robot, &by_strategy}) {
      fmt::print("{:<36} {:>7} {:>7} {:>7} {:>9}\n", "", "runs", "paths", "hits", "undecided");
      for (const auto& [kind, counts] : *table) {
        fmt::print("{:<36} {:>7} {:>7} {:>7} {:>9}\n", kind, counts.runs, counts.solved, counts.hit, counts.undecided);
      }
    }
    fmt::print("{} strategies replaced by their planner\n", refused);
  }
  for (const std::string& difference : differences) UNSCOPED_INFO(difference);
  CHECK(differences.empty());
  CHECK(paths == wanted);
}

}  // namespace

TEST_CASE("no path reported in the plane touches anything, between its points too", "[certified][law]") {
  check_paths(paths_asked().value_or(200), planar_problem);
}

TEST_CASE("no path driven by a motion model touches anything, between its states too", "[certified][law]") {
  check_paths(paths_asked().value_or(30), driven_problem);
}

TEST_CASE("no path reported in space touches anything, between its points too", "[certified][law]") {
  check_paths(paths_asked().value_or(60), spatial_problem);
}

namespace {

/// Compares the judge with a checker at configurations, on random motions that begin valid.
template <class Draw>
void check_judge(std::size_t problems, const Draw& draw) {
  std::size_t free = 0, hit = 0;
  for (std::size_t round = 0; round < problems; ++round) {
    const std::optional<HardProblem> hard = draw(round);
    if (!hard) continue;
    const Problem& problem = hard->problem;
    const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
    Stream stream(round, "", "motions");
    Configuration a = problem.start, b(a.size()), q(a.size());
    for (int i = 0; i < 20; ++i) {
      problem.space.sample_uniform(stream, q);
      problem.space.interpolate(a, q, i % 4 == 0 ? 1.0 : stream.uniform(0.0, 0.3), b);
      const Judgement judgement = hard->judge->motion(a, b);
      INFO(fmt::format("round {}, motion {}: {} in {}, {}", round, i, hard->robot, hard->world, judgement.what));
      if (judgement.verdict == Verdict::free) {
        ++free;
        for (int k = 0; k < 40; ++k) {
          problem.space.interpolate(a, b, stream.uniform(), q);
          CHECK(checker->valid(q));
        }
        a = b;
      } else if (judgement.verdict == Verdict::hit && !problem.scene->is_point()) {
        ++hit;
        problem.space.interpolate(a, b, judgement.at, q);
        CHECK_FALSE(checker->valid(q));
      }
    }
  }
  CHECK(free > problems);
  CHECK(hit > problems);
}

}  // namespace

TEST_CASE("the judge agrees with both backends at configurations of random motions", "[certified][judge]") {
  check_judge(150, planar_problem);
  check_judge(100, spatial_problem);
}
