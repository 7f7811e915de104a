// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <trellis/scene/spatial/mesh.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

/// Points that a sensor measured, each the centre of a closed ball; all balls have the same radius. Immutable; safe to
/// share between threads.
class PointCloud {
 public:
  /// The largest number of points.
  static constexpr std::size_t most_points = 5'000'000;

  /// Validates the points (finite, within `most_distant`) and the radius, and leaves repeated points out.
  /// \param points  metres, at least one and at most `most_points`
  /// \param radius  of the balls, in metres, greater than 0
  /// \param what    the cloud's name in messages
  /// \throws Error that names the point, counted from 1
  PointCloud(std::vector<Vec3> points, double radius, const std::string& what);

  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  [[nodiscard]] double radius() const { return radius_; }
  /// Returns the smallest box along the axes that contains the balls.
  [[nodiscard]] const Box3& bounds() const { return bounds_; }
  /// A hash of the points and the radius, the same in every process.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

  /// Returns a cloud of some of the points whose balls contain those of this one. A point is left out only where one
  /// that stays is at most `spacing` metres away; the radius grows by the largest such distance.
  /// \param spacing  in metres; so small that no point is left out, 0 and less too, it gives the same cloud
  [[nodiscard]] PointCloud thinned(double spacing) const;
  /// Returns the cloud scaled by `factor` > 0 about the origin.
  /// \param factor  of points and radius
  /// \throws Error for a factor that is not greater than 0, and where points or the radius would leave `most_distant`
  [[nodiscard]] PointCloud scaled(double factor) const;
  /// Returns the same points with balls of another radius, greater than 0.
  /// \param radius  in metres, at most `most_distant`
  /// \throws Error for another radius
  [[nodiscard]] PointCloud with_radius(double radius) const;

  /// Where the nearest point is.
  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< of the point, not of its ball
    std::size_t index = 0;                                      ///< of points()
  };
  /// Returns the nearest of the points that are nearer than `at_most` metres; else that distance, and no index.
  /// \param p  metres, in the frame of the points
  /// \param at_most  in metres; infinity: any distance
  [[nodiscard]] Nearest nearest(const Vec3& p, double at_most = std::numeric_limits<double>::infinity()) const;
  /// Calls `visit` with the indices of points, all that lie in the box among them, until it returns false.
  /// \param box  metres, closed, in the frame of the points
  /// \param visit  receives an index into points() and returns whether to continue
  void each_near(const Box3& box, const std::function<bool(std::size_t)>& visit) const;

 private:
  struct Index;
  PointCloud() = default;
  void add_bounds_and_hash();

  std::vector<Vec3> points_;
  double radius_ = 0.0;
  Box3 bounds_;
  std::uint64_t hash_ = 0;
  std::shared_ptr<Index> index_;  ///< of the points: copies and clouds of another radius share it
};

}  // namespace trellis
