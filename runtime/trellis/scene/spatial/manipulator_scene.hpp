// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/kinematic_tree.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// A ball of a robot's body, in the body's frame.
struct BodySphere {
  Vec3 centre;
  double radius = 0.0;
};

/// A point that a body of a robot carries.
struct PointOnBody {
  std::size_t body = 0;
  Vec3 point = {};  ///< in the body's frame
};

/// A manipulator as balls, which collision checking uses: those of a sphere model as they are, balls that cover every
/// other shape (conservative: a little space beside such a shape counts as the robot's).
class SphereModel {
 public:
  using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
  /// A configuration that has a name: "ready".
  struct State {
    std::string name;
    Configuration q;
  };

  /// \param may_touch  pairs of links that are not checked against each other, the lesser one first, ascending; links
  ///     that a joint connects, and those of one body, are never checked
  explicit SphereModel(Manipulator robot, Pairs may_touch = {});

  /// Returns a team: robots in one world, each at its base, whose links must not touch those of the others. Links and
  /// joints are named as "2/panda_link1"; configurations that all robots have by one name keep it.
  /// \throws Error for less than two robots, or with more than `KinematicTree::most_links` links in all
  static SphereModel team(const std::vector<SphereModel>& robots);
  /// The parts of the robot that move independently of each other, as the arms of a robot with a fixed torso: those
  /// that the base carries, by their coordinates. One of most robots.
  [[nodiscard]] std::vector<TeamMember> members() const;

  [[nodiscard]] const Manipulator& robot() const { return robot_; }
  /// For each body its balls; the first one contains the others.
  [[nodiscard]] const std::vector<std::vector<BodySphere>>& bodies() const { return bodies_; }
  /// Pairs of bodies that must not touch each other, the lesser one first.
  [[nodiscard]] const Pairs& pairs() const { return pairs_; }
  /// Where the base is in the world.
  [[nodiscard]] const Pose3& base() const { return base_; }
  [[nodiscard]] const std::vector<State>& states() const { return states_; }
  /// Whether every shape of the robot is a sphere.
  [[nodiscard]] bool exact() const { return exact_; }
  /// Whether the balls cover the shapes of the bodies, for pictures: not of a robot that is thinned or reduced.
  [[nodiscard]] bool covers_shapes() const { return covers_shapes_; }
  /// Returns a bound on the distance of the robot's points from its base at all configurations.
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// The middle of the last body of the longest chain of joints: of the hand of an arm with one.
  [[nodiscard]] PointOnBody tip() const;
  /// The tips of its members: of a robot with one part that moves, `tip`.
  [[nodiscard]] std::vector<PointOnBody> tips() const;
  /// Returns where a point of the robot is in the world.
  [[nodiscard]] Vec3 position(const PointOnBody& point, View q) const;
  /// Returns where the tip is in the world.
  [[nodiscard]] Vec3 tip_at(View q) const { return position(tip(), q); }
  /// Returns the robot with its base elsewhere.
  [[nodiscard]] SphereModel based_at(const Pose3& base) const;
  /// Returns the robot with configurations that have names.
  [[nodiscard]] SphereModel with_states(std::vector<State> states) const;
  /// Returns the robot with a shape that one of its links carries.
  /// \param name   of the shape, which becomes a link
  /// \param solid  in the frame of the link
  /// \param touch  links that the shape may touch beside the one that carries it
  /// \throws Error where a link has that name
  [[nodiscard]] SphereModel attached(const std::string& name, const Solid& solid, std::size_t link,
                                     const std::vector<std::size_t>& touch) const;
  /// Returns the robot with thinner links: each ball has its radius times `factor`, and lies in the ball that it was.
  [[nodiscard]] SphereModel thinned(double factor) const;
  /// Returns the robot of which some joints move alone, and without the bodies whose places others determine.
  /// \param kept  the columns of its coordinates, ascending; all of a joint's or none
  /// \return none where no moving body is determined
  [[nodiscard]] std::optional<SphereModel> reduced(const std::vector<std::size_t>& kept) const;

