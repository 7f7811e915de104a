// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace trellis {

/// The vertices of a roadmap that are connected to each other, to the start, and to a goal, by checked motions. A
/// disjoint-set forest; each union lists the vertices that it newly connects.
class Connectivity {
 public:
  static constexpr std::uint8_t to_start = 1;
  static constexpr std::uint8_t to_goal = 2;

  struct Joined {
    std::uint32_t vertex = 0;
    std::uint8_t side = 0;  ///< to_start or to_goal
  };

  /// Adds a vertex. Its id is the number of vertices before it.
  /// \param sides  to_start for the start, to_goal for a goal, else 0
  void add_vertex(std::uint8_t sides) {
    const auto id = static_cast<std::uint32_t>(parents_.size());
    parents_.push_back(id);
    next_.push_back(id);
    sizes_.push_back(1);
    sides_.push_back(sides);
  }
  /// Connects two vertices. Appends to `joined` each vertex that this connects to one more side.
  void join(std::uint32_t a, std::uint32_t b, std::vector<Joined>& joined) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    const auto all = static_cast<std::uint8_t>(sides_[a] | sides_[b]);
    for (const std::uint32_t set : {a, b}) {
      for (const std::uint8_t side : {to_start, to_goal}) {
        if ((all & side) == 0 || (sides_[set] & side) != 0) continue;
        std::uint32_t at = set;
        do {
          joined.push_back({at, side});
          at = next_[at];
        } while (at != set);
      }
    }
    if (sizes_[a] < sizes_[b]) std::swap(a, b);
    parents_[b] = a;
    sizes_[a] += sizes_[b];
    sides_[a] = all;
    std::swap(next_[a], next_[b]);
  }
  /// Whether two vertices are connected.
  [[nodiscard]] bool same(std::uint32_t a, std::uint32_t b) { return root(a) == root(b); }
  /// Equal for two vertices if they are connected. Changes nothing, so that several threads may call it.
  [[nodiscard]] std::uint32_t component(std::uint32_t vertex) const {
    while (parents_[vertex] != vertex) vertex = parents_[vertex];
    return vertex;
  }
  [[nodiscard]] bool connected(std::uint32_t vertex, std::uint8_t side) { return (sides_[root(vertex)] & side) != 0; }

 private:
  std::uint32_t root(std::uint32_t vertex) {
    while (parents_[vertex] != vertex) {
      parents_[vertex] = parents_[parents_[vertex]];
      vertex = parents_[vertex];
    }
    return vertex;
  }

  std::vector<std::uint32_t> parents_;
  std::vector<std::uint32_t> next_;   ///< next member of the set; the members form a ring
  std::vector<std::uint32_t> sizes_;  ///< number of members; valid at the set's root
  std::vector<std::uint8_t> sides_;   ///< sides that the set is connected to; valid at its root
};

}  // namespace trellis
