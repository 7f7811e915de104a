// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <trellis/collision/planar/distance.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/scene/planar/planar_box_tree.hpp>

namespace trellis {

/// Finds the boxes that overlap a box. The index of few boxes divides each axis into slabs. For each slab, two rows of
/// bits mark the boxes that end in it or beyond, and those that begin in it or before. A query intersects four rows: it
/// returns the boxes of the cells of a uniform grid, without duplicates and in the boxes' order. Many boxes are in a
/// tree, since a query would read a row of bits from end to end.
class PartIndex {
 public:
  PartIndex() = default;
  explicit PartIndex(std::vector<kernel::Box> boxes);

  [[nodiscard]] std::size_t size() const { return boxes_.size(); }
  /// Writes the indices of the boxes that overlap `box`, ascending, to `out` (size() entries); returns their number.
  unsigned query(const kernel::Box& box, unsigned* out) const;

  /// Calls `visit(i)` for every box whose distance from `box` may be at most `at_most`, nearer ones first; `visit`
  /// lowers `at_most`.
  template <class Visit>
  void nearest(const Box2& box, const double& at_most, const Visit& visit) const {
    double best = above(at_most);
    tree_.nearest(
        best, [&](const Box2& other) { return box_distance(box, other); },
        [&](std::size_t rank) {
          visit(tree_.order()[rank]);
          best = above(at_most);
        });
  }

 private:
  struct Axis {
    double lo = 0.0;
    double per_metre = 0.0;
    std::vector<std::uint64_t> reach;   ///< slab * words_ + word: boxes whose upper end lies in the slab or beyond
    std::vector<std::uint64_t> begins;  ///< boxes whose lower end lies in the slab or before
  };

  /// The least number above x.
  static double above(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }
  void sort(unsigned* indices, unsigned count) const;
  [[nodiscard]] std::size_t slab(const Axis& axis, double x) const;
  void build(Axis& axis, double kernel::Box::*lo, double kernel::Box::*hi);

  std::vector<kernel::Box> boxes_;
  PlanarBoxTree tree_;
  std::size_t slabs_ = 0;
  std::size_t words_ = 0;  ///< of a row; 0: the tree answers queries
  Axis x_;
  Axis y_;
};

}  // namespace trellis
