// SPDX-License-Identifier: GPL-3.0-or-later
// Lazy roadmaps solve what eager ones solve, and report to guides which vertices are connected.
#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/planner/roadmap_planner.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

struct Run {
  Solution solution;
  Search search;
  Checks checks;
};

Run run(const Problem& problem, std::uint64_t seed, const std::function<std::unique_ptr<Guidance>(Instance&)>& guide,
        bool guided, const std::vector<Options::Entry>& given = {}) {
  const PlannerKind& kind = *find_planner("lazy_prm");
  auto instance = make_instance(problem);
  const auto guidance = guide(*instance);
  Run out;
  out.search = Search(instance->space.dimension());
  const Options options = Options::validate(*kind.component, given);
  auto planner = kind.make(options, {*instance, *guidance, Stream(seed, "0", "proposals"), out.search, guided});
  out.solution = planner->solve(*guidance, kind.common(options).budget);
  out.checks = instance->checks;
  return out;
}

std::unique_ptr<Guidance> uniform(Instance& instance) { return std::make_unique<UniformGuidance>(instance.space); }

/// Proposes near points of a polyline, at most a little beyond the last one that a connected vertex came near.
class AheadGuidance final : public Guidance {
 public:
  AheadGuidance(const Space& space, const Configurations& corners) : space_(space), points_(space.dimension()) {
    constexpr double spacing = 0.25;
    Configuration q(space.dimension());
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const double length = space.distance(corners[i - 1], corners[i]);
      for (double at = 0.0; at < length; at += spacing) {
        space.interpolate(corners[i - 1], corners[i], at / length, q);
        points_.push(q);
      }
    }
    points_.push(corners.back());
  }
  Source sample(Stream& stream, MutableView out) override {
    const std::size_t end = std::min(points_.size() - 1, reached_ + 4);
    const std::size_t begin = reached_ > 2 ? reached_ - 2 : 0;
    const View centre = std::as_const(points_)[begin + stream.below(end - begin + 1)];
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = centre[j] + 0.15 * stream.normal() / space_.axes()[j].weight;
    space_.reflect(out);
    return 0;
  }
  void observe(const Outcome& outcome, bool) override {
    if (outcome.added.empty() || !outcome.connected || outcome.from_goal) return;
    for (std::size_t i = reached_ + 1; i < points_.size() && i <= reached_ + 4; ++i) {
      if (space_.distance(std::as_const(points_)[i], outcome.added) < 0.3) reached_ = i;
    }
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"ahead"}; }

 private:
  Space space_;
  Configurations points_;
  std::size_t reached_ = 0;
};

/// Evaluates edges by a validity, and counts them.
class CountingEvaluator final : public EdgeEvaluator {
 public:
  CountingEvaluator(std::shared_ptr<Validity> truth, Space space, const LazyEvaluation& how)
      : truth_(std::move(truth)), space_(std::move(space)), how_(how) {}

  [[nodiscard]] const LazyEvaluation& how() const override { return how_; }
  std::uint64_t begin() override {
    evaluated_now_ = 0;
    return epoch;
  }
  [[nodiscard]] bool exhausted() const override { return evaluated_now_ >= most; }
  [[nodiscard]] bool sparse_first() const override { return sparse; }
  [[nodiscard]] bool state(View q) override {
    ++states;
    return truth_->state(q);
  }
  [[nodiscard]] MotionReport sparsely(View, View) override {
    return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    ++motions;
    ++evaluated_now_;
    lengths.push_back(space_.distance(a, b));
    return truth_->motion(a, b);
  }

  std::uint64_t epoch = 0;
  std::size_t most = std::numeric_limits<std::size_t>::max();  ///< motions in one solve
  bool sparse = false;
  std::size_t states = 0;
  std::size_t motions = 0;
  std::vector<double> lengths;  ///< of motions, in the order of their evaluation

 private:
  std::shared_ptr<Validity> truth_;
  Space space_;
  LazyEvaluation how_;
  std::size_t evaluated_now_ = 0;
};

/// Presumes that everything is valid, for the time being.
class Presumed final : public EvaluatedValidity {
 public:
  explicit Presumed(EdgeEvaluator& evaluator) : evaluator_(evaluator) {}
  [[nodiscard]] bool state(View) override { return true; }
  [[nodiscard]] MotionReport motion(View, View) override { return {true, 0, std::numeric_limits<double>::quiet_NaN()}; }
  [[nodiscard]] double clearance(View) override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool spends_checks() const override { return false; }
  [[nodiscard]] EdgeEvaluator* evaluator() override { return &evaluator_; }

 private:
  EdgeEvaluator& evaluator_;
};

