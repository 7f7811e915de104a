// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a hierarchy worth its cost: bounded loss, findings that reach the level above, f of the instance as it
// stands now, and motions that are checked once.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/custom.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/set_up.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/skeleton.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/searched_guidance.hpp>

#include "support/bounded_loss.hpp"
#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/refuses.hpp"
#include "support/space.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// A guide from a function: a worst case of a user-defined guide.
class Adversary final : public CustomGuide {
 public:
  using Make = std::unique_ptr<Guide> (*)();
  Adversary(const std::string& name, const std::string& planner, Make maker)
      : CustomGuide({.name = name, .identity = name, .default_planner = planner, .resolves = 1000000}), make_(maker) {}
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite&) const override { return make_(); }

 private:
  Make make_;
};

/// An h that always samples one configuration.
class PointHeuristic : public Heuristic {
 public:
  explicit PointHeuristic(Configuration point) : point_(std::move(point)) {}
  Source sample(Stream&, MutableView out) override {
    std::copy(point_.begin(), point_.end(), out.begin());
    return 0;
  }
  void record(DensityRecord& record, double share) const override { record.add_atoms(share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"one point"}; }

 private:
  Configuration point_;
};

class UniformDraws final : public Heuristic {
 public:
  explicit UniformDraws(const Space& space) : uniform_(space) {}
  Source sample(Stream& stream, MutableView out) override { return uniform_.sample(stream, out); }
  void record(DensityRecord& record, double share) const override { uniform_.record(record, share); }
  [[nodiscard]] std::vector<std::string> sources() const override { return {"garbage"}; }

 private:
  UniformGuidance uniform_;
};

/// A guide that calls a function when it makes h.
class Observer final : public CustomGuide {
 public:
  explicit Observer(std::function<void()> seen)
      : CustomGuide({.name = "observer", .identity = "observer"}), seen_(std::move(seen)) {}
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite&) const override {
    class Observing final : public SamplingGuide {
     public:
      explicit Observing(const std::function<void()>& seen) : seen_(seen) {}
      std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
        seen_();
        return std::make_unique<UniformDraws>(parent.space);
      }

     private:
      const std::function<void()>& seen_;
    };
    return std::make_unique<Observing>(seen_);
  }

 private:
  std::function<void()> seen_;
};

class Garbage final : public SamplingGuide {
 public:
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    return std::make_unique<UniformDraws>(parent.space);
  }
};
/// The goal itself, whatever is in between: a path through all walls.
class ThroughWalls final : public SamplingGuide {
 public:
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    return std::make_unique<PointHeuristic>(parent.goal());
  }
};

/// Everything is valid except crossing a circle about the goal: a search that never ends.
class MoatValidity final : public Validity {
 public:
  MoatValidity(Space space, Configuration goal) : space_(std::move(space)), goal_(std::move(goal)) {}
  [[nodiscard]] bool state(View q) override {
    return space_.distance(q, goal_) <= inner || space_.distance(q, goal_) >= outer;
  }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    Configuration q(a.size());
    constexpr int pieces = 20;
    for (int i = 1; i <= pieces; ++i) {
      space_.interpolate(a, b, static_cast<double>(i) / pieces, q);
      if (!state(q)) return {false, static_cast<std::uint32_t>(i), static_cast<double>(i) / pieces};
    }
    return {true, pieces, std::numeric_limits<double>::quiet_NaN()};
  }
  [[nodiscard]] double clearance(View) override { return 0.0; }

 private:
  static constexpr double inner = 0.2;
  static constexpr double outer = 0.8;
  Space space_;
  Configuration goal_;
};

/// S = C as spaces.
class Same : public Guide {
 public:
  std::unique_ptr<Instance> project(const Instance& parent) override {
    auto instance = std::make_unique<Instance>(parent);
    instance->checks = {};
    return instance;
  }
  void project(View q, MutableView s) const override { std::copy(q.begin(), q.end(), s.begin()); }
  void lift(View s, Stream&, MutableView q) const override { std::copy(s.begin(), s.end(), q.begin()); }
  [[nodiscard]] double log_fibre_density(View) const override { return 0.0; }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    return std::make_unique<UniformDraws>(parent.space);
  }
};
class NeverFinds final : public Same {
 public:
  std::unique_ptr<Instance> project(const Instance& parent) override {
    auto instance = Same::project(parent);
    instance->validity = std::make_shared<MoatValidity>(parent.space, parent.goal());
    return instance;
  }
};
/// Solves the whole instance anew after each proposal of its own.
class ChangesItsMind final : public Same {
 public:
  class Fickle final : public PointHeuristic {
   public:
    using PointHeuristic::PointHeuristic;
    void observe(const Outcome&, bool mine) override { stale_ = stale_ || mine; }
    [[nodiscard]] bool stale() const override { return stale_; }

