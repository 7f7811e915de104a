// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <trellis/scene/planar/scene.hpp>

namespace trellis {

/// A box of the plane divided into equal cells. A cell is free where no obstacle overlaps it.
class WorldGrid {
 public:
  /// \param cells  along the longer side of the box, at least 2; the number along the shorter side makes cells nearly
  ///     square
  WorldGrid(const World& world, const Box2& box, std::size_t cells);

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return free_.size(); }
  [[nodiscard]] double width() const { return width_; }    ///< of a cell, metres
  [[nodiscard]] double height() const { return height_; }  ///< of a cell, metres
  [[nodiscard]] bool free(std::size_t cell) const { return free_[cell] != 0; }
  [[nodiscard]] Vec2 corner(std::size_t cell) const;  ///< the lower left one
  [[nodiscard]] Vec2 centre(std::size_t cell) const;
  /// Returns the cell that contains a point; the nearest one for a point outside.
  [[nodiscard]] std::size_t at(Vec2 point) const;
  /// Returns the free cell with the centre nearest to a point; none where no cell is free.
  [[nodiscard]] std::optional<std::size_t> free_near(Vec2 point) const;
  /// Returns the distance from each cell's centre to the nearest centre of an obstacle's or outer cell, metres; 0 for
  /// those.
  [[nodiscard]] const std::vector<double>& clearance() const { return clearance_; }

 private:
  Box2 box_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  double width_ = 0.0;
  double height_ = 0.0;
  std::vector<char> free_;
  std::vector<double> clearance_;
};

/// The oracle: returns the length of the shortest path from each free cell to `to` by steps to the eight neighbours,
/// metres; infinity where there is none. A diagonal step requires that both cells beside it are free.
std::vector<double> path_lengths_to(const WorldGrid& grid, std::size_t to);

/// Features of a free cell that need no search, for a learner: its position relative to start and goal, and the
/// obstacles around it and between it and the goal. Lengths are shares of the distance from start to goal or of the
/// grid's diagonal.
inline constexpr std::size_t cell_features = 21;
/// Returns all cells' features, row by row; zero for cells that are not free.
std::vector<double> features(const WorldGrid& grid, Vec2 start, Vec2 goal);

}  // namespace trellis
