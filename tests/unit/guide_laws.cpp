// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that every guide keeps, on every problem and below every other guide's space.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/path_steps.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/outcomes.hpp"
#include "support/solved_guide.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// An arm of three links, one of them with limits, between two boxes.
Problem arm_problem() {
  Arm arm{.links = {2, 1.5, 1}, .widths = {0.2, 0.2, 0.1}, .base = {5, 5}};
  arm.limits = {std::nullopt, std::pair(-2.5, 2.5)};
  return test::make_problem("arm", test::rectangle_world({{6.5, 6.5, 8, 8}, {2, 2, 3.5, 3.5}}), Robot::arm(arm),
                            {1.8, 0.3, 0.3}, {-0.8, -0.4, 0.5});
}

/// The same without limits, so that what inverse kinematics lifts has a closed density. Its ends are not stretched,
/// where fibres are too small for laws that are checked by sampling.
Problem free_arm_problem() {
  const Arm arm{.links = {2, 1.5, 1}, .widths = {0.2, 0.2, 0.1}, .base = {5, 5}};
  return test::make_problem("free arm", test::rectangle_world({{6.5, 6.5, 8, 8}, {2, 2, 3.5, 3.5}}), Robot::arm(arm),
                            {1.4, 1.3, -1.1}, {-0.8, -1.2, 1.3});
}

/// Whether S has the position of an arm's tip. It is a box and holds positions that the arm does not reach: these are
/// invalid, and have no fibre.
bool is_tip(const GuideKind& kind, const Problem& problem) {
  return kind.claims.needs == GuideClaims::Needs::position && !problem.scene->translates();
}

/// Whether S is f(C). A subspace is put into a box, which holds more: that is invalid, and has no fibre. Nor are its
/// fibres of one size.
bool is_image(const GuideKind& kind) { return kind.component->name != "pca"; }

/// Problems for a guide that it does not refuse; that of a robot with velocities for guides that leave these to the
/// fibre, as a tube in five dimensions is too thin for laws that are checked by sampling.
std::vector<Problem> problems(const GuideKind& kind) {
  if (kind.claims.needs == GuideClaims::Needs::team) return {test::team_problem()};
  std::vector<Problem> all = {test::cup_problem(), test::simple_passage_problem(), test::point_problem(5)};
  if (kind.claims.needs != GuideClaims::Needs::position_axes) all.push_back(arm_problem());
  if (kind.claims.needs == GuideClaims::Needs::position) all.push_back(free_arm_problem());
  const Problem driven = test::driven(test::simple_passage_problem(), "unicycle2");
  const auto parent = make_instance(driven);
  const auto sub = kind.make(Options::validate(*kind.component, {}))->project(*parent);
  const bool thin = sub && (!is_image(kind) || sub->space.dimension() == driven.space.dimension());
  if (!thin) all.push_back(driven);
  return all;
}

test::SolvedGuide solve(const GuideKind& kind, const Problem& problem, std::uint64_t seed = 1,
                        double proposals = Budget::unlimited) {
  return test::solve_guide(kind.component->name, {}, problem, seed, proposals);
}

}  // namespace

TEST_CASE("f maps start and goal into S, and S is what it says", "[guide][projection]") {
  for (const auto& kind : guide_kinds()) {
    for (const auto& problem : problems(kind)) {
      CAPTURE(kind.component->name, problem.name);
      auto parent = make_instance(problem);
      auto guide = kind.make(Options::validate(*kind.component, {}));
      auto sub = guide->project(*parent);
      REQUIRE((sub == nullptr) == kind.default_planner.empty());
      if (!sub) continue;
      CHECK(sub->space.contains(sub->start));
      CHECK(sub->space.contains(sub->goal()));
      Configuration s(sub->space.dimension());
      guide->project(parent->start, s);
      CHECK(s == sub->start);
      guide->project(parent->goal(), s);
      CHECK(s == sub->goal());
      CHECK((sub->graph != nullptr) == find_planner(kind.default_planner)->graph);
    }
  }
}

