// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/draw/surface.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>

namespace trellis {

draw::Point3 drawn(const Vec3& p);

/// Returns the surface of a solid. Curved ones are approximated from inside.
/// \param sides  of a turn, a multiple of 4
draw::Surface surface_of(const Solid& solid, unsigned sides = 24);

/// Returns the surface of a robot alone about its reference point; without triangles for a point.
draw::Surface surface_of(const Robot3& robot);

/// Returns the surface at a pose.
draw::Surface moved(const draw::Surface& surface, const Pose3& pose);

/// The surfaces of a world's obstacles, for pictures.
struct WorldSurfaces {
  std::vector<draw::Surface> obstacles;  ///< in the world's order
  std::size_t triangles = 0;             ///< before simplification
  double cell = 0.0;                     ///< metres: vertices in one cube of this size were merged; 0: none
  std::size_t points = 0;                ///< of clouds
  std::size_t shown_points = 0;          ///< the drawn ones among them

  /// A sentence about the simplification, "" where there is none.
  [[nodiscard]] std::string note() const;
};

/// Returns the surfaces with at most about `most` triangles: merges vertices of meshes in cubes, which grow until that
/// suffices. Of primitives, curved ones have fewer sides where they are too many.
WorldSurfaces surfaces_of(const World3& world, std::size_t most);

/// Returns the robot's solids at a configuration, each with at most about `most` triangles.
std::vector<draw::Surface> placed(const Robot3& robot, View q, std::size_t most = 600);

/// Returns a body's shapes, in its frame; of a robot that is thinned or reduced, its balls.
draw::Surface surface_of(const SphereModel& model, std::size_t body);
/// Returns the bodies of a robot of links and joints at a configuration.
std::vector<draw::Surface> placed(const SphereModel& model, View q);
/// The same for the robot of any scene in space.
std::vector<draw::Surface> placed(const Scene& scene, View q, std::size_t most = 600);

/// Returns the coordinates of a level's robot: how far other robots of a team are along their paths comes before them.
View own_coordinates(const LevelRecord& record, View q);
/// Whether the configurations of a level have positions in space: of reference points, or of the tip of a robot of
/// links and joints.
bool has_positions(const LevelRecord& record);
/// Returns the position of a configuration of such a level.
draw::Point3 position_in(const LevelRecord& record, View q);
/// The same of each robot of a team; of a robot alone the one position.
std::vector<draw::Point3> positions_in(const LevelRecord& record, View q);

}  // namespace trellis
