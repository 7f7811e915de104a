// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
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

/// The index of a space with rotations.
std::unique_ptr<NearestIndex::Implementation> make_rotation_index(const Space& space);

}  // namespace trellis
