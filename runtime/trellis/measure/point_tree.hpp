// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <trellis/measure/frame.hpp>

namespace trellis::measure {

class VantageTree;

/// A static, balanced kd-tree over points in metric coordinates: exact nearest neighbours and exact counts in balls,
/// under the wrapped metric. Results are distances and counts, so they do not depend on how ties were split. Rows of a
/// space with rotations are not metric coordinates: there the tree is a `VantageTree`.
///
/// The leaves are blocks of fixed length, one coordinate after the other, so that a scan of a leaf has no branches. The
/// wrap is min(|u|, period - |u|), which leaves an axis without a period unchanged.
class PointTree {
 public:
  /// \param rows  rows of the frame, metric coordinates within its bounds
  PointTree(const Frame& frame, std::span<const double> rows);

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Computes the squared distances to the nearest points, ascending; as many as `squared` has entries, infinity beyond
  /// the last point.
  void nearest(View y, std::span<double> squared) const;
  /// Returns the number of points at a squared distance of at most `squared`.
  [[nodiscard]] std::size_t count_within(View y, double squared) const;

  static constexpr std::size_t block = 16;  ///< the capacity of a leaf
  /// Neighbouring points: the block of coordinates of the first axis, then of the next. Unused entries are so far away
  /// that their squared distance is infinite.
  struct Leaf {
    const double* points;
    const double* box;  ///< lo and hi of each axis in turn
    std::size_t count;
    double least;  ///< lower bound of the squared distance of its points
  };
  /// Collects the leaves that may contain a point at a squared distance of at most `squared`, always in the same order.
  /// \throws Fault for a space with rotations
  void leaves_within(View y, double squared, std::vector<Leaf>& leaves) const;

 private:
  struct Node {
    std::uint32_t count = 0;
    std::uint32_t leaf = 0;    // block of a leaf
    std::uint32_t second = 0;  // the second child (the first follows its parent); 0 for a leaf
  };

  std::uint32_t build(std::span<const double> rows, std::span<std::uint32_t> ids);
  // D is the dimension where the compiler has it as a constant, else 0.
  template <std::size_t D>
  [[nodiscard]] double least(std::uint32_t node, const double* y) const;
  template <std::size_t D>
  [[nodiscard]] double greatest(std::uint32_t node, const double* y) const;
  template <std::size_t D>
  [[nodiscard]] const double* leaf_of(std::uint32_t node) const;
  template <std::size_t D>
  void scan(const double* data, const double* y, void* squared) const;
  template <std::size_t D>
  void find_nearest(const double* y, std::span<double> squared) const;
  template <std::size_t D>
  [[nodiscard]] std::size_t count(const double* y, double squared) const;

  std::size_t dimension_ = 0;
  std::size_t size_ = 0;
  std::vector<double> period_;
  std::vector<Node> nodes_;
  std::vector<double> boxes_;  // per node: lo and hi of each axis in turn
  std::vector<double> blocks_;
  std::shared_ptr<const VantageTree> vantage_;  // of a space with rotations, else null
};

}  // namespace trellis::measure
