// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/scene/planar/robot.hpp>
#include <trellis/scene/planar/world.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

/// A planar world and a planar robot.
class PlanarScene final : public SceneOf<World, Robot> {
 public:
  using SceneOf::SceneOf;

  [[nodiscard]] const PlanarScene* planar() const override { return this; }
  [[nodiscard]] std::size_t world_dimension() const override { return 2; }
  [[nodiscard]] double magnitude() const override;
  [[nodiscard]] std::optional<ThinnestObstacle> thinnest_obstacle() const override;
  [[nodiscard]] const std::string& robot_name() const override { return robot.name(); }
  [[nodiscard]] std::size_t robot_dimension() const override { return robot.dimension(); }
  [[nodiscard]] bool translates() const override { return robot.translates(); }
  [[nodiscard]] bool is_point() const override { return robot.is_point(); }
  [[nodiscard]] double inscribed_radius() const override { return robot.inscribed_radius(); }
  [[nodiscard]] std::size_t body_count() const override { return robot.bodies().size(); }
  [[nodiscard]] std::string body_name(std::size_t body) const override { return robot.body_name(body); }
  [[nodiscard]] std::vector<TeamMember> members() const override;
  [[nodiscard]] Space default_space(double weight) const override;
  [[nodiscard]] std::shared_ptr<const Scene> shrunken(double scale) const override;
  [[nodiscard]] std::shared_ptr<const Scene> with_obstacles(const std::vector<std::size_t>& kept) const override;
  [[nodiscard]] std::shared_ptr<const Scene> of_point() const override;
  [[nodiscard]] std::shared_ptr<const Scene> reduced(const std::vector<std::size_t>& kept) const override;
  [[nodiscard]] std::shared_ptr<const Scene> eroded(double distance) const override;
  [[nodiscard]] std::shared_ptr<const Scene> aggregated(double error) const override;
};

/// Returns the scene as a planar one.
/// \param scene  of any kind
/// \return the same object, valid as long as `scene`
/// \throws Fault where it is not planar: the caller works in the plane alone and did not refuse it
const PlanarScene& planar(const Scene& scene);
/// As `planar`, for a shared scene.
/// \param scene  not nullptr; the result shares its ownership
/// \throws Fault where it is not planar
std::shared_ptr<const PlanarScene> planar_scene(std::shared_ptr<const Scene> scene);

/// Returns the default space of a robot in a world: R^2 without turning, SE(2) with one angle, R^2 x SO(2)^k otherwise
/// (SO(2)^k for a fixed base); an angle with limits is a bounded axis, R. Of a team, the product of its members'
/// spaces.
/// \param robot  alone or a team; its limits are bounds of axes
/// \param world  its bounds are those of x and y
/// \param weight  metres of the metric per radian, greater than 0
/// \throws Error for another weight, where the robot turns
Space default_space(const Robot& robot, const World& world, double weight);

}  // namespace trellis