   private:
    bool stale_ = false;
  };
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    return std::make_unique<Fickle>(parent.start);
  }
};

template <class G>
GuideSpec adversary(const std::string& name, const std::string& planner = "") {
  return GuideSpec::make(
      std::make_shared<Adversary>(name, planner, []() -> std::unique_ptr<Guide> { return std::make_unique<G>(); }));
}

std::vector<GuideSpec> adversaries() {
  return {adversary<Garbage>("garbage"), adversary<ThroughWalls>("through walls"),
          adversary<NeverFinds>("never finds", "rrt"), adversary<ChangesItsMind>("changes its mind", "rrt"),
          adversary<ChangesItsMind>("changes two minds", "rrt_connect") >> adversary<NeverFinds>("never finds", "rrt")};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double work(const LevelRecord& level) {
  return static_cast<double>(level.search.checks.validity) + static_cast<double>(level.search.proposals.size());
}

/// Proposals of the parts of h that a guide is: after the goal, uniform and an informed path.
double guided_proposals(const LevelRecord& level) {
  return static_cast<double>(std::count_if(level.search.proposal_sources.begin(), level.search.proposal_sources.end(),
                                           [](auto source) { return source >= 3; }));
}

StrategySpec over(const GuideSpec& guide, const std::string& planner) {
  return {PlannerSpec::make(planner, {{"step", 0.5}}), guide};
}

}  // namespace

TEST_CASE("below the root, the work of guided proposals and of the levels below is bounded by that of unguided ones",
          "[strategy][bound]") {
  for (const auto& problem : {test::simple_passage_problem(), test::cup_problem()}) {
    for (const std::string planner : {"rrt", "rrt_connect"}) {
      for (const auto& guide : adversaries()) {
        CAPTURE(problem.name, planner, guide.text());
        const StrategySpec strategy{PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}}),
                                    guide >> adversary<Same>("same", planner)};
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
          const RunRecord run = execute(strategy, problem, seed);
          const LevelRecord& level = run.levels.at(1);
          const double guided = static_cast<double>(level.guided_checks) + guided_proposals(level);
          double below = 0.0;
          for (std::size_t i = 2; i < run.levels.size(); ++i) below += work(run.levels[i]);
          const double unguided = work(level) - guided;
          const double grant = 1.5 * problem.space.distance(problem.start, problem.goal()) / problem.resolution;
          // A search pauses between two proposals: the last of them, at each level, and the least slice may be beyond.
          const double beyond = 32.0 + 200.0 * static_cast<double>(run.levels.size());
          CHECK(guided + below <= 0.8 * unguided + grant + beyond);
        }
      }
    }
  }
}

TEST_CASE("whatever a guide does, a run spends at most twice what its planner spends alone, and a constant",
          "[strategy][bound]") {
  for (const auto& problem : {test::simple_passage_problem(), test::trap_problem(), test::cup_problem()}) {
    for (const std::string planner : {"rrt", "rrt_connect", "prm"}) {
      for (const auto& guide : adversaries()) {
        for (const double bound : {1.25, 2.0, 4.0}) {
          const StrategySpec strategy{PlannerSpec::make(planner, {{"bound", bound}}), guide};
          for (std::uint64_t seed = 1; seed <= 3; ++seed) test::check_law(strategy, problem, seed);
        }
      }
    }
  }
}

