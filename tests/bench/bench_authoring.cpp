// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the overhead of a strategy in Lua: runs the nested strategy of the first example, once from a script
// and once through the C++ interface, alternately on the same problem and seeds.
//
//   bench_authoring [ROUNDS]
//
// The two specs are equal, so the same code runs; the difference is the time to load the script.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdlib>
#include <string>
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

constexpr const char* script = R"(
local nested = skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 }
return experiment {
  problems = { scenes.simple_passage() }, strategies = { nested = nested }, seeds = 15, measure = tube { delta = 0.5 },
}
)";

StrategySpec through_cpp() {
  return GuideSpec::make("skeleton", {}) >> GuideSpec::make("shrink", {{"scale", 0.5}}) >>
         GuideSpec::make("lazy", {}) >> PlannerSpec::make("rrt", {{"step", 0.5}});
}

double execute_all(const StrategySpec& strategy, const Problem& problem) {
  const double begin = cpu_seconds();
  for (std::uint64_t seed = 1; seed <= 15; ++seed) execute(strategy, problem, seed);
  return cpu_seconds() - begin;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 30;
  std::vector<double> load;
  std::vector<double> lua;
  std::vector<double> cpp;
  std::vector<double> ratio;
  const dsl::Program first = dsl::Session("").load(script, "nested.lua");
  const StrategySpec built = through_cpp();
  if (!(first.experiment.strategies.front().second == built)) {
    fmt::print(stderr, "the two strategies differ\n");
    return 1;
  }
  for (int i = 0; i < rounds; ++i) {
    const double begin = cpu_seconds();
    const dsl::Program program = dsl::Session("").load(script, "nested.lua");
    load.push_back(cpu_seconds() - begin);
    const auto& problem = program.experiment.problems.front();
    const auto& authored = program.experiment.strategies.front().second;
    // The first of the two has a colder cache, so alternate the order too.
    const bool lua_first = i % 2 == 0;
    const double a = execute_all(lua_first ? authored : built, problem);
    const double b = execute_all(lua_first ? built : authored, problem);
    lua.push_back(lua_first ? a : b);
    cpp.push_back(lua_first ? b : a);
    ratio.push_back(lua.back() / cpp.back());
  }
  fmt::print("CPU time of 15 seeds of the nested strategy on simple_passage, {} rounds, medians\n", rounds);
  fmt::print("  through C++        {:8.3f} ms\n", 1e3 * median(cpp));
  fmt::print("  authored in Lua    {:8.3f} ms   ratio, paired by round: {:.4f}\n", 1e3 * median(lua), median(ratio));
  fmt::print("  loading the script {:8.3f} ms, once per experiment\n", 1e3 * median(load));
  return 0;
}
