// SPDX-License-Identifier: GPL-3.0-or-later
// The targets of each run: its own path, those of other seeds, and targets that are no tubes.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/targets.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/motion/steering.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

constexpr double pi = std::numbers::pi;

StrategySpec rrt(double step, double proposals = 5000.0) {
  return {PlannerSpec::make("rrt", {{"step", step}, {"proposals", proposals}})};
}

/// A point in an empty square of 10 m, from (1, 5) to (9, 5).
Problem open_problem() { return test::make_problem("open", test::rectangle_world({}), Robot::point(), {1, 5}, {9, 5}); }

TubeSettings tube() {
  TubeSettings settings;
  settings.points = 512;
  settings.pool = 2048;
  return settings;
}

Experiment open_experiment() {
  Experiment experiment;
  experiment.problems = {open_problem()};
  experiment.strategies = {{"fine", rrt(0.5)}, {"coarse", rrt(0.8)}};
  experiment.seeds = {1, 2, 3};
  experiment.measure = Measure{.target = tube(), .cross = 2};
  return experiment;
}

/// A target that identifies the paths of a score: that of the i-th path has the divergence 2^i / 64 from uniform
/// sampling, so that a mean over several paths identifies all of them.
class Marks {
 public:
  Marks() : paths_(std::make_shared<std::vector<std::vector<double>>>()) {}

  [[nodiscard]] UserTarget target() const {
    UserTarget user;
    user.points = 64;
    user.pool = 64;
    user.make = [paths = paths_](const UserTarget::Context& context) {
      const auto all = context.path.values();
      const std::vector<double> path(all.begin(), all.end());
      const auto known = std::find(paths->begin(), paths->end(), path);
      const double index = static_cast<double>(known - paths->begin());
      if (known == paths->end()) paths->push_back(path);
      const double height = 10.0 * std::exp(-std::exp2(index) / 64.0);
      Target::Distribution strip{Configurations(2), [height](View x) {
                                   return x[1] < height ? -std::log(10.0 * height)
                                                        : -std::numeric_limits<double>::infinity();
                                 }};
      for (std::int64_t i = 0; i < 64; ++i) {
        const auto at = static_cast<double>(i);
        strip.samples.push(std::vector{at / 6.4, height * std::fmod(at * 0.618, 1.0)});
      }
      return strip;
    };
    return user;
  }
  /// The paths in the mean of `count` targets.
  static std::set<int> of(const std::optional<Scores>& scores, std::size_t count) {
    REQUIRE(scores);
    const auto bits =
        static_cast<std::uint64_t>(std::llround(scores->expansion.uniform * 64.0 * static_cast<double>(count)));
    std::set<int> marks;
    for (int i = 0; i < 64; ++i) {
      if (((bits >> i) & 1U) != 0) marks.insert(i);
    }
    CHECK(marks.size() == count);
    return marks;
  }

 private:
  std::shared_ptr<std::vector<std::vector<double>>> paths_;
};

const LevelResult& root_of(const RunResult& run) { return run.levels.front(); }

const RunResult& find(const ExperimentResult& result, const std::string& strategy, std::uint64_t seed) {
  const auto it = std::find_if(result.runs.begin(), result.runs.end(),
                               [&](const RunResult& run) { return run.strategy == strategy && run.seed == seed; });
  REQUIRE(it != result.runs.end());
  return *it;
}

/// All figures of an experiment, to the last bit.
class Bytes {
 public:
  explicit Bytes(const ExperimentResult& result) {
    for (const RunResult& run : result.runs) {
      for (const LevelResult& level : run.levels) {
        for (const auto& scores : {level.own, level.root, level.own_cross, level.root_cross, level.equal}) {
          bits_.push_back(scores ? 1 : 0);
          if (!scores) continue;
          for (const Efficiency* e : {&scores->tree, &scores->expansion}) add(*e);
        }
      }
    }
    for (const PooledScores& pooled : result.pooled) {
      for (const Efficiency* e : {&pooled.scores.tree, &pooled.scores.expansion}) add(*e);
    }
  }
  friend bool operator==(const Bytes&, const Bytes&) = default;
  [[nodiscard]] std::size_t size() const { return bits_.size(); }

