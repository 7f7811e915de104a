// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include <trellis/scene/cells.hpp>
#include <trellis/scene/planar/triangulation.hpp>

namespace trellis {

/// The triangles of a planar world's free space.
class TriangleCells final : public Cells {
 public:
  explicit TriangleCells(Triangulation triangulation);

  [[nodiscard]] std::size_t size() const override { return triangulation_.triangles().size(); }
  [[nodiscard]] double volume(std::uint32_t cell) const override { return triangulation_.triangles()[cell].area; }
  [[nodiscard]] double volume() const override { return triangulation_.area(); }
  [[nodiscard]] double importance(std::uint32_t cell) const override {
    return std::min(volume(cell), largest_) / mean_;
  }
  void centre(std::uint32_t cell, MutableView out) const override;
  [[nodiscard]] const std::vector<Neighbour>& neighbours(std::uint32_t cell) const override {
    return neighbours_[cell];
  }
  [[nodiscard]] std::optional<std::uint32_t> find(View p) const override { return triangulation_.find({p[0], p[1]}); }
  void sample(std::uint32_t cell, Stream& stream, MutableView out) const override;

 private:
  Triangulation triangulation_;
  double largest_;  ///< area that counts: larger triangles are farther from obstacles
  double mean_ = 0.0;
  std::vector<std::vector<Neighbour>> neighbours_;  ///< in the order of the opposite corners
};

}  // namespace trellis