TEST_CASE("guides are set up only when the planner alone has done as much work", "[strategy][bound]") {
  const GuideSpec skeleton = GuideSpec::make("skeleton", {});
  const auto once = [](const std::string& planner) {
    return PlannerSpec::make(planner, {{"step", 0.5}, {"queries", 1.0}});
  };
  const Problem passage = test::simple_passage_problem();
  const double set_up = set_up_work(skeleton, *passage.scene, 1.0);
  REQUIRE(set_up > companion_constant.work);
  int early = 0, late = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const StrategySpec strategy = skeleton >> once("rrt");
    const RunRecord run = execute(strategy, passage, seed);
    test::check_law(strategy, passage, seed);
    CHECK(run.solved);
    if (run.bounded.guides_set_up) {
      ++late;
      CHECK(run.levels.size() == 2);
      CHECK(run.bounded.unguided.work >= set_up - companion_constant.work);
      CHECK(run.bounded.guided.work >= set_up);
    } else {
      ++early;
      // The planner alone did all.
      CHECK(run.levels.size() == 1);
      CHECK(run.bounded.unguided_won);
      CHECK(run.bounded.guided.work == 0.0);
      CHECK(run.work == execute(once("rrt"), passage, seed).work);
    }
  }
  CHECK(early > 0);
  CHECK(late > 0);
  // A thousand queries share the medial axis.
  CHECK(set_up_work(skeleton, *passage.scene, 1000.0) < companion_constant.work);
  CHECK(execute(skeleton >> PlannerSpec::make("rrt", {}), passage, 1).levels.size() == 2);
}

TEST_CASE("a run that is the only one in its world computes its set-ups anew", "[strategy]") {
  const Problem trap = test::trap_problem();
  const World& world = planar(*trap.scene).world;
  const auto shared = cached_medial_axis(world);
  std::vector<std::shared_ptr<const Skeleton>> seen;
  const StrategySpec strategy =
      GuideSpec::make(std::make_shared<Observer>([&] { seen.push_back(cached_medial_axis(world)); })) >>
      PlannerSpec::make("rrt", {{"bound", 0.0}, {"proposals", std::int64_t{50}}});
  for (const double queries : {1000.0, 1.0, 1.0, 2.0}) {
    static_cast<void>(execute(strategy.with("queries", queries), trap, 1));
  }
  REQUIRE(seen.size() == 4);
  CHECK(seen[0] == shared);
  CHECK(seen[1] != shared);
  CHECK(seen[2] != shared);
  CHECK(seen[2] != seen[1]);
  CHECK(seen[3] == shared);
  CHECK(cached_medial_axis(world) == shared);
}

TEST_CASE("a run finds the same with set-ups of its own, and counts all of them", "[strategy][bound]") {
  const Problem cup = test::cup_problem();
  const GuideSpec skeleton = GuideSpec::make("skeleton", {});
  const StrategySpec shared = skeleton >> GuideSpec::make("shrink", {{"scale", 0.5}}) >>
                              PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}});
  const StrategySpec own = shared.with("queries", 1.0);
  CHECK(own.text() == shared.text().substr(0, shared.text().size() - 2) + ", queries = 1 }");
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const RunRecord one = execute(shared, cup, seed);
    const RunRecord other = execute(own, cup, seed);
    CHECK(std::ranges::equal(one.path.values(), other.path.values()));
    CHECK(one.validity_checks == other.validity_checks);
    CHECK(one.queries == 1000.0);
    CHECK(other.queries == 1.0);
    const SetUp axis = set_up_of("skeleton", skeleton.options(), *cup.scene);
    CHECK(std::abs(other.work - one.work - 0.999 * axis.world) < 1e-6 * axis.world);
  }
}

TEST_CASE("an option of a strategy's planner is replaced, below a split too", "[strategy]") {
  const GuideSpec lazy = GuideSpec::make("lazy", {});
  const StrategySpec strategy = split(lazy >> PlannerSpec::make("rrt", {{"step", 0.5}}), {.depth = 2});
  const StrategySpec once = strategy.with("queries", 1.0);
  CHECK(once == split(lazy >> PlannerSpec::make("rrt", {{"step", 0.5}, {"queries", 1.0}}), {.depth = 2}));
  CHECK(once.with("queries", 1000.0) == strategy);
  CHECK_THROWS_AS(strategy.with("querie", 1.0), Error);
}

TEST_CASE("a guide that is set up again in a changed world counts with all of that world", "[strategy][bound]") {
  const GuideSpec skeleton = GuideSpec::make("skeleton", {});
  const StrategySpec strategy =
      skeleton >> GuideSpec::make("drop", {}) >> PlannerSpec::make("rrt", {{"step", 0.2}, {"proposals", 20000.0}});
  const Problem trap = test::trap_problem();
  // Of a world with one obstacle at least.
  const double least = set_up_of("skeleton", skeleton.options(), *trap.scene->with_obstacles({0})).world;
  REQUIRE(least > companion_constant.work);
  int changed = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    test::check_law(strategy, trap, seed);
    const RunRecord run = execute(strategy, trap, seed);
    REQUIRE(run.levels.size() == 3);
    // It is counted before it begins, so it is no part of a step; and not where the run ends before.
    CHECK(run.bounded.largest_step.work < least);
    if (run.levels.back().resolves.changed_world == 0) {
      CHECK(run.bounded.guided.work < least);
      continue;
    }
    ++changed;
    CHECK(run.bounded.guided.work >= least);
    // The planner alone has done as much before.
    CHECK(run.bounded.unguided.work >= least - companion_constant.work);
  }
  CHECK(changed > 0);
}

