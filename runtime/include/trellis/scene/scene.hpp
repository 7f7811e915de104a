// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/motion/motion_model.hpp>
#include <trellis/scene/planar/shapes.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

class PlanarScene;
class SpatialScene;
class ManipulatorScene;

/// The obstacle of a world that a motion passes most easily between two configurations.
struct ThinnestObstacle {
  std::size_t obstacle = 0;
  double thickness = 0.0;  ///< metres: the least distance between two parallel lines, or planes, that enclose it
};

/// A robot of a team.
struct TeamMember {
  std::size_t number = 1;         ///< in messages and scripts
  std::vector<std::size_t> axes;  ///< the coordinates of the team that are its own, ascending
  bool translates = false;        ///< the first `world_dimension` of them are the position of its reference point
};

/// The world and the robot of a problem. Immutable, shared between runs and threads. PlanarScene, SpatialScene
/// and ManipulatorScene implement it. Planners, guides and the measure use what it declares; code for one kind asks for
/// the scene as that kind (`planar`, `spatial`, `manipulator`).
class Scene {
 public:
  virtual ~Scene() = default;

  /// Returns this scene if it is of that kind, else nullptr.
  [[nodiscard]] virtual const PlanarScene* planar() const { return nullptr; }
  [[nodiscard]] virtual const SpatialScene* spatial() const { return nullptr; }
  [[nodiscard]] virtual const ManipulatorScene* manipulator() const { return nullptr; }

  /// The number of coordinates of a position in the world: 2 or 3.
  [[nodiscard]] virtual std::size_t world_dimension() const = 0;
  /// Returns the length of the diagonal of the world's bounds, in metres.
  [[nodiscard]] virtual double diagonal() const = 0;
  /// Returns the largest coordinate of the bounds, or the robot's bounding radius where it is larger, in metres.
  /// Rounding errors of collision checks are relative to it.
  [[nodiscard]] virtual double magnitude() const = 0;
  [[nodiscard]] virtual std::size_t obstacle_count() const = 0;
  /// Returns the obstacle's name in messages: "obstacle 3 (box 4 0 6 4.75)".
  /// \param obstacle  from 0 to obstacle_count() - 1
  /// \return valid as long as the scene
  /// \throws std::out_of_range for another index
  [[nodiscard]] virtual const std::string& obstacle_name(std::size_t obstacle) const = 0;
  /// Returns the obstacle with the least thickness, of the parts of a planar polygon that is not convex the least one;
  /// of a mesh along its axes. Surfaces have none. Clouds of points are left out. None without obstacles.
  [[nodiscard]] virtual std::optional<ThinnestObstacle> thinnest_obstacle() const = 0;
  /// Returns a pointer that identifies the world: scenes with copies of one world have the same.
  [[nodiscard]] virtual std::shared_ptr<const void> world_identity() const = 0;

  [[nodiscard]] virtual const std::string& robot_name() const = 0;
  /// The number of coordinates that a configuration of the robot has.
  [[nodiscard]] virtual std::size_t robot_dimension() const = 0;
  /// Whether the first `world_dimension` coordinates are the position of the robot's reference point; else the robot is
  /// fixed to its base.
  [[nodiscard]] virtual bool translates() const = 0;
  [[nodiscard]] virtual bool is_point() const = 0;
  /// Returns a bound on the distance of the robot's points from its reference point at all configurations.
  [[nodiscard]] virtual double bounding_radius() const = 0;
  /// Returns the radius of the largest ball about the reference point inside the robot; 0 for a point, or where the
  /// reference point lies outside.
  [[nodiscard]] virtual double inscribed_radius() const = 0;
  [[nodiscard]] virtual std::size_t body_count() const = 0;
  /// Returns "link 2", or "body 2" where it has no name.
  /// \param body  from 0 to body_count() - 1
  [[nodiscard]] virtual std::string body_name(std::size_t body) const = 0;

  /// The robots of a team, in the order of their first coordinates; none, or one, of a robot alone.
  [[nodiscard]] virtual std::vector<TeamMember> members() const { return {}; }

  /// Returns the space of the robot's configurations in the world.
  /// \param weight  metres of the metric per radian, greater than 0
  /// \throws Error for another weight, where the robot turns
  [[nodiscard]] virtual Space default_space(double weight) const = 0;

  // The scenes of guiding spaces.

