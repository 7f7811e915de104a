// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that every motion model keeps.
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/motion/motion_model.hpp>

#include "support/catch.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::shared_ptr<const MotionModel> model_of(const MotionKind& kind, const std::vector<Options::Entry>& given = {}) {
  return kind.make(Options::validate(*kind.component, given));
}

Space space_of(const MotionModel& model) {
  const Space se2 = Space::se2({-100, 100}, {-100, 100});
  const Space configurations = model.configuration_dimension() == 3
                                   ? se2
                                   : Space("R^2 x SO(2)^2", Space::product({{1.0, se2}, {1.0, Space::so2()}}).axes());
  return state_space(configurations, model);
}

/// A state near the middle of the space, within the limits of the model.
Configuration random_state(const MotionModel& model, const Space& space, Stream& stream) {
  Configuration x(space.dimension());
  do {
    space.sample_uniform(stream, x);
    x[0] *= 0.1;
    x[1] *= 0.1;
  } while (!model.admits(x));
  return x;
}

Configuration driven(const MotionModel& model, const Space& space, const Configuration& from, View control, int steps) {
  Configuration x = from;
  for (int k = 0; k < steps; ++k) model.step(space, x, control, x);
  return x;
}

Configuration random_control(const MotionModel& model, Stream& stream) {
  Configuration u(model.controls().size());
  model.sample_control(stream, u);
  return u;
}

}  // namespace

TEST_CASE("propagation is deterministic, and durations of constant controls add up to the bit", "[motion]") {
  for (const auto& kind : motion_kinds()) {
    CAPTURE(kind.component->name);
    const auto model = model_of(kind);
    const Space space = space_of(*model);
    Stream stream(1, "", "states");
    for (int i = 0; i < 100; ++i) {
      const auto x = random_state(*model, space, stream);
      const auto u = random_control(*model, stream);
      const auto whole = driven(*model, space, x, u, 9);
      CHECK(driven(*model, space, x, u, 9) == whole);
      CHECK(driven(*model, space, driven(*model, space, x, u, 4), u, 5) == whole);
    }
  }
}

TEST_CASE("smaller steps converge to the same motion, at the first order of Euler", "[motion]") {
  for (const auto& kind : motion_kinds()) {
    CAPTURE(kind.component->name);
    Stream stream(2, "", "states");
    const auto end = [&](const Configuration& x, const Configuration& u, int steps) {
      const auto fine = model_of(kind, {{"dt", 0.8 / steps}});
      return driven(*fine, space_of(*fine), x, u, steps);
    };
    const auto model = model_of(kind);
    const Space space = space_of(*model);
    double coarse = 0.0;
    double fine = 0.0;
    for (int i = 0; i < 40; ++i) {
      const auto x = random_state(*model, space, stream);
      const auto u = random_control(*model, stream);
      const auto exact = end(x, u, 8192);
      coarse += space.distance(end(x, u, 16), exact);
      fine += space.distance(end(x, u, 32), exact);
    }
    CHECK(coarse < 40 * 0.05);
    CHECK(fine < 0.6 * coarse);
    CHECK(fine > 0.4 * coarse);
  }
}

TEST_CASE("wheels do not slip sideways, and no motion is faster than the greatest speed", "[motion]") {
  for (const auto& kind : motion_kinds()) {
    CAPTURE(kind.component->name);
    const auto model = model_of(kind);
    const Space space = space_of(*model);
    Stream stream(3, "", "states");
    for (int i = 0; i < 200; ++i) {
      const auto x = random_state(*model, space, stream);
      const auto u = random_control(*model, stream);
      const auto y = driven(*model, space, x, u, 1);
      const double dx = y[0] - x[0];
      const double dy = y[1] - x[1];
      CHECK(std::abs(-std::sin(x[2]) * dx + std::cos(x[2]) * dy) < 1e-12);
      CHECK(std::hypot(dx, dy) <= 0.5 * model->dt() + 1e-12);
    }
  }
}

