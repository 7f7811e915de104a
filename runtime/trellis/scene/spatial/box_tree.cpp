// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/box_tree.hpp>

#include <algorithm>
#include <numeric>

#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

constexpr std::size_t leaf_size = 4;

Vec3 middle_of(const Box3& box) { return 0.5 * (box.lo + box.hi); }

}  // namespace

BoxTree::BoxTree(const std::vector<Box3>& boxes) : items_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(items_.begin(), items_.end(), 0U);
  nodes_.reserve(boxes.size());
  build(boxes, 0, boxes.size());
}

void BoxTree::build(const std::vector<Box3>& boxes, std::size_t first, std::size_t last) {
  Box3 box = boxes[items_[first]];
  Vec3 low = middle_of(box), high = low;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Box3& other = boxes[items_[i]];
    const Vec3 middle = middle_of(other);
    box = {least_of(box.lo, other.lo), greatest_of(box.hi, other.hi)};
    low = least_of(low, middle);
    high = greatest_of(high, middle);
  }
  const std::size_t at = nodes_.size();
  nodes_.push_back({box, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)});
  if (last - first <= leaf_size) return;
  const Vec3 extent = high - low;
  double Vec3::*axis = &Vec3::x;
  if (extent.y > extent.*axis) axis = &Vec3::y;
  if (extent.z > extent.*axis) axis = &Vec3::z;
  const std::size_t half = first + (last - first) / 2;
  const auto begin = items_.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(half),
                   begin + static_cast<std::ptrdiff_t>(last), [&](std::uint32_t a, std::uint32_t b) {
                     const double left = middle_of(boxes[a]).*axis, right = middle_of(boxes[b]).*axis;
                     return left != right ? left < right : a < b;
                   });
  build(boxes, first, half);
  const auto second = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, half, last);
  nodes_[at].second = second;
  nodes_[at].count = 0;
}

}  // namespace trellis
