// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/scene/planar/robot.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/robot.hpp>

namespace trellis {

/// Returns the bodies of a robot of space as robots of links and joints, one for each member of a team: the link "body"
/// on a floating joint, or on a translation where it does not rotate. A configuration has the same coordinates. Balls
/// cover the solids: a little space beside them counts as the robot's (SphereModel::excess).
/// \param robot  no point
/// \throws Error for a point
std::vector<SphereModel> linked(const Robot3& robot);

/// Returns a robot of the plane as robots of space that stand on the plane z = 0, one for each member of a team: its
/// shapes are prisms and cylinders of a height. A configuration has the same coordinates. Balls cover the shapes.
/// \param robot   its bodies may touch each other where they do in the plane
/// \param height  metres, greater than 0
/// \throws Error for a point, another height, a body whose angle is that of the world (Body::absolute), and where the
///     coordinates do not follow the order of the bodies
std::vector<SphereModel> upright(const Robot& robot, double height);

}  // namespace trellis
