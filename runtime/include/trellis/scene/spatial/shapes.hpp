// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <variant>

#include <trellis/scene/spatial/mesh.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

class PointCloud;

/// A closed ball about the origin of its frame, in metres; radius 0 is a point (allowed for robots only).
struct Sphere {
  double radius = 0.0;
  friend bool operator==(const Sphere&, const Sphere&) = default;
};

/// A closed box centred at the origin of its frame, with these lengths along x, y and z in metres.
struct Cuboid {
  Vec3 size;
  friend bool operator==(const Cuboid&, const Cuboid&) = default;
};

/// A closed cylinder centred at the origin of its frame, with its axis along z, in metres.
struct Cylinder {
  double radius = 0.0;
  double length = 0.0;
  friend bool operator==(const Cylinder&, const Cylinder&) = default;
};

/// All points within `radius` metres of a segment of this length in metres along z, centred at the origin of its frame.
struct Capsule {
  double radius = 0.0;
  double length = 0.0;  ///< of the segment, so the whole is 2 radius longer
  friend bool operator==(const Capsule&, const Capsule&) = default;
};

/// The shapes of obstacles and robot parts in space. A mesh is shared: copies of a scene have one. So is a cloud of
/// points, which only obstacles may be.
using Shape3 =
    std::variant<Sphere, Cuboid, Cylinder, Capsule, std::shared_ptr<const Mesh>, std::shared_ptr<const PointCloud>>;

/// A shape at a place.
struct Solid {
  Shape3 shape;
  Pose3 pose;  ///< of the shape's frame
};

/// Validates numbers: finite, within `most_distant`, extents and radii greater than 0, a pose with a unit quaternion.
/// \param solid  in metres; a mesh or a cloud of points that is nullptr fails
/// \param what  the solid's name in messages
/// \param point  whether a sphere may have radius 0
/// \throws Error that names the solid
void check_solid(const Solid& solid, const std::string& what, bool point = false);
/// Checks that the sizes of a solid are above the precision of coordinates.
/// \param solid  valid (check_solid)
/// \param farthest  in metres: the greatest absolute coordinate that occurs with the solid
/// \param what  the solid's name in messages
/// \throws Error that starts with `what` for a solid below the precision of coordinates of up to `farthest` metres
///     (check_size); a mesh may be flat
void check_precision(const Solid& solid, double farthest, const std::string& what);
/// Returns the greatest absolute coordinate of a box.
/// \param box  metres
double farthest_of(const Box3& box);

/// Returns the smallest box along the axes that contains the solid.
/// \param solid  valid (check_solid)
Box3 bounding_box(const Solid& solid);
/// Returns the largest distance of a point of the solid from the origin.
/// \param solid  valid (check_solid)
/// \return metres
double farthest_from_origin(const Solid& solid);
/// Checks that the solid may be a part of a robot.
/// \param solid  of any shape
/// \param what  the solid's name in messages
/// \throws Error that starts with `what` where the solid is a cloud of points
void check_no_cloud(const Solid& solid, const std::string& what);
/// Returns the distance of p from the solid in metres, 0 inside; of a mesh that is not closed the distance from its
/// surface. Takes time proportional to the number of a mesh's triangles.
/// \param solid  valid (check_solid)
/// \param p  metres, in the frame that the solid's pose is given in
double distance_to(const Solid& solid, const Vec3& p);
/// Returns the solid scaled by `factor` > 0 about the origin.
/// \param solid  valid (check_solid)
/// \param factor  finite; sizes, and the position of the pose, are multiplied by it
/// \throws Error where vertices or points would leave `most_distant`
Solid scaled(const Solid& solid, double factor);

}  // namespace trellis
