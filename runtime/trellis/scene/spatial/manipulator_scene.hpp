// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/body_sphere.hpp>
#include <trellis/scene/spatial/kinematic_tree.hpp>
#include <trellis/scene/spatial/medial_cover.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// A point that a body of a robot carries.
struct PointOnBody {
  std::size_t body = 0;
  Vec3 point = {};  ///< in the body's frame
};

/// Returns a ball that contains some balls: about the middle of their box.
/// \param balls  at least one
BodySphere enclosing(const std::vector<BodySphere>& balls);

/// The collision geometry of a robot's links as balls.
struct LinkCovers {
  CoverOptions options;            ///< of shapes that are attached, too
  std::vector<MedialCover> links;  ///< of each link, in its frame
};

/// Covers the collision geometry of each link of a robot.
LinkCovers link_covers(const KinematicTree& tree, const CoverOptions& options = {});

/// A manipulator as balls, which collision checking uses: those of a sphere model as they are, balls that cover every
/// other shape (conservative: a little space beside such a shape counts as the robot's).
class SphereModel {
 public:
  using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
  using Distances = std::map<std::pair<std::size_t, std::size_t>, double>;
  /// Balls of a body that self-collision checking compares with the same links: those of links with the same
  /// permissions.
  struct Part {
    std::size_t body = 0;
    std::size_t begin = 1;  ///< the first one among the balls of the body
    std::size_t end = 1;    ///< after the last one
    BodySphere whole = {};  ///< contains them

    [[nodiscard]] std::size_t count() const { return end - begin; }
  };
  /// Two links of one body, which do not move against each other and are checked.
  struct Standing {
    std::size_t first = 0;   ///< a link
    std::size_t second = 0;  ///< a link
    double gap = 0.0;        ///< their distance at all configurations, in metres; at most 0 in contact
  };
  /// A configuration that has a name: "ready".
  struct State {
    std::string name;
    Configuration q;
  };

  /// \param may_touch  pairs of links that are not checked against each other, the lesser one first. `neighbours` and
  ///     links that fixed joints connect are never checked
  explicit SphereModel(const Manipulator& robot, Pairs may_touch = {});
  /// \param covers  of the robot's links
  SphereModel(Manipulator robot, LinkCovers covers, Pairs may_touch);

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
  /// The link that a ball of a body belongs to.
  /// \param ball  from 1
  [[nodiscard]] std::size_t link_of(std::size_t body, std::size_t ball) const { return ball_links_[body][ball]; }
  /// The parts of all bodies with balls, by body.
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  /// Pairs of parts of different bodies that must not touch each other, the lesser one first, ascending.
  [[nodiscard]] const Pairs& pairs() const { return pairs_; }
  /// Whether two links must not touch each other.
  [[nodiscard]] bool checked(std::size_t first_link, std::size_t second_link) const;
  /// Pairs of links that may touch each other, the lesser one first, ascending.
  [[nodiscard]] const Pairs& may_touch() const { return may_touch_; }
  /// Whether two links are of one body: they do not move against each other.
  [[nodiscard]] bool stand(std::size_t first_link, std::size_t second_link) const {
    return robot_.body_of(first_link) == robot_.body_of(second_link);
  }
  /// Whether the distance of two links of one body is given, so that their balls are not compared.
  [[nodiscard]] bool stands_apart(std::size_t first_link, std::size_t second_link) const {
    return stand(first_link, second_link) && distances_.contains(std::minmax(first_link, second_link));
  }
  /// Returns the robot with distances of links of one body, in place of those of their balls. Pairs have the lesser
  /// link first; each distance is greater than 0, in metres.
  [[nodiscard]] SphereModel with_standing_distances(Distances distances) const;
  /// The nearest links of one body that must not touch each other; none without such links. Where they touch, no
  /// configuration is valid.
  [[nodiscard]] std::optional<Standing> standing() const;
  /// Where the base is in the world.
  [[nodiscard]] const Pose3& base() const { return base_; }
  [[nodiscard]] const std::vector<State>& states() const { return states_; }
  /// The balls of each link, in its frame, and how far they protrude.
  [[nodiscard]] const LinkCovers& covers() const { return *covers_; }
  /// Returns how far balls protrude beyond the shapes of the robot, at most, in metres.
  [[nodiscard]] double excess() const;
  /// Whether every shape of the robot is a sphere.
  [[nodiscard]] bool exact() const { return exact_; }
  /// Whether the balls cover the shapes of the bodies, for pictures: not of a robot that is thinned or reduced.
  [[nodiscard]] bool covers_shapes() const { return covers_shapes_; }
  /// Returns a bound on the distance of the robot's points from its base at all configurations.
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// Returns a bound on the distance of the points that a joint carries from the origin of its child's frame.
  /// \param joint  one that moves
  [[nodiscard]] double radius_carried_by(std::size_t joint) const;
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
  /// The name of the frame in which the base has its place: "world", as the virtual joint of a SRDF file says; "" where
  /// no file names it.
  [[nodiscard]] const std::string& world_frame() const { return world_frame_; }
  [[nodiscard]] SphereModel with_world_frame(std::string name) const;
  /// Returns the robot whose joints that do not move are at other values.
  /// \param values  see Manipulator
  [[nodiscard]] SphereModel with_values(const std::vector<std::vector<double>>& values) const;
  /// Returns the robot with pairs of links that touch in nearly every configuration, the lesser one first:
  /// `always_touch` is true of them. They have to be among those that may touch.
  [[nodiscard]] SphereModel with_touching(const Pairs& touching) const;
  /// Whether two links touch in nearly every configuration: neighbours, links that fixed joints connect, and those of
  /// `with_touching`.
  [[nodiscard]] bool always_touch(std::size_t first_link, std::size_t second_link) const;
  /// Returns the robot of which some links have other covers.
  [[nodiscard]] SphereModel with_covers(const std::map<std::size_t, MedialCover>& covers) const;
  /// Returns the robot with more pairs of links that may touch, the lesser one first.
  [[nodiscard]] SphereModel with_permissions(const Pairs& may_touch) const;
  /// Returns the robot that keeps a distance from obstacles, as MoveIt's link_scale and link_padding have it: each
  /// shape of a link is scaled about its origin, then grown. The links themselves are not, for self-collision: a grown
  /// copy is fixed to each, named "LINK (padded)", which may touch all links.
  /// \param scale    for each link, at least 1
  /// \param padding  for each link, metres, at least 0
  [[nodiscard]] SphereModel padded(const std::vector<double>& scale, const std::vector<double>& padding) const;
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
  /// A model with other balls and parts, which is not divided anew.
  SphereModel(const SphereModel& whole, Manipulator robot, std::vector<std::vector<BodySphere>> bodies);
  /// A model without bodies: `permit` adds them.
  SphereModel(std::shared_ptr<const LinkCovers> covers, Manipulator robot, Pairs may_touch, Distances distances = {});
  /// Sets the pairs of links that may touch, and divides the bodies into parts.
  void permit(Pairs may_touch);
  void divide();
  void add_standing();
  /// Takes what a robot has beside its geometry from another model: the base, the named configurations, the world's
  /// frame, and the pairs that may always touch.
  void keep(const SphereModel& other);
  void enclose();
  /// The tip among the bodies that these coordinates move, ascending; empty: all bodies.
  [[nodiscard]] PointOnBody tip_moved_by(const std::vector<std::size_t>& axes) const;

