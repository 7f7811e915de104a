// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstddef>
#include <numbers>

#include "collision_worlds.hpp"
#include "support/catch.hpp"

// The two backends, and an independent reference, give the same result for every configuration and motion.

using namespace collision_test;

namespace {

constexpr double resolution = 0.05;

/// The disagreements, and the largest distance from contact among them.
struct Tally {
  std::size_t backends = 0;
  std::size_t reference = 0;
  double worst = 0.0;
};

Tally compare_states(const Case& c, std::size_t count, std::size_t reference_every) {
  const auto planar = make_planar_checker(c.scene, c.space, resolution);
  const auto fcl = make_fcl_checker(c.scene, c.space, resolution);
  Stream stream(11, c.name, "states");
  Configuration q(c.space.dimension());
  Tally tally;
  for (std::size_t i = 0; i < count; ++i) {
    c.space.sample_uniform(stream, q);
    const bool ours = planar->valid(q);
    if (ours != fcl->valid(q)) {
      ++tally.backends;
      tally.worst = std::max(tally.worst, std::abs(reference_clearance(c, q)));
    }
    if (i % reference_every == 0 && ours != reference_valid(c, q)) ++tally.reference;
  }
  return tally;
}

Tally compare_motions(const Case& c, std::size_t count, std::size_t reference_every) {
  const auto planar = make_planar_checker(c.scene, c.space, resolution);
  const auto fcl = make_fcl_checker(c.scene, c.space, resolution);
  Stream stream(12, c.name, "motions");
  Configuration a(c.space.dimension());
  Configuration b(c.space.dimension());
  Configuration q(c.space.dimension());
  Tally tally;
  for (std::size_t i = 0; i < count; ++i) {
    random_motion(stream, c.space, a, b);
    const MotionReport ours = planar->motion(a, b);
    const MotionReport theirs = fcl->motion(a, b);
    if (!same(ours, theirs)) {
      ++tally.backends;
      const MotionReport& earlier = !ours.valid && (theirs.valid || ours.checks < theirs.checks) ? ours : theirs;
      c.space.interpolate(a, b, earlier.invalid_at, q);
      tally.worst = std::max(tally.worst, std::abs(reference_clearance(c, q)));
    }
    if (i % reference_every != 0) continue;
    const MotionReport reference = reference_motion(c, resolution, a, b);
    if (same(ours, reference)) continue;
    // The motion of a point is exact: it may be in contact between the configurations of the reference.
    if (c.scene->is_point() && reference.valid && ours.checks == reference.checks) {
      c.space.interpolate(a, b, ours.invalid_at, q);
      constexpr double rounding = 1e-12;
      if (reference_clearance(c, q) <= rounding) continue;
    }
    ++tally.reference;
  }
  return tally;
}

void require_none(const Tally& tally) {
  CHECK(tally.backends == 0);
  CHECK(tally.reference == 0);
  CHECK(tally.worst == 0.0);
}

}  // namespace

TEST_CASE("a million configurations of each of the paper's scenes", "[slow]") {
  for (const Case& c : paper_cases()) {
    INFO(c.name);
    require_none(compare_states(c, 1'000'000, 1));
  }
}

TEST_CASE("a million motions in each of the paper's scenes", "[slow]") {
  for (const Case& c : paper_cases()) {
    INFO(c.name);
    require_none(compare_motions(c, 1'000'000, 10));
  }
}

TEST_CASE("configurations of every kind of robot among every kind of obstacle", "[slow]") {
  for (const Case& c : mixed_cases()) {
    INFO(c.name);
    require_none(compare_states(c, 100'000, 1));
  }
}

TEST_CASE("motions of every kind of robot among every kind of obstacle", "[slow]") {
  for (const Case& c : mixed_cases()) {
    INFO(c.name);
    require_none(compare_motions(c, 100'000, 4));
  }
}
