// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/scene/planar/shapes.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// One rigid body of a robot. The frame's origin is the joint; the body's angle rotates the frame.
struct Body {
  std::vector<ConvexShape> parts;  ///< in the body's frame
  int parent = -1;                 ///< index of an earlier body, -1: the robot's reference point
  Vec2 joint;                      ///< the body's origin, in the parent's frame
  int angle_axis = -1;             ///< the axis that turns it; -1: it has its parent's angle
  bool absolute = false;           ///< the axis gives the angle in the world, not relative to the parent
  std::string name = {};           ///< its name in messages: "link 2"; "": "body 2"
  /// Of a body without a parent in a team: the first of the two axes that move its reference point; -1: that of the
  /// robot moves it.
  int position_axis = -1;
};

/// The parameters of `Robot::arm`. The joint of link i + 1 is at the far end of link i.
struct Arm {
  std::vector<double> links;   ///< lengths, from the base on
  std::vector<double> widths;  ///< of each link
  Vec2 base = {};              ///< position of the first joint
  /// Of each joint the least and the greatest angle, relative to the previous link, more than a turn apart or less;
  /// none: its angle wraps.
  std::vector<std::optional<std::pair<double, double>>> limits = {};
  bool self_collision = true;  ///< links that are not neighbours must not touch
};

/// A planar robot: a tree of rigid bodies moved by the configuration. A point, a disc and a polygon are one body. A
/// team of robots is a robot too: its bodies are theirs, and its configuration is theirs, one after the other.
class Robot {
 public:
  /// A robot of a team.
  struct Member {
    std::shared_ptr<const Robot> robot;  ///< never a team
    std::size_t axis = 0;                ///< of the team, the first that moves it
    std::size_t body = 0;                ///< of the team, its first body
    std::size_t number = 0;              ///< in messages and scripts, from 1 on
  };

  Robot() = default;
  /// \param name  in messages, as "disc"
  /// \param bodies  each parent before its children; at least one has a part
  /// \param translates  axes 0 and 1 move the reference point; otherwise it is fixed at `base`
  /// \param base  metres; not used where the robot translates
  /// \throws Error on an empty robot, a parent that does not come earlier, or a malformed part.
  Robot(std::string name, std::vector<Body> bodies, bool translates = true, Vec2 base = {});

  /// Returns a point that moves along x and y.
  static Robot point();
  /// Returns a disc that moves along x and y; its reference point is its centre.
  /// \param radius  in metres, greater than 0
  /// \throws Error for another radius
  static Robot disc(double radius);
  /// Returns a robot of one rigid body; axis 2 turns it where `rotates`. Splits non-convex polygons into convex parts.
  /// \param shapes  about the reference point, in metres; they may overlap
  /// \param rotates  whether axis 2 is the angle of the body; else it keeps the angle 0
  /// \throws Error without shapes, for too many, and for a malformed one
  static Robot rigid(const std::vector<Shape>& shapes, bool rotates = true);
  /// Returns a planar arm of rectangular links with revolute joints; the first joint's angle refers to the world.
  /// \param arm  metres and radians; as many widths as links
  /// \throws Error without links, for too many, for a length or a width that is not greater than 0, and for limits as
  ///     `limited`
  static Robot arm(const Arm& arm);

  /// Returns a team: robots in one world that must not touch each other. A team among them joins with its members.
  /// \param robots  in the order of their coordinates and numbers
  /// \throws Error for less than two robots, more than `most_members`, or a point, which nothing can touch
  static Robot team(const std::vector<Robot>& robots);
  /// The members that remain of a team, with the axes that they have there and their numbers; a robot alone where one
  /// remains that axis 0 begins.
  /// \param members  in the order of their axes; `body` of each is assigned here
  static Robot team_of(std::vector<Member> members);
  static constexpr std::size_t most_members = 64;

