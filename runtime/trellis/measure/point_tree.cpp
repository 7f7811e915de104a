// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/point_tree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include <trellis/base/clones.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/measure/vantage_tree.hpp>

namespace trellis::measure {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// A balanced tree over 2^32 points is not deeper than this, with one pending entry per level.
constexpr std::size_t deepest = 64;
// Coordinate of the unused entries of a leaf. Its squared distance to any point is infinite, and never NaN.
constexpr double nowhere = 1e300;

// A vector of four numbers. Explicit, because the compiler does not vectorise the loop over a leaf well.
using Four [[gnu::vector_size(4 * sizeof(double))]] = double;
constexpr std::size_t width = 4;

}  // namespace

PointTree::PointTree(const Frame& frame, std::span<const double> rows) : dimension_(frame.dimension()) {
  size_ = dimension_ == 0 ? 0 : rows.size() / dimension_;
  if (!frame.flat()) {
    vantage_ = std::make_shared<const VantageTree>(frame.space(), rows);
    return;
  }
  for (std::size_t j = 0; j < dimension_; ++j) period_.push_back(frame.period(j));
  if (size_ == 0) return;
  std::vector<std::uint32_t> ids(size_);
  std::iota(ids.begin(), ids.end(), 0U);
  const std::size_t leaves = 2 * (size_ / block + 1);
  nodes_.reserve(2 * leaves);
  boxes_.reserve(4 * leaves * dimension_);
  blocks_.reserve(leaves * block * dimension_);
  build(rows, ids);
}

std::uint32_t PointTree::build(std::span<const double> rows, std::span<std::uint32_t> ids) {
  poll();
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({static_cast<std::uint32_t>(ids.size()), 0, 0});
  std::size_t widest = 0;
  double width = -1.0;
  for (std::size_t j = 0; j < dimension_; ++j) {
    double lo = infinity;
    double hi = -infinity;
    for (const std::uint32_t i : ids) {
      const double y = rows[i * dimension_ + j];
      lo = std::min(lo, y);
      hi = std::max(hi, y);
    }
    boxes_.push_back(lo);
    boxes_.push_back(hi);
    if (hi - lo > width) {
      width = hi - lo;
      widest = j;
    }
  }
  if (ids.size() <= block) {
    nodes_[node].leaf = static_cast<std::uint32_t>(blocks_.size() / (block * dimension_));
    for (std::size_t j = 0; j < dimension_; ++j) {
      for (std::size_t i = 0; i < block; ++i) {
        blocks_.push_back(i < ids.size() ? rows[ids[i] * dimension_ + j] : nowhere);
      }
    }
    return node;
  }
  // The first side gets whole leaves: all leaves but the last are then full or nearly so.
  const std::size_t half = (ids.size() / 2 + block - 1) / block * block;
  const std::size_t middle = half < ids.size() ? half : ids.size() / 2;
  std::nth_element(
      ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(middle), ids.end(),
      [&](std::uint32_t a, std::uint32_t b) { return rows[a * dimension_ + widest] < rows[b * dimension_ + widest]; });
  build(rows, ids.first(middle));
  const std::uint32_t second = build(rows, ids.subspan(middle));
  nodes_[node].second = second;
  return node;
}

// The bounds below use the same operations in the same order as the distances in scan(), and rounding is monotone, so a
// bound never excludes a point that a linear search would count.

template <std::size_t D>
TRELLIS_ALONG double PointTree::least(std::uint32_t node, const double* y) const {
  const std::size_t dimension = D > 0 ? D : dimension_;
  const double* box = &boxes_[2 * dimension * node];
  double sum = 0.0;
  for (std::size_t j = 0; j < dimension; ++j) {
    const double below = box[2 * j] - y[j];
    const double above = y[j] - box[2 * j + 1];
    const double outside = std::max(below, above);
    // Outside of the box, the nearest point on an axis is one of its ends, in one direction or the other.
    const double other = period_[j] - std::max(std::abs(below), std::abs(above));
    const double u = std::max(0.0, std::min(outside, other));
    sum += u * u;
  }
  return sum;
}

template <std::size_t D>
TRELLIS_ALONG double PointTree::greatest(std::uint32_t node, const double* y) const {
  const std::size_t dimension = D > 0 ? D : dimension_;
  const double* box = &boxes_[2 * dimension * node];
  double sum = 0.0;
  for (std::size_t j = 0; j < dimension; ++j) {
    const double a = box[2 * j] - y[j];
    const double b = box[2 * j + 1] - y[j];
    const double half = 0.5 * period_[j];
    const bool across = (a <= half && b >= half) || (a <= -half && b >= -half);
    const double ends = std::max(std::min(std::abs(a), period_[j] - std::abs(a)),  //
                                 std::min(std::abs(b), period_[j] - std::abs(b)));
    const double u = across ? half : ends;
    sum += u * u;
  }
  return sum;
}

