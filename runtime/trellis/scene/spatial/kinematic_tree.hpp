// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/error.hpp>
#include <trellis/scene/spatial/shapes.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// A rigid part of a robot.
struct Link {
  std::string name;
  std::vector<Solid> solids;  ///< of its collision geometry, in its frame
};

/// A connection of two links, as URDF defines it.
struct Joint {
  enum class Kind : std::uint8_t {
    fixed,
    revolute,       ///< turns about the axis within limits
    continuous,     ///< turns about the axis without limits
    prismatic,      ///< slides along the axis within limits
    planar,         ///< three coordinates: slides along two directions across the axis, then turns about it
    floating,       ///< seven coordinates: a position and a quaternion x, y, z, w
    translation_2,  ///< two coordinates: slides along two directions across the axis
    translation_3   ///< three coordinates: a position
  };
  /// The coordinate follows that of another joint: multiplier * value + offset.
  struct Mimic {
    std::size_t joint = 0;
    double multiplier = 1.0;
    double offset = 0.0;
  };

  std::string name;
  Kind kind = Kind::fixed;
  std::size_t parent = 0;       ///< a link
  std::size_t child = 0;        ///< a link
  Pose3 origin = {};            ///< of the joint's frame in the parent's, where the joint is at 0
  Vec3 axis = {1.0, 0.0, 0.0};  ///< of norm 1, in the joint's frame
  double lo = 0.0;              ///< lower limit, radians or metres
  double hi = 0.0;              ///< upper limit
  double velocity = 0.0;        ///< greatest speed, radians or metres a second; 0: not stated
  std::optional<Mimic> mimic = {};
  bool locked = false;  ///< it stays where it is: its file does not say how far it moves

  /// The number of its coordinates: 0 where it is fixed or follows another.
  [[nodiscard]] std::size_t width() const;
  /// Whether it is of the kinds that carry a whole robot, whose limits are the bounds of the world: planar, floating
  /// and translations. Such a joint is the root of a robot of a team.
  [[nodiscard]] bool carries_robot() const;
  /// Whether it has limits: a revolute or a prismatic joint.
  [[nodiscard]] bool limited() const;
  /// Whether a planner can move it: it has coordinates, is not locked, and its limits are not one value.
  [[nodiscard]] bool plans() const;
};

/// Two directions across an axis, such that the three are right-handed; x and y for the axis z. A planar joint slides
/// along them.
/// \param axis  of norm 1
std::pair<Vec3, Vec3> across(const Vec3& axis);

/// Whether joints of a kind carry a whole robot; see Joint::carries_robot.
bool carries_robot(Joint::Kind kind);

/// The name of a kind, in URDF where it has one: "revolute".
const char* to_string(Joint::Kind kind);

/// A fault of a tree's links or joints, and which one has it, so that readers name its line.
class TreeError : public Error {
 public:
  enum class Part : std::uint8_t { link, joint };
  TreeError(Part which, std::size_t index, const std::string& message) : Error(message), part(which), number(index) {}
  Part part;
  std::size_t number;  ///< among those that KinematicTree was given
};

/// The links and joints of a robot: a tree whose root is the base. Immutable.
class KinematicTree {
 public:
  static constexpr std::size_t most_links = 1000;
  static constexpr double most_multiplier = 1e3;  ///< of a joint that follows another
  static constexpr double most_offset = 1e5;      ///< of a joint that follows another

  /// Checks that the joints make one tree of all links, and orders them from the base. A joint that follows a follower
  /// follows the leader of both. A continuous joint with a follower that is elsewhere after a whole turn (a slide, or
  /// a multiplier that is no integer) becomes a revolute one with limits of -pi and pi: its two ends are no one
  /// configuration.
  /// \throws TreeError that names the link or the joint: two parents, a cycle, several bases, a joint that follows
  ///     itself, limits that are not finite or in order, an axis that is not of norm 1
  KinematicTree(std::string name, std::vector<Link> links, std::vector<Joint> joints);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<Link>& links() const { return links_; }
  /// In an order in which each joint comes after that of its parent link.
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }
  [[nodiscard]] std::size_t base() const { return base_; }
  /// The joint whose child a link is; none for the base.
  [[nodiscard]] std::optional<std::size_t> joint_of(std::size_t link) const;
  /// Returns the robot with a joint, named "base", under its base: of the link "ground", which is the new base.
  /// \param kind  planar, floating or a translation; the axis across which it slides is z
  [[nodiscard]] KinematicTree on_ground(Joint::Kind kind = Joint::Kind::planar) const;
  [[nodiscard]] std::optional<std::size_t> find_link(const std::string& name) const;
  [[nodiscard]] std::optional<std::size_t> find_joint(const std::string& name) const;
  /// Whether fixed joints connect two links.
  [[nodiscard]] bool fixed_together(std::size_t a, std::size_t b) const { return body_of_[a] == body_of_[b]; }

 private:
  void order();
  void resolve_chains();
  void open_seams();
  /// Returns a joint on a cycle.
  /// \param carries  for each link the joint whose child it is
  /// \param link     on a cycle, or carried by one
  [[nodiscard]] std::size_t cycle_above(const std::vector<std::size_t>& carries, std::size_t link) const;
  void check_joints() const;

  std::string name_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::size_t base_ = 0;
  std::vector<std::size_t> joint_of_;  ///< for each link; the number of joints for the base
  std::vector<std::size_t> body_of_;   ///< for each link: the first link that fixed joints connect it to
};