TEST_CASE("a car turns about one point, no tighter than its steering allows", "[motion]") {
  const auto car = model_of(*find_motion("car"), {{"dt", 1e-3}});
  const Space space = space_of(*car);
  const Configuration hardest = {0.5, car->controls()[1].hi};
  // A turn of 2 pi on a circle of radius wheelbase / tan(steering).
  const double radius = 0.25 / std::tan(hardest[1]);
  const double once_round = 2.0 * std::acos(-1.0) * radius / 0.5;
  const Configuration start = {0, 0, 0};
  const auto half = driven(*car, space, start, hardest, static_cast<int>(std::round(0.5 * once_round / 1e-3)));
  CHECK(half[1] == Approx(2.0 * radius).epsilon(0.01));
  const auto round = driven(*car, space, start, hardest, static_cast<int>(std::round(once_round / 1e-3)));
  CHECK(std::hypot(round[0], round[1]) < 0.01);
}

TEST_CASE("a trailer that is pulled straight comes into line", "[motion]") {
  const auto model = model_of(*find_motion("car_with_trailer"));
  const Space space = space_of(*model);
  Configuration x = {0, 0, 0, 0.7};
  const Configuration straight = {0.5, 0.0};
  double before = x[3];
  for (int k = 0; k < 60; ++k) {
    model->step(space, x, straight, x);
    CHECK(std::abs(x[3]) < before);
    before = std::abs(x[3]);
  }
  CHECK(before < 0.02);
  CHECK_FALSE(model->admits(Configuration{0, 0, 0, 1.0}));
  CHECK(model->admits(Configuration{0, 0, 3.1, -3.1}));
}

TEST_CASE("controls out of bounds are clamped where asked and refused in a trajectory", "[motion]") {
  for (const auto& kind : motion_kinds()) {
    CAPTURE(kind.component->name);
    const auto model = model_of(kind);
    const Space space = space_of(*model);
    Configuration u;
    for (const auto& control : model->controls()) u.push_back(control.hi + 1.0);
    CHECK_FALSE(model->allows(u));
    Trajectory trajectory{Configurations(u.size()), {3}, model->dt()};
    trajectory.controls.push(u);
    const Configuration start(space.dimension(), 0.0);
    CHECK_THROWS_WITH(replay(*model, space, start, trajectory),
                      Contains("control 1") && Contains(kind.component->name));
    model->clamp(u);
    CHECK(model->allows(u));
    for (std::size_t j = 0; j < u.size(); ++j) CHECK(u[j] == model->controls()[j].hi);
    trajectory.controls = Configurations(u.size());
    trajectory.controls.push(u);
    const auto states = replay(*model, space, start, trajectory);
    REQUIRE(states.size() == 4);
    CHECK(trajectory.duration() == Approx(3 * model->dt()));
    const auto end = driven(*model, space, start, u, 3);
    CHECK(Configuration(states[3].begin(), states[3].end()) == end);
  }
}

TEST_CASE("a model is for robots with its coordinates, and for speeds in order", "[motion]") {
  const auto trailer = model_of(*find_motion("car_with_trailer"));
  CHECK_THROWS_WITH(state_space(Space::se2({0, 1}, {0, 1}), *trailer),
                    Contains("car_with_trailer") && Contains("4 coordinates") && Contains("x, y, theta"));
  CHECK_THROWS_WITH(model_of(*find_motion("unicycle1"), {{"min_speed", 0.7}}),
                    Contains("unicycle1") && Contains("min_speed (0.7)") && Contains("max_speed (0.5)"));
  const auto second = model_of(*find_motion("unicycle2"));
  const Space states = state_space(Space::se2({0, 1}, {0, 1}), *second);
  CHECK(states.name() == "SE(2) x R^2");
  CHECK(states.axes()[3].name == "v");
  CHECK(states.axes()[4].hi == 0.5);
}
