// SPDX-License-Identifier: GPL-3.0-or-later
// Lazy roadmaps solve what eager ones solve, and report to guides which vertices are connected.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/planner.hpp>

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
  auto planner = kind.make(options, {*instance, *guidance, Stream(seed, "0", "proposals"), out.search, guided, {}});
  out.solution = planner->solve(kind.common(options).budget);
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
  [[nodiscard]] double density(View) const override { return std::numeric_limits<double>::quiet_NaN(); }
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

}  // namespace

TEST_CASE("a lazy roadmap that has spent its proposals reconnects its nodes", "[planner][lazy]") {
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
