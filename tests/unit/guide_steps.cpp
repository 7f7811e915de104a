// SPDX-License-Identifier: GPL-3.0-or-later
// Paths in S that are validated sparsely in C, and followed by steps ahead of what is connected.
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <trellis/guide/excluded.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/guide/relaxed.hpp>
#include <trellis/instance/verified_motions.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/density.hpp"
#include "support/outcomes.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::blocked;
using test::reached;

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

TEST_CASE("two trees continue from both ends of a path", "[guide][steps]") {
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
  // Far from each other, connecting the trees costs too many checks; close together it does not.
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
  // Near the return path in a metric that ignores walls.
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
  // Proposals of other guides are no evidence against this path.
  for (int i = 0; i < 100; ++i) h.observe(blocked(far), false);
  CHECK_FALSE(h.stale());
  h.observe(blocked(far), true);
  CHECK(h.stale());
  REQUIRE(h.refuted_place());
  CHECK((*h.refuted_place())[0] == Approx(1.16).margin(0.1));
}

TEST_CASE("what is connected along a path is where its nodes are", "[guide][steps]") {
  const Space space = test::cup_problem().space;
  StepHeuristic h = follow(space, straight());
  CHECK(h.connected() == 0.0);
  h.observe(reached(Configuration{1.5, 5, 0}, 1), true);
  CHECK(h.connected() == Approx(h.progress()));
  h.observe(reached(Configuration{8.5, 5, 0}, 2, true), false);
  CHECK(h.connected() == Approx(1.0).margin(0.2));
  // What is made for the nodes that are there already has made no progress with them.
  ReachedIndex nodes(space, Configuration{1, 5, 0});
  nodes.add(Configuration{3, 5, 0});
  const StepHeuristic later("path", space, straight(), {.radius = 0.16, .step = 0.5}, {&nodes, nullptr});
  CHECK(later.connected() == Approx(2.0).margin(0.2));
  CHECK(later.progress() == 0.0);
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
      const DensityRecord now = test::record_of(h);
      for (std::size_t i = 0; i < probes.size(); ++i) sums[i] += now.at(probes[i]) / steps;
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
  const SparsePath path = sparse.validate(*instance, straight(), instance->goal(), as_it_is);
  CHECK_FALSE(path.refuted);
  // 16 pieces of 8 m, with valid ends.
  CHECK(path.waypoints.size() == 17);
  CHECK(instance->checks.validity == 15);
  sparse.validate(*instance, straight(), instance->goal(), as_it_is);
  CHECK(instance->checks.validity == 15);
}

TEST_CASE("a point without a valid lift refutes a path, another lift repairs it", "[guide][sparse]") {
  const auto problem = test::make_problem("wall", test::rectangle_world({{4.5, 4, 5.5, 6}}), test::rectangle_robot(),
                                          {1, 5, 0}, {9, 5, 0});
  const auto instance = make_instance(problem);
  SparseValidation sparse(instance->space, 0.4);
  const SparsePath path = sparse.validate(*instance, straight(), instance->goal(), as_it_is);
  REQUIRE(path.refuted);
  CHECK_FALSE(instance->valid(*path.refuted));
  const auto spent = instance->checks.validity;
  // The same point again is known to be refuted.
  const SparsePath again = sparse.validate(*instance, straight(), instance->goal(), as_it_is);
  REQUIRE(again.refuted);
  CHECK(instance->checks.validity == spent);
  // Lifts that go round it: all waypoints are valid then.
  SparseValidation fresh(instance->space, 0.4);
  const PointLift aside = [](int attempt, View s, View, View, Stream&, MutableView q) {
    std::copy(s.begin(), s.end(), q.begin());
    q[1] += 0.25 * attempt;
    return attempt < 10;
  };
  const SparsePath round = fresh.validate(*instance, straight(), instance->goal(), aside);
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
  CHECK(validity.exclude_place(place, {problem.start, problem.goal()}));
  CHECK(validity.epoch() > before);
  for (const double angle : {-3.0, 0.0, 1.5}) {
    CHECK_FALSE(validity.state(Configuration{2.1, 5.1, angle}));
    CHECK(validity.state(Configuration{2.3, 5.0, angle}));
  }
  CHECK_FALSE(validity.motion(Configuration{1, 5, 0}, Configuration{3, 5, 0}).valid);
  // What was valid before and does not enter the place needs no check to be valid still.
  const MotionReport still = validity.motion_still_valid(Configuration{1, 6, 0}, Configuration{2, 6, 0}, 0);
  CHECK(still.valid);
  CHECK(still.checks == 0);
}

