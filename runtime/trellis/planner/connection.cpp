// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/connection.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trellis {

Connection Connection::k_nearest(const Space& space, double factor) {
  const auto d = static_cast<double>(space.dimension());
  return {Rule::k_nearest, factor * std::numbers::e * (1.0 + 1.0 / d), std::numeric_limits<double>::infinity(), d};
}

Connection Connection::within(const Space& space, double factor) {
  const auto d = static_cast<double>(space.dimension());
  const double log_share = std::log(1.0 + 1.0 / d) + space.log_volume() - log_unit_ball(space.dimension());
  return {Rule::within, std::numeric_limits<double>::infinity(), factor * 2.0 * std::exp(log_share / d), d};
}

void Connection::find(const NearestIndex& index, View q, std::vector<NearestIndex::Neighbour>& out) const {
  find(index, q, out, 1.0);
}

std::size_t Connection::most(const NearestIndex& index) const {
  switch (rule_) {
    case Rule::fixed: return static_cast<std::size_t>(neighbours_);
    case Rule::k_nearest:
      return static_cast<std::size_t>(std::ceil(neighbours_ * std::log(static_cast<double>(index.size() + 1))));
    case Rule::within: return index.size();
  }
  return 0;
}

bool Connection::find(const NearestIndex& index, View q, std::vector<NearestIndex::Neighbour>& out, double more) const {
  if (rule_ == Rule::within) {
    const auto n = static_cast<double>(index.size() + 1);
    index.within(q, radius_ * std::pow(std::log(n) / n, 1.0 / dimension_), out);
    return true;
  }
  const auto k = static_cast<std::size_t>(more * static_cast<double>(most(index)));
  index.k_nearest(q, k, out);
  const bool all = out.size() < k;
  if (rule_ == Rule::k_nearest) return all;
  const std::size_t found = out.size();
  while (!out.empty() && std::sqrt(out.back().squared_distance) > radius_) out.pop_back();
  return all || out.size() < found;
}

}  // namespace trellis
