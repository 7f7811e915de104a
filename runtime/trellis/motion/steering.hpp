// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include <trellis/motion/motion_model.hpp>

namespace trellis {

/// Computes controls that drive a model along the shortest curve of its least turning radius from one configuration to
/// another: Dubins' curve for a model that only drives forwards, Reeds and Shepp's for one that also drives backwards.
/// The curve is exact for a car. Explicit Euler steps follow it to within half a step's turn, so the caller checks the
/// end state. Of a team each robot drives along a curve of its own, and waits at its end for the others.
/// \return no trajectory for models without such curves (velocities in the state, a trailer), where a piece is too
/// short
///     for the least speed, and where a robot of a team cannot wait.
std::optional<Trajectory> steer(const MotionModel& model, View from, View to);

/// As `steer`, at one speed. The speed determines the turning radius of a model whose control is an angular speed.
/// `share` in [0, 1] interpolates from the lowest speed (a tenth of the highest speed if the model may be slower) to
/// the highest. Each piece takes the nearest whole number of steps, so the trajectory ends only near `to`.
std::optional<Trajectory> steer_at(const MotionModel& model, View from, View to, double share);

/// The work of a call of `steer` or `steer_at`: CPU time in units of 0.07 us, as costs count it.
double steering_work(const MotionModel& model);

}  // namespace trellis
