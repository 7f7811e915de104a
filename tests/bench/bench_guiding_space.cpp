// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the overhead of a guide in Lua: runs built-in guides and the same guides by guiding_space, alternately
// on the same problems and seeds, per proposal over all levels.
//
//   bench_guiding_space [ROUNDS]
//
// The result includes loading the script where a run does; the benchmark also prints the time that `check` takes,
// which creates the levels of a run without searching.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/strategy/executor.hpp>

namespace {

using namespace trellis;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Pairs: the built-in first.
constexpr const char* script = R"(
local root = rrt { step = 0.5, proposals = 20000 }
local half = guiding_space {
  name = "half", robot = function(instance) return instance.robot:scaled(0.5) end,
}
local informed = guiding_space {
  name = "informed", robot = function(instance) return instance.robot:scaled(0.5) end,
  observe = function(outcome) end, stale = function() return false end,
}
local point = guiding_space {
  name = "point", space = { "x", "y" }, robot = robot.point(),
  heuristic = function(found) return lifted(along(found.path, { radius = 0.5 })) end,
}
local drawn = guiding_space {
  name = "drawn", space = {},
  heuristic = function(_, instance)
    local lower, upper = instance.space.lower, instance.space.upper
    local x, y, t = lower[1], lower[2], lower[3]
    local dx, dy, dt = upper[1] - x, upper[2] - y, upper[3] - t
    return function(random) return x + dx * random(), y + dy * random(), t + dt * random() end
  end,
}
return experiment {
  problems = { scenes.simple_passage(), scenes.trap() },
  strategies = {
    { "shrink", shrink(0.5) >> root }, { "shrink in Lua", half >> root },
    { "shrink, once more", shrink(0.5) >> root }, { "shrink in Lua, receives every outcome", informed >> root },
    { "workspace", workspace { radius = 0.5, planner = rrt {} } >> root }, { "workspace in Lua", point >> root },
    { "uniform", uniform() >> root }, { "uniform in Lua, each sample by a function", drawn >> root },
  },
  seeds = 15, measure = false,
}
)";

struct Cost {
  double seconds = 0.0;
  double set_up = 0.0;
  double proposals = 0.0;
};

Cost execute_all(const StrategySpec& strategy, const Problem& problem) {
  Cost cost;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const double begin = cpu_seconds();
    check(strategy, problem);
    const double made = cpu_seconds();
    cost.set_up += made - begin;
    {
      const RunRecord run = execute(strategy, problem, seed);
      for (const auto& level : run.levels) cost.proposals += static_cast<double>(level.search.proposals.size());
    }
    // The run has released its memory by now, its interpreter too.
    cost.seconds += cpu_seconds() - made;
  }
  return cost;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 10;
  const Experiment experiment = dsl::Session("").load(script, "twins.lua").experiment;
  constexpr double nano = 1e9;
  fmt::print("{:<16} {:<42} {:>12} {:>12} {:>8} {:>12}\n", "problem", "guide", "ns/proposal", "built-in", "ratio",
             "load, ms");
  for (const Problem& problem : experiment.problems) {
    for (std::size_t i = 0; i + 1 < experiment.strategies.size(); i += 2) {
      std::vector<double> own;
      std::vector<double> built_in;
      std::vector<double> ratio;
      std::vector<double> load;
      for (int round = 0; round < rounds; ++round) {
        const Cost a = execute_all(experiment.strategies[i].second, problem);
        const Cost b = execute_all(experiment.strategies[i + 1].second, problem);
        built_in.push_back(nano * a.seconds / a.proposals);
        own.push_back(nano * b.seconds / b.proposals);
        ratio.push_back(own.back() / built_in.back());
        load.push_back(1e3 * (b.set_up - a.set_up) / 15);
      }
      fmt::print("{:<16} {:<42} {:>12.0f} {:>12.0f} {:>8.2f} {:>12.2f}\n", problem.name,
                 experiment.strategies[i + 1].first, median(own), median(built_in), median(ratio), median(load));
    }
  }
  return 0;
}
