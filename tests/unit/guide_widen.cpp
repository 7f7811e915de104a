// SPDX-License-Identifier: GPL-3.0-or-later
// Retraction of the path that was found among eroded obstacles.
#include <memory>
#include <utility>

#include <trellis/guide/guide.hpp>
#include <trellis/scene/planar/erosion.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

struct Widened {
  std::unique_ptr<Instance> parent;
  std::unique_ptr<Guide> guide;
  std::unique_ptr<Instance> sub;
};

Widened widened(const Problem& problem, std::int64_t repair) {
  Widened w;
  const GuideKind& kind = *find_guide("widen");
  w.parent = make_instance(problem);
  w.guide = kind.make(
      Options::validate(*kind.component, {{"distance", 0.2}, {"repair", repair}, {"follow", std::string("tube")}}));
  w.sub = w.guide->project(*w.parent);
  return w;
}

/// A path that grazes the lower wall of the passage, 0.1 m deep.
Solution grazing() {
  Solution found;
  found.status = Status::solved;
  found.path = Configurations(3);
  found.path.push(Configuration{1, 8.5, 0});
  found.path.push(Configuration{3, 5, 0});
  for (double x = 3.8; x < 6.3; x += 0.2) found.path.push(Configuration{x, 4.75, 0});
  found.path.push(Configuration{7, 5, 0});
  found.path.push(Configuration{9, 1.5, 0});
  return found;
}

int invalid_points(Instance& instance, const Configurations& path) {
  int count = 0;
  for (std::size_t i = 0; i < path.size(); ++i) count += instance.validity->state(path[i]) ? 0 : 1;
  return count;
}

}  // namespace

TEST_CASE("points of the path that are invalid in C are retracted, at C's expense", "[guide][widen]") {
  const auto problem = test::simple_passage_problem();
  const Solution found = grazing();
  auto w = widened(problem, 10);
  const int before = invalid_points(*w.parent, found.path);
  REQUIRE(before > 8);
  REQUIRE(invalid_points(*w.sub, found.path) == 0);
  const auto h = w.guide->heuristic(*w.parent, w.sub.get(), &found);
  const Configurations followed = h->lifted_path();
  CHECK(invalid_points(*w.parent, followed) <= before / 3);
  REQUIRE(followed.size() == found.path.size());
  CHECK(w.parent->checks.validity >= found.path.size());
  CHECK(w.parent->checks.validity <= found.path.size() + static_cast<std::size_t>(before) * 10);
  for (std::size_t i = 0; i < followed.size(); ++i) {
    // What was valid stays, what was not stays near.
    const double moved = problem.space.distance(followed[i], found.path[i]);
    if (w.parent->validity->state(found.path[i])) CHECK(moved == 0.0);
    CHECK(moved < 0.2 + 4 * 0.2);
  }
}

TEST_CASE("without tries the path is followed as it was found", "[guide][widen]") {
  const Solution found = grazing();
  auto w = widened(test::simple_passage_problem(), 0);
  const auto h = w.guide->heuristic(*w.parent, w.sub.get(), &found);
  const Configurations followed = h->lifted_path();
  REQUIRE(followed.size() == found.path.size());
  for (std::size_t i = 0; i < followed.size(); ++i) {
    CHECK(std::equal(followed[i].begin(), followed[i].end(), found.path[i].begin()));
  }
  CHECK(w.parent->checks.validity == 0);
}

TEST_CASE("an obstacle of which rounding alone would be left vanishes", "[guide][widen]") {
  // 5.5 - 0.1 is more than 5.3 + 0.1 by a rounding error.
  const World world({{0, 0}, {10, 10}}, {{"wall", Box2{{5.3, 5.05}, {5.5, 5.55}}}});
  CHECK(eroded(world, 0.1).obstacles().empty());
}
