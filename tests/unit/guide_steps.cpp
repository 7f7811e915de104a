// SPDX-License-Identifier: GPL-3.0-or-later
// Paths in S that are validated sparsely in C, and followed by steps ahead of what is connected.
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <trellis/guide/excluded.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/instance/verified_motions.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

Configurations straight(double y = 5.0) {
  Configurations path(3);
  path.push(std::vector<double>{1, y, 0});
  path.push(std::vector<double>{9, y, 0});
  return path;
}

StepHeuristic follow(const Space& space, const Configurations& path, std::int64_t evidence = 60) {
  return {"path", space, path, {.radius = 0.16, .step = 0.5, .evidence = evidence}, {nullptr, nullptr}};
}

Outcome reached(View q, std::uint32_t row, bool from_goal = false) {
  Outcome outcome;
  outcome.fate = Fate::reached;
  outcome.proposal = q;
  outcome.near = q;
  outcome.added = q;
  outcome.added_row = row;
  outcome.from_goal = from_goal;
  return outcome;
}

Outcome blocked(View q) {
  Outcome outcome;
  outcome.proposal = q;
  outcome.near = q;
  outcome.blocked_at = q;
  return outcome;
}

const PointLift as_it_is = [](int attempt, View s, View, View, Stream&, MutableView q) {
  std::copy(s.begin(), s.end(), q.begin());
  return attempt == 0;
};

}  // namespace

TEST_CASE("proposals are a step ahead of the node that came farthest along the path", "[guide][steps]") {
  const auto problem = test::cup_problem();
  auto h = follow(problem.space, straight());
  Stream stream(1, "0", "steps");
  Configuration q(3);
  double front = 1.0;
  for (std::uint32_t row = 1; front < 8.5; ++row) {
    for (int i = 0; i < 20; ++i) {
      h.sample(stream, q);
      CHECK(q[0] > front);
      CHECK(q[0] <= front + 0.5 + 0.1);
      CHECK(std::abs(q[1] - 5.0) <= 0.1);
    }
    front += 0.5;
    const Configuration node = {front, 5.0, 0.0};
    h.observe(reached(node, row), true);
    CHECK(h.vertex() == row);
  }
  CHECK(h.progress() == Approx(front - 1.0).margin(0.2));
}

TEST_CASE("two trees go on from both ends of a path", "[guide][steps]") {
  const auto problem = test::cup_problem();
  auto h = follow(problem.space, straight());
  Stream stream(1, "0", "steps");
  Configuration q(3);
  h.select_tree(TreeSide::goal);
  h.sample(stream, q);
  CHECK(q[0] > 8.3);
  h.observe(reached(std::vector<double>{8.5, 5, 0}, 7, true), true);
  h.sample(stream, q);
  CHECK(q[0] < 8.2);
  CHECK(h.vertex() == 7);
  h.select_tree(TreeSide::start);
  h.sample(stream, q);
  CHECK(q[0] < 1.7);
  // Far apart, connecting the trees is not worth its checks; where they meet it is.
  CHECK_FALSE(h.worth_connecting(std::vector<double>{1, 5, 0}, std::vector<double>{8.5, 5, 0}));
  for (double x = 1.5; x < 8.0; x += 0.5) h.observe(reached(std::vector<double>{x, 5, 0}, 8), true);
  CHECK(h.worth_connecting(std::vector<double>{7.5, 5, 0}, std::vector<double>{8.5, 5, 0}));
}

TEST_CASE("what lies behind a wall beside the path is no progress, nor is a vertex that is not connected",
          "[guide][steps]") {
  const auto problem = test::cup_problem();
  // There and back, half a metre apart.
  Configurations path(3);
  for (const auto& [x, y] : {std::pair(1.0, 5.0), std::pair(8.0, 5.0), std::pair(8.0, 5.5), std::pair(1.0, 5.5)}) {
    path.push(std::vector<double>{x, y, 0});
  }
  auto h = follow(problem.space, path);
  Stream stream(1, "0", "steps");
  Configuration q(3);
  h.observe(reached(std::vector<double>{1.5, 5.0, 0}, 1), true);
  const double before = h.progress();
  // Near the way back by a metric that knows no walls.
  h.observe(reached(std::vector<double>{1.5, 5.25, 0}, 2), true);
  CHECK(h.progress() <= before + 0.5);
  Outcome loose = reached(std::vector<double>{2.0, 5.0, 0}, 3);
  loose.connected = false;
  const double now = h.progress();
  h.observe(loose, true);
  CHECK(h.progress() == now);
}

