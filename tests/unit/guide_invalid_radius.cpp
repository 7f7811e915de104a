// SPDX-License-Identifier: GPL-3.0-or-later
// The invalid radius of the validities of guiding spaces.
#include <memory>
#include <vector>

#include <trellis/guide/changing_world.hpp>
#include <trellis/guide/excluded.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

TEST_CASE("a world that changes bounds the invalid radius as its checker does", "[guide][invalid_radius]") {
  const auto problem = test::cup_problem();
  const auto parent = make_instance(problem);
  ChangingWorld world(*parent, problem.scene);
  const Configuration inside{6.75, 5, 0};
  CHECK(parent->validity->invalid_radius(inside) > 0.2);
  CHECK(world.invalid_radius(inside) == parent->validity->invalid_radius(inside));
  world.set(problem.scene->with_obstacles({}));
  CHECK(world.invalid_radius(inside) == 0.0);
}

TEST_CASE("what is excluded for a while is invalid as far as the ball about it reaches", "[guide][invalid_radius]") {
  const auto problem = test::cup_problem();
  const auto parent = make_instance(problem);
  ExcludingValidity excluding(parent->validity, parent->space, 0.5);
  const Configuration at{5, 5, 0};
  CHECK(excluding.invalid_radius(at) == 0.0);
  Configurations path(3);
  for (const double x : {1.0, 3.0, 5.0, 6.0}) path.push(Configuration{x, 5, 0});
  excluding.exclude(path);
  Stream stream(1, "", "excluded");
  Configuration q(3), other(3);
  int bounded = 0;
  for (int i = 0; i < 20000; ++i) {
    parent->space.sample_uniform(stream, q);
    const double radius = excluding.invalid_radius(q);
    if (excluding.state(q)) {
      REQUIRE(radius == 0.0);
      continue;
    }
    if (parent->validity->state(q)) ++bounded;
    parent->space.sample_uniform(stream, other);
    const double distance = parent->space.distance(q, other);
    if (radius <= 0.0 || distance <= 0.0) continue;
    const Configuration far = other;
    parent->space.interpolate(q, far, std::min(1.0, 0.999 * radius / distance), other);
    REQUIRE_FALSE(excluding.state(other));
  }
  CHECK(bounded > 100);
  excluding.include_paths();
  CHECK(excluding.invalid_radius(at) == 0.0);
}