  /// Returns the robot with these self-collision pairs, the lower index first; bodies of no pair may overlap.
  /// \param pairs  indices of bodies, in any order; replace the earlier pairs
  /// \throws Error for indices out of range.
  [[nodiscard]] Robot apart(std::vector<std::pair<std::size_t, std::size_t>> pairs) const;
  /// Returns the robot with joint limits on the axes that turn bodies, in their order; none or an empty list: they
  /// wrap. An axis with limits does not wrap: angles a turn apart are different configurations, and the motion between
  /// them is a turn.
  /// \param limits  radians, least and greatest angle; replace the earlier ones; axes after the last entry wrap
  /// \throws Error for more entries than axes that turn bodies, and for bounds that are not finite and ascending, or
  ///     farther than `most_turns` from 0
  [[nodiscard]] Robot limited(std::vector<std::optional<std::pair<double, double>>> limits) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
  [[nodiscard]] bool translates() const { return translates_; }
  [[nodiscard]] Vec2 base() const { return base_; }
  [[nodiscard]] const std::vector<std::pair<std::size_t, std::size_t>>& pairs() const { return pairs_; }
  [[nodiscard]] const std::vector<std::optional<std::pair<double, double>>>& limits() const { return limits_; }
  /// Returns "link 2", or "body 2" where it has no name.
  /// \param body  index into bodies()
  /// \throws std::out_of_range for another index
  [[nodiscard]] std::string body_name(std::size_t body) const;
  /// The robots of a team; none of a robot alone.
  [[nodiscard]] const std::vector<Member>& members() const { return members_; }
  /// Returns which member of a team a body belongs to, from 0 on. Requires a team.
  /// \param body  index into bodies()
  [[nodiscard]] std::size_t member_of(std::size_t body) const;
  [[nodiscard]] bool is_point() const;
  /// Returns the number of axes that a configuration of the robot has.
  [[nodiscard]] std::size_t dimension() const { return dimension_; }

  /// Returns the robot scaled by `factor` > 0 about its reference point, shapes and joints alike.
  /// \param factor  finite, greater than 0
  /// \throws Error for another factor
  [[nodiscard]] Robot scaled(double factor) const;
  /// Returns the robot with less of its shape, whose reference points stay: scaled where it translates, else thinned; a
  /// team of such robots.
  /// \param factor  in (0, 1]
  /// \throws Error for a factor that is not greater than 0
  [[nodiscard]] Robot shrunken(double factor) const;
  /// Returns the robot with each part of each body scaled by `factor` > 0 across the body's axis, and discs about their
  /// centres. Joints do not move, so the kinematics are the same. The axis leads from the body's joint to the farthest
  /// joint that it carries, or to the middle of its own parts. For a factor of at most 1 every part lies within that of
  /// the original robot at the same configuration. Radii and displacement bounds stay those of the original robot, so
  /// that a checker validates a motion at the same configurations; only `inscribed_radius` is 0.
  /// \param factor  finite, greater than 0
  /// \throws Error for another factor
  [[nodiscard]] Robot thinned(double factor) const;
  /// Returns a bound on the distance of the robot's points from its reference point at all configurations.
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// Returns the radius of the largest disc about the reference point inside the robot (0 for a point, or where the
  /// reference point lies outside).
  [[nodiscard]] double inscribed_radius() const { return inscribed_radius_; }

  /// Computes the pose of each body at q; `out` has bodies().size() entries.
  /// \param q  at least `dimension` numbers, of which the first are used; fewer are undefined behaviour
  /// \param out  receives the poses, in the order of bodies()
  void place(View q, std::span<Pose2> out) const;
  /// Returns a bound, in metres, on the displacement of all points of the robot on the straight motion from a to b in
  /// the space: translation plus radius times turn, summed along the chain.
  /// \param space  of the robot's configurations; coordinates beyond the robot's own move nothing
  /// \param a, b  configurations of `space`
  [[nodiscard]] double displacement_bound(const Space& space, View a, View b) const;
  /// Returns a bound, in metres, on the displacement of the points of one body on a straight motion, seen from the
  /// frame of a body that carries it.
  /// \param body  index into bodies()
  /// \param ancestor  the carrying body; -1: a frame that moves with the reference point and does not turn, in a team
  ///     the world
  /// \param difference  Space::difference of the ends
  [[nodiscard]] double displacement_of(std::size_t body, int ancestor, View difference) const;

 private:
  std::string name_;
  std::vector<Body> bodies_;
  bool translates_ = true;
  Vec2 base_;
  std::size_t dimension_ = 0;
  double bounding_radius_ = 0.0;
  double inscribed_radius_ = 0.0;
  std::vector<double> body_radius_;  ///< of each body's parts about its own origin
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  std::vector<std::optional<std::pair<double, double>>> limits_;
  std::vector<Member> members_;
};

}  // namespace trellis