TEST_CASE("lifting draws from the fibre: f(lift(s)) = s", "[guide][projection]") {
  for (const auto& kind : guide_kinds()) {
    if (kind.default_planner.empty()) continue;
    for (const auto& problem : problems(kind)) {
      CAPTURE(kind.component->name, problem.name);
      const auto solved = solve(kind, problem);
      Stream stream(3, "0", "lift");
      Configuration s(solved.sub->space.dimension());
      Configuration back(s.size());
      Configuration q(solved.parent->space.dimension());
      const bool tip = is_tip(kind, problem);
      const bool exact = is_image(kind) && !tip;
      const bool limited = tip && problem.name != "free arm";
      for (int i = 0; i < 200; ++i) {
        solved.sub->space.sample_uniform(stream, s);
        if (limited) {
          // S has positions that are valid and that the limits of joints exclude.
          solved.parent->space.sample_uniform(stream, q);
          solved.guide->project(q, s);
        }
        solved.guide->lift(s, stream, q);
        CHECK(solved.parent->space.contains(q));
        if (!exact && !limited && !solved.sub->valid(s)) continue;
        solved.guide->project(q, back);
        CHECK(solved.sub->space.distance(back, s) < (exact ? 1e-300 : 1e-9));
      }
    }
  }
}

TEST_CASE("f of a guide that relaxes maps what is valid in C to what is valid in S", "[guide][projection]") {
  for (const auto& kind : guide_kinds()) {
    if (kind.default_planner.empty() || !kind.claims.relaxes) continue;
    for (const auto& problem : problems(kind)) {
      CAPTURE(kind.component->name, problem.name);
      const auto solved = solve(kind, problem);
      Stream stream(4, "0", "valid");
      Configuration q(solved.parent->space.dimension());
      Configuration s(solved.sub->space.dimension());
      for (int i = 0; i < 2000; ++i) {
        solved.parent->space.sample_uniform(stream, q);
        if (!solved.parent->valid(q)) continue;
        solved.guide->project(q, s);
        REQUIRE(solved.sub->valid(s));
      }
    }
  }
}

namespace {

/// The mass of h's density over C, with its standard error. Half of the points are uniform on C, half on the box that
/// holds h's own draws: what is a ball of a few centimetres would be missed by the others.
std::pair<double, double> mass(Heuristic& h, const Space& space, std::uint64_t seed) {
  constexpr int points = 60000;
  Stream stream(seed, "0", "mass");
  Configuration q(space.dimension());
  std::vector<std::pair<double, double>> box(space.dimension(), {1e9, -1e9});
  for (int i = 0; i < 2000; ++i) {
    h.sample(stream, q);
    for (std::size_t j = 0; j < q.size(); ++j) {
      box[j] = {std::min(box[j].first, q[j]), std::max(box[j].second, q[j])};
    }
  }
  double box_volume = 1.0;
  for (std::size_t j = 0; j < box.size(); ++j) {
    const auto& axis = space.axes()[j];
    const double wider = 0.02 * (box[j].second - box[j].first) + 1e-9;
    box[j] = {std::max(axis.lo, box[j].first - wider), std::min(axis.hi, box[j].second + wider)};
    box_volume *= axis.weight * (box[j].second - box[j].first);
  }
  const double volume = std::exp(space.log_volume());
  const DensityRecord now = test::record_of(h);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < points; ++i) {
    if (i % 2 == 0) {
      space.sample_uniform(stream, q);
    } else {
      for (std::size_t j = 0; j < q.size(); ++j) q[j] = stream.uniform(box[j].first, box[j].second);
    }
    bool in_box = true;
    for (std::size_t j = 0; j < q.size(); ++j) in_box = in_box && q[j] >= box[j].first && q[j] <= box[j].second;
    const double density = now.at(q);
    REQUIRE(density >= 0.0);
    const double p = density / (0.5 / volume + (in_box ? 0.5 / box_volume : 0.0));
    sum += p;
    squares += p * p;
  }
  const double mean = sum / points;
  return {mean, std::sqrt(std::max(0.0, squares / points - mean * mean) / points)};
}

