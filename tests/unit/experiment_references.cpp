// SPDX-License-Identifier: GPL-3.0-or-later
// Perfect guidance scores 0 and uniform sampling its own divergence, in every scene; the score of a guide whose tube is
// the target.
#include <cmath>
#include <string>
#include <vector>

#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/targets.hpp>
#include <trellis/measure/samples.hpp>
#include <trellis/measure/statistics.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

StrategySpec plain() { return {PlannerSpec::make("rrt", {{"step", 0.5}})}; }

Experiment experiment_on(const Problem& problem, const StrategySpec& strategy, std::size_t seeds) {
  Experiment experiment;
  experiment.problems = {problem};
  experiment.strategies = {{"strategy", strategy}};
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) experiment.seeds.push_back(seed);
  experiment.measure = Measure{};
  experiment.measure->cross = 0;
  return experiment;
}

/// The estimators' errors where the truth is 0 (docs/measure.md: T itself).
constexpr double accuracy = 0.01;

void check_zero(const std::vector<double>& values) {
  const Interval interval = student_interval(values, 0.99);
  CAPTURE(interval.value, interval.lo, interval.hi);
  CHECK(interval.lo <= accuracy);
  CHECK(interval.hi >= -accuracy);
}

/// Of samples that all lie in the target, which estimators are sure about.
void check_perfect(const std::vector<double>& values) {
  check_zero(values);
  CHECK(std::abs(student_interval(values).value) < 0.05);
}

}  // namespace

TEST_CASE("in every scene the oracle scores 0 and uniform sampling its own divergence, tree and expansion",
          "[references][slow]") {
  const std::vector<Problem> scenes = {test::simple_passage_problem(), test::trap_problem(), test::cup_problem(),
                                       test::point_problem(3)};
  for (const Problem& scene : scenes) {
    for (const auto distance : {TubeSettings::Distance::planar, TubeSettings::Distance::full}) {
      // Expansions of RRT have a closed density: `exact` scores these, `knn` the trees.
      Experiment experiment = experiment_on(scene, plain(), 8);
      TubeSettings tube;
      tube.distance = distance;
      experiment.measure->target = tube;
      std::vector<double> perfect_tree;
      std::vector<double> perfect_expansion;
      std::vector<double> uniform_tree;
      std::vector<double> uniform_expansion;
      for (const RunResult& run : run(experiment).runs) {
        REQUIRE(run.run.solved);
        const LevelResult& root = run.levels.front();
        REQUIRE(root.oracle);
        REQUIRE(root.uniform);
        perfect_tree.push_back(root.oracle->tree.value - root.oracle->tree.perfect);
        perfect_expansion.push_back(root.oracle->expansion.value - root.oracle->expansion.perfect);
        uniform_tree.push_back(root.uniform->tree.above_uniform);
        uniform_expansion.push_back(root.uniform->expansion.above_uniform);
      }
      CAPTURE(scene.name, to_string(distance));
      check_perfect(perfect_tree);
      check_perfect(perfect_expansion);
      check_zero(uniform_tree);
      check_zero(uniform_expansion);
    }
  }
}

TEST_CASE("every estimator that claims accuracy scores the oracle 0", "[references][slow]") {
  for (const Problem& scene : {test::simple_passage_problem(), test::cup_problem(), test::point_problem(3)}) {
    const ExperimentResult result = run(experiment_on(scene, plain(), 8));
    for (const EstimatorSpec& estimator : {EstimatorSpec::make("exact"), EstimatorSpec::make("knn"),
                                           EstimatorSpec::make("arc", {{"dimension", std::int64_t{1}}})}) {
      std::vector<double> scores;
      for (const RunResult& run : result.runs) {
        REQUIRE(run.run.solved);
        const LevelRecord& record = run.levels.front().record;
        const auto anywhere = [](View) { return true; };
        const Target target(record.space, run.run.path, record.position_axes, TubeSettings{}, anywhere, run.seed);
        Stream stream(run.seed, "", "oracle");
        const double density = std::exp(-target.log_volume());
        const Efficiency e = efficiency(
            target, target.draw(1000, stream),
            {.estimators = {estimator}, .density = [&](View x) { return target.contains(x) ? density : 0.0; }});
        REQUIRE(e.estimator == estimator.text());
        scores.push_back(e.unregularised);
      }
      CAPTURE(scene.name, estimator.text());
      check_perfect(scores);
    }
  }
}

TEST_CASE("identity() is near perfect on the tube that it proposes in, and a thinner tube is not", "[references]") {
  constexpr double delta = 0.4;
  TubeSettings tube;
  tube.distance = TubeSettings::Distance::full;
  tube.delta = delta;
  struct Found {
    std::vector<double> value;
    std::vector<double> mass;
    std::vector<double> uniform;
  };
  const auto score = [&](double radius) {
    // The tube, and no more: without bounded loss, uniform proposals and goal bias all that is proposed lies in it.
    const StrategySpec strategy =
        GuideSpec::make("identity", {{"radius", radius}, {"follow", std::string("tube")}}) >>
        StrategySpec(PlannerSpec::make("rrt", {{"step", 0.5}, {"uniform", 0.0}, {"bound", 0.0}, {"goal_bias", 0.0}}));
    Found found;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const RunResult run = run_cell("identity", strategy, test::point_problem(3), seed);
      REQUIRE(run.levels.size() == 2);
      // The tube about the path that guides, not about the one that was found along it.
      const LevelRecord& root = run.levels[0].record;
      const Configurations& path = run.levels[1].record.solution.path;
      const Target target(
          root.space, path, {}, tube, [](View) { return true; }, seed);
      REQUIRE(root.root_proposal_density);
      const Efficiency e =
          efficiency(target, root.root_proposals(),
                     {.estimators = {EstimatorSpec::make("exact")}, .density = root.root_proposal_density});
      found.value.push_back(e.value - e.perfect);
      found.mass.push_back(e.parts.mass - e.perfect);
      found.uniform.push_back(e.uniform);
    }
    return found;
  };
  const Found matched = score(delta);
  const Found thin = score(0.25 * delta);
  const double of_matched = student_interval(matched.value).value;
  const double of_thin = student_interval(thin.value).value;
  const double uniform = student_interval(matched.uniform).value;
  CAPTURE(of_matched, of_thin, uniform, student_interval(matched.mass).value);
  CHECK(std::abs(student_interval(matched.mass).value) < 0.05);
  CHECK(of_matched < 0.25 * uniform);
  CHECK(of_thin > of_matched + 0.5);
  // What the thin tube loses is spread: its mass is perfect as well.
  CHECK(std::abs(student_interval(thin.mass).value) < 0.05);
}