TEST_CASE("after a projection of another world motions that were valid are checked anew", "[guide][excluded]") {
  const auto problem = test::cup_problem();
  auto changed = problem;
  auto rectangles = test::cup();
  rectangles.push_back({4.9, 4, 5.1, 6});
  changed.scene = std::make_shared<PlanarScene>(test::rectangle_world(rectangles), planar(*problem.scene).robot);
  const Configuration a = {4, 5, 0};
  const Configuration b = {6, 5, 0};
  const auto guide = find_guide("shrink")->make(Options::validate(*find_guide("shrink")->component, {}));
  const auto parent = make_instance(problem);
  const auto sub = guide->project(*parent);
  REQUIRE(sub->motion(a, b).valid);
  const auto changed_parent = make_instance(changed);
  const auto sub_of_changed = guide->project(*changed_parent);
  CHECK_FALSE(sub_of_changed->motion_still_valid(a, b, 0));
  CHECK(sub_of_changed->motion_still_valid(Configuration{4, 3, 0}, Configuration{6, 3, 0}, 0));
}

TEST_CASE("a verified motion is known in both directions, a part of it is another motion", "[instance][verified]") {
  const auto space = test::cup_problem().space;
  VerifiedMotions verified;
  Stream stream(3, "0", "verified");
  Configuration a(3);
  Configuration b(3);
  Configuration p(3);
  for (int i = 0; i < 200; ++i) {
    space.sample_uniform(stream, a);
    space.sample_uniform(stream, b);
    CHECK_FALSE(verified.contain(a, b));
    verified.add(a, b);
    CHECK(verified.contain(a, b));
    CHECK(verified.contain(b, a));
    space.interpolate(a, b, 0.5, p);
    CHECK_FALSE(verified.contain(a, p));
    CHECK_FALSE(verified.contain(p, b));
    // A motion that stays where it is says nothing of another one.
    verified.add(a, a);
    CHECK(verified.contain(a, a));
    CHECK_FALSE(verified.contain(b, b));
  }
}