 private:
  void add(const Estimate& e) {
    for (const double x : {e.value, e.unregularised, e.above_uniform}) bits_.push_back(bits(x));
    texts_.push_back(e.estimator);
  }
  void add(const Efficiency& e) {
    add(static_cast<const Estimate&>(e));
    for (const Estimate& other : e.others) add(other);
    for (const double x :
         {e.uniform, e.mass, e.mass_lower95, e.coverage, e.free_share, e.along.divergence, e.along.empty_share}) {
      bits_.push_back(bits(x));
    }
    for (const BallHits& hits : {e.hitting.position, e.hitting.full}) {
      for (const double x : {hits.hitting, hits.hitting_lo, hits.hitting_hi, hits.bottleneck, hits.bottleneck_lo,
                             hits.bottleneck_hi, hits.at}) {
        bits_.push_back(bits(x));
      }
    }
    for (const double x : e.along.target) bits_.push_back(bits(x));
    for (const double x : e.along.samples) bits_.push_back(bits(x));
    bits_.push_back(e.samples);
    bits_.push_back(e.in_target);
    texts_.insert(texts_.end(), e.flags.begin(), e.flags.end());
    texts_.push_back(e.reason);
  }
  static std::uint64_t bits(double x) { return std::isnan(x) ? 0 : std::bit_cast<std::uint64_t>(x); }

  std::vector<std::uint64_t> bits_;
  std::vector<std::string> texts_;
};

}  // namespace

TEST_CASE("a run is scored on the paths of other seeds, the same ones under every strategy", "[scoring]") {
  for (const std::int64_t cross : {1, 2, 4, 9}) {
    Experiment experiment = open_experiment();
    const Marks marks;
    experiment.measure = Measure{.target = marks.target(), .cross = cross};
    const ExperimentResult result = run(experiment);
    const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(cross), 4);  // 2 strategies, 2 more seeds
    std::set<int> givers;
    for (const std::uint64_t seed : experiment.seeds) {
      CAPTURE(cross, seed);
      const auto& fine = find(result, "fine", seed);
      const auto& coarse = find(result, "coarse", seed);
      REQUIRE((fine.run.solved && coarse.run.solved));
      const auto used = Marks::of(root_of(fine).root_cross, count);
      CHECK(used == Marks::of(root_of(coarse).root_cross, count));
      for (const RunResult* own : {&fine, &coarse}) {
        // Each path makes its own target, and no path of its seed is among the others.
        const auto mark = Marks::of(root_of(*own).root, 1);
        CHECK(used.count(*mark.begin()) == 0);
        if (used.count(*mark.begin()) == 0) givers.insert(used.begin(), used.end());
        CHECK(std::isfinite(root_of(*own).root_cross->tree.value));
      }
    }
    // One run of each seed gives its path, and more where that many are asked for.
    if (cross == 2) CHECK(givers.size() == experiment.seeds.size());
    if (cross > 2) CHECK(givers.size() > experiment.seeds.size());
  }
}

TEST_CASE("without other paths there is no cross score", "[scoring]") {
  Experiment experiment = open_experiment();
  SECTION("none asked for") { experiment.measure->cross = 0; }
  SECTION("a single seed") { experiment.seeds = {1}; }
  for (const RunResult& run : run(experiment).runs) {
    CHECK(root_of(run).own);
    CHECK(root_of(run).root);
    CHECK_FALSE(root_of(run).own_cross);
    CHECK_FALSE(root_of(run).root_cross);
  }
}

TEST_CASE("lower levels are scored on other seeds' paths in their own spaces on request", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.strategies = {{"guided", GuideSpec::make("shrink", {}) >> rrt(0.5)}};
  for (const bool requested : {false, true}) {
    experiment.measure->cross_levels = requested;
    for (const RunResult& run : run(experiment).runs) {
      const LevelResult& level = run.levels.at(1);
      REQUIRE(level.record.solution.solved());
      CHECK(level.own);
      CHECK(level.root_cross);
      CHECK(level.own_cross.has_value() == requested);
      if (requested) CHECK(std::isfinite(level.own_cross->tree.value));
      CHECK(root_of(run).own_cross);
    }
  }
}

TEST_CASE("a run without a path is scored on the others' and never dropped", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.strategies = {{"fine", rrt(0.5)}, {"short", rrt(0.5, 40.0)}};
  const Marks marks;
  experiment.measure = Measure{.target = marks.target(), .cross = 2};
  const ExperimentResult result = run(experiment);
  REQUIRE(result.runs.size() == 6);
  std::set<int> paths;
  for (const std::uint64_t seed : experiment.seeds) {
    const auto mark = Marks::of(root_of(find(result, "fine", seed)).root, 1);
    paths.insert(mark.begin(), mark.end());
  }
  CHECK(paths.size() == 3);
  for (const std::uint64_t seed : experiment.seeds) {
    CAPTURE(seed);
    const RunResult& failed = find(result, "short", seed);
    CHECK_FALSE(failed.run.solved);
    CHECK_FALSE(root_of(failed).own);
    CHECK_FALSE(root_of(failed).root);
    REQUIRE(root_of(failed).root_cross);
    CHECK(root_of(failed).root_cross->expansion.samples == 40);
    CHECK(std::isfinite(root_of(failed).root_cross->expansion.value));
    // Only runs with a path provide one.
    const auto used = Marks::of(root_of(failed).root_cross, 2);
    CHECK(std::includes(paths.begin(), paths.end(), used.begin(), used.end()));
    CHECK(used == Marks::of(root_of(find(result, "fine", seed)).root_cross, 2));
  }

  // Without any path there is no target, and the result still has every run.
  experiment.strategies = {{"short", rrt(0.5, 5.0)}};
  const ExperimentResult none = run(experiment);
  REQUIRE(none.runs.size() == 3);
  for (const RunResult& run : none.runs) {
    REQUIRE(run.levels.size() == 1);
    CHECK_FALSE(root_of(run).root_cross);
  }
}

