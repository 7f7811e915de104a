// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that every guide keeps for bodies in space, as guide_laws.cpp has them for the plane.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/outcomes.hpp"
#include "support/solved_guide.hpp"

using namespace trellis;

namespace {

/// A rod, or a ball that does not turn, among blocks, a ball and a cylinder.
Problem among_blocks(bool rotates) {
  World3 world({{0, 0, 0}, {6, 5, 4}}, {{"low", {Cuboid{{0.8, 5, 1.2}}, {{3, 2.5, 0.6}, {}}}},
                                        {"high", {Cuboid{{0.8, 2.5, 1.5}}, {{3, 1.25, 3.25}, {}}}},
                                        {"ball", {Sphere{0.5}, {{4.6, 2.5, 2.5}, {}}}},
                                        {"post", {Cylinder{0.3, 4}, {{1.6, 3.6, 2}, {}}}}});
  Robot3 robot = rotates ? Robot3("rod", {{Cuboid{{0.9, 0.3, 0.3}}, {}}}) : Robot3("ball", {{Sphere{0.3}, {}}}, false);
  Problem problem;
  problem.name = rotates ? "rod" : "ball";
  problem.scene = std::make_shared<const SpatialScene>(std::move(world), std::move(robot));
  problem.space = problem.scene->default_space(0.5);
  problem.start = {0.8, 0.8, 0.8};
  problem.goals = {{5.2, 1.2, 2.6}};
  if (rotates) {
    const double half = std::sqrt(0.5);
    problem.start.insert(problem.start.end(), {0, 0, 0, 1});
    problem.goals.front().insert(problem.goals.front().end(), {0, half, 0, half});
  }
  problem.collision = "fcl";
  return problem;
}

/// `joints` keeps two coordinates of the ball by default, which determine nothing of it, and says so.
std::vector<Problem> problems(const std::string& guide) {
  if (guide == "joints") return {among_blocks(true)};
  return {among_blocks(false), among_blocks(true)};
}

/// Guides that work in space without a file, and what their S is.
std::vector<const GuideKind*> kinds() {
  std::vector<const GuideKind*> some;
  for (const GuideKind& kind : guide_kinds()) {
    const std::string& name = kind.component->name;
    if (kind.claims.needs == GuideClaims::Needs::team) continue;
    if (name != "learned" && name != "holonomic" && name != "blossom" && name != "experience") some.push_back(&kind);
  }
  return some;
}

test::SolvedGuide solve(const GuideKind& kind, const Problem& problem,
                        const std::vector<Options::Entry>& options = {}) {
  return test::solve_guide(kind.component->name, options, problem, 1, 3000.0);
}

/// The median distance of h's draws from a configuration.
double spread(Heuristic& h, const Space& space, View centre, Stream& stream) {
  std::vector<double> distances(201);
  Configuration q(space.dimension());
  for (double& distance : distances) {
    h.sample(stream, q);
    distance = space.distance(centre, q);
  }
  std::nth_element(distances.begin(), distances.begin() + 100, distances.end());
  return std::max(0.01, distances[100]);
}

/// The probability of the ball of a kernel about a centre, by h's own draws and by its density there.
void check_ball(Heuristic& h, const DensityRecord& now, const BallKernel& ball, View centre, Stream& stream) {
  constexpr int draws = 6000;
  constexpr int points = 6000;
  Configuration q(ball.space().dimension());
  double inside = 0.0;
  for (int i = 0; i < draws; ++i) {
    h.sample(stream, q);
    REQUIRE(ball.space().contains(q));
    if (ball.density(centre, q) > 0.0) inside += 1.0 / draws;
  }
  double mass = 0.0, squares = 0.0;
  for (int i = 0; i < points; ++i) {
    ball.sample(centre, stream, q);
    const double share = now.at(q) / ball.density(centre, q);
    REQUIRE(share >= 0.0);
    mass += share / points;
    squares += share * share / points;
  }
  const double error = std::sqrt(std::max(0.0, squares - mass * mass) / points + inside * (1.0 - inside) / draws);
  CHECK(std::abs(inside - mass) < 5.0 * error + 2e-3);
}

}  // namespace

TEST_CASE("f maps the ends of a body in space into S, and what is valid to what is valid",
          "[guide][projection][space]") {
  for (const GuideKind* kind : kinds()) {
    for (const Problem& problem : problems(kind->component->name)) {
      CAPTURE(kind->component->name, problem.name);
      const auto parent = make_instance(problem);
      const auto guide = kind->make(Options::validate(*kind->component, {}));
      const auto sub = guide->project(*parent);
      if (!sub) continue;
      CHECK(sub->space.contains(sub->start));
      CHECK(sub->space.contains(sub->goal()));
      Configuration s(sub->space.dimension()), q(problem.space.dimension()), back(s.size());
      guide->project(parent->start, s);
      CHECK(s == sub->start);
      guide->project(parent->goal(), s);
      CHECK(s == sub->goal());
      Stream stream(2, "0", "configurations");
      for (int i = 0; i < 300; ++i) {
        problem.space.sample_uniform(stream, q);
        guide->project(q, s);
        if (kind->claims.relaxes && parent->valid(q)) REQUIRE(sub->valid(s));
        guide->lift(s, stream, q);
        CHECK(problem.space.contains(q));
        guide->project(q, back);
        // What projects outside of a subspace's part of C is lifted to its boundary.
        if (kind->component->name != "pca" || sub->valid(s)) CHECK(sub->space.distance(s, back) < 1e-7);
      }
    }
  }
}

TEST_CASE("samples of h for a body in space fall where its density says", "[guide][density][space][slow]") {
  struct Case {
    std::string guide;
    std::vector<Options::Entry> options;
  };
  std::vector<Case> cases;
  for (const GuideKind* kind : kinds()) cases.push_back({kind->component->name, {}});
  cases.push_back({"skeleton", {{"follow", std::string("regions")}}});
  cases.push_back({"decomposition", {{"size", 0.6}, {"explore", 0.0}}});
  cases.push_back({"pca", {{"follow", std::string("tube")}}});
  for (const Case& one : cases) {
    for (const Problem& problem : problems(one.guide)) {
      CAPTURE(one.guide, problem.name);
      const GuideKind& kind = *find_guide(one.guide);
      const test::SolvedGuide solved = solve(kind, problem, one.options);
      const DensityRecord now = test::record_of(*solved.h);
      if (std::isnan(now.at(problem.start)) || now.atoms() > 0.0) continue;
      Stream stream(4, one.guide, problem.name);
      Configuration centre(problem.space.dimension());
      for (int i = 0; i < 3; ++i) {
        solved.h->sample(stream, centre);
        check_ball(*solved.h, now, BallKernel(problem.space, spread(*solved.h, problem.space, centre, stream)), centre,
                   stream);
      }
    }
  }
}

TEST_CASE("a guide of a body in space records its density at every step", "[guide][density][space]") {
  for (const GuideKind* kind : kinds()) {
    for (const Problem& problem : problems(kind->component->name)) {
      CAPTURE(kind->component->name, problem.name);
      test::check_record(solve(*kind, problem), 20, 60);
    }
  }
}
