// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/collision/spatial/turn.hpp>
#include <trellis/scene/spatial/distance_field.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/spatial/sphere_cover.hpp>

namespace trellis {

/// Decides from balls and a distance field where a robot of space certainly is free of obstacles, and where it
/// certainly meets one. It says nothing about the world's boundary.
class NearFilter {
 public:
  enum class Verdict : std::uint8_t { free, meets, unknown };
  struct Answer {
    Verdict verdict = Verdict::unknown;
    double clearance = 0.0;  ///< of a free pose: all obstacles are at least that far from the robot, in metres
  };

  /// Whether it saves time: FCL's checks of boxes and spheres alone take less than the filter does.
  [[nodiscard]] static bool pays(const SpatialScene& scene);

  /// \param slack  the gap below which bodies count as touching
  NearFilter(const SpatialScene& scene, double slack);

  /// \param enough  the search for a larger clearance ends at this one
  [[nodiscard]] Answer decide(const Turn& turn, double enough) const;
  /// Returns the distance, in metres, below which FCL decides.
  [[nodiscard]] double margin() const { return margin_; }

 private:
  struct Node {
    Vec3 centre;  ///< in the robot's frame
    double outer = 0.0;
    double inner = 0.0;
    const DistanceField* field = nullptr;   ///< as fine as the ball's size needs
    const DistanceField* coarse = nullptr;  ///< a coarser one
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  std::shared_ptr<const DistanceFields> fields_;
  double margin_ = 0.0;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> roots_;

  // Scratch.
  mutable std::vector<std::uint32_t> waiting_;
  mutable std::uint32_t last_met_ = 0;   ///< the ball that met an obstacle last
  mutable std::uint32_t last_near_ = 0;  ///< the leaf that was too near to one last
};

}  // namespace trellis
