// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

/// A decomposition of a world's free space into convex cells: triangles of the plane, boxes of space. Immutable.
class Cells {
 public:
  virtual ~Cells() = default;

  /// Where a cell meets another one.
  struct Neighbour {
    std::uint32_t cell = 0;
    std::array<double, 3> middle{};  ///< a point of both, about which they meet; of the plane, the last number is 0
  };

  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Square or cubic metres of a cell.
  [[nodiscard]] virtual double volume(std::uint32_t cell) const = 0;
  /// Square or cubic metres of all cells.
  [[nodiscard]] virtual double volume() const = 0;
  /// How large a cell counts where cells are compared, 1 on average: its share of the mean volume. 1 for all cells
  /// where their sizes say how near obstacles are, not how much room is left to explore.
  [[nodiscard]] virtual double importance(std::uint32_t cell) const = 0;
  /// Computes a point inside a cell.
  virtual void centre(std::uint32_t cell, MutableView out) const = 0;
  [[nodiscard]] virtual const std::vector<Neighbour>& neighbours(std::uint32_t cell) const = 0;
  /// Returns the cell that contains p, one of them where they meet; none in obstacles, outside the bounds, and where
  /// space is too narrow for a cell.
  [[nodiscard]] virtual std::optional<std::uint32_t> find(View p) const = 0;
  /// Draws a uniform point of a cell.
  virtual void sample(std::uint32_t cell, Stream& stream, MutableView out) const = 0;

 protected:
  Cells() = default;
  Cells(const Cells&) = default;
  Cells& operator=(const Cells&) = default;
};

/// Decomposes the free space of a scene's world: a constrained Delaunay triangulation, or an octree.
/// \param size  sides of triangles, about; in space the longest side of a cell, metres
/// \param needed  in space: cells are divided until points with this distance from obstacles are in one, metres; not
///     below a sixteenth of `size`, and not into more than 20,000 cells
/// Cached for the world and its copies as long as one of them exists, for the last few sizes. Thread-safe.
/// \throws Error where that gives too many cells
std::shared_ptr<const Cells> free_cells(const Scene& scene, double size, double needed);

}  // namespace trellis
