// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/uncoupled_runs.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include <trellis/base/parallel.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/left_out.hpp>
#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/scene/uncoupled.hpp>

namespace trellis {

namespace {

bool divides_team(const GuideSpec& guide) {
  if (guide.kind() != GuideSpec::Kind::component) {
    return std::any_of(guide.terms().begin(), guide.terms().end(),
                       [](const GuideSpec::Term& term) { return divides_team(term.guide); });
  }
  if (!guide.custom() && find_guide(guide.name())->divides_team) return true;
  return guide.below() != nullptr && divides_team(*guide.below());
}

/// A strategy on a problem in which some robots pass through each other.
struct Test {
  std::size_t strategy = 0;
  std::vector<std::size_t> robots;  ///< Uncoupled::robots
  Problem problem;
  std::vector<CensoredCost> costs = {};
  std::vector<std::vector<std::vector<std::size_t>>> touching = {};  ///< Uncoupled::touching
};

/// Returns the pairs of robots, by their numbers, that touch on a path.
std::vector<std::vector<std::size_t>> touching_on(const Problem& problem, const Configurations& path) {
  std::vector<std::vector<std::size_t>> touching;
  const std::vector<TeamMember> members = problem.scene->members();
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t k = i + 1; k < members.size() && path.size() > 0; ++k) {
      const std::vector<std::size_t> axes = axes_of(members, {i, k});
      const AxisProjection both(problem.space, axes, "pair");
      const bool all = axes.size() == problem.space.dimension();
      const auto validity = make_validity(problem.collision, all ? problem.scene : problem.scene->reduced(axes),
                                          both.space(), problem.resolution, nullptr);
      Configurations part(axes.size());
      Configuration q(axes.size());
      for (std::size_t c = 0; c < path.size(); ++c) {
        both.project(path[c], q);
        part.push(q);
      }
      const PathCertificate certificate = certify(both.space(), *validity, part, certificate_tolerance(problem));
      if (!certificate.certified()) touching.push_back({members[i].number, members[k].number});
    }
  }
  return touching;
}

/// The runs on one problem.
class ProblemUncoupled {
 public:
  ProblemUncoupled(const Experiment& experiment, const ExperimentResult& result, std::size_t problem,
                   const ExperimentOptions& options)
      : experiment_(experiment),
        options_(options),
        problem_(experiment.problems[problem]),
        first_run_(&result.runs[problem * experiment.strategies.size() * experiment.seeds.size()]),
        left_(ablation_budget(experiment, result, problem_.name)) {
    for (const TeamMember& member : problem_.scene->members()) numbers_.push_back(member.number);
  }

  std::vector<Uncoupled> run() {
    std::vector<std::size_t> dividing;
    for (std::size_t s = 0; s < experiment_.strategies.size() && numbers_.size() > 1; ++s) {
      const auto& [name, strategy] = experiment_.strategies[s];
      if (!is_ablation(experiment_, name) && trellis::divides_team(strategy)) dividing.push_back(s);
    }
    std::vector<Test> of_all;
    for (const std::size_t s : dividing) add(s, {}, of_all);
    if (!of_all.empty() && run_stage(of_all)) {
      // Of two robots there is one pair.
      std::vector<Test> of_robots;
      for (const Test& all : of_all) {
        if (!needed(all) || numbers_.size() == 2) continue;
        for (const std::size_t number : numbers_) add(all.strategy, {number}, of_robots);
      }
      if (!of_robots.empty() && run_stage(of_robots)) {
        std::vector<Test> of_pairs;
        for (std::size_t i = 0; i < of_robots.size(); ++i) {
          for (std::size_t k = i + 1; k < of_robots.size(); ++k) {
            if (of_robots[i].strategy != of_robots[k].strategy) continue;
            if (!needed(of_robots[i]) || !needed(of_robots[k])) continue;
            add(of_robots[i].strategy, {of_robots[i].robots.front(), of_robots[k].robots.front()}, of_pairs);
          }
        }
        if (!of_pairs.empty()) run_stage(of_pairs);
        std::move(of_pairs.begin(), of_pairs.end(), std::back_inserter(of_robots));
      }
      std::move(of_robots.begin(), of_robots.end(), std::back_inserter(of_all));
    }
    std::stable_sort(of_all.begin(), of_all.end(),
                     [](const Test& a, const Test& b) { return a.strategy < b.strategy; });
    std::vector<Uncoupled> found;
    found.reserve(of_all.size());
    for (Test& test : of_all) {
      found.push_back({problem_.name, experiment_.strategies[test.strategy].first, std::move(test.robots),
                       std::move(test.costs), std::move(test.touching)});
    }
    return found;
  }