TEST_CASE("the own score is that of the run's samples on the tube about its path", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.problems = {test::cup_problem()};
  experiment.strategies.pop_back();
  experiment.seeds = {4, 5};
  experiment.measure->estimators = {EstimatorSpec::make("exact"), EstimatorSpec::make("knn")};
  const ExperimentResult result = run(experiment);
  const std::shared_ptr<Instance> instance = make_instance(experiment.problems.front());
  for (const RunResult& run : result.runs) {
    REQUIRE(run.run.solved);
    const LevelRecord& record = root_of(run).record;
    // Other points of the same tube.
    const Target target(
        record.space, run.run.path, {0, 1}, TubeSettings{}, [&](View q) { return instance->validity->state(q); }, 1);
    const Efficiency nodes = efficiency(target, record.search.nodes, {.support = SampleSupport::valid_only});
    const Scores& own = *root_of(run).own;
    CHECK(own.tree.uniform == Approx(nodes.uniform).margin(0.02));
    CHECK(own.tree.value == Approx(nodes.value).margin(0.1));
    CHECK(own.tree.coverage == Approx(nodes.coverage).margin(0.05));
    CHECK(own.tree.samples == record.search.nodes.size());
    CHECK(own.tree.in_target == nodes.in_target);
    CHECK(own.tree.estimator == "knn");
    // The proposals' density is known: uniform but for the goal itself, 5 % of them.
    CHECK(own.expansion.estimator == "exact");
    CHECK(own.expansion.unregularised == Approx(own.expansion.uniform - std::log(0.95)).margin(1e-9));
    REQUIRE(own.expansion.others.size() == 1);
    CHECK(own.expansion.others.front().estimator == "knn");
    CHECK(own.expansion.samples == record.search.proposals.size());
  }
  // Without a list of estimators, only the headline's runs.
  experiment.measure = Measure{};
  for (const RunResult& run : run(experiment).runs) {
    CHECK(root_of(run).own->expansion.estimator == "exact");
    CHECK(root_of(run).own->expansion.others.empty());
  }
}

TEST_CASE("the oracle and uniform sampling frame the root's figures", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.problems = {test::cup_problem()};
  experiment.strategies.pop_back();
  experiment.seeds = {1, 2, 3, 4, 5, 6};
  std::vector<double> perfect;
  std::vector<double> none;
  for (const RunResult& run : run(experiment).runs) {
    const LevelResult& root = root_of(run);
    if (!run.run.solved) continue;
    REQUIRE(root.oracle);
    REQUIRE(root.uniform);
    CHECK(root.oracle->tree.samples == std::min<std::size_t>(root.own->tree.samples, LevelResult::most_references));
    CHECK(root.oracle->tree.in_target == root.oracle->tree.samples);
    CHECK(root.oracle->expansion.estimator == "exact");
    CHECK(root.oracle->expansion.unregularised == Approx(0.0).margin(1e-9));
    CHECK(root.uniform->expansion.value == Approx(root.own->expansion.uniform).margin(1e-6));
    perfect.push_back(root.oracle->tree.unregularised);
    none.push_back(root.uniform->tree.value - root.uniform->tree.uniform);
  }
  REQUIRE(perfect.size() >= 5);
  for (const auto& values : {perfect, none}) {
    const Interval interval = student_interval(values, 0.99);
    CAPTURE(interval.value, interval.lo, interval.hi);
    CHECK(interval.lo <= 0.01);
    CHECK(interval.hi >= -0.01);
  }
}