 private:
  SphereModel(const SphereModel& whole, Manipulator robot, std::vector<std::vector<BodySphere>> bodies, Pairs pairs);
  void enclose();
  /// The tip among the bodies that these coordinates move, ascending; empty: all bodies.
  [[nodiscard]] PointOnBody tip_moved_by(const std::vector<std::size_t>& axes) const;

  Manipulator robot_;
  std::vector<std::vector<BodySphere>> bodies_;
  Pairs may_touch_;
  Pairs pairs_;
  Pose3 base_;
  std::vector<State> states_;
  bool exact_ = true;
  bool covers_shapes_ = true;
  double bounding_radius_ = 0.0;
};

/// Returns the pairs of bodies of a manipulator that are checked for self-collision: all whose links no joint connects
/// and no pair of links that may touch.
/// \param may_touch  pairs of links, the lesser one first, ascending
SphereModel::Pairs self_collision_pairs(const Manipulator& robot, const SphereModel::Pairs& may_touch);

/// Returns the axes of a robot's configurations: of each joint that moves its own, in order.
/// \param bounds  of the positions of a base that moves
/// \param weight  metres of the metric per radian
std::vector<Axis> joint_axes(const Manipulator& robot, const Box3& bounds, double weight);

/// Returns pairs of bodies that touch in at least 95 % of 1000 configurations that are drawn uniformly, the same ones
/// each time: no configuration would be valid.
/// \param may_touch  pairs of links that are not examined, the lesser one first, ascending
/// \param at_zero    pairs that touch at the configuration 0 count too
SphereModel::Pairs likely_contacts(const Manipulator& robot, const SphereModel::Pairs& may_touch, bool at_zero);

/// Returns all pairs of the links of two bodies, for pairs of bodies; ascending.
SphereModel::Pairs links_of(const Manipulator& robot, const SphereModel::Pairs& bodies);

/// A world of space and a manipulator in it.
class ManipulatorScene final : public SceneOf<World3, SphereModel> {
 public:
  using SceneOf::SceneOf;

  [[nodiscard]] const ManipulatorScene* manipulator() const override { return this; }
  [[nodiscard]] std::size_t world_dimension() const override { return 3; }
  [[nodiscard]] double magnitude() const override;
  [[nodiscard]] std::optional<ThinnestObstacle> thinnest_obstacle() const override;
  [[nodiscard]] const std::string& robot_name() const override { return robot.robot().tree().name(); }
  [[nodiscard]] std::size_t robot_dimension() const override { return robot.robot().dimension(); }
  [[nodiscard]] bool translates() const override { return false; }
  [[nodiscard]] bool is_point() const override { return false; }
  [[nodiscard]] double inscribed_radius() const override { return 0.0; }
  [[nodiscard]] std::size_t body_count() const override { return robot.bodies().size(); }
  [[nodiscard]] std::string body_name(std::size_t body) const override;
  [[nodiscard]] std::vector<TeamMember> members() const override { return robot.members(); }
  /// A line for each joint with limits, a circle for each one without.
  [[nodiscard]] Space default_space(double weight) const override;
  [[nodiscard]] std::shared_ptr<const Scene> shrunken(double scale) const override;
  [[nodiscard]] std::shared_ptr<const Scene> with_obstacles(const std::vector<std::size_t>& kept) const override;
  [[nodiscard]] std::shared_ptr<const Scene> of_point() const override;
  /// The bodies that the first joints carry, up to the first joint that is not kept.
  [[nodiscard]] std::shared_ptr<const Scene> reduced(const std::vector<std::size_t>& kept) const override;
  [[nodiscard]] std::shared_ptr<const Scene> eroded(double distance) const override;
  [[nodiscard]] std::shared_ptr<const Scene> aggregated(double error) const override;
};

}  // namespace trellis
