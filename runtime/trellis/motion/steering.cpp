// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/motion/steering.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <trellis/motion/curves.hpp>

namespace trellis {

namespace {

/// The controls of a model whose first control is the speed and whose second control steers; empty for other models.
struct Wheels {
  ControlAxis speed;
  ControlAxis turn;

  static std::optional<Wheels> of(const MotionModel& model) {
    if (model.dimension() != 3 || model.controls().size() != 2) return std::nullopt;
    return Wheels{model.controls()[0], model.controls()[1]};
  }
  /// Returns the least turning radius in metres at a speed > 0.
  [[nodiscard]] std::optional<double> radius(const MotionModel& model, View from, double at) const {
    const std::array<double, 2> hardest = {at, turn.hi};
    std::array<double, 3> rate{};
    model.derivative(from, hardest, rate);
    const double least = at / rate[2];
    if (!(least > 0.0) || !std::isfinite(least)) return std::nullopt;
    return least;
  }
  [[nodiscard]] Curve curve(View from, View to, double radius) const {
    const CurvePose a{from[0], from[1], from[2]};
    const CurvePose b{to[0], to[1], to[2]};
    return speed.lo < 0.0 ? reeds_shepp(a, b, radius) : dubins(a, b, radius);
  }
  /// A steering angle fixes the curvature at any speed; an angular speed must be proportional to the speed.
  [[nodiscard]] std::array<double, 2> control(double v, int side, double fastest) const {
    if (turn.name == "steering") return {v, side * turn.hi};
    // The rounded quotient must not exceed the bound.
    return {v, side * std::copysign(std::min(turn.hi, turn.hi * std::abs(v) / fastest), v)};
  }
};

}  // namespace

std::optional<Trajectory> steer(const MotionModel& model, View from, View to) {
  const auto wheels = Wheels::of(model);
  const auto radius = wheels ? wheels->radius(model, from, wheels->speed.hi) : std::nullopt;
  if (!radius) return std::nullopt;
  Trajectory trajectory{Configurations(2), {}, model.dt()};
  for (const CurvePiece& piece : wheels->curve(from, to, *radius).pieces) {
    const double fastest = piece.length < 0.0 ? -wheels->speed.lo : wheels->speed.hi;
    // Take the fewest whole steps, at the speed at which they add up to the piece's length.
    const double steps = std::ceil(std::abs(piece.length) / (fastest * model.dt()) - 1e-9);
    if (steps < 1.0) continue;
    const auto control = wheels->control(piece.length / (steps * model.dt()), piece.turn, wheels->speed.hi);
    if (!model.allows(control)) return std::nullopt;
    trajectory.controls.push(control);
    trajectory.steps.push_back(static_cast<std::uint32_t>(steps));
  }
  return trajectory;
}

std::optional<Trajectory> steer_at(const MotionModel& model, View from, View to, double share) {
  const auto wheels = Wheels::of(model);
  if (!wheels) return std::nullopt;
  // A model that may stop could turn on the spot at almost zero speed: bound the speed from below.
  const double slowest = std::max(wheels->speed.lo, 0.1 * wheels->speed.hi);
  const double pace = slowest + share * (wheels->speed.hi - slowest);
  const auto radius = wheels->radius(model, from, pace);
  if (!radius) return std::nullopt;
  Trajectory trajectory{Configurations(2), {}, model.dt()};
  for (const CurvePiece& piece : wheels->curve(from, to, *radius).pieces) {
    const double v = piece.length < 0.0 ? -std::min(pace, -wheels->speed.lo) : pace;
    const double steps = std::round(std::abs(piece.length / v) / model.dt());
    if (steps < 1.0) continue;
    trajectory.controls.push(wheels->control(v, piece.turn, pace));
    trajectory.steps.push_back(static_cast<std::uint32_t>(steps));
  }
  return trajectory;
}

}  // namespace trellis
