// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/collision/planar/kernel.hpp>
#include <trellis/scene/spatial/mesh.hpp>

namespace trellis {

/// The points of a cloud in cubic cells, as the kernels of manipulators read them: of each cell its points, and how far
/// the nearest one at least is from all of the cell.
class CloudGrid {
 public:
  /// \param points  at least one, in the world's frame
  /// \param radius  of the ball about each
  CloudGrid(const std::vector<Vec3>& points, double radius);
  CloudGrid(const CloudGrid&) = delete;
  CloudGrid& operator=(const CloudGrid&) = delete;
  CloudGrid(CloudGrid&&) = default;
  CloudGrid& operator=(CloudGrid&&) = default;
  ~CloudGrid() = default;

  [[nodiscard]] const kernel::Cloud3& data() const { return data_; }

 private:
  void choose_cells(const std::vector<Vec3>& points);
  void sort(const std::vector<Vec3>& points);
  void measure();
  [[nodiscard]] std::size_t cells() const;

  kernel::Cloud3 data_;
  std::vector<unsigned> begin_;
  std::vector<float> clear_;
  std::vector<kernel::Lanes> x_, y_, z_;
};

}  // namespace trellis