TEST_CASE("evidence refutes a path, and nothing else does", "[guide][steps]") {
  const auto problem = test::cup_problem();
  auto h = follow(problem.space, straight(), 30);
  const Configuration far = {2.0, 8.0, 0.0};
  // Nodes elsewhere are no progress, and no evidence.
  for (std::uint32_t i = 0; i < 500; ++i) h.observe(reached(far, i), true);
  CHECK_FALSE(h.stale());
  for (int i = 0; i < 29; ++i) h.observe(blocked(far), true);
  CHECK_FALSE(h.stale());
  // What others drew is no evidence against this path.
  for (int i = 0; i < 100; ++i) h.observe(blocked(far), false);
  CHECK_FALSE(h.stale());
  h.observe(blocked(far), true);
  CHECK(h.stale());
  REQUIRE(h.refuted_place());
  CHECK((*h.refuted_place())[0] == Approx(1.16).margin(0.1));
}

TEST_CASE("what follows a path by steps enters into a record is its density at every step", "[guide][steps][density]") {
  const auto problem = test::cup_problem();
  for (const std::size_t every : {2U, 7U}) {
    auto h = follow(problem.space, straight(), 1000000);
    Stream stream(every, "0", "density");
    std::vector<Configuration> probes;
    for (int i = 0; i < 40; ++i) {
      probes.push_back({stream.uniform(1, 9), stream.uniform(4.5, 5.5), stream.uniform(-0.6, 0.6)});
    }
    std::vector<double> sums(probes.size(), 0.0);
    DensityRecord record;
    Configuration q(3);
    constexpr int steps = 200;
    for (int t = 0; t < steps; ++t) {
      h.select_tree(t % 2 == 0 ? TreeSide::start : TreeSide::goal);
      h.sample(stream, q);
      record.served(h);
      for (std::size_t i = 0; i < probes.size(); ++i) sums[i] += h.density(probes[i]) / steps;
      const bool success = static_cast<std::size_t>(t) % every == 0;
      h.observe(success ? reached(q, static_cast<std::uint32_t>(t), t % 2 != 0) : blocked(q), true);
    }
    REQUIRE(record.exact());
    for (std::size_t i = 0; i < probes.size(); ++i) {
      CHECK(record.at(probes[i]) == Approx(sums[i]).epsilon(1e-9).margin(1e-12));
    }
  }
}

TEST_CASE("a path is validated at points that are the spacing apart, and each is checked once", "[guide][sparse]") {
  const auto instance = make_instance(
      test::make_problem("open", test::rectangle_world({}), test::rectangle_robot(), {1, 5, 0}, {9, 5, 0}));
  SparseValidation sparse(instance->space, 0.5);
  const SparsePath path = sparse.validate(*instance, straight(), true, as_it_is);
  CHECK_FALSE(path.refuted);
  // 16 pieces of 8 m, both ends known to be valid.
  CHECK(path.waypoints.size() == 17);
  CHECK(instance->checks.validity == 15);
  sparse.validate(*instance, straight(), true, as_it_is);
  CHECK(instance->checks.validity == 15);
}