/// h is a distribution over C: it draws inside, and has the mass that it claims.
void check_distribution(const GuideKind& kind, test::SolvedGuide& solved, std::uint64_t seed) {
  const Space& space = solved.parent->space;
  Stream stream(seed, "0", "draws");
  Configuration q(space.dimension());
  for (int i = 0; i < 200; ++i) {
    solved.h->sample(stream, q);
    REQUIRE(space.contains(q));
  }
  const double there = test::record_of(*solved.h).at(solved.parent->start);
  if (!kind.claims.closed_form) CHECK(std::isnan(there));
  if (std::isnan(there)) return;
  const auto [mean, error] = mass(*solved.h, space, seed);
  CHECK(std::abs(mean - (1.0 - test::record_of(*solved.h).atoms())) < 5.0 * error + 1e-9);
}

/// A wall from side to side between start and goal.
Problem sealed_problem() {
  return test::make_problem("sealed", test::rectangle_world({{4, 0, 6, 10}}), test::rectangle_robot(), {1, 8.5, 0},
                            {9, 1.5, 0});
}

}  // namespace

TEST_CASE("a guide has a closed form where it claims one", "[guide][claims]") {
  for (const auto& kind : guide_kinds()) {
    CAPTURE(kind.component->name);
    auto solved = solve(kind, problems(kind).front());
    CHECK(std::isnan(test::record_of(*solved.h).at(solved.parent->start)) == !kind.claims.closed_form);
    if (kind.claims.category == GuideClaims::Category::sampling) CHECK(kind.default_planner.empty());
    CHECK((kind.claims.fallback == GuideClaims::Fallback::none) == kind.default_planner.empty());
  }
}

TEST_CASE("an end that is invalid in C leaves a guide with a distribution over C", "[guide][claims]") {
  for (const auto& kind : guide_kinds()) {
    for (const bool at_goal : {false, true}) {
      CAPTURE(kind.component->name, at_goal);
      const bool team = kind.claims.needs == GuideClaims::Needs::team;
      auto problem = team ? test::team_problem() : test::cup_problem();
      // Inside the cup's bottom, or one robot inside the wall.
      (at_goal ? problem.goals.front() : problem.start) =
          team ? Configuration{4.5, 2, 8, 1} : Configuration{6.75, 5, 0};
      auto solved = solve(kind, problem, 1, 500);
      if (solved.sub) {
        const Configuration& end = at_goal ? solved.sub->goal() : solved.sub->start;
        Configuration s(end.size());
        solved.guide->project(at_goal ? problem.goal() : problem.start, s);
        CHECK(s == end);  // f moves nothing
        if (!solved.ends_valid) CHECK_FALSE(solved.found.solved());
      }
      check_distribution(kind, solved, 11);
    }
  }
}

TEST_CASE("a guide whose space has no path goes by what it claims to", "[guide][claims]") {
  for (const auto& kind : guide_kinds()) {
    if (kind.default_planner.empty() || kind.claims.needs == GuideClaims::Needs::team) continue;
    CAPTURE(kind.component->name);
    auto solved = solve(kind, sealed_problem(), 1, 1000);
    if (solved.found.solved()) continue;  // what it leaves out is the wall
    check_distribution(kind, solved, 12);
    if (kind.claims.fallback != GuideClaims::Fallback::nearest || solved.found.path.size() < 2) continue;
    const auto path = solved.h->lifted_path();
    REQUIRE(path.size() >= 2);
    const Space& space = solved.parent->space;
    CHECK(space.distance(path.front(), solved.parent->start) == 0.0);
    CHECK(space.distance(path.back(), solved.parent->goal()) < space.distance(path.front(), solved.parent->goal()));
  }
}

