// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace trellis {

/// The vertices that a search has not expanded, by cost from the start, then by id. Costs are not negative. The order
/// is total, so that no other queue returns them differently. A heap of four children each: half the levels of a binary
/// one, and children beside each other in memory.
class VertexQueue {
 public:
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  void clear() { heap_.clear(); }
  void push(double cost, std::uint32_t vertex) {
    heap_.emplace_back();
    rise(heap_.size() - 1, key(cost, vertex));
  }
  /// Removes the first vertex. Returns it and its cost.
  std::pair<double, std::uint32_t> pop() {
    const Key first = heap_.front();
    const Key last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) {
      // The last one belongs near the leaves: the hole sinks to a leaf, and the last one rises from there.
      const std::size_t size = heap_.size();
      std::size_t hole = 0;
      for (std::size_t child = 1; child < size; child = children * hole + 1) {
        std::size_t least = child;
        if (child + children <= size) {
          const std::size_t left = lesser(child, child + 1);
          const std::size_t right = lesser(child + 2, child + 3);
          least = lesser(left, right);
        } else {
          while (++child < size) least = lesser(least, child);
        }
        heap_[hole] = heap_[least];
        hole = least;
      }
      rise(hole, last);
    }
    return {std::bit_cast<double>(static_cast<std::uint64_t>(first >> 64U)), static_cast<std::uint32_t>(first)};
  }

 private:
  // As numbers, costs that are not negative have the order of their bits.
  __extension__ using Key = unsigned __int128;
  static constexpr std::size_t children = 4;

  static Key key(double cost, std::uint32_t vertex) { return Key{std::bit_cast<std::uint64_t>(cost)} << 64U | vertex; }
  [[nodiscard]] std::size_t lesser(std::size_t a, std::size_t b) const { return heap_[b] < heap_[a] ? b : a; }
  void rise(std::size_t hole, Key key) {
    while (hole > 0) {
      const std::size_t parent = (hole - 1) / children;
      if (heap_[parent] <= key) break;
      heap_[hole] = heap_[parent];
      hole = parent;
    }
    heap_[hole] = key;
  }

  std::vector<Key> heap_;
};

}  // namespace trellis
