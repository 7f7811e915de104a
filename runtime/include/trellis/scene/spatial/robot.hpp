// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/scene/spatial/shapes.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// A rigid body that moves freely in space: its solids are given in the frame of its reference point. A configuration
/// is the reference point's position x, y, z and, where the body rotates, the quaternion x, y, z, w of its orientation.
class Robot3 {
 public:
  /// A point.
  Robot3() : Robot3("point", {Solid{Sphere{0.0}, {}}}, false) {}
  /// \param rotates  whether configurations have an orientation: SE(3), else R^3
  /// \throws Error without solids, or where one is malformed
  Robot3(std::string name, std::vector<Solid> solids, bool rotates = true);

  static Robot3 point() { return {}; }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<Solid>& solids() const { return solids_; }
  [[nodiscard]] bool rotates() const { return rotates_; }
  [[nodiscard]] bool is_point() const { return bounding_radius_ == 0.0; }
  /// Returns the number of coordinates of a configuration: 3 or 7.
  [[nodiscard]] std::size_t dimension() const { return rotates_ ? 7 : 3; }
  /// Returns the robot scaled by `factor` > 0 about its reference point.
  [[nodiscard]] Robot3 scaled(double factor) const;
  /// Returns the largest distance of the robot's points from its reference point.
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// Returns the radius of the largest ball about the reference point inside one of the robot's solids; 0 for a point,
  /// and where the reference point lies outside.
  [[nodiscard]] double inscribed_radius() const { return inscribed_radius_; }

  /// Returns the pose of the body at q.
  /// \param q  `dimension` numbers, as a and b below; fewer are undefined behaviour
  [[nodiscard]] Pose3 pose(View q) const;
  /// Returns a bound, in metres, on how far the robot's points move on the shortest motion from a to b: translation
  /// plus radius times turn.
  [[nodiscard]] double displacement_bound(View a, View b) const;

 private:
  std::string name_;
  std::vector<Solid> solids_;
  bool rotates_ = false;
  double bounding_radius_ = 0.0;
  double inscribed_radius_ = 0.0;
};

}  // namespace trellis
