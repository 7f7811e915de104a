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
#include <trellis/motion/motion_model.hpp>
#include <trellis/scene/shapes.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

struct Obstacle {
  std::string name;  ///< how messages call it: "obstacle 3 (box 4 0 6 4.75)"
  Shape shape;
};

/// A planar workspace: a boundary box, inside which the whole robot stays, and closed obstacles. Immutable: copies
/// share their content, so that robots of several sizes in one world share what is worked out about it.
class World {
 public:
  /// A convex piece of an obstacle.
  struct Part {
    ConvexShape shape;
    std::size_t obstacle = 0;  ///< index into obstacles()
  };

  World() : World(Box2{{0, 0}, {1, 1}}, {}) {}
  /// Validates (finite, positive extents and radii, simple polygons) and splits non-convex polygons into convex parts.
  /// Throws Error naming the obstacle.
  World(Box2 bounds, std::vector<Obstacle> obstacles);

  [[nodiscard]] const Box2& bounds() const { return content_->bounds; }
  [[nodiscard]] const std::vector<Obstacle>& obstacles() const { return content_->obstacles; }
  [[nodiscard]] const std::vector<Part>& parts() const { return content_->parts; }
  /// What copies have in common: the same pointer for them, another for any other world while one of them lives.
  [[nodiscard]] std::shared_ptr<const void> identity() const { return content_; }

 private:
  struct Content {
    Box2 bounds;
    std::vector<Obstacle> obstacles;
    std::vector<Part> parts;
  };
  std::shared_ptr<const Content> content_;
};

/// One rigid body of a robot. Its frame: origin at its joint, turned by its angle.
struct Body {
  std::vector<ConvexShape> parts;  ///< in the body's frame
  int parent = -1;                 ///< index of an earlier body, -1: the robot's reference point
  Vec2 joint;                      ///< where the body's origin sits, in the parent's frame
  int angle_axis = -1;             ///< the axis that turns it; -1: it keeps its parent's angle
  bool absolute = false;           ///< the axis gives the angle in the world, not relative to the parent
  std::string name = {};           ///< how messages call it: "link 2"; "": "body 2"
};

/// What `Robot::arm` makes an arm from. Link i + 1 hangs on the far end of link i.
struct Arm {
  std::vector<double> links;   ///< their lengths, from the base on
  std::vector<double> widths;  ///< of each link
  Vec2 base = {};              ///< where the first joint is fixed
  /// Of each joint the least and the greatest angle, relative to the link before it; none: full turns.
  std::vector<std::optional<std::pair<double, double>>> limits = {};
  bool self_collision = true;  ///< links that are no neighbours must not meet
};

/// A planar robot: a tree of rigid bodies moved by the configuration. A point, a disc and a polygon are one body.
class Robot {
 public:
  Robot() = default;
  /// \param translates  axes 0 and 1 move the reference point; otherwise it is fixed at `base`
  /// Throws Error on an empty robot, a parent that does not come earlier, or a malformed part.
  Robot(std::string name, std::vector<Body> bodies, bool translates = true, Vec2 base = {});

  static Robot point();
  static Robot disc(double radius);
  /// One rigid body, turned by axis 2 where `rotates`. Non-convex polygons are split into convex parts.
  static Robot rigid(const std::vector<Shape>& shapes, bool rotates = true);
  /// A planar arm of rectangular links with revolute joints; the first joint's angle is in the world.
  static Robot arm(const Arm& arm);

  /// Pairs of bodies that must not meet each other, the lower index first; by default bodies may overlap. Throws Error
  /// for bodies that there are not.
  [[nodiscard]] Robot apart(std::vector<std::pair<std::size_t, std::size_t>> pairs) const;
  /// Bounds of the axes that turn bodies, the first of them first; none or an empty list: full turns. Throws Error for
  /// bounds that are not finite and in order, or more than a full turn apart.
  [[nodiscard]] Robot limited(std::vector<std::optional<std::pair<double, double>>> limits) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
  [[nodiscard]] bool translates() const { return translates_; }
  [[nodiscard]] Vec2 base() const { return base_; }
  [[nodiscard]] const std::vector<std::pair<std::size_t, std::size_t>>& pairs() const { return pairs_; }
  [[nodiscard]] const std::vector<std::optional<std::pair<double, double>>>& limits() const { return limits_; }
  /// "link 2", or "body 2" where it has no name.
  [[nodiscard]] std::string body_name(std::size_t body) const;
  [[nodiscard]] bool is_point() const;
  /// The number of axes that the robot needs in a configuration.
  [[nodiscard]] std::size_t dimension() const { return dimension_; }

  /// The robot scaled by `factor` > 0 about its reference point, shapes and joints alike.
  [[nodiscard]] Robot scaled(double factor) const;
  /// The robot with each part of each body scaled by `factor` > 0 across the body's axis, and discs about their
  /// centres: joints stay in their places, so that kinematics are the same. The axis leads from the body's joint to the
  /// farthest joint that it carries, or to the middle of its own parts. For a factor of at most 1 every part lies
  /// within that of the whole robot at the same configuration. Radii and displacement bounds stay those of the whole
  /// robot, so that a motion is checked in the same configurations; only `inscribed_radius` is 0.
  [[nodiscard]] Robot thinned(double factor) const;
  /// No point of the robot is ever farther than this from its reference point.
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// The largest disc about the reference point inside the robot (0 for a point, or where the point lies outside).
  [[nodiscard]] double inscribed_radius() const { return inscribed_radius_; }

  /// The pose of each body at q; `out` has bodies().size() entries.
  void place(View q, std::span<Pose2> out) const;
  /// A bound on the way that any point of the robot moves along the straight motion from a to b in the space,
  /// in metres: translation plus radius times turn, summed along the chain.
  [[nodiscard]] double displacement_bound(const Space& space, View a, View b) const;

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
};

/// What a planar problem takes place in. Immutable, shared between runs and threads.
struct Scene {
  World world;
  Robot robot;
};

/// A set of goals: all configurations that bring a point of the robot into a box of the workspace.
struct Reach {
  std::size_t body = 0;  ///< of the robot
  Vec2 point = {};       ///< in the body's frame
  Box2 box = {};
};

/// A planning problem as a user states it. Throws nothing by itself; `checked` validates.
struct Problem {
  std::string name;
  std::shared_ptr<const Scene> scene;
  Space space;
  Configuration start;
  Configuration goal;
  Configurations further_goals = {};  ///< each of them would do as well
  std::optional<Reach> reach = {};    ///< what the goals were chosen for, where any configuration of a set would do
  double goal_tolerance = 1e-6;       ///< a configuration this near (metric) to the goal is the goal
  double resolution = 0.05;          ///< metres that the robot's fastest point moves between two checked configurations
  std::string collision = "planar";  ///< the backend: "planar" or "fcl"
  /// nullptr: the robot moves straight from any configuration to any other. Else `space` holds its states.
  std::shared_ptr<const MotionModel> motion_model = nullptr;
};

/// The default space of a robot in a world: R^2 without turning, SE(2) with one angle, R^2 x SO(2)^k otherwise
/// (SO(2)^k for a fixed base); an angle with limits is a bounded axis, R. `weight` in metres per radian.
Space default_space(const Robot& robot, const World& world, double weight);

}  // namespace trellis