/// A robot of which some joints move: a configuration has the coordinates of these joints in order, the other joints
/// stay where they are. Its base is fixed; a root joint (Joint::carries_robot) may move all that the base carries.
/// Links that do not move against each other are one body.
class Manipulator {
 public:
  /// A part that moves as a whole: links between which no joint moves.
  struct Body {
    /// Whether its joint carries a whole robot; see Joint.
    [[nodiscard]] bool is_root() const { return trellis::carries_robot(kind); }
    /// Whether its joint only slides it.
    [[nodiscard]] bool slides() const {
      return kind == Joint::Kind::prismatic || kind == Joint::Kind::translation_2 || kind == Joint::Kind::translation_3;
    }

    std::string name;  ///< of its first link
    std::vector<std::size_t> links = {};
    std::size_t parent = 0;  ///< the body that carries it; its own number for the base
    Pose3 origin = {};       ///< of its joint's frame in the parent's frame
    Joint::Kind kind = Joint::Kind::fixed;
    Vec3 axis = {1.0, 0.0, 0.0};
    std::size_t column = 0;   ///< of its joint's first coordinate
    double multiplier = 1.0;  ///< of a joint that follows another
    double offset = 0.0;
    std::vector<Solid> solids = {};  ///< in its frame
    double radius = 0.0;             ///< largest distance of its points from the origin of its frame
  };

  /// \param moving  joints with coordinates, ascending; joints that follow them move too
  /// \param values  of the other joints' coordinates, for each joint; 0 or the nearest limit where it is empty
  /// \throws Error where a joint is fixed, follows another one, or is repeated
  Manipulator(KinematicTree tree, std::vector<std::size_t> moving, const std::vector<std::vector<double>>& values = {});

  [[nodiscard]] const KinematicTree& tree() const { return tree_; }
  [[nodiscard]] const std::vector<std::size_t>& moving() const { return moving_; }
  /// Of the joints that do not move, for each joint; empty where they are at 0 or at the nearest limit.
  [[nodiscard]] const std::vector<std::vector<double>>& values() const { return values_; }
  /// The base first; each body comes after its parent.
  [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
  [[nodiscard]] std::size_t dimension() const { return dimension_; }
  /// Whether no joint that moves carries a whole robot.
  [[nodiscard]] bool has_fixed_base() const;
  /// The body that a link belongs to, and the pose of the link in the body's frame.
  [[nodiscard]] std::size_t body_of(std::size_t link) const { return body_of_[link]; }
  [[nodiscard]] const Pose3& pose_in_body(std::size_t link) const { return in_body_[link]; }

  /// Computes the poses of all bodies in the frame of the base (forward kinematics).
  /// \param q  `dimension` numbers, which is not checked
  void poses(View q, std::vector<Pose3>& out) const;
  /// Returns how many coordinates, from `column` on, the joint of a body has; 1 where it follows another one.
  [[nodiscard]] std::size_t width(std::size_t body) const;
  /// Returns the pose of a body in its parent's frame.
  [[nodiscard]] Pose3 joint_pose(std::size_t body, View q) const;
  /// Returns the pose of a link in the frame of the base.
  [[nodiscard]] Pose3 pose_of(std::size_t link, View q) const;
  /// Computes how much the coordinates change from a to b, as the bounds on displacements read it: the difference of
  /// each, but of a floating joint and of translations the distance in the place of the first coordinate of the
  /// position, the angle of the turn in that of the first one of the quaternion, and 0 for the others. \param space  of
  /// the robot's configurations, with any coordinates after the robot's \param a, b  configurations of `space` \param
  /// out  receives so many numbers as a configuration has
  void change(const Space& space, View a, View b, MutableView out) const;
  /// Returns a bound, in metres, on how far the points of a body move on the straight motion whose coordinates change
  /// by these amounts.
  /// \param change  see the function of that name
  [[nodiscard]] double displacement_bound(std::size_t body, View change) const;
  /// The farthest that a prismatic joint slides a body from its joint's frame, in metres; 0 for other joints.
  [[nodiscard]] double extension(std::size_t body) const;
  /// Returns the robot of which these joints move, and the others stay where they are: those that moved at 0 or at the
  /// nearest limit.
  [[nodiscard]] Manipulator with_moving(std::vector<std::size_t> moving) const;
  /// Returns the robot with one more link, the last one, which is fixed to another.
  /// \throws Error where a link has its name
  [[nodiscard]] Manipulator attached(const Link& link, std::size_t to) const;

 private:
  void add_reaches();

  KinematicTree tree_;
  std::vector<std::vector<double>> values_;  ///< of the joints that do not move
  std::vector<std::size_t> moving_;
  std::size_t dimension_ = 0;
  std::vector<Body> bodies_;
  std::vector<std::size_t> body_of_;
  std::vector<Pose3> in_body_;
  std::vector<std::pair<std::size_t, std::size_t>> positions_;  ///< of floating joints and translations: column, count
  /// For each body and coordinate: metres that its points move, at most, for a unit of the coordinate.
  std::vector<std::vector<double>> reach_;
};

}  // namespace trellis
