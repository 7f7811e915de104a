// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/common.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

void check_fits(const Scene& scene, const Space& space, double resolution) {
  if (!std::isfinite(resolution) || resolution <= 0.0) {
    throw Error(fmt::format("the collision resolution must be a finite number greater than 0, got {}", resolution));
  }
  if (scene.body_count() == 0) throw Error("collision checking needs a robot with at least one body");
  if (space.dimension() < scene.robot_dimension()) {
    throw Error(fmt::format("robot '{}' needs {} axes, the space {} has {}", scene.robot_name(),
                            scene.robot_dimension(), space.name(), space.dimension()));
  }
}

namespace {

// Rates: `scripts/bench-work --law`.

CheckCost scaled(const CheckCost& one, double by) {
  return {by * one.on_motion, by * one.alone, by * one.distance, by * one.motion};
}

CheckCost cost_of(const PlanarScene& scene) {
  // A motion of the plane costs about the same with 5 configurations and with 50.
  constexpr CheckCost piece{.on_motion = 3.0 / 128.0, .alone = 0.5, .distance = 2.0, .motion = 1.0};
  constexpr double placing = 0.5;
  std::size_t pieces = 0;
  for (const auto& body : scene.robot.bodies()) pieces += body.parts.size();
  CheckCost cost = scaled(piece, static_cast<double>(std::max<std::size_t>(1, pieces)));
  cost.alone += placing;
  return cost;
}

CheckCost cost_of(const SpatialScene& scene) {
  constexpr CheckCost solid{.on_motion = 3.0, .alone = 4.0, .distance = 16.0, .motion = 8.0};
  constexpr CheckCost mesh{.on_motion = 10.0, .alone = 10.0, .distance = 20.0, .motion = 8.0};
  const auto is_mesh = [](const Solid& of) { return std::holds_alternative<std::shared_ptr<const Mesh>>(of.shape); };
  const auto& solids = scene.robot.solids();
  const auto& obstacles = scene.world.obstacles();
  const bool meshes = std::any_of(solids.begin(), solids.end(), is_mesh) ||
                      std::any_of(obstacles.begin(), obstacles.end(), [&](const auto& o) { return is_mesh(o.solid); });
  return scaled(meshes ? mesh : solid, static_cast<double>(std::max<std::size_t>(1, scene.robot.members().size())));
}

CheckCost cost_of(const ManipulatorScene& scene) {
  std::size_t balls = 0;
  for (const auto& body : scene.robot.bodies()) balls += body.size();
  const double check = 0.25 + static_cast<double>(balls) / 24.0;
  return {.on_motion = check, .alone = check, .distance = 4.0 * check, .motion = 2.0};
}

}  // namespace

CheckCost check_cost(const Scene& scene) {
  return visit(scene, [](const auto& of) { return cost_of(of); });
}

double touching_slack(const Scene& scene) { return std::ldexp(scene.magnitude(), -43); }

std::vector<double> wraps(const Space& space, View a, View difference) {
  std::vector<double> found;
  for (std::size_t j = 0; j < space.dimension(); ++j) {
    const Axis& axis = space.axes()[j];
    if (!axis.periodic || difference[j] == 0.0) continue;
    // The ends of periods that lie between the ends of the motion; a itself need not be normalised.
    const double to = a[j] + difference[j];
    const double first = std::ceil((std::min(a[j], to) - axis.lo) / axis.period());
    const double last = std::floor((std::max(a[j], to) - axis.lo) / axis.period());
    for (double k = first; k <= last; ++k) {
      const double t = (axis.lo + k * axis.period() - a[j]) / difference[j];
      if (t > 0.0 && t < 1.0) found.push_back(t);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace trellis