TEST_CASE("the work of setting up is known for every guide, and grows with the world", "[strategy][bound]") {
  const Problem passage = test::simple_passage_problem(), slot = test::slot_problem();
  for (const GuideKind& kind : test::guides_of_one_robot()) {
    CAPTURE(kind.component->name);
    const Options options = Options::validate(*kind.component, {});
    for (const Problem* problem : {&passage, &slot}) {
      const SetUp few = set_up_of(kind.component->name, options, *problem->scene);
      CHECK(few.run > 0.0);
      CHECK(few.world >= 0.0);
      const SetUp none = set_up_of(kind.component->name, options, *problem->scene->with_obstacles({}));
      CHECK(none.run <= few.run);
      CHECK(none.world <= few.world);
    }
  }
}

TEST_CASE("the sides of bounded loss are all that a level and those below it spent", "[strategy][bound]") {
  const auto problem = test::simple_passage_problem();
  const GuideSpec skeleton = GuideSpec::make("skeleton", {});
  const GuideSpec shrink = GuideSpec::make("shrink", {{"scale", 0.5}});
  const PlannerSpec rrt = PlannerSpec::make("rrt", {{"step", 0.5}});
  const RunRecord run = execute((skeleton >> shrink) + GuideSpec::make("goal_bias", {}) >> rrt, problem, 3);
  REQUIRE(run.levels.size() == 3);
  for (const LevelRecord& level : run.levels) {
    CAPTURE(level.name);
    CHECK(level.guided_checks + level.unguided_checks == level.search.checks.validity);
    CHECK(level.guided_proposals <= level.search.proposals.size());
  }
  const LevelRecord& root = run.levels[0];
  CHECK(root.guided);
  CHECK(static_cast<double>(root.guided_proposals) == guided_proposals(root));
  CHECK(root.guided_proposals > 0);
  CHECK(root.checks_below == run.levels[1].search.checks.validity + run.levels[2].search.checks.validity);
  CHECK(root.proposals_below == run.levels[1].search.proposals.size() + run.levels[2].search.proposals.size());
  CHECK(root.unguided_checks + root.guided_checks + root.checks_below == run.validity_checks);
  CHECK(run.levels[1].guided);
  CHECK(run.levels[1].checks_below == run.levels[2].search.checks.validity);
  // A graph is searched, which nothing guides.
  CHECK_FALSE(run.levels[2].guided);
  CHECK(run.levels[2].guided_checks == 0);
  CHECK(run.levels[2].checks_below == 0);

  // The halves of a divided instance are below it, but no guide of it searches them; what they draw is its own too.
  const PlannerSpec divided = split(rrt);
  const RunRecord halves = execute(skeleton >> divided, problem, 3);
  std::uint64_t below = 0;
  for (const LevelRecord& level : halves.levels) {
    if (level.key == "0/0") below += level.search.checks.validity;
  }
  REQUIRE(halves.levels.size() > 3);
  CHECK(halves.levels.front().checks_below == below);
  const RunRecord beneath = execute(GuideSpec::make("shrink", {{"scale", 0.5}}, divided) >> rrt, problem, 3);
  REQUIRE(beneath.levels.size() > 3);
  CHECK(beneath.levels.front().checks_below == beneath.validity_checks - beneath.levels.front().search.checks.validity);
  CHECK(beneath.levels.front().proposals_below == beneath.levels[1].search.proposals.size());
}