TEST_CASE("samples of all seeds together are scored without the seed whose path it is", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.seeds = {1, 2, 3, 4};
  experiment.measure = Measure{.target = tube(), .cross = 3};
  const ExperimentResult result = run(experiment);
  REQUIRE(result.pooled.size() == experiment.strategies.size());
  for (const PooledScores& pooled : result.pooled) {
    CHECK(pooled.seeds == 3);
    CHECK(pooled.targets == 3);
    // Each run of more than 500 samples gives 500 of them.
    std::size_t most = 0;
    for (const RunResult& run : result.runs) {
      if (run.strategy == pooled.strategy) most += std::min<std::size_t>(root_of(run).record.search.nodes.size(), 500);
    }
    CHECK(pooled.scores.tree.samples < most);
    CHECK(pooled.scores.tree.samples > 0);
    CHECK(std::isfinite(pooled.scores.tree.value));
    // Proposals of plain RRT are uniform but for the goal, alone and together.
    CHECK(pooled.scores.expansion.estimator == "exact");
    CHECK(pooled.scores.expansion.unregularised ==
          Approx(pooled.scores.expansion.uniform - std::log(0.95)).margin(1e-6));
    const Hitting& hitting = pooled.scores.expansion.hitting;
    CHECK(std::abs(hitting.position.hitting) < 0.5);
    CHECK(hitting.position.bottleneck <= 0.5);
    CHECK(hitting.position.bottleneck_lo < 0.0);
    CHECK(hitting.position.at > 0.0);
    CHECK(hitting.position.at < hitting.length);
    CHECK(hitting.samples > 0);
    CHECK(hitting.samples <= 4000);
    CHECK(std::isfinite(pooled.scores.tree.hitting.full.hitting));
  }
  // On its own path, and on those of other seeds, each run has its own.
  for (const RunResult& run : result.runs) {
    for (const auto where : {&LevelScores::root, &LevelScores::root_cross}) {
      REQUIRE((root_of(run).*where).has_value());
      CHECK(std::isfinite((*(root_of(run).*where)).tree.hitting.position.hitting));
    }
  }
  experiment.measure->cross = 0;
  CHECK(run(experiment).pooled.empty());
}

TEST_CASE("the scores of the overview are a part of all scores", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.measure = Measure{.target = tube(), .cross = 2};
  for (const bool together : {false, true}) {
    CAPTURE(together);
    experiment.seeds = {1, 2, 3, 4};
    if (together) experiment.seeds.push_back(5);
    const ExperimentResult all = run(experiment);
    const ExperimentResult part = run(experiment, {.scope = ScoreScope::overview});
    REQUIRE(part.runs.size() == all.runs.size());
    for (std::size_t i = 0; i < all.runs.size(); ++i) {
      const LevelResult& whole = root_of(all.runs[i]);
      const LevelResult& few = root_of(part.runs[i]);
      CHECK_FALSE(few.root.has_value());
      REQUIRE(few.root_cross.has_value());
      if (together) {
        // Beside the figures of all seeds, single runs have an estimate for their nodes, on one path.
        CHECK(few.root_cross->tree.value == Approx(whole.root_cross->tree.value).margin(1.0));
        CHECK(std::isnan(few.root_cross->tree.value_hi));
        CHECK(std::isnan(few.root_cross->expansion.value));
        continue;
      }
      for (const auto role : {&Scores::tree, &Scores::expansion}) {
        CHECK((*few.root_cross.*role).value == (*whole.root_cross.*role).value);
        CHECK((*few.root_cross.*role).value_hi == (*whole.root_cross.*role).value_hi);
      }
    }
    REQUIRE(part.pooled.size() == all.pooled.size());
    for (std::size_t i = 0; i < all.pooled.size(); ++i) {
      for (const auto role : {&Scores::tree, &Scores::expansion}) {
        CHECK((part.pooled[i].scores.*role).value_lo == (all.pooled[i].scores.*role).value_lo);
        CHECK((part.pooled[i].scores.*role).value_hi == (all.pooled[i].scores.*role).value_hi);
        CHECK((part.pooled[i].scores.*role).hitting.position.hitting ==
              (all.pooled[i].scores.*role).hitting.position.hitting);
      }
    }
  }
}

TEST_CASE("a run's own path flatters its tree", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.problems = {test::cup_problem()};
  experiment.strategies.pop_back();
  experiment.seeds = {1, 2, 3, 4, 5, 6};
  double gap = 0.0;
  for (const RunResult& run : run(experiment).runs) {
    REQUIRE(run.run.solved);
    gap += (root_of(run).root_cross->tree.value - root_of(run).root->tree.value) / 6.0;
  }
  CHECK(gap > 0.2);
}

