// SPDX-License-Identifier: GPL-3.0-or-later
// The part that bench_rrt and the OMPL peer share, so that both measure the same and report it in the same format: the
// scenes of the paper, the clock, the command line, and the lines of results. Includes neither library.
#pragma once

#include <time.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace bench {

/// An axis-aligned rectangle, metres.
struct Rectangle {
  double xmin, ymin, xmax, ymax;
};

/// x, y in metres, theta in radians.
using Pose = std::array<double, 3>;

/// A robot of 0.6 x 0.2 m, centred on its reference point, in a world of 10 x 10 m.
struct Scene {
  std::string name;
  Pose start;
  Pose goal;
  std::vector<Rectangle> obstacles;
};

inline constexpr double world_size = 10.0;
inline constexpr double robot_length = 0.6;
inline constexpr double robot_width = 0.2;

// How both sides plan.
inline constexpr double step = 0.5;
inline constexpr double goal_bias = 0.05;
inline constexpr double goal_tolerance = 1e-6;
inline constexpr double resolution = 0.05;
/// Iterations after which a run counts as unsolved: a count, so that runs repeat exactly.
inline constexpr std::uint64_t iteration_limit = 1'000'000;

/// The three scenes of Attali et al., Evaluating Guiding Spaces for Motion Planning (2022).
inline const std::vector<Scene>& scenes() {
  static const std::vector<Scene> all = {
      {"simple_passage", {1, 8.5, 0}, {9, 1.5, 0}, {{4, 0, 6, 4.75}, {4, 5.25, 6, 10}}},
      {"trap",
       {1, 4, 0},
       {9, 4, 0},
       {{4.5, 0, 5.5, 1.925},
        {4.5, 2.075, 5.5, 3.325},
        {4.5, 3.475, 5.5, 4.525},
        {4.5, 4.675, 5.5, 5.05},
        {5.3, 5.05, 5.5, 5.55},
        {4.5, 5.55, 5.5, 5.925},
        {4.5, 6.075, 5.5, 6.95},
        {5.3, 6.95, 5.5, 7.45},
        {4.5, 7.45, 5.5, 8.75},
        {4.5, 9.25, 5.5, 10}}},
      {"cup", {1, 5, 0}, {9, 5, 0}, {{6.5, 1.5, 7, 8.5}, {3, 1.5, 6.5, 2}, {3, 8, 6.5, 8.5}}},
  };
  return all;
}

/// CPU time of the calling thread, seconds.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One run of the planner.
struct Run {
  bool solved = false;
  double cpu = 0.0;       ///< CPU seconds of the library's call that solves
  double planning = 0.0;  ///< seconds of the planner's loop alone, on the clock that the library offers
  std::uint64_t iterations = 0;
  std::uint64_t checks = 0;  ///< validity checks
  std::uint64_t nodes = 0;
};

struct Arguments {
  std::vector<Scene> scenes = bench::scenes();
  std::string checker;
  std::string planner = "rrt";
  std::string metric = "own";  ///< of the peer
  std::uint64_t seeds = 100;
};

/// The planners that both sides have, by our names.
inline const std::vector<std::string>& planners() {
  static const std::vector<std::string> all = {"rrt", "rrt_connect", "prm"};
  return all;
}

/// Reads [--scene NAME] [--checker NAME] [--planner NAME] [--metric own|trellis] [--seeds N]; the first of `checkers`
/// is the default. Throws std::invalid_argument.
inline Arguments parse(int argc, char** argv, const std::vector<std::string>& checkers) {
  Arguments result;
  result.checker = checkers.front();
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i];
    if (i + 1 == argc) throw std::invalid_argument(name + " needs a value");
    const std::string value = argv[i + 1];
    if (name == "--scene") {
      std::erase_if(result.scenes, [&](const Scene& scene) { return scene.name != value; });
      if (result.scenes.empty()) throw std::invalid_argument("no scene " + value);
    } else if (name == "--checker") {
      if (std::find(checkers.begin(), checkers.end(), value) == checkers.end()) {
        throw std::invalid_argument("no checker " + value);
      }
      result.checker = value;
    } else if (name == "--planner") {
      if (std::find(planners().begin(), planners().end(), value) == planners().end()) {
        throw std::invalid_argument("no planner " + value);
      }
      result.planner = value;
    } else if (name == "--metric") {
      if (value != "own" && value != "trellis") throw std::invalid_argument("no metric " + value);
      result.metric = value;
    } else if (name == "--seeds") {
      const char* end = value.data() + value.size();
      const auto [stop, error] = std::from_chars(value.data(), end, result.seeds);
      if (error != std::errc() || stop != end || result.seeds == 0) {
        throw std::invalid_argument("--seeds needs a positive integer, got " + value);
      }
    } else {
      throw std::invalid_argument("unknown option " + name);
    }
  }
  return result;
}

/// Runs `plan` for every scene and seed and prints a line for each run, the fields separated by tabs:
/// RUN, side, checker, scene, seed, solved (0 or 1), CPU seconds, seconds of planning, iterations, checks, nodes.
inline void measure(const Arguments& arguments, const std::string& side,
                    const std::function<Run(const Scene&, std::uint64_t seed)>& plan) {
  for (const Scene& scene : arguments.scenes) {
    static_cast<void>(plan(scene, 1));  // warms caches up; its time is not kept
    for (std::uint64_t seed = 1; seed <= arguments.seeds; ++seed) {
      const Run run = plan(scene, seed);
      std::printf("RUN\t%s\t%s\t%s\t%" PRIu64 "\t%d\t%.9f\t%.9f\t%" PRIu64 "\t%" PRIu64 "\t%" PRIu64 "\n", side.c_str(),
                  arguments.checker.c_str(), scene.name.c_str(), seed, run.solved ? 1 : 0, run.cpu, run.planning,
                  run.iterations, run.checks, run.nodes);
    }
  }
}

}  // namespace bench
