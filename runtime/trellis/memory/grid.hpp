// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis {

/// A box of the plane divided into equal cells. A cell is free where no obstacle comes into it.
class WorldGrid {
 public:
  /// \param cells  along the longer side of the box, at least 2; the shorter side has as many as keep them nearly
  /// square
  WorldGrid(const World& world, const Box2& box, std::size_t cells);

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return free_.size(); }
  [[nodiscard]] double width() const { return width_; }    ///< of a cell, metres
  [[nodiscard]] double height() const { return height_; }  ///< of a cell, metres
  [[nodiscard]] bool free(std::size_t cell) const { return free_[cell] != 0; }
  [[nodiscard]] Vec2 corner(std::size_t cell) const;  ///< the lower left one
  [[nodiscard]] Vec2 centre(std::size_t cell) const;
  /// The cell that holds a point; the nearest one for a point outside.
  [[nodiscard]] std::size_t at(Vec2 point) const;
  /// The free cell with the centre nearest to a point; none where no cell is free.
  [[nodiscard]] std::optional<std::size_t> free_near(Vec2 point) const;
  /// How far from each cell's centre the nearest obstacle's or outer cell's centre is, metres; 0 for those.
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

/// The oracle: the length of the shortest way from each free cell to `to` by steps to the eight cells around, metres;
/// infinity where there is none. A step across a corner needs both cells beside it free.
std::vector<double> ways_to(const WorldGrid& grid, std::size_t to);

/// What is known of a free cell without search, for a learner: where it lies between start and goal, and what stands
/// around it and in the way. Lengths are in shares of the distance from start to goal or of the grid's diagonal.
inline constexpr std::size_t cell_features = 21;
/// All cells' features, row by row; those of cells that are not free are zero.
std::vector<double> features(const WorldGrid& grid, Vec2 start, Vec2 goal);

}  // namespace trellis
