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

std::size_t Connection::most(std::size_t nodes) const {
  switch (rule_) {
    case Rule::fixed: return static_cast<std::size_t>(neighbours_);
    case Rule::k_nearest:
      return static_cast<std::size_t>(std::ceil(neighbours_ * std::log(static_cast<double>(nodes + 1))));
    case Rule::within: return nodes;
  }
  return 0;
}

bool Connection::find_since(const NearestIndex& index, View q, const std::vector<NearestIndex::Neighbour>& old,
                            std::size_t old_nodes, const NearestIndex& added,
                            std::vector<NearestIndex::Neighbour>& out) const {
  const std::size_t wanted = most(index);
  if (rule_ == Rule::within || wanted != most(old_nodes)) return false;
  added.k_nearest(q, wanted, out);
  while (!out.empty() && std::sqrt(out.back().squared_distance) > radius_) out.pop_back();
  for (auto& neighbour : out) neighbour.id += static_cast<std::uint32_t>(old_nodes);
  const auto middle = static_cast<std::ptrdiff_t>(out.size());
  out.insert(out.end(), old.begin(), old.end());
  std::inplace_merge(out.begin(), out.begin() + middle, out.end(), [](const auto& a, const auto& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.id < b.id;
  });
  if (out.size() > wanted) out.resize(wanted);
  return true;
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
