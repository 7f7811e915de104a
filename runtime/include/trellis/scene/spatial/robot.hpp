// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/scene/spatial/shapes.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// A rigid body that moves freely in space: its solids are given in the frame of its reference point. A configuration
/// is the reference point's position x, y, z and, where the body rotates, the quaternion x, y, z, w of its orientation.
/// A team of bodies is a robot too: its configuration is theirs, one after the other.
class Robot3 {
 public:
  /// A robot of a team.
  struct Member {
    std::shared_ptr<const Robot3> robot;  ///< never a team
    std::size_t column = 0;               ///< its first coordinate in a configuration of the team
    std::size_t number = 0;               ///< in messages and scripts, from 1 on

    /// Returns its part of a configuration of the team.
    /// \param q  a configuration of the team
    /// \return valid as long as `q`
    [[nodiscard]] View own(View q) const { return q.subspan(column, robot->dimension()); }
  };

  /// A point.
  Robot3() : Robot3("point", {Solid{Sphere{0.0}, {}}}, false) {}
  /// \param name  in messages, as "body"
  /// \param solids  in the frame of the reference point; they may overlap
  /// \param rotates  whether configurations have an orientation: SE(3), else R^3
  /// \throws Error without solids, or where one is malformed
  Robot3(std::string name, std::vector<Solid> solids, bool rotates = true);

  static Robot3 point() { return {}; }

  /// Returns a team: bodies in one world that must not touch each other. A team among them joins with its members.
  /// \param robots  in the order of their coordinates and numbers
  /// \throws Error for less than two robots, more than `most_members`, or a point, which nothing can touch
  static Robot3 team(const std::vector<Robot3>& robots);
  /// The members that remain of a team, with the coordinates that they have there and their numbers; a robot alone
  /// where one remains whose coordinates come first.
  /// \param members  in the order of their columns
  static Robot3 team_of(std::vector<Member> members);
  static constexpr std::size_t most_members = 64;
  /// Returns the team in which the two robots of each of some pairs pass through each other, and so in all that is made
  /// of it.
  /// \param pairs  of numbers (Member::number); those of robots that are not in the team are ignored
  [[nodiscard]] Robot3 uncoupled(std::vector<std::pair<std::size_t, std::size_t>> pairs) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// The robots of a team; none of a robot alone.
  [[nodiscard]] const std::vector<Member>& members() const { return members_; }
  /// The pairs of robots of a team that pass through each other, by their numbers.
  [[nodiscard]] const std::vector<std::pair<std::size_t, std::size_t>>& passing() const { return passing_; }
  /// Whether two robots of the team must not touch each other.
  /// \param one  a number (Member::number)
  /// \param other  a number (Member::number)
  [[nodiscard]] bool are_coupled(std::size_t one, std::size_t other) const;
  /// Its solids; of a team those of all its robots, each in the frame of its own.
  [[nodiscard]] const std::vector<Solid>& solids() const { return solids_; }
  /// Whether it rotates; of a team whether a robot does.
  [[nodiscard]] bool rotates() const { return rotates_; }
  [[nodiscard]] bool is_point() const { return bounding_radius_ == 0.0; }
  /// Returns the number of coordinates of a configuration: 3 or 7, of a team their sum.
  [[nodiscard]] std::size_t dimension() const { return dimension_; }
  /// Returns the robot scaled by `factor` > 0 about its reference point; of a team each robot about its own.
  /// \param factor  finite, greater than 0
  /// \throws Error for a factor that is not greater than 0, and where solids become too large or too small for the
  ///     precision of coordinates
  [[nodiscard]] Robot3 scaled(double factor) const;
  /// Returns the largest distance of the robot's points from its reference point; of a team the largest of its robots'.
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// Returns the radius of the largest ball about the reference point inside one of the robot's solids; 0 for a point,
  /// a team, and where the reference point lies outside.
  [[nodiscard]] double inscribed_radius() const { return inscribed_radius_; }

  /// Returns the pose of the body at q. Requires a robot alone.
  /// \param q  `dimension` numbers, as a and b below; fewer are undefined behaviour
  /// \throws Fault for a team
  [[nodiscard]] Pose3 pose(View q) const;
  /// Returns a bound, in metres, on how far the robot's points move on the shortest motion from a to b: translation
  /// plus radius times turn; of a team the largest of its robots'.
  /// \param a, b  the ends of the motion
  [[nodiscard]] double displacement_bound(View a, View b) const;

 private:
  [[nodiscard]] bool same_shape(const Robot3& other) const;

  std::string name_;
  std::vector<Solid> solids_;
  bool rotates_ = false;
  std::size_t dimension_ = 0;
  double bounding_radius_ = 0.0;
  double inscribed_radius_ = 0.0;
  std::vector<Member> members_;
  std::vector<std::pair<std::size_t, std::size_t>> passing_;
};

}  // namespace trellis