template <std::size_t D>
TRELLIS_ALONG const double* PointTree::leaf_of(std::uint32_t node) const {
  return &blocks_[block * (D > 0 ? D : dimension_) * nodes_[node].leaf];
}

/// Computes the squared distances from y to four entries of a leaf.
template <std::size_t D>
TRELLIS_ALONG void PointTree::scan(const double* data, const double* y, void* squared) const {
  const std::size_t dimension = D > 0 ? D : dimension_;
  Four sum{};
  for (std::size_t j = 0; j < dimension; ++j, data += block) {
    Four at;
    std::memcpy(&at, data, sizeof at);
    const Four offset = at - y[j];
    const Four u = offset < 0.0 ? -offset : offset;
    const Four v = period_[j] - u;
    const Four w = v < u ? v : u;
    sum += w * w;
  }
  std::memcpy(squared, &sum, sizeof sum);
}

template <std::size_t D>
TRELLIS_ALONG void PointTree::find_nearest(const double* y, std::span<double> squared) const {
  std::fill(squared.begin(), squared.end(), infinity);
  if (size_ == 0 || squared.empty()) return;
  struct Waiting {
    std::uint32_t node;
    double bound;
  };
  std::array<Waiting, deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 0.0};
  double& worst = squared.back();
  while (depth > 0) {
    const Waiting top = stack[--depth];
    if (top.bound >= worst) continue;
    std::uint32_t node = top.node;
    while (nodes_[node].second != 0) {
      const std::uint32_t first = node + 1;
      const std::uint32_t second = nodes_[node].second;
      const double to_first = least<D>(first, y);
      const double to_second = least<D>(second, y);
      const bool swap = to_second < to_first;
      const double far = swap ? to_first : to_second;
      if (far < worst) stack[depth++] = {swap ? first : second, far};
      node = swap ? second : first;
    }
    const double* data = leaf_of<D>(node);
    for (std::size_t begin = 0; begin < block; begin += width) {
      Four distances;
      scan<D>(data + begin, y, &distances);
      const auto closer = distances < worst;
      if ((closer[0] | closer[1] | closer[2] | closer[3]) == 0) continue;
      for (std::size_t place = 0; place < width; ++place) {
        const double d = distances[place];
        if (!(d < worst)) continue;
        std::size_t i = squared.size() - 1;
        for (; i > 0 && squared[i - 1] > d; --i) squared[i] = squared[i - 1];
        squared[i] = d;
      }
    }
  }
}

template <std::size_t D>
TRELLIS_ALONG std::size_t PointTree::count(const double* y, double squared) const {
  if (size_ == 0 || least<D>(0, y) > squared) return 0;
  std::array<std::uint32_t, deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  decltype(Four{} <= Four{}) within{};
  std::size_t found = 0;
  while (depth > 0) {
    const std::uint32_t node = stack[--depth];
    if (nodes_[node].second == 0) {
      const double* data = leaf_of<D>(node);
      for (std::size_t begin = 0; begin < block; begin += width) {
        Four distances;
        scan<D>(data + begin, y, &distances);
        within -= distances <= squared;  // true is -1
      }
    } else if (greatest<D>(node, y) <= squared) {
      found += nodes_[node].count;
    } else {
      for (const std::uint32_t child : {node + 1, nodes_[node].second}) {
        if (least<D>(child, y) <= squared) stack[depth++] = child;
      }
    }
  }
  return found + static_cast<std::size_t>(within[0] + within[1] + within[2] + within[3]);
}

TRELLIS_CLONES void PointTree::nearest(View y, std::span<double> squared) const {
  if (vantage_) return vantage_->nearest(y, squared);
  switch (dimension_) {
    case 2: return find_nearest<2>(y.data(), squared);
    case 3: return find_nearest<3>(y.data(), squared);
    default: return find_nearest<0>(y.data(), squared);
  }
}

TRELLIS_CLONES std::size_t PointTree::count_within(View y, double squared) const {
  if (vantage_) return vantage_->count_within(y, squared);
  switch (dimension_) {
    case 2: return count<2>(y.data(), squared);
    case 3: return count<3>(y.data(), squared);
    default: return count<0>(y.data(), squared);
  }
}

void PointTree::leaves_within(View y, double squared, std::vector<Leaf>& leaves) const {
  if (vantage_) throw Fault("the leaves of a tree of a space with rotations");
  leaves.clear();
  if (size_ == 0) return;
  std::array<std::uint32_t, deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t node = stack[--depth];
    const double nearest = least<0>(node, y.data());
    if (nearest > squared) continue;
    if (nodes_[node].second == 0) {
      leaves.push_back({&blocks_[block * dimension_ * nodes_[node].leaf], &boxes_[2 * dimension_ * node],
                        nodes_[node].count, nearest});
    } else {
      stack[depth++] = nodes_[node].second;
      stack[depth++] = node + 1;
    }
  }
}

}  // namespace trellis::measure
