// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/scene/planar/scene.hpp>
#include "support/catch.hpp"

using namespace trellis;

namespace {

/// A 10 x 10 world with a wall that leaves a gap, a rectangle robot.
Problem passage(const std::string& name, double gap = 2.0) {
  const Box2 bounds{{0, 0}, {10, 10}};
  const std::vector<Obstacle> walls = {{"lower wall", Box2{{4.5, 0}, {5.5, 5 - 0.5 * gap}}},
                                       {"upper wall", Box2{{4.5, 5 + 0.5 * gap}, {5.5, 10}}}};
  auto scene = std::make_shared<PlanarScene>(
      World(bounds, walls), Robot::rigid({Polygon{{{-0.3, -0.1}, {0.3, -0.1}, {0.3, 0.1}, {-0.3, 0.1}}}}));
  Problem problem;
  problem.name = name;
  problem.space = default_space(planar(*scene).robot, planar(*scene).world, 1.0 / std::numbers::pi);
  problem.scene = std::move(scene);
  problem.start = {1, 8, 0};
  problem.goals = {{9, 2, 0}};
  return problem;
}

Experiment small() {
  Experiment experiment;
  experiment.problems = {passage("wide", 3.0), passage("narrow", 1.5)};
  const PlannerSpec rrt = PlannerSpec::make("rrt", {{"step", 0.5}});
  experiment.strategies = {{"rrt", rrt}, {"shrunken", GuideSpec::make("shrink", {{"scale", 0.5}}) >> rrt}};
  experiment.seeds = {1, 2};
  TubeSettings measure;
  measure.points = 256;
  measure.pool = 1024;
  experiment.measure = Measure{.target = measure, .cross = 1};
  return experiment;
}

bool same(const Configurations& a, const Configurations& b) {
  return a.dimension() == b.dimension() &&
         std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

/// Equal figures, NaN equal to NaN.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same(const std::optional<Scores>& a, const std::optional<Scores>& b) {
  if (a.has_value() != b.has_value()) return false;
  return !a || (same(a->tree.value, b->tree.value) && same(a->expansion.value, b->expansion.value) &&
                same(a->tree.coverage, b->tree.coverage) && same(a->tree.uniform, b->tree.uniform));
}

void check_same(const ExperimentResult& a, const ExperimentResult& b) {
  REQUIRE(a.runs.size() == b.runs.size());
  for (std::size_t i = 0; i < a.runs.size(); ++i) {
    const RunResult& x = a.runs[i];
    const RunResult& y = b.runs[i];
    CAPTURE(x.problem, x.strategy, x.seed);
    CHECK(x.problem == y.problem);
    CHECK(x.strategy == y.strategy);
    CHECK(x.seed == y.seed);
    CHECK(x.run.status == y.run.status);
    CHECK(x.run.validity_checks == y.run.validity_checks);
    CHECK(same(x.run.path, y.run.path));
    REQUIRE(x.levels.size() == y.levels.size());
    for (std::size_t l = 0; l < x.levels.size(); ++l) {
      CHECK(same(x.levels[l].record.search.nodes, y.levels[l].record.search.nodes));
      CHECK(same(x.levels[l].record.search.proposals, y.levels[l].record.search.proposals));
      CHECK(same(x.levels[l].own, y.levels[l].own));
      CHECK(same(x.levels[l].root, y.levels[l].root));
    }
  }
}

}  // namespace

TEST_CASE("an experiment runs every cell, in a fixed order", "[experiment]") {
  const Experiment experiment = small();
  const ExperimentResult result = run(experiment);
  REQUIRE(result.runs.size() == 8);
  std::size_t i = 0;
  for (const auto& problem : experiment.problems) {
    for (const auto& [strategy, spec] : experiment.strategies) {
      for (const auto seed : experiment.seeds) {
        const RunResult& cell = result.runs[i++];
        CAPTURE(problem.name, strategy, seed);
        CHECK(cell.problem == problem.name);
        CHECK(cell.strategy == strategy);
        CHECK(cell.seed == seed);
        CHECK(cell.run.levels.empty());
        REQUIRE(cell.levels.size() == (strategy == "rrt" ? 1 : 2));
        for (const auto& level : cell.levels) CHECK_FALSE(level.record.valid);
        REQUIRE(cell.run.solved);
        // The root's own target is the root's target.
        REQUIRE(cell.levels[0].own);
        CHECK(same(cell.levels[0].own, cell.levels[0].root));
        CHECK(std::isfinite(cell.levels[0].own->tree.value));
        CHECK(cell.levels[0].own->tree.above_uniform ==
              Approx(cell.levels[0].own->tree.uniform - cell.levels[0].own->tree.value));
        if (strategy == "shrunken") {
          REQUIRE(cell.levels[1].root);
          CHECK(cell.levels[1].root->tree.uniform == cell.levels[0].root->tree.uniform);
          CHECK(cell.levels[1].own.has_value() == cell.levels[1].record.solution.solved());
        }
      }
    }
  }
}

TEST_CASE("the result does not depend on the number of jobs", "[experiment]") {
  const Experiment experiment = small();
  const ExperimentResult one = run(experiment);
  ExperimentOptions two;
  two.jobs = 2;
  check_same(one, run(experiment, two));
  two.jobs = 100;  // more than there are cells
  check_same(one, run(experiment, two));
}

