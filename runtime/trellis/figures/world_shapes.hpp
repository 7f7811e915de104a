// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/draw/planar.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

/// Converts a shape of a world for pictures.
draw::WorldShape drawn(const Shape& shape);
/// Returns the robot's parts at a configuration.
std::vector<draw::WorldShape> placed(const Robot& robot, View q);
/// The same for each robot of a team.
std::vector<std::vector<draw::WorldShape>> placed_team(const Robot& team, View q);
/// Adds the robot, or each robot of a team, at start and goals.
void add_ends(const Problem& problem, draw::PlanarFigure& figure);

}  // namespace trellis
