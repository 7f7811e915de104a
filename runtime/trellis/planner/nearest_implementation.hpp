// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <trellis/planner/nearest.hpp>

namespace trellis {

/// What an index of one kind of space does; see NearestIndex.
class NearestIndex::Implementation {
 public:
  Implementation() = default;
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  virtual ~Implementation() = default;
  virtual std::uint32_t add(View q) = 0;
  /// \param ids  for each point its new id, in ascending order, or `removed`
  /// \param kept  number of points that stay
  virtual void renumber(const std::vector<std::uint32_t>& ids, std::size_t kept) = 0;
  static constexpr std::uint32_t removed = std::numeric_limits<std::uint32_t>::max();
  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual Neighbour nearest(View q) const = 0;
  virtual void k_nearest(View q, std::size_t k, std::vector<Neighbour>& out) const = 0;
  virtual void within(View q, double radius, std::vector<Neighbour>& out) const = 0;
};

/// The order of neighbours: by distance, then by id. A function object, so that the heap functions inline it.
struct NearerNeighbour {
  bool operator()(const NearestIndex::Neighbour& a, const NearestIndex::Neighbour& b) const {
    return a.squared_distance < b.squared_distance || (a.squared_distance == b.squared_distance && a.id < b.id);
  }
};

/// Adds a candidate to the k nearest so far, a heap with the farthest of them first.
inline void offer_nearest(std::vector<NearestIndex::Neighbour>& nearest, std::size_t k,
                          const NearestIndex::Neighbour& candidate) {
  constexpr NearerNeighbour nearer;
  if (nearest.size() < k) {
    nearest.push_back(candidate);
    std::push_heap(nearest.begin(), nearest.end(), nearer);
  } else if (nearer(candidate, nearest.front())) {
    std::pop_heap(nearest.begin(), nearest.end(), nearer);
    nearest.back() = candidate;
    std::push_heap(nearest.begin(), nearest.end(), nearer);
  }
}

/// The index of a space with rotations.
std::unique_ptr<NearestIndex::Implementation> make_rotation_index(const Space& space);

}  // namespace trellis
