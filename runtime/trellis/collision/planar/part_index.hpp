// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <trellis/collision/planar/kernel.hpp>

namespace trellis {

/// Finds the boxes that overlap a box. The index divides each axis into slabs. For each slab, two rows of bits mark the
/// boxes that end in it or beyond, and those that begin in it or before. A query intersects four rows: it returns the
/// boxes of the cells of a uniform grid, without duplicates and in the boxes' order.
class PartIndex {
 public:
  PartIndex() = default;
  explicit PartIndex(std::vector<kernel::Box> boxes);

  [[nodiscard]] std::size_t size() const { return boxes_.size(); }
  /// Writes the indices of the boxes that overlap `box`, ascending, to `out` (size() entries); returns their number.
  unsigned query(const kernel::Box& box, unsigned* out) const;

 private:
  struct Axis {
    double lo = 0.0;
    double per_metre = 0.0;
    std::vector<std::uint64_t> reach;   ///< slab * words_ + word: boxes whose upper end lies in the slab or beyond
    std::vector<std::uint64_t> begins;  ///< boxes whose lower end lies in the slab or before
  };

  [[nodiscard]] std::size_t slab(const Axis& axis, double x) const;
  void build(Axis& axis, double kernel::Box::*lo, double kernel::Box::*hi);

  std::vector<kernel::Box> boxes_;
  std::size_t slabs_ = 0;
  std::size_t words_ = 0;
  Axis x_;
  Axis y_;
};

}  // namespace trellis
