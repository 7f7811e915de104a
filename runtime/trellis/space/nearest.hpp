// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Exact nearest neighbours in a space's metric, with circles and rotations. Ties go to the point that was added first,
/// so results do not depend on the internal structure. A kd-tree of buckets with tight bounding boxes, which grows
/// point by point or is built of all points at once.
class NearestIndex {
 public:
  struct Neighbour {
    std::uint32_t id = 0;
    double squared_distance = 0.0;
  };

  explicit NearestIndex(const Space& space);
  /// An index of these points, row by row, whose ids are the numbers of the rows.
  NearestIndex(const Space& space, std::span<const double> rows);
  ~NearestIndex();
  NearestIndex(NearestIndex&&) noexcept;
  NearestIndex& operator=(NearestIndex&&) noexcept;

  /// Adds a point. Its id is the number of points before it.
  std::uint32_t add(View q);
  /// Removes points, in time linear in the number of all points. The others keep their order: the id of a point is then
  /// the number of points before it that were kept.
  /// \param keep  for each point, whether it stays
  void retain(const std::vector<std::uint8_t>& keep);
  [[nodiscard]] std::size_t size() const;
  /// The nearest point. Requires size() > 0.
  [[nodiscard]] Neighbour nearest(View q) const;
  /// The squared distance of a point of the index from q, as `nearest` has it, to the bit.
  [[nodiscard]] double squared_distance(View point, View q) const;
  /// The k nearest points, nearest first; all points if there are fewer than k.
  void k_nearest(View q, std::size_t k, std::vector<Neighbour>& out) const;
  /// All points within `radius` (closed ball), in order of id.
  void within(View q, double radius, std::vector<Neighbour>& out) const;
  /// Computes the squared distances of the nearest points, ascending; as many as `squared` has entries, infinity beyond
  /// the last point.
  void nearest_distances(View q, std::span<double> squared) const;
  /// Returns the number of points at a squared distance of at most `squared`, which is finite.
  [[nodiscard]] std::size_t count_within(View q, double squared) const;

  class Implementation;

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace trellis
