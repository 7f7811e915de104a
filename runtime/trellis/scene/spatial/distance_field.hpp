// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// The signed distance of obstacles (see ObstacleDistance) at the centres of a regular grid of cubic voxels, and bounds
/// between the centres. A voxel's value is computed when it is first used; threads share the field.
class DistanceField {
 public:
  /// The largest number of voxels of a field, which takes 4 bytes of memory for each that is used.
  static constexpr std::size_t most_voxels = std::size_t{1} << 24U;

  /// Makes a field without values. The centres of the outermost voxels lie on the region's sides or beyond them.
  /// \param spacing  between centres, in metres; the field has a larger one where most_voxels would be exceeded
  DistanceField(std::shared_ptr<const ObstacleDistance> distance, const Box3& region, double spacing);

  [[nodiscard]] const ObstacleDistance& distance() const { return *distance_; }
  /// Returns the distance between neighbouring centres in metres.
  [[nodiscard]] double spacing() const { return spacing_; }
  /// Returns the centre of voxel (0, 0, 0).
  [[nodiscard]] const Vec3& origin() const { return origin_; }
  /// Returns the numbers of voxels along x, y and z.
  [[nodiscard]] const std::array<std::size_t, 3>& counts() const { return counts_; }
  [[nodiscard]] std::size_t size() const { return counts_[0] * counts_[1] * counts_[2]; }

  /// Returns the index of voxel (i, j, k); i varies fastest.
  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * counts_[1] + j) * counts_[0] + i;
  }
  /// Returns i, j and k of a voxel.
  [[nodiscard]] std::array<std::size_t, 3> place(std::size_t index) const {
    return {index % counts_[0], index / counts_[0] % counts_[1], index / (counts_[0] * counts_[1])};
  }
  [[nodiscard]] Vec3 centre(std::size_t i, std::size_t j, std::size_t k) const {
    return {origin_.x + spacing_ * static_cast<double>(i), origin_.y + spacing_ * static_cast<double>(j),
            origin_.z + spacing_ * static_cast<double>(k)};
  }
  [[nodiscard]] Vec3 centre(std::size_t index) const {
    const auto [i, j, k] = place(index);
    return centre(i, j, k);
  }
  /// Returns the voxel whose centre is nearest to p.
  [[nodiscard]] std::size_t nearest(const Vec3& p) const {
    return index(along(p.x, origin_.x, counts_[0]), along(p.y, origin_.y, counts_[1]),
                 along(p.z, origin_.z, counts_[2]));
  }

  /// Returns the signed distance at a voxel's centre, rounded to a float: to 24 bits. Without obstacles it is the
  /// largest float.
  [[nodiscard]] double value(std::size_t index) const {
    const float known = std::atomic_ref<float>(values_.get()[index]).load(std::memory_order_relaxed);
    return known != 0.0F ? known : compute(index);
  }
  /// Computes the values of all voxels that have none yet.
  void fill() const;

  /// Returns a number that the signed distance of p is not below. Near the field's region it is below it by at most
  /// sqrt(3) times the spacing.
  [[nodiscard]] double lower_bound(const Vec3& p) const { return bounds(p).lower; }
  /// Returns a number that the signed distance of p is not above; where it is negative, p lies at least that deep
  /// inside obstacles.
  [[nodiscard]] double upper_bound(const Vec3& p) const { return bounds(p).upper; }
  /// Both bounds.
  struct Bounds {
    double lower = 0.0;
    double upper = 0.0;
  };
  [[nodiscard]] Bounds bounds(const Vec3& p) const {
    const std::size_t i = along(p.x, origin_.x, counts_[0]), j = along(p.y, origin_.y, counts_[1]),
                      k = along(p.z, origin_.z, counts_[2]);
    const double here = value(index(i, j, k));
    const Vec3 from = p - centre(i, j, k);
    const double away = std::sqrt(from.x * from.x + from.y * from.y + from.z * from.z);
    // The values are floats.
    const double slack = rounding_ + 0x1p-22 * (std::abs(here) + away);
    if (away > spacing_) return beyond(p, here, away, slack);
    return {here - away - slack, here + away + slack};
  }

  /// Returns the unit vector along which the signed distance of p grows fastest, exactly, not from the grid: away from
  /// the nearest obstacle or out of it; 0 on a surface and without obstacles.
  [[nodiscard]] Vec3 gradient(const Vec3& p) const;

 private:
  struct Release {
    void operator()(float* values) const;
  };

  /// The nearest of the voxels along an axis.
  [[nodiscard]] std::size_t along(double x, double from, std::size_t count) const {
    const double at = (x - from) * per_metre_ + 0.5;
    // Also 0 where x is not a number.
    if (!(at > 0.0)) return 0;
    return at < static_cast<double>(count) ? static_cast<std::size_t>(at) : count - 1;
  }
  [[nodiscard]] double compute(std::size_t index) const;
  /// The bounds at a point outside the grid.
  [[nodiscard]] Bounds beyond(const Vec3& p, double here, double away, double slack) const;

  std::shared_ptr<const ObstacleDistance> distance_;
  Box3 obstacles_;  ///< the box of all obstacles
  double spacing_ = 0.0;
  double per_metre_ = 0.0;  ///< 1 / spacing
  Vec3 origin_;
  std::array<std::size_t, 3> counts_{};
  double rounding_ = 0.0;                   ///< what the bounds leave for rounding, in metres
  std::unique_ptr<float, Release> values_;  ///< 0 where it was not computed
};

/// The distance fields of a world: the same region at several spacings, each twice the one before. World3::distances
/// makes them once per world, without values.
class DistanceFields {
 public:
  explicit DistanceFields(const World3& world);

  [[nodiscard]] const std::shared_ptr<const ObstacleDistance>& distance() const { return distance_; }
  /// Returns the field of level 0, the finest, or a coarser one.
  [[nodiscard]] const DistanceField& level(std::size_t i) const { return levels_[i]; }
  [[nodiscard]] std::size_t size() const { return levels_.size(); }
  /// Returns the level with the greatest spacing of at most this many metres; 0 where none is as fine.
  [[nodiscard]] std::size_t level_of(double spacing) const;

 private:
  std::shared_ptr<const ObstacleDistance> distance_;
  std::vector<DistanceField> levels_;
};

}  // namespace trellis