TEST_CASE("two nested searches cost little where the planner alone needs few checks", "[strategy][bound]") {
  // There is no obstacle, so the first proposal of RRT-Connect nearly always finds a path.
  Problem problem = test::slot_problem();
  const Robot3& plank = spatial(*problem.scene).robot;
  problem.name = "open";
  problem.scene = std::make_shared<const SpatialScene>(World3({{0, 0, 0}, {10, 10, 10}}, {}), plank);
  problem.start = {1, 1, 1, 0, std::sqrt(0.5), 0, std::sqrt(0.5)};
  problem.goals = {{9, 9, 9, std::sqrt(0.5), 0, 0, std::sqrt(0.5)}};
  const GuideSpec shrink = GuideSpec::make("shrink", {{"scale", 0.5}});
  const PlannerSpec connect = PlannerSpec::make("rrt_connect", {{"step", 0.5}});
  const auto spent = [&](const StrategySpec& strategy) {
    std::vector<double> checks;
    for (std::uint64_t seed = 1; seed <= 15; ++seed) {
      const RunRecord run = execute(strategy, problem, seed);
      CHECK(run.solved);
      checks.push_back(static_cast<double>(run.validity_checks));
    }
    return median(checks);
  };
  const double alone = spent(connect);
  const double nested = spent(GuideSpec::make("workspace", {}) >> shrink >> connect);
  CAPTURE(alone, nested);
  CHECK(nested <= 3.0 * alone);
}

TEST_CASE("without a bound a guide may spend what it likes", "[strategy][bound]") {
  const auto problem = test::cup_problem();
  const StrategySpec bounded = over(adversary<Garbage>("garbage"), "rrt");
  const StrategySpec free = {PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}}), adversary<Garbage>("garbage")};
  const auto share = [&](const StrategySpec& strategy) {
    double guided = 0.0;
    double all = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const RunRecord run = execute(strategy, problem, seed);
      guided += static_cast<double>(run.levels.front().guided_checks) + guided_proposals(run.levels.front());
      all += work(run.levels.front());
    }
    return guided / all;
  };
  CHECK(share(free) > 0.85);
  CHECK(share(bounded) < 0.6);
}

TEST_CASE("another solution in S gives other proposals in C", "[strategy][pairs]") {
  const auto problem = test::simple_passage_problem();
  const auto path_of = [](const RunRecord& run) {
    const auto& values = run.levels[1].solution.path.values();
    return std::vector<double>(values.begin(), values.end());
  };
  const auto proposals_of = [](const RunRecord& run) {
    const auto& values = run.levels.front().search.proposals.values();
    return std::vector<double>(values.begin(), values.end());
  };
  int different = 0;
  int pairs = 0;
  for (const auto& guided : test::guides_of_one_robot()) {
    if (guided.default_planner.empty() || guided.component->name == "experience") continue;
    const auto small = [](const GuideKind& kind) {
      return kind.default_planner.empty()
                 ? GuideSpec::make(kind.component->name, {})
                 : GuideSpec::make(kind.component->name, {},
                                   PlannerSpec::make(kind.default_planner, {{"proposals", std::int64_t{400}}}));
    };
    const RunRecord alone = execute(over(small(guided), "rrt"), problem, 2);
    for (const std::string above : {"identity", "shrink", "goal_bias", "skeleton"}) {
      const GuideKind& kind = *find_guide(above);
      if (test::refuses(kind, guided, problem)) continue;
      CAPTURE(above, guided.component->name);
      const RunRecord nested = execute(over(small(kind) >> small(guided), "rrt"), problem, 2);
      ++pairs;
      if (path_of(nested) == path_of(alone)) continue;
      if (guided_proposals(nested.levels.front()) + guided_proposals(alone.levels.front()) == 0.0) continue;
      ++different;
      CHECK(proposals_of(nested) != proposals_of(alone));
    }
  }
  CHECK(different > pairs / 2);
}

TEST_CASE("what comes back into the world of a level comes back into the worlds of the levels below it",
          "[strategy][project]") {
  const auto problem = test::trap_problem();
  for (const std::string below : {"skeleton", "shrink"}) {
    CAPTURE(below);
    std::uint64_t solves = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const StrategySpec strategy = {PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}}),
                                     GuideSpec::make(below, {}) >> GuideSpec::make("drop", {})};
      const RunRecord run = execute(strategy, problem, seed);
      REQUIRE(run.levels.size() == 3);
      const auto obstacles = [&](std::size_t i) { return run.levels[i].scene->obstacle_count(); };
      CHECK(obstacles(1) > 0);
      solves = std::max<std::uint64_t>(solves, run.levels[2].solves);
      if (below == "shrink") CHECK(obstacles(2) == obstacles(1));
    }
    CHECK(solves > 1);
  }
}