TEST_CASE("numbers of samples that differ much are also compared at the least", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.strategies = {{"fine", rrt(0.1)}, {"coarse", rrt(1.0)}};
  const ExperimentResult result = run(experiment);
  const auto median_number = [&](const std::string& strategy, bool tree) {
    std::vector<std::size_t> numbers;
    for (const std::uint64_t seed : experiment.seeds) {
      const Search& search = root_of(find(result, strategy, seed)).record.search;
      numbers.push_back(tree ? search.nodes.size() : search.proposals.size());
    }
    std::sort(numbers.begin(), numbers.end());
    return numbers[1];
  };
  const std::size_t nodes = median_number("coarse", true);
  REQUIRE(median_number("fine", true) > 2 * nodes);
  for (const RunResult& run : result.runs) {
    CAPTURE(run.strategy, run.seed);
    const LevelResult& root = root_of(run);
    REQUIRE(root.equal);
    CHECK(root.equal->tree.samples == std::min(nodes, root.record.search.nodes.size()));
    // On the same paths as all of them.
    CHECK(root.equal->tree.uniform == root.root_cross->tree.uniform);
    if (root.record.search.nodes.size() <= nodes) CHECK(root.equal->tree.value == root.root_cross->tree.value);
  }
  // Within a factor of two they stay as they are.
  experiment.strategies = {{"a", rrt(0.5)}, {"b", rrt(0.51)}};
  for (const RunResult& run : run(experiment).runs) CHECK_FALSE(root_of(run).equal);
}

TEST_CASE("every figure is the same to the last bit whatever the number of jobs", "[scoring][slow]") {
  Experiment experiment;
  experiment.problems = {test::cup_problem()};
  experiment.strategies = {{"plain", rrt(0.5)}, {"nested", GuideSpec::make("shrink", {{"scale", 0.5}}) >> rrt(0.5)}};
  experiment.seeds = {1, 2};
  Measure measure{.target = tube(), .cross = 2};
  std::get<TubeSettings>(measure.target).points = 128;
  SECTION("tube") {}
  SECTION("near_optimal") {
    NearOptimalSettings settings;
    settings.points = 128;
    settings.pool = 256;
    settings.nodes = 200;
    measure.target = settings;
  }
  SECTION("progress") { measure.target = ProgressSettings{}; }
  experiment.measure = measure;
  const Bytes once(run(experiment));
  CHECK(once.size() > 100);
  ExperimentOptions options;
  options.jobs = 2;
  CHECK(once == Bytes(run(experiment, options)));
}

TEST_CASE("near_optimal is the ellipse about start and goal in an empty world", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.strategies = {{"fine", rrt(0.5)}, {"short", rrt(0.5, 20.0)}};
  NearOptimalSettings settings;
  settings.points = 512;
  settings.pool = 2048;
  settings.nodes = 600;
  settings.epsilon = 0.2;
  experiment.measure = Measure{.target = settings, .cross = 2};
  const ExperimentResult result = run(experiment);
  const double a = 0.5 * 1.2 * 8;
  const double area = pi * a * std::sqrt(a * a - 16);
  for (const RunResult& run : result.runs) {
    CAPTURE(run.strategy, run.seed);
    const LevelResult& root = root_of(run);
    // The same for every run, with or without a path of its own.
    REQUIRE(root.own);
    CHECK(root.own->tree.uniform == root_of(result.runs.front()).own->tree.uniform);
    CHECK(root.own->tree.uniform == Approx(std::log(100 / area)).margin(0.03));
    REQUIRE(root.root_cross);
    CHECK(root.root_cross->tree.value == root.root->tree.value);
    CHECK(root.own->expansion.unregularised == Approx(root.own->expansion.uniform - std::log(0.95)).margin(1e-9));
  }

  // Behind a wall there is no optimum.
  experiment.problems = {
      test::make_problem("shut", test::rectangle_world({{4, 0, 6, 10}}), Robot::point(), {1, 5}, {9, 5})};
  experiment.strategies = {{"short", rrt(0.5, 50.0)}};
  for (const RunResult& run : run(experiment).runs) {
    const LevelResult& root = root_of(run);
    if (root.own) CHECK(std::isnan(root.own->tree.value));
  }
}

TEST_CASE("progress ranks a motion by the share of its rivals that come closer to the goal", "[scoring]") {
  // The goal is so far off that half of all directions come closer, and the angle to it is all that counts.
  LevelRecord level;
  level.key = "0";
  level.space = Space::euclidean({{-1000, 1000}, {-1000, 1000}});
  level.goal = {900, 0};
  level.search = Search(2);
  level.search.nodes.push(std::vector{0.0, 0.0});
  level.search.parents = {0};
  ProgressSettings settings;
  settings.controls = 4000;
  const std::vector<double> angles = {0.1, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, -0.7, -2.2};
  for (const double angle : angles) {
    // Long or short, a motion has its direction's rank.
    const double length = angle > 1.2 ? 0.3 : 7.0;
    level.search.proposals.push(std::vector{length * std::cos(angle), length * std::sin(angle)});
    level.search.near.push_back(0);
    level.search.nodes.push(level.search.proposals.back());
    level.search.parents.push_back(0);
  }
  // An entry without a parent node is no motion, nor is one without length.
  level.search.proposals.push(std::vector{1.0, 1.0});
  level.search.near.push_back(no_node);
  level.search.proposals.push(std::vector{0.0, 0.0});
  level.search.near.push_back(0);
  for (const bool tree : {true, false}) {
    const Ranks ranks = rank_motions(level, tree, settings, 1);
    REQUIRE(ranks.samples.size() == angles.size());
    for (std::size_t i = 0; i < angles.size(); ++i) {
      CAPTURE(angles[i]);
      CHECK(ranks.samples[i][0] == Approx(std::abs(angles[i]) / pi).margin(0.03));
    }
    // T is uniform on the better half.
    REQUIRE(ranks.target.target);
    CHECK(ranks.target.target->uniform() == Approx(std::log(2.0)).margin(0.03));
    CHECK(ranks.target.target->contains(std::vector{0.2}));
    CHECK_FALSE(ranks.target.target->contains(std::vector{0.8}));
  }
  level.search.parents.assign(level.search.nodes.size(), no_node);
  const Ranks none = rank_motions(level, true, settings, 1);
  CHECK_FALSE(none.target.target);
  CHECK_FALSE(none.target.reason.empty());
}

