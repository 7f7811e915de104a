// SPDX-License-Identifier: MIT-0
// guided [SCRIPT.lua [SEED]]: OMPL's RRTConnect, alone and with draws from a guide of Trellis, on the problems of a
// script. docs/sampler.md describes it.
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include <trellis/ompl.hpp>
#include <trellis/testing.hpp>

namespace {

/// Plans, and returns whether that found a path.
bool solve(const trellis::OmplProblem& problem) {
  ompl::geometric::RRTConnect planner(problem.information());
  planner.setRange(0.5);
  planner.setProblemDefinition(problem.definition());
  planner.setup();
  return planner.solve(ompl::base::timedPlannerTerminationCondition(10.0)) == ompl::base::PlannerStatus::EXACT_SOLUTION;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const auto script = trellis::testing::load(argc > 1 ? argv[1] : "problems.lua");
  ompl::msg::setLogLevel(ompl::msg::LOG_WARN);
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
  for (const std::string& name : script.problems()) {
    const trellis::Problem problem = script.problem(name);
    const trellis::OmplProblem alone(problem);
    const bool alone_solved = solve(alone);

    const trellis::OmplProblem with(problem);
    trellis::Sampler sampler(trellis::GuideSpec::make("skeleton", {}), problem, seed);
    const trellis::OmplGuide guide(with.information(), sampler, trellis::OmplGuide::Search::trees);
    const bool guided_solved = solve(with);

    std::cout << name << ": " << alone.checks() << " checks alone, " << guide.checks() + sampler.checks()
              << " with skeleton()" << (alone_solved && guided_solved ? "" : "; a planner found no path in 10 s")
              << '\n';
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