TEST_CASE("measuring does not change a run", "[experiment]") {
  Experiment experiment = small();
  const ExperimentResult measured = run(experiment);
  experiment.measure.reset();
  const ExperimentResult plain = run(experiment);
  REQUIRE(plain.runs.size() == measured.runs.size());
  for (std::size_t i = 0; i < plain.runs.size(); ++i) {
    CHECK(plain.runs[i].run.validity_checks == measured.runs[i].run.validity_checks);
    CHECK(same(plain.runs[i].run.path, measured.runs[i].run.path));
    for (const auto& level : plain.runs[i].levels) {
      CHECK_FALSE(level.own);
      CHECK_FALSE(level.root);
      CHECK_FALSE(level.record.valid);
    }
  }
}

TEST_CASE("the thread that plans a run finds the obstacles that rejected its proposals", "[experiment]") {
  const Experiment experiment = small();
  std::size_t rejected = 0;
  for (const RunResult& cell : run(experiment).runs) {
    for (const LevelResult& level : cell.levels) {
      const Rejections again = rejections(level.record, experiment.problems.front().resolution);
      REQUIRE(level.rejections);
      CHECK(level.rejections->rejected == again.rejected);
      CHECK(level.rejections->by == again.by);
      rejected += again.rejected;
    }
  }
  CHECK(rejected > 0);
}

TEST_CASE("an unsolved run has no target", "[experiment]") {
  Experiment experiment = small();
  experiment.problems = {passage("narrow", 1.0)};
  experiment.strategies = {{"short", PlannerSpec::make("rrt", {{"step", 0.5}, {"proposals", 5.0}})}};
  const ExperimentResult result = run(experiment);
  for (const auto& cell : result.runs) {
    CHECK_FALSE(cell.run.solved);
    REQUIRE(cell.levels.size() == 1);
    CHECK_FALSE(cell.levels[0].own);
    CHECK_FALSE(cell.levels[0].root);
  }
}

TEST_CASE("progress reports every cell, one at a time", "[experiment]") {
  Experiment experiment = small();
  experiment.measure.reset();
  for (const unsigned jobs : {1U, 2U}) {
    std::vector<std::size_t> reported;
    std::atomic<int> inside{0};
    bool overlapped = false;
    ExperimentOptions options;
    options.jobs = jobs;
    options.progress = [&](std::size_t done, std::size_t all) {
      if (inside.fetch_add(1) != 0) overlapped = true;
      reported.push_back(done);
      if (all != 8) overlapped = true;
      inside.fetch_sub(1);
    };
    static_cast<void>(run(experiment, options));
    CHECK_FALSE(overlapped);
    CHECK(reported == std::vector<std::size_t>{1, 2, 3, 4, 5, 6, 7, 8});
  }
}

TEST_CASE("an experiment can be interrupted", "[experiment]") {
  const Experiment experiment = small();
  for (const unsigned jobs : {1U, 2U}) {
    ExperimentOptions options;
    options.jobs = jobs;
    std::atomic<bool> now{false};
    options.progress = [&](std::size_t, std::size_t) { now = true; };
    options.interrupted = [&] { return now.load(); };
    CHECK_THROWS_AS(run(experiment, options), Interrupted);
  }
}

TEST_CASE("a fault in one cell stops the others and comes out", "[experiment]") {
  const Experiment experiment = small();
  for (const unsigned jobs : {1U, 2U}) {
    std::atomic<int> cells{0};
    ExperimentOptions options;
    options.jobs = jobs;
    options.progress = [&](std::size_t, std::size_t) {
      ++cells;
      throw Fault("broken");
    };
    CHECK_THROWS_WITH(run(experiment, options), "broken");
    CHECK(cells == 1);
  }
}

TEST_CASE("an experiment is checked before it runs", "[experiment]") {
  Experiment e = small();
  const auto message = [&] {
    try {
      check(e);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(message().empty());

  SECTION("no problem") {
    e.problems.clear();
    CHECK(message() == "experiment: no problem given");
  }
  SECTION("no strategy") {
    e.strategies.clear();
    CHECK(message() == "experiment: no strategy given");
  }
  SECTION("no seed") {
    e.seeds.clear();
    CHECK(message() == "experiment: no seed given");
  }
  SECTION("a problem twice") {
    e.problems.push_back(e.problems.front());
    CHECK(message() == "experiment: two problems are called 'wide'");
  }
  SECTION("a strategy twice") {
    e.strategies.push_back(e.strategies.front());
    CHECK(message() == "experiment: two strategies are called 'rrt'");
  }
  SECTION("a name that is empty") {
    e.strategies.front().first.clear();
    CHECK(message() == "experiment: a strategy without a name");
  }
  SECTION("a seed twice") {
    e.seeds = {3, 4, 3};
    CHECK(message().find("seed 3 is given twice") != std::string::npos);
  }
  SECTION("shortcut") {
    e.shortcut = -1;
    CHECK(message() == "experiment: shortcut must be at least 0 rounds, got -1");
  }
  SECTION("measure") {
    std::get<TubeSettings>(e.measure->target).delta = 0.0;
    CHECK(message().find("delta") != std::string::npos);
    std::get<TubeSettings>(e.measure->target).delta = std::numeric_limits<double>::quiet_NaN();
    CHECK(message().find("delta") != std::string::npos);
  }
  SECTION("a start in collision") {
    e.problems[1].start = {5, 1, 0};
    CHECK(message().find("narrow") != std::string::npos);
    CHECK(message().find("lower wall") != std::string::npos);
  }
}
