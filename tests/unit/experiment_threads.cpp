// SPDX-License-Identifier: GPL-3.0-or-later
// Several threads for one run: the record is that of one thread.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <trellis/base/helper_threads.hpp>
#include <trellis/experiment/cell.hpp>
#include <trellis/planner/lookahead.hpp>
#include <trellis/planner/planner.hpp>

#include "support/catch.hpp"
#include "support/random_specs.hpp"
#include "support/space.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}

PlannerSpec planner(const std::string& name, std::int64_t proposals) {
  return PlannerSpec::make(name, {{"step", 0.5}, {"proposals", proposals}});
}

/// A wall without a gap: searches spend all proposals.
Problem closed_problem() {
  Problem problem = test::trap_problem();
  problem.name = "closed";
  problem.scene = std::make_shared<const PlanarScene>(test::rectangle_world({{6, 0, 7, 10}}), test::rectangle_robot());
  return problem;
}

/// Slow enough that helpers pay, so that all phases of their use occur; counts who is asked.
class SlowValidity final : public Validity {
 public:
  SlowValidity(std::shared_ptr<Validity> inner, std::shared_ptr<std::atomic<std::size_t>> helped, bool helper)
      : inner_(std::move(inner)), helped_(std::move(helped)), helper_(helper) {}
  [[nodiscard]] bool state(View q) override { return inner_->state(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(20);
    while (std::chrono::steady_clock::now() < end) std::this_thread::yield();
    if (helper_) ++*helped_;
    ++asked;
    return inner_->motion(a, b);
  }
  [[nodiscard]] double clearance(View q) override { return inner_->clearance(q); }
  [[nodiscard]] std::shared_ptr<Validity> for_thread() const override {
    return std::make_shared<SlowValidity>(inner_->for_thread(), helped_, true);
  }

  std::size_t asked = 0;

 private:
  std::shared_ptr<Validity> inner_;
  std::shared_ptr<std::atomic<std::size_t>> helped_;
  bool helper_;
};

struct Outcomes {
  Search search;
  Checks checks;
  std::size_t helped = 0;  ///< motions that helpers checked
};

Outcomes search(const std::string& name, unsigned threads) {
  const PlannerKind& kind = *find_planner(name);
  const auto instance = make_instance(closed_problem());
  const auto helped = std::make_shared<std::atomic<std::size_t>>(0);
  instance->validity = std::make_shared<SlowValidity>(instance->validity, helped, false);
  UniformGuidance guidance(instance->space);
  Outcomes out{Search(instance->space.dimension()), {}, 0};
  HelperThreads helpers(threads);
  // PRM* checks tens of motions for each proposal.
  const std::int64_t proposals = name == "prm_star" ? 2500 : 4000;
  const Options options = Options::validate(*kind.component, {{"proposals", proposals}});
  Lookahead ahead(*instance, guidance, threads > 1 ? &helpers : nullptr);
  const auto made = kind.make(options, {*instance, guidance, Stream(1, "0", "proposals"), out.search, false, &ahead});
  made->solve(guidance, kind.common(options).budget);
  out.checks = instance->checks;
  out.helped = *helped;
  return out;
}

}  // namespace

TEST_CASE("helpers do all tasks, each once") {
  HelperThreads helpers(4);
  CHECK(helpers.workers() == 4);
  for (const std::size_t count : {0, 1, 3, 1000}) {
    std::vector<std::atomic<int>> done(count);
    std::vector<std::atomic<int>> busy(4);
    std::atomic<bool> alone = true;
    helpers.run(count, [&](std::size_t i, unsigned worker) {
      if (++busy[worker] != 1) alone = false;
      ++done[i];
      --busy[worker];
    });
    for (const auto& times : done) CHECK(times == 1);
    CHECK(alone);
  }
  CHECK(helpers.cpu_seconds() > 0.0);
}

TEST_CASE("helpers check motions ahead, and the search is the same") {
  const std::string name = GENERATE("rrt", "rrt_connect", "rrt_star", "prm", "prm_star");
  INFO(name);
  const Outcomes one = search(name, 1);
  Outcomes three = search(name, 3);
  CHECK(one.helped == 0);
  // A phase of 1024 steps with helpers comes in any case; how much they do of it depends on what else the machine does.
  for (int again = 0; again < 20 && three.helped == 0; ++again) three = search(name, 3);
  CHECK(three.helped > 0);
  CHECK(std::ranges::equal(one.search.nodes.values(), three.search.nodes.values()));
  CHECK(std::ranges::equal(one.search.proposals.values(), three.search.proposals.values()));
  CHECK(one.search.near == three.search.near);
  CHECK(one.search.edges == three.search.edges);
  CHECK(one.checks.validity == three.checks.validity);
  CHECK(one.checks.motion == three.checks.motion);
}

TEST_CASE("a run of several threads has the record of one thread") {
  const std::int64_t many = 4000;
  std::vector<StrategySpec> strategies = {
      StrategySpec(planner("rrt", many)),
      StrategySpec(planner("rrt_connect", many)),
      StrategySpec(
          PlannerSpec::make("rrt_connect", {{"step", 0.5}, {"proposals", many}, {"grow", std::string("smaller")}})),
      StrategySpec(planner("rrt_star", 2500)),
      StrategySpec(PlannerSpec::make("rrt_connect", {{"step", 0.5}, {"proposals", many}, {"goal_bias", 0.3}})),
      guide("shrink", {{"scale", 0.5}}) >> planner("rrt", many),
      guide("shrink", {{"scale", 0.5}}) >> guide("lazy") >> planner("rrt_connect", many),
      guide("skeleton") >> guide("shrink", {{"scale", 0.8}}) >> planner("rrt", many),
      guide("goal_bias", {{"share", 0.25}}) >> planner("rrt_connect", many),
      StrategySpec(PlannerSpec::make("prm", {{"proposals", many}})),
      StrategySpec(PlannerSpec::make("prm", {{"proposals", many}, {"neighbours", std::int64_t{3}}, {"radius", 0.8}})),
      StrategySpec(PlannerSpec::make("prm_star", {{"proposals", std::int64_t{2500}}})),
      guide("shrink", {{"scale", 0.5}}) >> PlannerSpec::make("prm", {{"proposals", many}}),
  };
  test::RandomSpecs random(7);
  for (int i = 0; i < 4; ++i) strategies.push_back(random.strategy(3));
  for (const Problem& problem : {test::trap_problem(), closed_problem()}) {
    for (std::size_t s = 0; s < strategies.size(); ++s) {
      INFO(problem.name << ", strategy " << s);
      const RunResult one = run_cell("s", strategies[s], problem, 5);
      for (const unsigned threads : {2U, 5U}) {
        CHECK(difference_text(one, run_cell("s", strategies[s], problem, 5, {.threads = threads})).empty());
      }
    }
  }
}

TEST_CASE("a run in space of several threads has the record of one thread") {
  const Problem problem = test::slot_problem();
  for (const char* name : {"rrt", "rrt_connect"}) {
    const StrategySpec strategy(PlannerSpec::make(name, {{"step", 1.0}, {"proposals", std::int64_t{4000}}}));
    const RunResult one = run_cell("s", strategy, problem, 2);
    CHECK(difference_text(one, run_cell("s", strategy, problem, 2, {.threads = 3})).empty());
  }
}