TEST_CASE("a point without a valid lift refutes a path; another lift repairs it", "[guide][sparse]") {
  const auto problem = test::make_problem("wall", test::rectangle_world({{4.5, 4, 5.5, 6}}), test::rectangle_robot(),
                                          {1, 5, 0}, {9, 5, 0});
  const auto instance = make_instance(problem);
  SparseValidation sparse(instance->space, 0.4);
  const SparsePath path = sparse.validate(*instance, straight(), true, as_it_is);
  REQUIRE(path.refuted);
  CHECK_FALSE(instance->valid(*path.refuted));
  const auto spent = instance->checks.validity;
  // The same point again is known to be refuted.
  const SparsePath again = sparse.validate(*instance, straight(), true, as_it_is);
  REQUIRE(again.refuted);
  CHECK(instance->checks.validity == spent);
  // Lifts that go round it: all waypoints are valid then.
  SparseValidation fresh(instance->space, 0.4);
  const PointLift aside = [](int attempt, View s, View, View, Stream&, MutableView q) {
    std::copy(s.begin(), s.end(), q.begin());
    q[1] += 0.25 * attempt;
    return attempt < 10;
  };
  const SparsePath round = fresh.validate(*instance, straight(), true, aside);
  CHECK_FALSE(round.refuted);
  for (std::size_t i = 0; i < round.waypoints.size(); ++i) CHECK(instance->valid(round.waypoints[i]));
}

TEST_CASE("excluded places hold every configuration with a position near them, unless it is to be kept",
          "[guide][excluded]") {
  const auto problem = test::cup_problem();
  const auto instance = make_instance(problem);
  ExcludingValidity validity(instance->validity, problem.space, 0.3, {0, 1}, 0.2);
  const Configuration place = {2, 5, 0};
  CHECK_FALSE(validity.exclude_place(place, {{2.1, 5, 0}}));
  CHECK(validity.state(place));
  const auto before = validity.epoch();
  CHECK(validity.exclude_place(place, {problem.start, problem.goal}));
  CHECK(validity.epoch() > before);
  for (const double angle : {-3.0, 0.0, 1.5}) {
    CHECK_FALSE(validity.state(Configuration{2.1, 5.1, angle}));
    CHECK(validity.state(Configuration{2.3, 5.0, angle}));
  }
  CHECK_FALSE(validity.motion(Configuration{1, 5, 0}, Configuration{3, 5, 0}).valid);
  // What was valid before and does not enter the place needs no check to be valid still.
  const MotionReport still = validity.motion_still_valid(Configuration{1, 6, 0}, Configuration{2, 6, 0});
  CHECK(still.valid);
  CHECK(still.checks == 0);
}

TEST_CASE("a part of a verified motion is covered, in both directions, and nothing beside it", "[instance][verified]") {
  const auto space = test::cup_problem().space;
  VerifiedMotions verified(space);
  Stream stream(3, "0", "verified");
  Configuration a(3);
  Configuration b(3);
  Configuration p(3);
  Configuration q(3);
  for (int i = 0; i < 50; ++i) {
    space.sample_uniform(stream, a);
    space.sample_uniform(stream, b);
    CHECK_FALSE(verified.cover(a, b));
    verified.add(a, b);
    CHECK(verified.contain(b, a));
    for (int k = 0; k < 20; ++k) {
      space.interpolate(a, b, stream.uniform(), p);
      space.interpolate(a, b, stream.uniform(), q);
      CHECK(verified.cover(p, q));
      CHECK(verified.cover(q, p));
      q[1] += q[1] < 5 ? 1e-3 : -1e-3;
      CHECK_FALSE(verified.cover(p, q));
    }
  }
}

TEST_CASE("what was verified holds until the instance changes", "[instance][verified]") {
  const auto problem = test::cup_problem();
  const auto instance = make_instance(problem);
  const auto excluding =
      std::make_shared<ExcludingValidity>(instance->validity, problem.space, 0.3, std::vector<std::size_t>{0, 1}, 0.2);
  instance->validity = excluding;
  instance->verified = std::make_shared<VerifiedMotions>(problem.space);
  const Configuration a = {1, 5, 0};
  const Configuration b = {2.5, 5, 0};
  instance->verified->hold_at(instance->epoch());
  REQUIRE(instance->motion(a, b).valid);
  instance->verified->add(a, b);
  const auto spent = instance->checks.validity;
  CHECK(instance->motion(a, b).valid);
  CHECK(instance->checks.validity == spent);
  REQUIRE(excluding->exclude_place(Configuration{1.8, 5, 0}, {}));
  CHECK_FALSE(instance->is_verified(a, b));
  CHECK_FALSE(instance->motion(a, b).valid);
}