  Manipulator robot_;
  std::shared_ptr<const LinkCovers> covers_;
  std::vector<std::vector<BodySphere>> bodies_;
  std::vector<std::vector<std::size_t>> ball_links_;  ///< for each ball of a body its link; the first one has none
  Pairs may_touch_;
  std::vector<Part> parts_;
  Pairs pairs_;
  std::vector<std::optional<Standing>> standing_;  ///< for each body
  Pose3 base_;
  std::vector<State> states_;
  std::string world_frame_;
  Distances distances_;  ///< of links of one body, given
  Pairs touching_;       ///< pairs of links that touch in nearly every configuration, ascending
  bool exact_ = true;
  bool covers_shapes_ = true;
  double bounding_radius_ = 0.0;
};

/// Returns the pairs of links that may touch each other because they are neighbours, the lesser one first, ascending:
/// a joint connects them, or joints with only links without collision geometry between them.
SphereModel::Pairs neighbours(const KinematicTree& tree);

/// Returns the coordinates of a robot's configurations: of each joint that moves its own, in order; a quaternion has
/// four, from -1 to 1.
/// \param bounds  of the positions of a base that moves
/// \param weight  metres of the metric per radian
std::vector<Axis> joint_axes(const Manipulator& robot, const Box3& bounds, double weight);
/// Returns the space of a robot's configurations: a line for each joint with limits, a circle for each one without, and
/// the rotations of space for each floating joint.
/// \param bounds  of the positions of a base that moves
/// \param weight  for a joint that moves, by its number in the tree: metres of the metric per radian, greater than 0
/// \throws Error for another weight
Space joint_space(const Manipulator& robot, const Box3& bounds, const std::function<double(std::size_t)>& weight);

/// Returns pairs of links that touch in at least 95 % of 1000 configurations of all joints, which are drawn uniformly
/// within their limits, the same ones each time: hardly a configuration would be valid. A base that moves stays.
/// \param may_touch  pairs of links that are not examined, the lesser one first
/// \return ascending
SphereModel::Pairs likely_contacts(const KinematicTree& tree, const LinkCovers& covers,
                                   const SphereModel::Pairs& may_touch);

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
  /// The same as `default_space` with the weight 1, but where a joint is floating a radian weighs the radius of what it
  /// carries: so the metric bounds how far its points move.
  [[nodiscard]] Space own_space() const;
  /// See joint_space.
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
