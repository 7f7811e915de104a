// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/robot.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// A world of space and a rigid body, or a team of them, that moves freely in it.
class SpatialScene final : public SceneOf<World3, Robot3> {
 public:
  using SceneOf::SceneOf;

  [[nodiscard]] const SpatialScene* spatial() const override { return this; }
  [[nodiscard]] std::size_t world_dimension() const override { return 3; }
  [[nodiscard]] double magnitude() const override;
  [[nodiscard]] std::optional<ThinnestObstacle> thinnest_obstacle() const override;
  [[nodiscard]] const std::string& robot_name() const override { return robot.name(); }
  [[nodiscard]] std::size_t robot_dimension() const override { return robot.dimension(); }
  [[nodiscard]] bool translates() const override { return robot.members().empty(); }
  [[nodiscard]] bool is_point() const override { return robot.is_point(); }
  [[nodiscard]] double inscribed_radius() const override { return robot.inscribed_radius(); }
  [[nodiscard]] std::size_t body_count() const override { return std::max<std::size_t>(robot.members().size(), 1); }
  [[nodiscard]] std::string body_name(std::size_t body) const override;
  [[nodiscard]] std::vector<TeamMember> members() const override;
  /// R^3, or SE(3) where the robot rotates; of a team the product of those of its robots.
  [[nodiscard]] Space default_space(double weight) const override;
  /// The same, where a radian weighs the bounding radius of the body: so the metric bounds how far its points move.
  [[nodiscard]] Space own_space() const;
  [[nodiscard]] std::shared_ptr<const Scene> shrunken(double scale) const override;
  [[nodiscard]] std::shared_ptr<const Scene> with_obstacles(const std::vector<std::size_t>& kept) const override;
  [[nodiscard]] std::shared_ptr<const Scene> of_point() const override;
  [[nodiscard]] std::shared_ptr<const Scene> reduced(const std::vector<std::size_t>& kept) const override;
  [[nodiscard]] std::shared_ptr<const Scene> eroded(double distance) const override;
  [[nodiscard]] std::shared_ptr<const Scene> aggregated(double error) const override;
};

/// Returns the scene as one of space.
/// \param scene  of any kind
/// \return the same object, valid as long as `scene`
/// \throws Fault where it is planar: the caller works in space alone and did not refuse it
const SpatialScene& spatial(const Scene& scene);

}  // namespace trellis