/// A search of a roadmap that presumes what an evaluator finds out.
struct GeneralizedLazySearch {
  GeneralizedLazySearch(const Problem& problem, std::uint64_t seed, const LazyEvaluation& how)
      : instance(make_instance(problem)),
        truth(instance->validity),
        evaluator(truth, instance->space, how),
        search(instance->space.dimension()),
        guidance(instance->space) {
    instance->validity = std::make_shared<Presumed>(evaluator);
    const PlannerKind& kind = *find_planner("lazy_prm");
    const Options options = Options::validate(*kind.component, {{"samples", std::int64_t{400}}});
    budget = kind.common(options).budget;
    planner = kind.make(options, {*instance, guidance, Stream(seed, "0", "proposals"), search, false});
  }
  double solve() {
    solution = planner->solve(guidance, budget);
    return solution.solved() ? path_length(instance->space, solution.path) : 0.0;
  }
  [[nodiscard]] bool valid() const {
    for (std::size_t i = 1; i < solution.path.size(); ++i) {
      if (!truth->motion(solution.path[i - 1], solution.path[i]).valid) return false;
    }
    return solution.solved();
  }
  [[nodiscard]] std::uint64_t expanded() const { return dynamic_cast<const RoadmapPlanner&>(*planner).expanded(); }

  std::unique_ptr<Instance> instance;
  std::shared_ptr<Validity> truth;
  CountingEvaluator evaluator;
  Search search;
  UniformGuidance guidance;
  Budget budget;
  std::unique_ptr<Planner> planner;
  Solution solution;
};

/// Two walls, to pass at opposite ends.
Problem slalom() {
  return test::make_problem("slalom", test::rectangle_world({{3, 0, 3.5, 7.5}, {6, 2.5, 6.5, 10}}),
                            test::rectangle_robot(), {1, 1, 0}, {9, 9, 0});
}

using Event = LazyEvaluation::Event;
using Selector = LazyEvaluation::Selector;

}  // namespace

TEST_CASE("a lazy roadmap that has spent its proposals reconnects its nodes", "[planner][lazy][slow]") {
  // In these runs, with the default budget, nodes found invalid take the places of the nearest valid ones.
  const std::vector<std::pair<Problem, std::vector<std::uint64_t>>> cases = {{test::simple_passage_problem(), {4, 15}},
                                                                             {test::trap_problem(), {13}}};
  for (const auto& [problem, seeds] : cases) {
    for (const std::uint64_t seed : seeds) {
      CAPTURE(problem.name, seed);
      const auto out = run(problem, seed, uniform, false);
      REQUIRE(out.solution.solved());
      CHECK(out.search.proposals.size() == 50000);
      const auto checker = make_planar_checker(problem.scene, problem.space, problem.resolution);
      for (std::size_t i = 1; i < out.solution.path.size(); ++i) {
        CHECK(checker->motion(out.solution.path[i - 1], out.solution.path[i]).valid);
      }
    }
  }
}

TEST_CASE("without a path a lazy roadmap ends all the same, within its budget of checks", "[planner][lazy]") {
  const auto problem = test::make_problem("walled", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(),
                                          {1, 5, 0}, {9, 5, 0});
  const auto out = run(problem, 1, uniform, false, {{"proposals", std::int64_t{500}}});
  CHECK(out.solution.status == Status::budget_spent);
  const auto limited =
      run(problem, 1, uniform, false, {{"proposals", std::int64_t{500}}, {"checks", std::int64_t{700}}});
  CHECK(limited.solution.status == Status::budget_spent);
  CHECK(limited.checks.validity < 800);
}

TEST_CASE("guided, nodes found invalid take no place among a new node's neighbours", "[planner][lazy]") {
  const auto problem = test::simple_passage_problem();
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const auto out = run(problem, seed, uniform, true, {{"proposals", std::int64_t{25000}}});
    CHECK(out.solution.solved());
    CHECK(out.search.proposals.size() < 25000);
  }
}

TEST_CASE("a guide that proposes ahead of connected vertices leads a lazy roadmap to the goal", "[planner][lazy]") {
  const auto problem = test::simple_passage_problem();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    const auto ahead = [&](Instance& instance) -> std::unique_ptr<Guidance> {
      Configurations corners(3);
      for (const auto& q :
           {Configuration{1, 8.5, 0}, Configuration{3.5, 5, 0}, Configuration{6.5, 5, 0}, Configuration{9, 1.5, 0}}) {
        corners.push(q);
      }
      return std::make_unique<AheadGuidance>(instance.space, corners);
    };
    const auto out = run(problem, seed, ahead, true, {{"proposals", std::int64_t{3000}}});
    CHECK(out.solution.solved());
    CHECK(out.checks.validity < 5000);
  }
}

TEST_CASE("every event and every selector of a generalized lazy search leads to the path of LazySP",
          "[planner][lazy][gls]") {
  for (const auto& problem : {test::cup_problem(), slalom()}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(problem.name, seed);
      GeneralizedLazySearch lazy_sp(problem, seed, {});
      const double expected = lazy_sp.solve();
      REQUIRE(lazy_sp.valid());
      CHECK(lazy_sp.instance->checks.validity == 0);
      for (const auto event :
           {Event::shortest_path, Event::constant_depth, Event::heuristic_progress, Event::subpath_existence}) {
        for (const auto selector : {Selector::alternate, Selector::forward, Selector::backward, Selector::fail_fast}) {
          CAPTURE(event, selector);
          GeneralizedLazySearch search(problem, seed, {event, 2, 0.5, selector});
          CHECK(search.solve() == Approx(expected).epsilon(1e-9));
          CHECK(search.valid());
          CHECK(search.search.proposals.size() == lazy_sp.search.proposals.size());
        }
      }
    }
  }
}

