// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/base/configurations.hpp>
#include <trellis/scene/planar/robot.hpp>
#include <trellis/scene/spatial/robot.hpp>

namespace trellis {

/// A robot about another reference point.
template <class R>
struct Recentred {
  R robot;
  Vec3 offset;  ///< the new reference point in the frame of the given robot; z = 0 in the plane
};

/// Returns the robot about the centre of the largest disc, or ball, inside of it; of several the one found first, from
/// the middle of its bounding box. Guides that plan for this disc leave out gaps that are too narrow, and turns about
/// this point sweep less space.
/// \throws Error for a robot of several bodies, or one that is fixed to its base
Recentred<Robot> recentred(const Robot& robot);
Recentred<Robot3> recentred(const Robot3& robot);

/// Returns the configuration of the recentred robot that puts its body where the given robot has it at q.
/// \param q  a configuration of a robot of `dimension()` numbers
Configuration recentred_configuration(const Robot& robot, Vec3 offset, View q);
Configuration recentred_configuration(const Robot3& robot, Vec3 offset, View q);

}  // namespace trellis
