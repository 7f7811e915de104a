// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <trellis/space/space.hpp>

namespace trellis::measure {

/// A vantage-point tree over configurations: exact nearest neighbours and exact counts in balls in any space, by its
/// metric and the triangle inequality alone. Source: Yianilos, Data structures and algorithms for nearest neighbor
/// search in general metric spaces, 1993.
class VantageTree {
 public:
  /// \param rows  configurations, row by row
  VantageTree(const Space& space, std::span<const double> rows);

  /// Computes the squared distances to the nearest points, ascending; as many as `squared` has entries, infinity beyond
  /// the last point.
  void nearest(View y, std::span<double> squared) const;
  /// Returns the number of points at a squared distance of at most `squared`.
  [[nodiscard]] std::size_t count_within(View y, double squared) const;

 private:
  /// Points begin .. end - 1: the vantage point, those within `inner` of it, then the others. A leaf has no children.
  struct Node {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t middle = 0;  ///< the first of the others; 0 for a leaf
    double inner = 0.0;
    double outer = 0.0;        ///< largest distance from the vantage point
    std::uint32_t second = 0;  ///< the node of the others; that of the near ones follows its parent
  };

  std::uint32_t build(std::span<const double> rows, std::span<std::uint32_t> ids, std::size_t begin);
  [[nodiscard]] View row(std::size_t i) const { return View(rows_).subspan(i * dimension_, dimension_); }
  void find(std::uint32_t node, View y, std::span<double> squared) const;
  [[nodiscard]] std::size_t count(std::uint32_t node, View y, double squared) const;

  Space space_;
  std::size_t dimension_;
  double slack_;              ///< above the rounding of distances
  std::vector<double> rows_;  ///< in the order of the nodes
  std::vector<Node> nodes_;
};

}  // namespace trellis::measure