TEST_CASE("a path that lazy validated is not checked again", "[strategy][lazy]") {
  const auto problem = test::cup_problem();
  const auto planner = PlannerSpec::make("rrt", {{"step", 0.5}, {"goal_bias", 0.0}, {"uniform", 0.0}});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const RunRecord run =
        execute({planner, GuideSpec::make("skeleton", {}) >> GuideSpec::make("lazy", {})}, problem, seed);
    REQUIRE(run.solved);
    const LevelRecord& root = run.levels.front();
    // No more motions than the edges of the candidate paths: those that the tree drives along cost none.
    std::size_t candidates = 0;
    for (const auto& turn : run.turns) {
      if (turn.level == 1 && turn.solve_ended && !turn.path.empty()) candidates += turn.path.size() - 1;
    }
    CHECK(root.search.checks.motion <= candidates + 1);
    CHECK(root.search.proposals.size() >= 20);
  }
}

TEST_CASE("a path that the search of a smaller robot's space validated in C is not checked again",
          "[strategy][relaxed]") {
  // Wide passages, so that the smaller robot's path holds for the whole one.
  const auto problem = test::cup_problem();
  std::vector<double> nested;
  std::vector<double> alone;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    const auto skeleton = GuideSpec::make("skeleton", {});
    const RunRecord both = execute(over(skeleton >> GuideSpec::make("shrink", {{"scale", 0.5}}), "rrt"), problem, seed);
    const RunRecord one = execute(over(skeleton, "rrt"), problem, seed);
    REQUIRE(both.solved);
    REQUIRE(one.solved);
    nested.push_back(static_cast<double>(both.validity_checks));
    alone.push_back(static_cast<double>(one.validity_checks));
    // The root goes along what was verified.
    CHECK(3 * both.levels.front().search.checks.validity < one.levels.front().search.checks.validity);
    CHECK(both.levels.front().search.proposals.size() >= 20);
  }
  std::sort(nested.begin(), nested.end());
  std::sort(alone.begin(), alone.end());
  CHECK(nested[4] <= 1.3 * alone[4]);
}

TEST_CASE("a false gap is found out before anything is drawn towards it at any level", "[strategy][sparse]") {
  // One gap that half the robot passes, and one for the robot itself.
  const auto problem = test::make_problem(
      "two gaps", test::rectangle_world({{4.5, 0, 5.5, 4.925}, {4.5, 5.075, 5.5, 8.5}, {4.5, 9.5, 5.5, 10}}),
      test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  int tries = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const RunRecord run = execute(
        over(GuideSpec::make("skeleton", {{"prune", false}}) >> GuideSpec::make("shrink", {{"scale", 0.5}}), "rrt"),
        problem, seed);
    REQUIRE(run.solved);
    // The smaller robot does not try what the whole one cannot pass.
    for (const std::size_t level : {0U, 1U}) {
      const Search& search = run.levels[level].search;
      for (std::size_t i = 0; i < search.proposals.size(); ++i) {
        if (search.proposal_sources[i] < 3) continue;
        const View q = search.proposals[i];
        if (q[0] > 4.0 && q[0] < 6.0 && std::abs(q[1] - 5.0) < 0.3) ++tries;
      }
    }
    CHECK(run.levels[1].solves == 1);
    CHECK(run.levels[2].solves > 1);
  }
  CHECK(tries == 0);
}

TEST_CASE("what guides the search for a smaller robot leaves out passages too narrow for the whole one",
          "[strategy][needed]") {
  const auto problem = test::make_problem(
      "two gaps", test::rectangle_world({{4.5, 0, 5.5, 4.925}, {4.5, 5.075, 5.5, 8.5}, {4.5, 9.5, 5.5, 10}}),
      test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  const auto shrunken = GuideSpec::make("shrink", {{"scale", 0.5}});
  // Below two levels the robot is a quarter as large; it is the root's robot that has to pass.
  for (const auto& below : {shrunken, shrunken >> shrunken}) {
    const RunRecord run = execute(over(GuideSpec::make("skeleton", {}) >> below, "rrt"), problem, 1);
    REQUIRE(run.solved);
    for (std::size_t i = 1; i < run.levels.size(); ++i) CHECK(run.levels[i].solves == 1);
    for (const auto& turn : run.turns) {
      for (std::size_t i = 0; i < turn.path.size(); ++i) {
        const View q = turn.path[i];
        if (q[0] > 4.5 && q[0] < 5.5) CHECK(q[1] > 8.5);
      }
    }
  }
}