TEST_CASE("the later the event, the fewer edges are evaluated and the more vertices expanded", "[planner][lazy][gls]") {
  const auto spent = [](const LazyEvaluation& how) {
    std::pair<std::size_t, std::uint64_t> sum{0, 0};
    for (const auto& problem : {test::cup_problem(), slalom()}) {
      for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        GeneralizedLazySearch search(problem, seed, how);
        search.solve();
        sum.first += search.evaluator.motions;
        sum.second += search.expanded();
      }
    }
    return sum;
  };
  const auto by_depth = [&](std::int64_t depth) {
    return spent({Event::constant_depth, depth, 0.5, Selector::forward});
  };
  const auto one = by_depth(1);
  const auto three = by_depth(3);
  const auto all = by_depth(1000000);
  CHECK(one.first > three.first);
  CHECK(three.first > all.first);
  CHECK(one.second < three.second);
  CHECK(three.second < all.second);
  // A subpath of any length: the shortest path to the goal alone is evaluated.
  CHECK(all.first == spent({Event::shortest_path, 1, 0.5, Selector::forward}).first);
  // Between evaluating each subpath at once and only whole paths.
  const auto likely = spent({Event::subpath_existence, 1, 0.1, Selector::forward});
  const auto certain = spent({Event::subpath_existence, 1, 0.9, Selector::forward});
  CHECK(likely.first < certain.first);
  CHECK(likely.second > certain.second);
  CHECK(likely.first >= all.first);
  const auto progress = spent({Event::heuristic_progress, 1, 0.5, Selector::forward});
  CHECK(progress.first > all.first);
  CHECK(progress.first < one.first);
}

TEST_CASE("the selector says in which order the edges of a path are evaluated", "[planner][lazy][gls]") {
  const auto problem = slalom();
  for (const auto selector : {Selector::alternate, Selector::forward, Selector::backward, Selector::fail_fast}) {
    CAPTURE(selector);
    GeneralizedLazySearch search(problem, 1, {Event::shortest_path, 1, 0.5, selector});
    search.solve();
    // All edges of the path found are evaluated again, in one go.
    search.evaluator.lengths.clear();
    ++search.instance->revision;
    ++search.evaluator.epoch;
    search.solve();
    const auto& path = std::as_const(search.solution.path);
    const std::size_t edges = path.size() - 1;
    REQUIRE(edges > 3);
    std::vector<std::size_t> order(edges);
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto length = [&](std::size_t i) { return problem.space.distance(path[i], path[i + 1]); };
    if (selector == Selector::backward) std::reverse(order.begin(), order.end());
    if (selector == Selector::alternate) {
      for (std::size_t i = 0; i < edges; ++i) order[i] = i % 2 == 0 ? i / 2 : edges - 1 - i / 2;
    }
    if (selector == Selector::fail_fast) {
      std::sort(order.begin(), order.end(), [&](auto i, auto k) { return length(i) > length(k); });
    }
    REQUIRE(search.evaluator.lengths.size() == edges);
    for (std::size_t i = 0; i < edges; ++i) CHECK(search.evaluator.lengths[i] == length(order[i]));
  }
}

TEST_CASE("a search that may evaluate no more returns its candidate, and continues there", "[planner][lazy][gls]") {
  const auto problem = slalom();
  GeneralizedLazySearch whole(problem, 1, {});
  const double expected = whole.solve();
  GeneralizedLazySearch parts(problem, 1, {});
  parts.evaluator.most = 10;
  std::size_t solves = 1;
  double length = parts.solve();
  for (; !parts.valid() && solves < 10000; ++solves) {
    ++parts.instance->revision;
    length = parts.solve();
  }
  CHECK(solves > 2);
  CHECK(parts.valid());
  CHECK(length == Approx(expected).epsilon(1e-9));
  CHECK(parts.evaluator.motions <= whole.evaluator.motions + solves);
}

TEST_CASE("what was evaluated is evaluated anew where it need not hold any more", "[planner][lazy][gls]") {
  GeneralizedLazySearch search(test::cup_problem(), 1, {});
  search.solve();
  const std::size_t motions = search.evaluator.motions;
  const std::size_t edges = search.solution.path.size() - 1;
  ++search.instance->revision;
  search.solve();
  CHECK(search.evaluator.motions == motions);
  ++search.instance->revision;
  ++search.evaluator.epoch;
  search.solve();
  CHECK(search.evaluator.motions >= motions + edges);
  CHECK(search.valid());
}

TEST_CASE("single configurations are evaluated before edges where candidates fail", "[planner][lazy][gls]") {
  std::size_t plain = 0;
  std::size_t sparse = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const bool first : {false, true}) {
      GeneralizedLazySearch search(slalom(), seed, {});
      search.evaluator.sparse = first;
      search.solve();
      CHECK(search.valid());
      CHECK((search.evaluator.states > 0) == first);
      (first ? sparse : plain) += search.evaluator.motions;
    }
  }
  CHECK(2 * sparse < plain);
}
