// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/scene/planar/world.hpp>

namespace trellis {

/// A decomposition of a world's free space into triangles that share whole sides.
class Triangulation {
 public:
  struct Triangle {
    std::array<Vec2, 3> corners;  ///< counter-clockwise
    /// Across the side opposite each corner; none at an obstacle or the boundary.
    std::array<std::optional<std::uint32_t>, 3> neighbours;
    double area = 0.0;  ///< square metres

    [[nodiscard]] Vec2 centroid() const { return (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]); }
  };

  /// \param size  approximate length of the triangles' sides near obstacles, metres; it is doubled up to three times
  /// where
  ///     obstacles are four times, eight times and so on farther away than that. Circumscribed polygons replace discs
  /// \throws Error where that gives more than a million triangles.
  Triangulation(const World& world, double size);
  /// Returns how many triangles are made at most, apart from those that the corners of obstacles add.
  /// \throws Error as the constructor does
  static double at_most(const Box2& bounds, double size);

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  /// Square metres.
  [[nodiscard]] double area() const { return area_; }
  /// Approximate length of the sides of the smallest triangles, metres.
  [[nodiscard]] double size() const { return cell_; }
  /// Returns the triangle that contains p (one of them for a point on a side); none in obstacles and outside of the
  /// boundary.
  [[nodiscard]] std::optional<std::uint32_t> find(Vec2 p) const;
  /// Returns a uniform sample of a triangle.
  [[nodiscard]] Vec2 sample(std::uint32_t triangle, Stream& stream) const;

 private:
  [[nodiscard]] std::size_t bucket(double x, double lo, std::size_t n) const;

  std::vector<Triangle> triangles_;
  double area_ = 0.0;
  Box2 bounds_;
  // A grid over the world: for each cell, the triangles whose boxes overlap it.
  double cell_ = 1.0;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<std::vector<std::uint32_t>> cells_;
};

}  // namespace trellis
