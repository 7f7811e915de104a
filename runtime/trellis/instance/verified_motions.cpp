// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/verified_motions.hpp>

#include <algorithm>
#include <cstddef>

#include <trellis/base/random.hpp>

namespace trellis {

namespace {

/// Metres in the metric within which a configuration lies on a motion: squared distances are differences, which
/// rounding leaves with half their digits.
constexpr double rounding = 1e-7;

/// The same for (a, b) and (b, a).
std::uint64_t digest(View a, View b) {
  const auto of = [](View q) {
    return stable_hash({reinterpret_cast<const char*>(q.data()), q.size() * sizeof(double)});
  };
  return of(a) ^ of(b);
}

/// Whether q may lie between two configurations, by the axes that do not wrap around.
bool may_lie_between(const Space& space, View from, View to, View q) {
  const auto& axes = space.axes();
  for (std::size_t j = 0; j < axes.size(); ++j) {
    if (axes[j].periodic) continue;
    const double slack = rounding / axes[j].weight;
    if (q[j] < std::min(from[j], to[j]) - slack || q[j] > std::max(from[j], to[j]) + slack) return false;
  }
  return true;
}

}  // namespace

void VerifiedMotions::add(View a, View b) {
  ends_.push(a);
  ends_.push(b);
  known_.insert(digest(a, b));
}

bool VerifiedMotions::contain(View a, View b) const { return known_.contains(digest(a, b)); }

bool VerifiedMotions::cover(View a, View b) const {
  for (std::size_t i = 0; i + 1 < ends_.size(); i += 2) {
    const View from = ends_[i];
    const View to = ends_[i + 1];
    if (!may_lie_between(space_, from, to, a) || !may_lie_between(space_, from, to, b)) continue;
    if (nearest_on_motion(space_, from, to, a).squared_distance > rounding * rounding) continue;
    if (nearest_on_motion(space_, from, to, b).squared_distance <= rounding * rounding) return true;
  }
  return false;
}

}  // namespace trellis