TEST_CASE("progress in every direction that comes closer gains what is to be gained, in any direction nothing",
          "[scoring]") {
  LevelRecord level;
  level.key = "0";
  level.space = Space::euclidean({{-1000, 1000}, {-1000, 1000}});
  level.goal = {0, 900};
  Stream stream(1, "", "test");
  const auto gain = [&](double widest) {
    level.search = Search(2);
    level.search.nodes.push(std::vector{0.0, 0.0});
    for (int i = 0; i < 2000; ++i) {
      const double angle = 0.5 * pi + widest * stream.uniform(-1, 1);
      level.search.proposals.push(std::vector{std::cos(angle), std::sin(angle)});
      level.search.near.push_back(0);
    }
    const Ranks ranks = rank_motions(level, false, ProgressSettings{}, 1);
    return efficiency(*ranks.target.target, ranks.samples).above_uniform;
  };
  CHECK(gain(pi) == Approx(0.0).margin(0.05));
  // SE of the better half: q = 0.95 * 2 + 0.05.
  CHECK(gain(0.5 * pi) == Approx(std::log(1.95)).margin(0.05));
  CHECK(gain(0.25 * pi) < 0.0);  // half of the directions that come closer are never taken
}

namespace {

/// A level of a driven robot with one node, whose planner drives for at most five steps.
LevelRecord driven_level(const MotionModel& model) {
  LevelRecord level;
  level.key = "0";
  level.space = Space::se2({-10, 10}, {-10, 10});
  level.goal = {-3, 1, 0.4};
  level.search = Search(3);
  level.search.nodes.push(std::vector{0.0, 0.0, 0.3});
  level.search.parents = {0};
  level.search.controls.controls = Configurations(model.controls().size());
  level.search.controls.longest = 5;
  level.search.controls.dt = model.dt();
  return level;
}

/// Adds a motion from the node that was chosen for some steps and driven for less.
void add_motion(LevelRecord& level, const MotionModel& model, const std::vector<double>& control, std::uint32_t steps,
                std::uint32_t driven) {
  Search& search = level.search;
  search.proposals.push(std::vector{5.0, 5.0, 0.0});  // what it was for does not count
  search.near.push_back(0);
  search.controls.controls.push(control);
  search.controls.steps.push_back(steps);
  search.controls.driven.push_back(driven);
  search.controls.ends.push_back(static_cast<std::uint32_t>(search.controls.steps.size()));
  search.added.push_back(driven > 0 ? static_cast<std::uint32_t>(search.nodes.size()) : no_node);
  if (driven == 0) return;
  Configuration at(search.nodes[0].begin(), search.nodes[0].end());
  for (std::uint32_t k = 0; k < driven; ++k) model.step(level.space, at, control, at);
  search.nodes.push(at);
  search.parents.push_back(0);
}

}  // namespace

