// SPDX-License-Identifier: GPL-3.0-or-later
// Retraction by ascent of clearance.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <trellis/guide/guide.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

struct Retracted {
  double clearance = 0.0;  ///< mean
  double turned = 0.0;     ///< mean of |sin| of the last coordinate
  double off = 0.0;        ///< mean distance from y = 4.5 where the slit's ends are far
  int valid = 0;
};

Retracted retracted(const Problem& problem, std::int64_t climbs, int count) {
  const GuideKind& kind = *find_guide("medial_axis");
  const auto parent = make_instance(problem);
  const auto guide = kind.make(Options::validate(*kind.component, {{"climbs", climbs}}));
  CHECK(guide->project(*parent) == nullptr);
  const auto h = guide->heuristic(*parent, nullptr, nullptr);
  Stream stream(5, "", "retracted");
  Configuration q(problem.space.dimension());
  Retracted r;
  int middle = 0;
  for (int i = 0; i < count; ++i) {
    h->sample(stream, q);
    CHECK(problem.space.contains(q));
    r.valid += parent->validity->state(q) ? 1 : 0;
    r.clearance += parent->validity->clearance(q) / count;
    r.turned += std::abs(std::sin(q.back())) / count;
    if (q[0] > 1.5 && q[0] < 8.5) {
      ++middle;
      r.off += std::abs(q[1] - 4.5);
    }
  }
  r.off /= std::max(1, middle);
  return r;
}

}  // namespace

TEST_CASE("a robot is turned as it is retracted, and ends between two walls", "[guide][medial_axis]") {
  const auto problem = test::make_problem("slit", test::rectangle_world({{0, 0, 10, 4}, {0, 5, 10, 10}}),
                                          test::rectangle_robot(0.8, 0.1), {1, 4.5, 0}, {9, 4.5, 0});
  const Retracted fixed = retracted(problem, 0, 200);
  const Retracted turning = retracted(problem, 3, 200);
  CHECK(fixed.valid == 200);
  CHECK(turning.valid == 200);
  CHECK(fixed.off < 2.0 * problem.resolution);
  CHECK(turning.off < 2.0 * problem.resolution);
  CHECK(turning.turned < 0.7 * fixed.turned);
  CHECK(turning.clearance > 1.1 * fixed.clearance);
}

TEST_CASE("an arm that is fixed to its base is retracted in its angles", "[guide][medial_axis]") {
  const Arm arm{.links = {2, 1.5, 1}, .widths = {0.2, 0.2, 0.1}, .base = {5, 5}};
  const auto problem = test::make_problem("arm", test::rectangle_world({{6.5, 6.5, 8, 8}, {2, 2, 3.5, 3.5}}),
                                          Robot::arm(arm), {1.8, 0.3, 0.3}, {-0.8, -0.4, 0.5});
  const Retracted turning = retracted(problem, 3, 200);
  const Retracted still = retracted(problem, 0, 200);
  CHECK(turning.valid == 200);
  CHECK(still.valid == 200);
  CHECK(turning.clearance > 1.2 * still.clearance);
}