TEST_CASE("h proposes inside C, and its density integrates to one less its atoms", "[guide][density][slow]") {
  for (const auto& kind : guide_kinds()) {
    for (const auto& problem : problems(kind)) {
      CAPTURE(kind.component->name, problem.name);
      const auto solved = solve(kind, problem);
      const auto& space = solved.parent->space;
      if (std::isnan(test::record_of(*solved.h).at(solved.parent->start))) continue;  // no closed form is claimed
      const auto [whole, error] = mass(*solved.h, space, 5);
      CHECK(std::abs(whole - (1.0 - test::record_of(*solved.h).atoms())) < 4.0 * error + 1e-9);
    }
  }
}

TEST_CASE("samples of h fall where its density says", "[guide][density][slow]") {
  for (const auto& kind : guide_kinds()) {
    for (const auto& problem : problems(kind)) {
      CAPTURE(kind.component->name, problem.name);
      const auto solved = solve(kind, problem);
      const auto& space = solved.parent->space;
      Stream stream(6, "0", "samples");
      Configuration q(space.dimension());
      const bool closed = !std::isnan(test::record_of(*solved.h).at(solved.parent->start));
      // The probability of each cell of a grid over the first two axes, from samples and from the density.
      constexpr int cells = 6;
      constexpr int draws = 40000;
      std::vector<double> drawn(cells * cells, 0.0);
      std::vector<double> expected(cells * cells, 0.0);
      std::vector<double> variance(cells * cells, 0.0);
      const auto cell = [&](View x) {
        const auto part = [&](std::size_t j) {
          const auto& axis = space.axes()[j];
          return std::min(cells - 1, static_cast<int>((x[j] - axis.lo) / (axis.hi - axis.lo) * cells));
        };
        return static_cast<std::size_t>(part(0) * cells + part(1));
      };
      const Configuration goal = solved.parent->goal();
      double atoms = 0.0;
      // The box that holds all draws, a little wider: where the density is integrated.
      std::vector<std::pair<double, double>> box(space.dimension(), {1e9, -1e9});
      for (int i = 0; i < draws; ++i) {
        solved.h->sample(stream, q);
        REQUIRE(space.contains(q));
        for (std::size_t j = 0; j < q.size(); ++j) {
          box[j].first = std::min(box[j].first, q[j]);
          box[j].second = std::max(box[j].second, q[j]);
        }
        const Configurations& path = solved.found.path;
        bool atom = q == goal;
        for (std::size_t k = 0; k < path.size() && !atom && path.dimension() == q.size(); ++k) {
          atom = std::equal(q.begin(), q.end(), path[k].begin());
        }
        if (atom && test::record_of(*solved.h).atoms() > 0.0) {
          atoms += 1.0;
        } else {
          drawn[cell(q)] += 1.0 / draws;
        }
      }
      CHECK(atoms / draws == Approx(test::record_of(*solved.h).atoms()).margin(0.01));
      if (!closed) continue;
      double volume = 1.0;
      for (std::size_t j = 0; j < box.size(); ++j) {
        const auto& axis = space.axes()[j];
        const double wider = 0.02 * (box[j].second - box[j].first);
        box[j] = {std::max(axis.lo, box[j].first - wider), std::min(axis.hi, box[j].second + wider)};
        volume *= axis.weight * (box[j].second - box[j].first);
      }
      const DensityRecord now = test::record_of(*solved.h);
      // A density that is high in small places needs more points until its integral is known well enough.
      double points = 0.0;
      double squares = 1.0;
      constexpr double batch = 120000.0;
      for (; points < batch || (std::sqrt(squares) > 0.01 * points && points < 30.0 * batch); ++points) {
        for (std::size_t j = 0; j < q.size(); ++j) q[j] = stream.uniform(box[j].first, box[j].second);
        const double p = now.at(q) * volume;
        expected[cell(q)] += p;
        variance[cell(q)] += p * p;
        squares += p * p;
      }
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        expected[i] /= points;
        variance[i] /= points * points;
      }
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        const double error = std::sqrt(variance[i] + expected[i] / draws) + 1.0 / draws;
        CHECK(std::abs(drawn[i] - expected[i]) < 5.0 * error);
      }
    }
  }
}

