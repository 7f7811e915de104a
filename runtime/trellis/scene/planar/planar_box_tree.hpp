// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>
#include <trellis/scene/spatial/box_tree.hpp>

namespace trellis {

/// A BoxTree of boxes of the plane: those of the tree have z = 0.
class PlanarBoxTree {
 public:
  PlanarBoxTree() = default;
  explicit PlanarBoxTree(const std::vector<Box2>& boxes) {
    std::vector<Box3> flat;
    flat.reserve(boxes.size());
    for (const Box2& box : boxes) flat.push_back({{box.lo.x, box.lo.y, 0.0}, {box.hi.x, box.hi.y, 0.0}});
    tree_ = BoxTree(flat);
  }

  /// As BoxTree has it.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return tree_.order(); }

  /// As BoxTree::nearest. \param bound  of a Box2
  template <class Bound, class Visit>
  void nearest(const double& best, const Bound& bound, const Visit& visit) const {
    tree_.nearest(
        best, [&](const Box3& box) { return bound(flat(box)); }, visit);
  }
  /// As BoxTree::each. \param meets  of a Box2
  template <class Meets, class Visit>
  void each(const Meets& meets, const Visit& visit) const {
    tree_.each([&](const Box3& box) { return meets(flat(box)); }, visit);
  }

 private:
  static Box2 flat(const Box3& box) { return {{box.lo.x, box.lo.y}, {box.hi.x, box.hi.y}}; }

  BoxTree tree_;
};

/// Whether two closed boxes have a common point.
inline bool boxes_meet(const Box2& a, const Box2& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y;
}

}  // namespace trellis
