// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <trellis/scene/spatial/mesh.hpp>

namespace trellis {

/// A binary tree of boxes over items 0..n-1, for searches that leave most items out. The same boxes make the same tree.
class BoxTree {
 public:
  BoxTree() = default;
  /// \param boxes  of the items
  explicit BoxTree(const std::vector<Box3>& boxes);

  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  /// Returns the items in the tree's order: those of a node follow each other.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return items_; }
  /// Returns the box of all items. Requires one item at least.
  [[nodiscard]] const Box3& bounds() const { return nodes_.front().box; }

  /// Calls `visit(rank)` for every item that may be nearer than `best`, nearer boxes first; `visit` lowers `best`.
  /// The item is order()[rank].
  /// \param bound  of a box: a number that no item in it is below, in the unit of `best`
  template <class Bound, class Visit>
  void nearest(const double& best, const Bound& bound, const Visit& visit) const {
    if (nodes_.empty() || !(bound(nodes_.front().box) < best)) return;
    std::array<std::uint32_t, depth_limit> waiting;
    std::array<double, depth_limit> bounds;
    std::size_t size = 0;
    std::uint32_t at = 0;
    for (;;) {
      const Node& node = nodes_[at];
      if (node.count > 0) {
        for (std::uint32_t i = 0; i < node.count; ++i) visit(node.second + i);
      } else {
        std::uint32_t near = at + 1, far = node.second;
        double to_near = bound(nodes_[near].box), to_far = bound(nodes_[far].box);
        if (to_far < to_near) {
          std::swap(near, far);
          std::swap(to_near, to_far);
        }
        if (to_far < best) {
          waiting[size] = far;
          bounds[size++] = to_far;
        }
        if (to_near < best) {
          at = near;
          continue;
        }
      }
      do {
        if (size == 0) return;
        at = waiting[--size];
      } while (!(bounds[size] < best));
    }
  }

  /// Calls `visit(item)` for every item of the leaves whose boxes fulfil `meets(box)`, as do all boxes above them.
  template <class Meets, class Visit>
  void each(const Meets& meets, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, depth_limit> waiting;
    std::size_t size = 0;
    waiting[size++] = 0;
    while (size > 0) {
      const std::uint32_t at = waiting[--size];
      const Node& node = nodes_[at];
      if (!meets(node.box)) continue;
      if (node.count > 0) {
        for (std::uint32_t i = 0; i < node.count; ++i) visit(items_[node.second + i]);
      } else {
        waiting[size++] = node.second;
        waiting[size++] = at + 1;
      }
    }
  }

  /// Calls `visit(rank, other_rank)` for every pair of items of leaves of this tree and another one whose boxes fulfil
  /// `meets(box, other_box)`, as do boxes above them; until `visit` returns false. The items are order()[rank].
  template <class Meets, class Visit>
  void each_pair(const BoxTree& other, const Meets& meets, const Visit& visit) const {
    if (nodes_.empty() || other.nodes_.empty()) return;
    std::array<std::pair<std::uint32_t, std::uint32_t>, 2 * depth_limit> waiting;
    std::size_t size = 0;
    waiting[size++] = {0, 0};
    while (size > 0) {
      const auto [a, b] = waiting[--size];
      const Node &mine = nodes_[a], &others = other.nodes_[b];
      if (!meets(mine.box, others.box)) continue;
      if (mine.count > 0 && others.count > 0) {
        for (std::uint32_t i = 0; i < mine.count; ++i) {
          for (std::uint32_t j = 0; j < others.count; ++j) {
            if (!visit(mine.second + i, others.second + j)) return;
          }
        }
      } else if (others.count > 0 || (mine.count == 0 && size_of(mine) > size_of(others))) {
        waiting[size++] = {mine.second, b};
        waiting[size++] = {a + 1, b};
      } else {
        waiting[size++] = {a, others.second};
        waiting[size++] = {a, b + 1};
      }
    }
  }

 private:
  /// An inner node's first child follows it.
  struct Node {
    Box3 box;
    std::uint32_t second = 0;  ///< the second child, or of a leaf the first item
    std::uint32_t count = 0;   ///< of items; 0 of an inner node
  };
  /// Items are halved, so that this depth suffices for 2^32 of them.
  static constexpr std::size_t depth_limit = 64;

  /// A measure by which of two nodes the larger one is divided.
  [[nodiscard]] static double size_of(const Node& node) {
    const Vec3 extent = node.box.hi - node.box.lo;
    return extent.x + extent.y + extent.z;
  }

  void build(const std::vector<Box3>& boxes, std::size_t first, std::size_t last);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

}  // namespace trellis