  /// Returns the scene of a smaller robot: scaled about its reference point, or with thinner links where it is fixed to
  /// its base.
  /// \param scale  in (0, 1]
  /// \throws Error for a scale that is not greater than 0
  [[nodiscard]] virtual std::shared_ptr<const Scene> shrunken(double scale) const = 0;
  /// Returns the scene with some of its obstacles.
  /// \param kept  ascending indices, from 0 to obstacle_count() - 1; none: the scene is without obstacles
  /// \throws std::out_of_range for an index of no obstacle
  [[nodiscard]] virtual std::shared_ptr<const Scene> with_obstacles(const std::vector<std::size_t>& kept) const = 0;
  /// Returns the world with a point instead of the robot.
  [[nodiscard]] virtual std::shared_ptr<const Scene> of_point() const = 0;
  /// Returns the scene of the part of the robot that some of its coordinates determine: bodies whose pose depends on no
  /// other coordinate, and the largest ball inside a body whose position alone is determined. The result's coordinates
  /// are numbered as in `kept`. nullptr if nothing is determined.
  /// \param kept  ascending; those beyond the robot's own are ignored
  [[nodiscard]] virtual std::shared_ptr<const Scene> reduced(const std::vector<std::size_t>& kept) const = 0;
  /// Returns the scene with obstacles that lost all points within `distance` metres of their boundary.
  /// \param distance  in metres, at least 0
  /// \throws Error where an obstacle cannot be eroded
  [[nodiscard]] virtual std::shared_ptr<const Scene> eroded(double distance) const = 0;
  /// Returns the scene with near obstacles merged into their convex hulls.
  /// \param error  metres: no point of a hull is farther from its obstacles; with 0 the result is the same scene
  [[nodiscard]] virtual std::shared_ptr<const Scene> aggregated(double error) const = 0;

 protected:
  Scene() = default;
  Scene(const Scene&) = default;
  Scene(Scene&&) = default;
  Scene& operator=(const Scene&) = default;
  Scene& operator=(Scene&&) = default;
};

/// A world and a robot of one kind.
template <class W, class R>
class SceneOf : public Scene {
 public:
  /// Makes the scene; does not check that the robot fits into the world.
  /// \param w  a world; copies of it share their content
  /// \param r  a robot of the same dimension of the workspace
  SceneOf(W w, R r) : world(std::move(w)), robot(std::move(r)) {}

  W world;
  R robot;

  [[nodiscard]] double diagonal() const final { return norm(world.bounds().hi - world.bounds().lo); }
  [[nodiscard]] std::size_t obstacle_count() const final { return world.obstacles().size(); }
  [[nodiscard]] const std::string& obstacle_name(std::size_t obstacle) const final {
    return world.obstacles().at(obstacle).name;
  }
  [[nodiscard]] std::shared_ptr<const void> world_identity() const final { return world.identity(); }
  [[nodiscard]] double bounding_radius() const final { return robot.bounding_radius(); }
};

/// A goal region: all configurations that place a point of the robot in a box of the workspace.
struct Reach {
  std::size_t body = 0;  ///< of the robot
  Vec2 point = {};       ///< in the body's frame
  Box2 box = {};
};

/// A planning problem as a user states it. The struct itself throws nothing; `checked` validates it.
struct Problem {
  std::string name;
  std::shared_ptr<const Scene> scene;
  Space space;
  Configuration start;
  std::vector<Configuration> goals = {};  ///< each solves the problem; the first is that of unsolved runs
  std::optional<Reach> reach = {};        ///< the goal region from which the goals were chosen
  double goal_tolerance = 1e-6;  ///< a configuration within this distance (metric) of the goal counts as the goal
  double resolution = 0.05;      ///< metres that the robot's fastest point moves between two checked configurations
  /// Metres: the displacement below which the certificate of a path no longer divides motions; what is undecided there
  /// counts as contact. 0: a millionth of `resolution`.
  double contact_tolerance = 0.0;
  std::string collision = "planar";  ///< the backend: "planar" or "fcl"
  /// nullptr: the robot moves straight between any two configurations. Else `space` is its state space.
  std::shared_ptr<const MotionModel> motion_model = nullptr;

  /// Returns the first goal. Requires that there is one.
  [[nodiscard]] const Configuration& goal() const { return goals.front(); }
};

}  // namespace trellis
