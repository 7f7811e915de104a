// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/motion/steering.hpp>

#include <array>
#include <cmath>

#include <trellis/motion/curves.hpp>

namespace trellis {

std::optional<Trajectory> steer(const MotionModel& model, View from, View to) {
  if (model.dimension() != 3 || model.controls().size() != 2) return std::nullopt;
  const ControlAxis& speed = model.controls()[0];
  const ControlAxis& turn = model.controls()[1];
  // The curvature at the greatest speed, turning as hard as can be.
  const std::array<double, 2> hardest = {speed.hi, turn.hi};
  std::array<double, 3> rate{};
  model.derivative(from, hardest, rate);
  const double radius = speed.hi / rate[2];
  if (!(radius > 0.0) || !std::isfinite(radius)) return std::nullopt;
  const CurvePose a{from[0], from[1], from[2]};
  const CurvePose b{to[0], to[1], to[2]};
  const Curve curve = speed.lo < 0.0 ? reeds_shepp(a, b, radius) : dubins(a, b, radius);

  Trajectory trajectory{Configurations(2), {}, model.dt()};
  for (const CurvePiece& piece : curve.pieces) {
    const double fastest = piece.length < 0.0 ? -speed.lo : speed.hi;
    // As few whole steps as can be, at the speed that makes them come out.
    const double steps = std::ceil(std::abs(piece.length) / (fastest * model.dt()) - 1e-9);
    if (steps < 1.0) continue;
    const double v = piece.length / (steps * model.dt());
    // A steering angle fixes the curvature at any speed; an angular speed goes with the speed.
    const double full = turn.name == "steering" ? turn.hi : turn.hi * std::abs(v) / speed.hi;
    const double sideways = turn.name == "steering" ? 1.0 : std::copysign(1.0, v);
    const std::array<double, 2> control = {v, piece.turn * sideways * full};
    if (!model.allows(control)) return std::nullopt;
    trajectory.controls.push(control);
    trajectory.steps.push_back(static_cast<std::uint32_t>(steps));
  }
  return trajectory;
}

}  // namespace trellis