 private:
  /// Adds a test of some robots, unless their scene cannot be changed.
  void add(std::size_t strategy, std::vector<std::size_t> robots, std::vector<Test>& tests) const {
    std::vector<RobotPair> pairs;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      for (std::size_t k = i + 1; k < numbers_.size(); ++k) {
        const auto concerns = [&](std::size_t robot) { return robot == numbers_[i] || robot == numbers_[k]; };
        if (std::all_of(robots.begin(), robots.end(), concerns)) pairs.emplace_back(numbers_[i], numbers_[k]);
      }
    }
    Problem problem = problem_;
    problem.scene = uncoupled(*problem_.scene, pairs);
    if (problem.scene) tests.push_back({strategy, std::move(robots), std::move(problem)});
  }

  [[nodiscard]] const RunRecord& complete(const Test& test, std::size_t seed) const {
    return first_run_[test.strategy * experiment_.seeds.size() + seed].run;
  }
  /// Whether some seed is solved only where the robots do not pass through each other.
  [[nodiscard]] bool needed(const Test& test) const {
    for (std::size_t i = 0; i < test.costs.size(); ++i) {
      if (complete(test, i).solved && !test.costs[i].solved) return true;
    }
    return false;
  }

  /// Returns whether the work that is left sufficed.
  bool run_stage(std::vector<Test>& tests) {
    double spent = 0.0;
    std::size_t tested = 0;
    while (tested < experiment_.seeds.size() && spent < left_) {
      spent += run_seed(tested++, tests);
      // An estimate for as many seeds as a verdict takes.
      const auto seeds = static_cast<double>(std::max(tested, least_tested_seeds));
      if (tested < least_tested_seeds && spent / static_cast<double>(tested) * seeds > left_) break;
    }
    left_ -= spent;
    if (tested >= least_tested_seeds) return true;
    for (Test& test : tests) {
      test.costs.clear();
      test.touching.clear();
    }
    return false;
  }

  /// Returns the work of all runs on the seed.
  double run_seed(std::size_t seed, std::vector<Test>& tests) {
    std::vector<double> work(tests.size(), 0.0);
    std::vector<CensoredCost> costs(tests.size());
    std::vector<std::vector<std::vector<std::size_t>>> touching(tests.size());
    in_parallel(tests.size(), options_.jobs, [&](std::size_t i) {
      const Test& test = tests[i];
      const auto interrupted = [this] { return options_.interrupted && options_.interrupted(); };
      if (interrupted()) throw Interrupted();
      const RunRecord run =
          execute(experiment_.strategies[test.strategy].second, test.problem, experiment_.seeds[seed],
                  {.interrupted = options_.interrupted,
                   .measured = false,
                   .threads = options_.threads,
                   .work_limit = most_left_out_work * complete(test, seed).work + companion_constant.work});
      if (interrupted()) throw Interrupted();
      work[i] = run.work;
      costs[i] = {static_cast<double>(run.validity_checks - run.improvement_checks),
                  run.solved && path_fault(problem_, run.path).empty()};
      if (test.robots.empty()) touching[i] = touching_on(problem_, run.path);
    });
    double sum = 0.0;
    for (std::size_t i = 0; i < tests.size(); ++i) {
      sum += work[i];
      tests[i].costs.push_back(costs[i]);
      if (tests[i].robots.empty()) tests[i].touching.push_back(std::move(touching[i]));
    }
    return sum;
  }

  const Experiment& experiment_;
  const ExperimentOptions& options_;
  const Problem& problem_;
  const RunResult* first_run_;
  double left_;  ///< of the budget
  std::vector<std::size_t> numbers_;
};

}  // namespace

bool divides_team(const StrategySpec& strategy) {
  return strategy.guide() != nullptr && divides_team(*strategy.guide());
}

void run_uncoupled(const Experiment& experiment, ExperimentResult& result, const ExperimentOptions& options) {
  result.uncoupled.clear();
  if (experiment.ablation <= 0.0 || experiment.seeds.size() < least_tested_seeds) return;
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    std::vector<Uncoupled> found = ProblemUncoupled(experiment, result, p, options).run();
    std::move(found.begin(), found.end(), std::back_inserter(result.uncoupled));
  }
}

}  // namespace trellis
