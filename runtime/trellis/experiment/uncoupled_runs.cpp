// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/uncoupled_runs.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include <trellis/experiment/left_out.hpp>
#include <trellis/experiment/sequential_runs.hpp>
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
struct Coupling {
  std::size_t strategy = 0;
  std::vector<std::size_t> robots;                                   ///< Uncoupled::robots
  std::vector<std::vector<std::vector<std::size_t>>> touching = {};  ///< Uncoupled::touching
};
/// The couplings of a stage, with their tests.
struct Stage {
  std::vector<Coupling> couplings;
  std::vector<SequentialTest> tests;
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
        problem_(experiment.problems[problem]),
        runs_(experiment, result, problem, options, ablation_budget(experiment, result, problem_.name)) {
    for (const TeamMember& member : problem_.scene->members()) numbers_.push_back(member.number);
  }

  std::vector<Uncoupled> run() {
    Stage of_all;
    for (std::size_t s = 0; s < experiment_.strategies.size() && numbers_.size() > 1; ++s) {
      const auto& [name, strategy] = experiment_.strategies[s];
      if (!is_ablation(experiment_, name) && trellis::divides_team(strategy)) add(s, {}, of_all);
    }
    run_stage(of_all);
    // Of two robots there is one pair.
    Stage of_robots;
    for (std::size_t i = 0; i < of_all.tests.size(); ++i) {
      if (!needed(of_all.tests[i]) || numbers_.size() == 2) continue;
      for (const std::size_t number : numbers_) add(of_all.couplings[i].strategy, {number}, of_robots);
    }
    run_stage(of_robots);
    Stage of_pairs;
    for (std::size_t i = 0; i < of_robots.tests.size(); ++i) {
      for (std::size_t k = i + 1; k < of_robots.tests.size(); ++k) {
        const Coupling& one = of_robots.couplings[i];
        const Coupling& other = of_robots.couplings[k];
        if (one.strategy != other.strategy || !needed(of_robots.tests[i]) || !needed(of_robots.tests[k])) continue;
        add(one.strategy, {one.robots.front(), other.robots.front()}, of_pairs);
      }
    }
    run_stage(of_pairs);
    std::vector<Uncoupled> found;
    for (std::size_t s = 0; s < experiment_.strategies.size(); ++s) {
      for (Stage* stage : {&of_all, &of_robots, &of_pairs}) {
        for (std::size_t i = 0; i < stage->tests.size(); ++i) {
          if (stage->tests[i].strategy != s) continue;
          found.push_back({problem_.name, experiment_.strategies[s].first, std::move(stage->couplings[i].robots),
                           std::move(stage->tests[i].pairs), stage->tests[i].work,
                           std::move(stage->couplings[i].touching)});
        }
      }
    }
    return found;
  }

 private:
  /// Adds a test of some robots, unless their scene cannot be changed.
  void add(std::size_t strategy, std::vector<std::size_t> robots, Stage& stage) const {
    std::vector<RobotPair> pairs;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      for (std::size_t k = i + 1; k < numbers_.size(); ++k) {
        const auto concerns = [&](std::size_t robot) { return robot == numbers_[i] || robot == numbers_[k]; };
        if (std::all_of(robots.begin(), robots.end(), concerns)) pairs.emplace_back(numbers_[i], numbers_[k]);
      }
    }
    Problem problem = problem_;
    problem.scene = uncoupled(*problem_.scene, pairs);
    if (!problem.scene) return;
    stage.couplings.push_back({strategy, std::move(robots)});
    stage.tests.push_back({strategy, experiment_.strategies[strategy].second, std::move(problem)});
  }

  /// Whether some seed is solved only where the robots do not pass through each other.
  [[nodiscard]] static bool needed(const SequentialTest& test) {
    return std::any_of(test.pairs.begin(), test.pairs.end(), [](const TestedPair& pair) {
      return pair.with.solved && !pair.without.solved && !pair.without.cut_off;
    });
  }

  void run_stage(Stage& stage) {
    const auto cost = [&](std::size_t i, const RunRecord& run) {
      CensoredCost found = first_path_cost(run);
      if (found.solved) found.solved = path_fault(problem_, run.path).empty();
      if (stage.couplings[i].robots.empty()) stage.couplings[i].touching.push_back(touching_on(problem_, run.path));
      return found;
    };
    const auto ratio = [](const TestedPair& pair) { return solved_bracket(pair.with, pair.without); };
    runs_.run(stage.tests, {.cost = cost, .ratio = ratio});
  }

  const Experiment& experiment_;
  const Problem& problem_;
  SequentialRuns runs_;
  std::vector<std::size_t> numbers_;
};

}  // namespace

bool divides_team(const StrategySpec& strategy) {
  return strategy.guide() != nullptr && divides_team(*strategy.guide());
}

void run_uncoupled(const Experiment& experiment, ExperimentResult& result, const ExperimentOptions& options) {
  result.uncoupled.clear();
  if (experiment.ablation <= 0.0) return;
  for (std::size_t p = 0; p < experiment.problems.size(); ++p) {
    std::vector<Uncoupled> found = ProblemUncoupled(experiment, result, p, options).run();
    std::move(found.begin(), found.end(), std::back_inserter(result.uncoupled));
  }
}

}  // namespace trellis
