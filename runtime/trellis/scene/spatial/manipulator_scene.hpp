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

/// A manipulator as balls, which collision checking uses: those of a sphere model as they are, balls that cover every
/// other shape (conservative: a little space beside such a shape counts as the robot's).
class SphereModel {
 public:
  /// \param pairs  of bodies that must not touch each other, the lesser one first
  SphereModel(Manipulator robot, std::vector<std::pair<std::size_t, std::size_t>> pairs);

  [[nodiscard]] const Manipulator& robot() const { return robot_; }
  /// For each body its balls; the first one contains the others.
  [[nodiscard]] const std::vector<std::vector<BodySphere>>& bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<std::pair<std::size_t, std::size_t>>& pairs() const { return pairs_; }
  /// Whether every shape of the robot is a sphere.
  [[nodiscard]] bool exact() const { return exact_; }
  /// Returns a bound on the distance of the robot's points from its base at all configurations.
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// Returns the robot with thinner links: each ball has its radius times `factor`, and lies in the ball that it was.
  [[nodiscard]] SphereModel thinned(double factor) const;
  /// Returns the robot of which some joints move alone, and without the bodies whose places others determine.
  /// \param kept  the columns of its coordinates, ascending; all of a joint's or none
  /// \return none where no moving body is determined
  [[nodiscard]] std::optional<SphereModel> reduced(const std::vector<std::size_t>& kept) const;

 private:
  SphereModel(Manipulator robot, std::vector<std::vector<BodySphere>> bodies,
              std::vector<std::pair<std::size_t, std::size_t>> pairs, bool exact);
  void enclose();

  Manipulator robot_;
  std::vector<std::vector<BodySphere>> bodies_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  bool exact_ = true;
  double bounding_radius_ = 0.0;
};

/// Returns the pairs of bodies of a manipulator that are checked for self-collision: all whose links no joint connects
/// and no pair of links that is disabled.
/// \param disabled  pairs of links that may touch, the lesser one first, in order
std::vector<std::pair<std::size_t, std::size_t>> self_collision_pairs(
    const Manipulator& robot, const std::vector<std::pair<std::size_t, std::size_t>>& disabled);

/// A world of space and a manipulator whose base does not move.
class ManipulatorScene final : public Scene {
 public:
  ManipulatorScene(World3 w, SphereModel r, Pose3 at = {}) : world(std::move(w)), robot(std::move(r)), base(at) {}

  World3 world;
  SphereModel robot;
  Pose3 base;  ///< of the robot's base in the world

  [[nodiscard]] const ManipulatorScene* manipulator() const override { return this; }
  [[nodiscard]] std::size_t world_dimension() const override { return 3; }
  [[nodiscard]] double diagonal() const override { return norm(world.bounds().hi - world.bounds().lo); }
  [[nodiscard]] double magnitude() const override;
  [[nodiscard]] std::size_t obstacle_count() const override { return world.obstacles().size(); }
  [[nodiscard]] const std::string& obstacle_name(std::size_t obstacle) const override {
    return world.obstacles().at(obstacle).name;
  }
  [[nodiscard]] std::optional<ThinnestObstacle> thinnest_obstacle() const override;
  [[nodiscard]] std::shared_ptr<const void> world_identity() const override { return world.identity(); }
  [[nodiscard]] const std::string& robot_name() const override { return robot.robot().tree().name(); }
  [[nodiscard]] std::size_t robot_dimension() const override { return robot.robot().dimension(); }
  [[nodiscard]] bool translates() const override { return false; }
  [[nodiscard]] bool is_point() const override { return false; }
  [[nodiscard]] double bounding_radius() const override { return robot.bounding_radius(); }
  [[nodiscard]] double inscribed_radius() const override { return 0.0; }
  [[nodiscard]] std::size_t body_count() const override { return robot.bodies().size(); }
  [[nodiscard]] std::string body_name(std::size_t body) const override;
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
