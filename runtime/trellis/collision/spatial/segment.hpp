// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/shapes.hpp>

namespace trellis {

/// The motion of a point in space: all points from + t along, t in [0, 1].
struct Segment3 {
  Vec3 from;
  Vec3 along;

  [[nodiscard]] Vec3 at(double t) const { return from + t * along; }
};

/// Returns a segment in the frame of a pose.
Segment3 seen_from(const Pose3& inverse, const Segment3& segment);

/// Decides whether a segment comes within `reach` metres of a closed shape in the shape's frame. No place between two
/// configurations is left out.
/// \param shape  no mesh, and no cloud
/// \return a parameter in [0, 1] at which the segment is in contact; none where it is free
std::optional<double> contact(const Segment3& segment, const Shape3& shape, double reach);

/// Decides whether a segment comes within `reach` metres of a mesh's surface, in the mesh's frame.
std::optional<double> contact(const Segment3& segment, const MeshDistance& mesh, double reach);

/// Decides whether a segment comes within `reach` metres of the balls of a cloud, in the cloud's frame.
std::optional<double> contact(const Segment3& segment, const PointCloud& cloud, double reach);

/// Decides whether a segment comes within `reach` metres of a triangle.
std::optional<double> contact(const Segment3& segment, const std::array<Vec3, 3>& corners, double reach);

}  // namespace trellis