TEST_CASE("progress ranks a driven motion among those that its planner could choose", "[scoring]") {
  const MotionKind& unicycle = *find_motion("unicycle1");
  const auto model = unicycle.make(Options::validate(*unicycle.component, {{"min_speed", -0.2}, {"max_speed", 0.5}}));
  LevelRecord level = driven_level(*model);
  const auto& axes = model->controls();
  // All controls and durations, by a fine grid.
  std::vector<double> distances;
  constexpr int grid = 100;
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      const auto between = [](const ControlAxis& axis, int k) {
        return axis.lo + (axis.hi - axis.lo) * (k + 0.5) / grid;
      };
      const std::vector<double> control = {between(axes[0], i), between(axes[1], j)};
      Configuration at = {0.0, 0.0, 0.3};
      for (int k = 0; k < 5; ++k) {
        model->step(level.space, at, control, at);
        distances.push_back(level.space.distance(at, level.goal));
      }
    }
  }
  const auto share_below = [&](double distance) {
    return static_cast<double>(
               std::count_if(distances.begin(), distances.end(), [&](double d) { return d < distance; })) /
           static_cast<double>(distances.size());
  };
  Stream stream(5, "", "test");
  std::vector<double> chosen;
  std::vector<double> driven;
  for (int i = 0; i < 60; ++i) {
    std::vector<double> control(2);
    model->sample_control(stream, control);
    const auto steps = static_cast<std::uint32_t>(1 + stream.below(5));
    const auto valid = static_cast<std::uint32_t>(stream.below(steps + 1));
    add_motion(level, *model, control, steps, valid);
    Configuration at = {0.0, 0.0, 0.3};
    for (std::uint32_t k = 1; k <= steps; ++k) {
      model->step(level.space, at, control, at);
      if (k == valid) driven.push_back(share_below(level.space.distance(at, level.goal)));
    }
    chosen.push_back(share_below(level.space.distance(at, level.goal)));
  }
  ProgressSettings settings;
  settings.controls = 4000;
  const double closer = share_below(level.space.distance(level.search.nodes[0], level.goal));
  CHECK(closer > 0.1);
  CHECK(closer < 0.5);
  for (const bool tree : {false, true}) {
    const Ranks ranks = rank_motions(level, tree, settings, 1, model.get());
    const auto& expected = tree ? driven : chosen;
    REQUIRE(ranks.samples.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CAPTURE(tree, i);
      CHECK(ranks.samples[i][0] == Approx(expected[i]).margin(0.035));
    }
    REQUIRE(ranks.target.target);
    CHECK(ranks.target.target->uniform() == Approx(-std::log(closer)).margin(0.05));
  }
}

TEST_CASE("progress gives a planner's own random controls and curves nothing, and its best controls what they gain",
          "[scoring]") {
  const MotionKind& car = *find_motion("car");
  const auto model = car.make(Options::validate(*car.component, {}));
  ProgressSettings settings;
  settings.controls = 64;
  Stream stream(6, "", "test");
  const auto gain = [&](int tried, bool curves) {
    LevelRecord level = driven_level(*model);
    level.search.controls.curves = curves;
    for (int i = 0; i < 1500; ++i) {
      std::vector<double> best(model->controls().size());
      std::uint32_t best_steps = 0;
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k < tried; ++k) {
        if (curves) break;
        std::vector<double> control(best.size());
        model->sample_control(stream, control);
        const auto steps = static_cast<std::uint32_t>(1 + stream.below(5));
        Configuration at = {0.0, 0.0, 0.3};
        for (std::uint32_t n = 0; n < steps; ++n) model->step(level.space, at, control, at);
        const double distance = level.space.distance(at, level.goal);
        if (distance >= least) continue;
        least = distance;
        best = control;
        best_steps = steps;
      }
      if (!curves) {
        add_motion(level, *model, best, best_steps, 0);
        continue;
      }
      Configuration towards(3);
      level.space.sample_uniform(stream, towards);
      const auto curve = steer_at(*model, level.search.nodes[0], towards, stream.uniform());
      REQUIRE(curve);
      level.search.proposals.push(towards);
      level.search.near.push_back(0);
      level.search.added.push_back(no_node);
      for (std::size_t k = 0; k < curve->steps.size(); ++k) {
        level.search.controls.controls.push(curve->controls[k]);
        level.search.controls.steps.push_back(curve->steps[k]);
        level.search.controls.driven.push_back(0);
      }
      level.search.controls.ends.push_back(static_cast<std::uint32_t>(level.search.controls.steps.size()));
    }
    const Ranks ranks = rank_motions(level, false, settings, 1, model.get());
    CHECK(ranks.samples.size() == 1500);
    return efficiency(*ranks.target.target, ranks.samples).above_uniform;
  };
  CHECK(gain(1, false) == Approx(0.0).margin(0.07));
  CHECK(gain(0, true) == Approx(0.0).margin(0.07));
  CHECK(gain(3, false) > 0.2);
}

TEST_CASE("an experiment is scored by progress, whether its runs find paths or not", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.strategies = {{"fine", rrt(0.5)}, {"short", rrt(0.5, 40.0)}};
  experiment.measure = Measure{.target = ProgressSettings{}, .cross = 2};
  for (const RunResult& run : run(experiment).runs) {
    CAPTURE(run.strategy, run.seed);
    const LevelResult& root = root_of(run);
    REQUIRE(root.own);
    // Every proposal and every node but the start is a motion; most of them have a direction that comes closer.
    CHECK(root.own->expansion.samples <= root.record.search.proposals.size());
    CHECK(root.own->tree.samples == root.record.search.nodes.size() - 1);
    CHECK(root.own->expansion.uniform == Approx(std::log(2.0)).margin(0.25));
    CHECK(root.own->expansion.along.target.empty());
    REQUIRE(root.root_cross);
    CHECK(root.root_cross->expansion.value == root.own->expansion.value);
  }
}

