// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// The signed distance of points from what bounds the free part of a world: its obstacles, and its bounds where they
/// must contain the whole robot. Negative inside obstacles and outside such bounds. It changes by at most the distance
/// between two points. Immutable; threads share it.
class FreeDistance {
 public:
  explicit FreeDistance(const World3& world);

  /// Returns the signed distance of p in metres; infinity where nothing bounds it.
  [[nodiscard]] double operator()(const Vec3& p) const;
  /// The nearest point of an obstacle's surface or of a side of the bounds, and the signed distance from it.
  struct Nearest {
    double distance = 0.0;
    Vec3 point;
  };
  [[nodiscard]] Nearest nearest(const Vec3& p) const;

 private:
  [[nodiscard]] Nearest side(const Vec3& p) const;

  std::shared_ptr<const ObstacleDistance> obstacles_;
  Box3 bounds_;
  bool bounded_;
};

}  // namespace trellis