TEST_CASE("what h enters into a record is its density at every step", "[guide][density]") {
  for (const auto& kind : guide_kinds()) {
    for (const auto& problem : problems(kind)) {
      CAPTURE(kind.component->name, problem.name);
      test::check_record(solve(kind, problem), 60, 400);
    }
  }
}

TEST_CASE("lifting what is uniform on S is uniform on C, per volume in either's metric", "[guide][density]") {
  for (const auto& kind : guide_kinds()) {
    if (kind.default_planner.empty() || !is_image(kind)) continue;
    for (auto problem : problems(kind)) {
      if (is_tip(kind, problem)) continue;  // fibres of a tip differ in size
      CAPTURE(kind.component->name, problem.name);
      for (const double weight : {1.0, 2.5}) {
        auto axes = problem.space.axes();
        for (auto& axis : axes) axis.weight *= weight;
        problem.space = Space(problem.space.name(), axes);
        const auto solved = solve(kind, problem);
        Configuration q(problem.space.dimension());
        Stream stream(8, "0", "fibres");
        for (int i = 0; i < 20; ++i) {
          problem.space.sample_uniform(stream, q);
          CHECK(solved.guide->log_fibre_density(q) - solved.sub->space.log_volume() ==
                Approx(-problem.space.log_volume()).epsilon(1e-12));
        }
      }
    }
  }
}

TEST_CASE("a shrunken robot's path keeps to the world that the larger one sees", "[guide][shrink]") {
  const auto solved = solve(*find_guide("shrink"), test::simple_passage_problem());
  REQUIRE(solved.found.solved());
  CHECK(solved.sub->scene->bounding_radius() == Approx(0.5 * solved.parent->scene->bounding_radius()).epsilon(1e-12));
  for (std::size_t i = 0; i < solved.found.path.size(); ++i) CHECK(solved.sub->valid(solved.found.path[i]));
}

TEST_CASE("lazy forgets its presumption where C found something invalid", "[guide][lazy]") {
  const auto problem = test::cup_problem();
  auto solved = solve(*find_guide("lazy"), problem);
  const Configuration inside = {6.75, 5, 0};
  REQUIRE(solved.sub->valid(inside));
  CHECK(solved.sub->checks.validity == 0);
  Outcome outcome;
  outcome.proposal = inside;
  outcome.near = problem.start;
  outcome.blocked_at = inside;
  const auto before = solved.sub->validity->epoch();
  solved.guide->learn(outcome);
  CHECK_FALSE(solved.sub->valid(inside));
  CHECK(solved.sub->validity->epoch() > before);
  CHECK_FALSE(solved.sub->motion(Configuration{5, 5, 0}, Configuration{8, 5, 0}).valid);
  CHECK(solved.sub->motion(Configuration{5, 7, 0}, Configuration{8, 7, 0}).valid);
}

TEST_CASE("regions travel along the skeleton as the planner's nodes enter them", "[guide][skeleton]") {
  const auto problem = test::simple_passage_problem();
  auto solved = solve(*find_guide("skeleton"), problem);
  REQUIRE(solved.found.solved());
  const auto mean_x = [&] {
    Stream stream(9, "0", "regions");
    Configuration q(3);
    double sum = 0.0;
    for (int i = 0; i < 4000; ++i) {
      solved.h->sample(stream, q);
      sum += q[0] / 4000;
    }
    return sum;
  };
  const double before = mean_x();
  // A walker that has followed the path found in S to the middle of the corridor.
  for (std::size_t i = 0; i < solved.found.path.size(); ++i) {
    const View p = std::as_const(solved.found.path)[i];
    if (p[0] > 5.0) break;
    const Configuration q = {p[0], p[1], 0.0};
    const Outcome outcome = test::reached(q);
    solved.guide->learn(outcome);
    solved.h->observe(outcome, false);
  }
  CHECK(mean_x() > before + 0.5);
}