TEST_CASE("strategies with a guide taken out are scored beside the whole ones, and give no paths", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.problems = {test::point_problem(3)};
  // Without a companion, whose paths would be those of the plain planner.
  const StrategySpec free = PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}});
  const StrategySpec whole = GuideSpec::make("lazy", {}) >> free;
  experiment.strategies = {{"plain", rrt(0.5)}, {"guided", whole}};
  ablate(experiment, {"guided"});
  REQUIRE(experiment.strategies.size() == 3);
  CHECK(experiment.strategies[1].second == whole);
  const auto& [name, spec] = experiment.strategies[2];
  CHECK(spec == StrategySpec(free));
  REQUIRE(experiment.ablations.size() == 1);
  CHECK(experiment.ablations.front().strategy == name);
  CHECK(experiment.ablations.front().of == "guided");
  CHECK(name == "guided " + experiment.ablations.front().text);
  CHECK(experiment.seeds == std::vector<std::uint64_t>{1, 2, 3});

  const Marks marks;
  experiment.measure = Measure{.target = marks.target(), .cross = 4};
  const ExperimentResult result = run(experiment);
  REQUIRE(result.runs.size() == 9);
  std::set<int> taken_out;
  std::set<int> used;
  std::set<int> whole_paths;
  for (const std::uint64_t seed : experiment.seeds) {
    const auto cross = Marks::of(root_of(find(result, name, seed)).root_cross, 4);
    used.insert(cross.begin(), cross.end());
    CHECK(cross == Marks::of(root_of(find(result, "plain", seed)).root_cross, 4));
    for (const RunResult& run : result.runs) {
      if (run.seed != seed) continue;
      const auto own = Marks::of(root_of(run).root, 1);
      (run.strategy == name ? taken_out : whole_paths).insert(own.begin(), own.end());
    }
  }
  CHECK(used.size() == 6);
  for (const int mark : taken_out) {
    if (whole_paths.count(mark) == 0) CHECK(used.count(mark) == 0);
  }

  Experiment wrong = open_experiment();
  CHECK_THROWS_WITH(ablate(wrong, {"fin"}), "experiment: ablate names no strategy: 'fin' (did you mean 'fine'?)");
  CHECK_THROWS_WITH(ablate(wrong, {"fine"}),
                    "experiment: ablate: strategy 'fine' has no guide that could be taken out");
  CHECK(wrong.strategies.size() == 2);
}

TEST_CASE("a user's target lies in the root's space: levels are scored on it lifted", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.problems = {test::point_problem(3)};
  experiment.strategies = {{"guided", GuideSpec::make("lazy", {}) >> rrt(0.5)}};
  const Marks marks;
  experiment.measure = Measure{.target = marks.target(), .cross = 1};
  for (const RunResult& run : run(experiment).runs) {
    REQUIRE(run.levels.size() == 2);
    CHECK(run.levels[0].own);
    CHECK_FALSE(run.levels[1].own);
    REQUIRE(run.levels[1].root);
    CHECK(run.levels[1].root->tree.uniform == run.levels[0].root->tree.uniform);
    CHECK(run.levels[1].root_cross);
  }
  // An exception in a target's function reaches the caller.
  UserTarget broken;
  broken.make = [](const UserTarget::Context&) -> Target::Distribution { throw Error("no target today"); };
  experiment.measure->target = broken;
  CHECK_THROWS_WITH(run(experiment), "no target today");
  experiment.measure->target = UserTarget{};
  CHECK_THROWS_WITH(run(experiment), "target: has no samples");
}

TEST_CASE("a measure that makes no sense is refused before anything runs", "[scoring]") {
  Experiment experiment = open_experiment();
  experiment.measure->cross = -1;
  CHECK_THROWS_WITH(check(experiment), "experiment: cross must be at least 0 paths, got -1");
  experiment = open_experiment();
  experiment.measure->estimators.clear();
  CHECK_THROWS_WITH(check(experiment), "experiment: no estimator given");
  experiment = open_experiment();
  experiment.baseline = "corse";
  CHECK_THROWS_WITH(check(experiment),
                    "experiment: baseline 'corse' is no strategy (did you mean 'coarse'?); there are: coarse, fine");
  experiment = open_experiment();
  NearOptimalSettings near;
  near.epsilon = 0.0;
  experiment.measure->target = near;
  CHECK_THROWS_WITH(check(experiment), Catch::Contains("epsilon") && Catch::Contains("greater than 0"));
  ProgressSettings progress;
  progress.controls = 2;
  experiment.measure->target = progress;
  CHECK_THROWS_WITH(check(experiment), Catch::Contains("controls") && Catch::Contains("16"));
}
