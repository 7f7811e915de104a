// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/vantage_tree.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace trellis::measure {

namespace {

constexpr std::size_t bucket = 12;  // points of a leaf

/// Puts a squared distance among ascending ones, unless it is larger than all.
void offer(double d, std::span<double> squared) {
  if (!(d < squared.back())) return;
  std::size_t i = squared.size() - 1;
  for (; i > 0 && squared[i - 1] > d; --i) squared[i] = squared[i - 1];
  squared[i] = d;
}

/// Returns a number that the squared distance is not below, without an arc tangent: of rotations it counts the chord
/// between quaternions, 2 sin(angle / 4), twice.
double least_squared_distance(const Space& space, View a, View b) {
  double sum = 0.0;
  for (const Factor& factor : space.factors()) {
    const std::size_t j = factor.column;
    double squared = 0.0;
    if (factor.kind == Factor::Kind::rotation) {
      double same = 0.0, opposite = 0.0;
      for (std::size_t k = j; k < j + 4; ++k) {
        same += (a[k] - b[k]) * (a[k] - b[k]);
        opposite += (a[k] + b[k]) * (a[k] + b[k]);
      }
      squared = 4.0 * std::min(same, opposite);
    } else if (factor.kind == Factor::Kind::line) {
      squared = (a[j] - b[j]) * (a[j] - b[j]);
    }
    sum += factor.axis.weight * factor.axis.weight * squared;
  }
  constexpr double rounding = 1e-12;
  return (1.0 - rounding) * sum;
}

}  // namespace

VantageTree::VantageTree(const Space& space, std::span<const double> rows)
    : space_(space), dimension_(space.dimension()), slack_(1e-9 * space.diameter()) {
  const std::size_t size = rows.size() / dimension_;
  if (size == 0) return;
  std::vector<std::uint32_t> ids(size);
  std::iota(ids.begin(), ids.end(), 0U);
  build(rows, ids, 0);
  rows_.reserve(rows.size());
  for (const std::uint32_t id : ids) {
    const auto first = rows.begin() + static_cast<std::ptrdiff_t>(id * dimension_);
    rows_.insert(rows_.end(), first, first + static_cast<std::ptrdiff_t>(dimension_));
  }
}

std::uint32_t VantageTree::build(std::span<const double> rows, std::span<std::uint32_t> ids, std::size_t begin) {
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({.begin = begin, .end = begin + ids.size()});
  if (ids.size() <= bucket) return node;
  const auto at = [&](std::uint32_t id) { return View(rows).subspan(id * dimension_, dimension_); };
  std::vector<std::pair<double, std::uint32_t>> by_distance;
  by_distance.reserve(ids.size());
  for (const std::uint32_t id : ids) by_distance.emplace_back(space_.distance(at(ids.front()), at(id)), id);
  const auto first = by_distance.begin() + 1;  // after the vantage point
  const std::size_t middle = 1 + (ids.size() - 1) / 2;
  std::nth_element(first, by_distance.begin() + static_cast<std::ptrdiff_t>(middle), by_distance.end());
  nodes_[node].middle = begin + middle;
  nodes_[node].inner = by_distance[middle].first;
  nodes_[node].outer = std::max_element(first, by_distance.end())->first;
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = by_distance[i].second;
  build(rows, ids.subspan(1, middle - 1), begin + 1);
  const std::uint32_t second = build(rows, ids.subspan(middle), begin + middle);
  nodes_[node].second = second;
  return node;
}

void VantageTree::find(std::uint32_t node, View y, std::span<double> squared) const {
  const Node& here = nodes_[node];
  if (here.middle == 0) {
    for (std::size_t i = here.begin; i < here.end; ++i) {
      if (least_squared_distance(space_, y, row(i)) > squared.back()) continue;
      offer(space_.squared_distance(y, row(i)), squared);
    }
    return;
  }
  const double own = space_.squared_distance(y, row(here.begin));
  offer(own, squared);
  const double d = std::sqrt(own);
  const auto visit = [&](std::uint32_t child, double bound) {
    bound -= slack_;
    if (bound <= 0.0 || bound * bound <= squared.back()) find(child, y, squared);
  };
  if (d < here.inner) {
    visit(node + 1, 0.0);
    visit(here.second, here.inner - d);
  } else {
    visit(here.second, d - here.outer);
    visit(node + 1, d - here.inner);
  }
}

std::size_t VantageTree::count(std::uint32_t node, View y, double squared) const {
  const Node& here = nodes_[node];
  const auto within = [&](std::size_t i) {
    return least_squared_distance(space_, y, row(i)) <= squared && space_.squared_distance(y, row(i)) <= squared;
  };
  std::size_t found = 0;
  if (here.middle == 0) {
    for (std::size_t i = here.begin; i < here.end; ++i) found += within(i) ? 1 : 0;
    return found;
  }
  const double d = space_.distance(y, row(here.begin));
  const double radius = std::sqrt(squared);
  if (d + here.outer <= radius - slack_) return here.end - here.begin;
  if (within(here.begin)) ++found;
  if (d - here.inner <= radius + slack_) found += count(node + 1, y, squared);
  if (here.inner - d <= radius + slack_ && d - here.outer <= radius + slack_) found += count(here.second, y, squared);
  return found;
}

void VantageTree::nearest(View y, std::span<double> squared) const {
  std::fill(squared.begin(), squared.end(), std::numeric_limits<double>::infinity());
  if (!nodes_.empty() && !squared.empty()) find(0, y, squared);
}

std::size_t VantageTree::count_within(View y, double squared) const {
  return nodes_.empty() ? 0 : count(0, y, squared);
}

}  // namespace trellis::measure