TEST_CASE("what was verified holds until the instance changes", "[instance][verified]") {
  const auto problem = test::cup_problem();
  const auto instance = make_instance(problem);
  const auto excluding =
      std::make_shared<ExcludingValidity>(instance->validity, problem.space, 0.3, std::vector<std::size_t>{0, 1}, 0.2);
  instance->validity = excluding;
  instance->verified = std::make_shared<VerifiedMotions>();
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

TEST_CASE("a motion towards a guided proposal is checked once for C and the space that relaxes it",
          "[guide][relaxed]") {
  const auto problem = test::cup_problem();
  const auto c = make_instance(problem);
  const auto smaller =
      std::make_shared<PlanarScene>(planar(*problem.scene).world, planar(*problem.scene).robot.scaled(0.2));
  RelaxedValidity relaxed(c->validity_in(smaller), c->validity_in(problem.scene));
  const auto alone = c->validity_in(smaller);
  const auto whole = c->validity_in(problem.scene);
  Stream stream(5, "0", "relaxed");
  Configuration a(3);
  Configuration b(3);
  int in_both = 0;
  int in_s_only = 0;
  for (int i = 0; i < 2000; ++i) {
    problem.space.sample_uniform(stream, a);
    problem.space.sample_uniform(stream, b);
    problem.space.interpolate(a, b, 0.1, b);
    if (!whole->state(a)) continue;
    const MotionReport in_s = alone->motion(a, b);
    const MotionReport in_c = whole->motion(a, b);
    // A search without a guide checks in S only.
    relaxed.expect_guided(false);
    const MotionReport unguided = relaxed.motion(a, b);
    CHECK(unguided.valid == in_s.valid);
    CHECK(unguided.checks == in_s.checks);
    CHECK_FALSE(relaxed.valid_in_c(a, b));
    // A new one for each motion: it stops asking C where C says no.
    RelaxedValidity fresh(c->validity_in(smaller), c->validity_in(problem.scene));
    fresh.expect_guided(true);
    const MotionReport guided = fresh.motion(a, b);
    CHECK(guided.valid == in_s.valid);
    // The beginning is checked in C, too.
    CHECK(guided.checks == 1 + (in_c.valid ? in_c.checks : in_c.checks + in_s.checks));
    CHECK(fresh.valid_in_c(b, a) == in_c.valid);
    // The second time it is known.
    if (in_c.valid) CHECK(fresh.motion(a, b).checks == 0);
    in_both += in_c.valid ? 1 : 0;
    in_s_only += in_s.valid && !in_c.valid ? 1 : 0;
  }
  CHECK(in_both > 100);
  CHECK(in_s_only > 10);
}

TEST_CASE("a motion from where C is invalid is not valid in C", "[guide][relaxed]") {
  const auto problem = test::cup_problem();
  const auto c = make_instance(problem);
  const auto nothing =
      std::make_shared<PlanarScene>(World(planar(*problem.scene).world.bounds(), {}), planar(*problem.scene).robot);
  const auto in_c = c->validity_in(problem.scene);
  RelaxedValidity relaxed(c->validity_in(nothing), in_c);
  relaxed.expect_guided(true);
  Stream stream(7, "0", "relaxed");
  Configuration a(3);
  Configuration b(3);
  int out_of_obstacles = 0;
  for (int i = 0; i < 20000 && out_of_obstacles < 20; ++i) {
    problem.space.sample_uniform(stream, a);
    problem.space.sample_uniform(stream, b);
    problem.space.interpolate(a, b, 0.005, b);
    if (in_c->state(a) || !in_c->motion(a, b).valid) continue;
    ++out_of_obstacles;
    CHECK(relaxed.motion(a, b).valid);
    CHECK_FALSE(relaxed.valid_in_c(a, b));
  }
  CHECK(out_of_obstacles == 20);
}

TEST_CASE("C is asked about few motions where it finds most of them invalid", "[guide][relaxed]") {
  const auto problem = test::cup_problem();
  const auto c = make_instance(problem);
  // Everything is valid in S.
  const auto nothing =
      std::make_shared<PlanarScene>(World(planar(*problem.scene).world.bounds(), {}), planar(*problem.scene).robot);
  const auto in_c = c->validity_in(problem.scene);
  RelaxedValidity relaxed(c->validity_in(nothing), in_c);
  const auto alone = c->validity_in(nothing);
  relaxed.expect_guided(true);
  Stream stream(6, "0", "relaxed");
  Configuration a(3);
  Configuration b(3);
  int asked = 0;
  int motions = 0;
  while (motions < 400) {
    problem.space.sample_uniform(stream, a);
    problem.space.sample_uniform(stream, b);
    if (!in_c->state(a) || in_c->motion(a, b).valid) continue;
    const MotionReport report = relaxed.motion(a, b);
    const auto expected = alone->motion(a, b);
    CHECK(report.valid == expected.valid);
    asked += report.checks > expected.checks ? 1 : 0;
    ++motions;
  }
  CHECK(asked < 60);
}

TEST_CASE("along edges that were verified their ends are proposed themselves", "[guide][steps][verified]") {
  const auto problem = test::cup_problem();
  Configurations path(3);
  for (double x = 1.0; x <= 9.0; x += 0.5) path.push(std::vector<double>{x, 5, 0});
  const std::size_t edges = path.size() - 1;
  std::vector<char> verified(edges, 1);
  verified[4] = verified[5] = 0;
  StepHeuristic h("path", problem.space, path, {.radius = 0.16, .step = 0.5, .evidence = 60}, {nullptr, nullptr},
                  verified);
  Stream stream(1, "0", "steps");
  Configuration q(3);
  std::size_t vertex = 0;
  for (; vertex < 4; ++vertex) {
    CHECK(test::record_of(h).atoms() == 1.0);
    h.sample(stream, q);
    CHECK(q == Configuration(path[vertex + 1].begin(), path[vertex + 1].end()));
    CHECK(test::record_of(h).at(q) == 0.0);
    // A node in the middle lies on the edge too.
    Configuration half = q;
    half[0] -= 0.25;
    h.observe(reached(half, static_cast<std::uint32_t>(2 * vertex + 1)), true);
    h.sample(stream, q);
    CHECK(q == Configuration(path[vertex + 1].begin(), path[vertex + 1].end()));
    h.observe(reached(q, static_cast<std::uint32_t>(2 * vertex + 2)), true);
    CHECK(h.vertex() == 2 * vertex + 2);
  }
  // Nothing is known of the next edge: proposals are near the path, a step ahead.
  CHECK(test::record_of(h).atoms() == 0.0);
  h.sample(stream, q);
  CHECK(test::record_of(h).at(q) > 0.0);
  h.observe(reached(std::vector<double>{3.4, 5.02, 0.1}, 20), true);
  // The end of what is not known is near: from there the edges are verified again.
  h.observe(reached(std::vector<double>{3.8, 5.02, 0.1}, 21), true);
  h.sample(stream, q);
  CHECK(q == Configuration{4.0, 5, 0});
  // Where that is blocked, it proposes points nearby.
  h.observe(blocked(q), true);
  CHECK(test::record_of(h).atoms() == 0.0);
}

TEST_CASE("trees along a verified path meet where both have come", "[guide][steps][verified]") {
  const auto problem = test::cup_problem();
  Configurations path(3);
  for (double x = 1.0; x <= 4.0; x += 0.5) path.push(std::vector<double>{x, 5, 0});
  StepHeuristic h("path", problem.space, path, {.radius = 0.16, .step = 0.5, .evidence = 60}, {nullptr, nullptr},
                  std::vector<char>(path.size() - 1, 1));
  Stream stream(1, "0", "steps");
  Configuration q(3);
  for (std::uint32_t row = 1; row <= 3; ++row) {
    h.select_tree(TreeSide::start);
    h.sample(stream, q);
    CHECK(q == Configuration{1.0 + 0.5 * row, 5, 0});
    h.observe(reached(q, row), true);
    CHECK_FALSE(h.worth_connecting(q, q));
    h.select_tree(TreeSide::goal);
    h.sample(stream, q);
    CHECK(q == Configuration{4.0 - 0.5 * row, 5, 0});
    h.observe(reached(q, row, true), true);
    CHECK(h.worth_connecting(q, q) == (row == 3));
  }
}

TEST_CASE("a path through an excluded place is refuted without a check", "[guide][sparse]") {
  const auto problem = test::cup_problem();
  const auto instance = make_instance(problem);
  const auto excluding =
      std::make_shared<ExcludingValidity>(instance->validity, problem.space, 0.3, std::vector<std::size_t>{0, 1}, 0.05);
  instance->validity = excluding;
  const auto path = straight(9.5);
  // Between two points of the path that are checked.
  REQUIRE(excluding->exclude_place(Configuration{2.6, 9.5, 0}, {}));
  SparseValidation sparse(problem.space, 0.8);
  instance->start = {1, 9.5, 0};
  instance->goals = {{9, 9.5, 0}};
  const SparsePath found = sparse.validate(*instance, path, instance->goal(), as_it_is);
  REQUIRE(found.refuted);
  CHECK((*found.refuted)[0] == Approx(2.6).margin(0.06));
  CHECK(found.refuted_at == Approx(1.6).margin(0.06));
  CHECK(instance->checks.validity <= 12);
}
