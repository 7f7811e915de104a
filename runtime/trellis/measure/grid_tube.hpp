// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <trellis/measure/tube.hpp>

namespace trellis::measure {

/// The tube of a flat space of few axes.
///
/// A cover of small grid cells around P has two uses: quasi Monte Carlo points drawn from it mostly lie in the tube,
/// and a membership test needs only the pieces of P near the point's cell. The grid spans the first three axes of the
/// distance; each cell has bounds on the others. Waypoints within a thousandth of the radius of the line that replaces
/// them are omitted, which simplifies densely interpolated paths.
class GridTube : public Tube {
 public:
  /// The parameters of `make_tube`.
  GridTube(const Frame& frame, const Configurations& path, std::vector<std::size_t> axes, double radius);

  [[nodiscard]] bool contains(View y) const override;
  [[nodiscard]] double distance(View y) const override;
  [[nodiscard]] double length() const override { return length_; }
  [[nodiscard]] double along(View y) const override;
  [[nodiscard]] double log_cover_volume() const override;
  [[nodiscard]] std::size_t unit_dimension() const override { return frame_.dimension() + 1; }
  bool draw(View unit, MutableView y) const override;

 private:
  void add_piece(const std::vector<double>& from, const std::vector<double>& step, double piece_limit);
  void cut_path(const Space& space, const Configurations& path);
  void choose_grid();
  void fill_cells();
  void bound_rest();
  [[nodiscard]] std::size_t pieces() const { return step_square_.size(); }
  /// Returns the squared distance to a piece over the first `count` axes. `at`, if given, receives the nearest point's
  /// parameter on the piece.
  [[nodiscard]] double squared(std::size_t piece, const double* z, std::size_t count, double* at = nullptr) const;
  /// Returns the cell that contains y; none outside of the cover.
  [[nodiscard]] std::optional<std::size_t> cell_of(View y) const;
  /// Returns the first cell at which the cumulative volume exceeds a volume.
  [[nodiscard]] std::size_t cell_at(double volume) const;
  [[nodiscard]] bool near(std::size_t cell, const double* z) const;
  /// Calls look(piece) for pieces of which one is the nearest to y; z: the coordinates of y over the tube's axes.
  template <class Look>
  void look_near(View y, const double* z, Look look) const;

  // Pieces of P over the tube's axes: start and shortest difference to the end, about as long as the radius.
  std::vector<double> from_, step_;
  std::vector<double> step_square_;
  std::vector<double> begin_;  // arc length at each piece's start
  double length_ = 0.0;

  // The grid: cells per axis, their sides, and the occupied cells in the order of their keys.
  std::size_t grid_axes_ = 0;
  std::vector<std::uint64_t> cells_;
  std::vector<double> side_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> cell_of_key_;  // of all cells of the grid, where they are not too many
  std::vector<std::uint32_t> first_;        // of each cell's pieces in near_, one more than cells
  std::vector<std::uint32_t> near_;
  std::vector<char> inside_;        // the whole cell lies in the tube
  std::vector<double> rest_;        // per cell: lo and width of each axis of the tube beyond the grid
  std::vector<double> cumulative_;  // volume of the cells up to and with this one
  double cover_volume_ = 0.0;
};

}  // namespace trellis::measure
