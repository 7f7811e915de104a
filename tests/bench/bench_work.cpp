// SPDX-License-Identifier: GPL-3.0-or-later
// Measures what the rates of set-ups are made from (GuideKind::set_up, beside each guide): the CPU time of a validity
// check, and of the set-up of the guides of each strategy of a script, once for a world and again in each run; and of a
// run of one proposal without a bound, less that of the planner alone: it makes h, and searches S where there is one.
//
//   bench_work SCRIPT [ROUNDS]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/level.hpp>

#include "support/renewed.hpp"

namespace {

using namespace trellis;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

template <class Body>
double median_seconds(int times, const Body& body) {
  std::vector<double> all;
  for (int i = 0; i < times; ++i) {
    const double begin = thread_seconds();
    body();
    all.push_back(thread_seconds() - begin);
  }
  return median(all);
}

/// The planner with a budget of one proposal, which h draws.
PlannerSpec of_one_proposal(const PlannerSpec& planner) {
  std::vector<Options::Entry> options = planner.options().entries();
  for (auto& [name, value] : options) {
    if (name == "proposals") value = 1.0;
    if (name == "bound" || name == "goal_bias" || name == "uniform") value = 0.0;
  }
  return PlannerSpec::make(planner.name(), options);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "bench_work SCRIPT [ROUNDS]\n");
    return 2;
  }
  const int times = argc > 2 ? std::max(1, std::atoi(argv[2])) : 5;
  std::ifstream file(argv[1]);
  std::stringstream text;
  text << file.rdbuf();
  // What is computed once for a world is computed again for each copy of the script's worlds.
  std::vector<dsl::Program> copies;
  for (int i = 0; i < times; ++i) copies.push_back(dsl::Session("").load(text.str(), argv[1]));
  const dsl::Program& program = copies.front();
  fmt::print("world,strategy,obstacles,check_us,once_us,each_us,first_proposal_us\n");
  for (std::size_t p = 0; p < program.experiment.problems.size(); ++p) {
    const Problem& problem = program.experiment.problems[p];
    const StrategySpec alone = program.experiment.strategies.front().second;
    const std::unique_ptr<Instance> root = root_instance(alone, problem);
    Stream stream(1, "0", "bench");
    Configurations at(root->space.dimension());
    Configuration q(root->space.dimension());
    constexpr int many = 20000;
    for (int i = 0; i < many; ++i) {
      root->space.sample_uniform(stream, q);
      at.push(q);
    }
    int valid = 0;
    const double check_s = median_seconds(5,
                                          [&] {
                                            for (std::size_t i = 0; i < at.size(); ++i)
                                              valid += root->validity->state(std::as_const(at)[i]) ? 1 : 0;
                                          }) /
                           many;
    for (const auto& [name, strategy] : program.experiment.strategies) {
      std::vector<double> first, again, proposed;
      try {
        for (const dsl::Program& copy : copies) {
          const Problem fresh = test::renewed(copy.experiment.problems[p]);
          const StrategySpec planner(strategy.planner());
          const auto seconds = [&](const StrategySpec& of) { return median_seconds(1, [&] { check(of, fresh); }); };
          static_cast<void>(seconds(planner));
          const double none = seconds(planner);
          first.push_back(seconds(strategy) - none);
          again.push_back(median_seconds(5, [&] { check(strategy, fresh); }) - none);
          const StrategySpec alone_once(of_one_proposal(strategy.planner()));
          const double unguided = median_seconds(5, [&] { execute(alone_once, fresh, 1); });
          if (strategy.guide() == nullptr) continue;
          const StrategySpec guided_once(of_one_proposal(strategy.planner()), *strategy.guide());
          proposed.push_back(median_seconds(5, [&] { execute(guided_once, fresh, 1); }) - unguided);
        }
      } catch (const std::exception& error) {
        fmt::print("{},{},{:.3f},error: {}\n", problem.name, name, 1e6 * check_s, error.what());
        continue;
      }
      const double each = median(again), once = median(first) - each;
      fmt::print("{},{},{},{:.3f},{:.1f},{:.1f},{:.1f}\n", problem.name, name, problem.scene->obstacle_count(),
                 1e6 * check_s, 1e6 * once, 1e6 * each, proposed.empty() ? 0.0 : 1e6 * median(proposed));
    }
  }
}
