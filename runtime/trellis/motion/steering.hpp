// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include <trellis/motion/motion_model.hpp>

namespace trellis {

/// Controls that drive a model along the shortest curve of its least turning radius from one configuration to another:
/// Dubins' where it only goes forwards, Reeds and Shepp's where it can go backwards. The curve is exact for a car;
/// steps of explicit Euler follow it to within half a step's turn, so where they end is for the caller to look at. None
/// for models without such curves (velocities in the state, a trailer), and where a piece is too short for the least
/// speed.
std::optional<Trajectory> steer(const MotionModel& model, View from, View to);

/// The same at one speed, which tells how narrow its turns are where the model turns by an angular speed: `share` of
/// the way from the slowest (a tenth of the fastest where it may be slower) to the fastest, in [0, 1]. Each piece takes
/// the whole number of steps that is nearest, so it ends near to `to` only.
std::optional<Trajectory> steer_at(const MotionModel& model, View from, View to, double share);

}  // namespace trellis