namespace {

/// The problem with two more goals, one nearer to the start than its own.
Problem with_more_goals(Problem problem) {
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  Stream stream(12, problem.name, "goals");
  Configuration q(problem.space.dimension());
  Configuration nearer;
  Configuration other;
  while (nearer.empty() || other.empty()) {
    problem.space.sample_uniform(stream, q);
    if (!problem.space.contains(q) || !checker->valid(q)) continue;
    const double own = problem.space.distance(problem.start, problem.goals.front());
    Configuration& end = problem.space.distance(problem.start, q) < 0.5 * own ? nearer : other;
    if (end.empty()) end = q;
  }
  problem.goals.insert(problem.goals.end(), {nearer, other});
  return problem;
}

/// What h draws from a fixed stream.
Configurations draws(Heuristic& h, const Space& space) {
  Stream stream(13, "0", "draws");
  Configurations drawn(space.dimension());
  Configuration q(space.dimension());
  for (int i = 0; i < 50; ++i) {
    h.sample(stream, q);
    drawn.push(q);
  }
  return drawn;
}

bool same(const Configurations& a, const Configurations& b) { return std::ranges::equal(a.values(), b.values()); }

}  // namespace

TEST_CASE("S, the path found in it and h serve all goals, whatever their order", "[guide][goals]") {
  for (const auto& kind : guide_kinds()) {
    for (const auto& problem : problems(kind)) {
      CAPTURE(kind.component->name, problem.name);
      Problem permuted = with_more_goals(problem);
      std::ranges::sort(permuted.goals);
      test::SolvedGuide first = solve(kind, permuted);
      const Configurations drawn = draws(*first.h, permuted.space);
      while (std::ranges::next_permutation(permuted.goals).found) {
        test::SolvedGuide again = solve(kind, permuted);
        if (first.sub) {
          CHECK(again.sub->start == first.sub->start);
          CHECK(again.sub->goals == first.sub->goals);
          CHECK(again.found.status == first.found.status);
          CHECK(same(again.found.path, first.found.path));
          CHECK(same(again.h->lifted_path(), first.h->lifted_path()));
        }
        // The goal itself is drawn by its number.
        if (kind.component->name != "goal_bias") CHECK(same(draws(*again.h, permuted.space), drawn));
        again.h->found(0.9 * permuted.space.diameter());
        first.h->found(0.9 * permuted.space.diameter());
        const DensityRecord here = test::record_of(*first.h);
        const DensityRecord there = test::record_of(*again.h);
        CHECK(there.atoms() == Approx(here.atoms()));
        Stream stream(14, "0", "density");
        Configuration q(permuted.space.dimension());
        for (int i = 0; i < 50; ++i) {
          permuted.space.sample_uniform(stream, q);
          const double density = here.at(q);
          if (std::isnan(density)) {
            CHECK(std::isnan(there.at(q)));
          } else {
            CHECK(there.at(q) == Approx(density).margin(1e-300));
          }
        }
      }
    }
  }
}

TEST_CASE("a path in S leads to the goal that is nearest there", "[guide][goals]") {
  for (const auto& kind : guide_kinds()) {
    if (kind.default_planner.empty() || !find_planner(kind.default_planner)->graph) continue;
    if (kind.component->name == "experience") continue;  // its library is empty
    CAPTURE(kind.component->name);
    Problem problem = test::cup_problem();
    problem.goals = {{9, 5, 0}, {1.5, 9, 1}};
    test::SolvedGuide solved = solve(kind, problem);
    REQUIRE(solved.found.solved());
    Configuration s(solved.sub->space.dimension());
    solved.guide->project(problem.goals[1], s);
    CHECK(std::ranges::equal(solved.found.path.back(), s));
    const Configurations lifted = solved.h->lifted_path();
    REQUIRE_FALSE(lifted.empty());
    CHECK(std::ranges::equal(lifted.back(), problem.goals[1]));
  }
}
