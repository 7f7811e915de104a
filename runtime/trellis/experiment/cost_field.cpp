// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/cost_field.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/polling.hpp>
#include <trellis/base/random.hpp>
#include <trellis/measure/low_discrepancy.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t start_node = 0;
constexpr std::uint32_t goal_node = 1;
/// Configurations tried for each requested sample.
constexpr std::size_t tries_per_sample = 64;

}  // namespace

CostField::CostField(CostFieldInstance instance, const CostFieldSettings& settings, std::uint64_t seed,
                     const std::vector<Configurations>& known)
    : instance_(std::move(instance)),
      nodes_(instance_.space.dimension()),
      index_(instance_.space),
      optimum_(infinity),
      path_(instance_.space.dimension()) {
  if (!instance_.valid(instance_.start) || !instance_.valid(instance_.goal)) {
    throw Error("a cost field needs a valid start and a valid goal");
  }
  for (const auto* end : {&instance_.start, &instance_.goal}) {
    nodes_.push(*end);
    index_.add(*end);
  }
  sample(settings.samples, seed);
  const auto d = static_cast<double>(instance_.space.degrees());
  neighbours_ = static_cast<std::size_t>(
      std::ceil(std::numbers::e * (1.0 + 1.0 / d) * std::log(static_cast<double>(nodes_.size()))));
  join(known);
  from_start_ = search(start_node);
  to_goal_ = search(goal_node);
  // Both searches give a path; shortcutting from opposite ends makes them differ.
  const bool forward = from_start_.cost[goal_node] <= to_goal_.cost[start_node];
  const CostTree& tree = forward ? from_start_ : to_goal_;
  const std::uint32_t end = forward ? goal_node : start_node;
  optimum_ = tree.cost[end];
  if (optimum_ == infinity) return;
  std::vector<std::uint32_t> stops = {end};
  while (tree.before[stops.back()] != stops.back()) stops.push_back(tree.before[stops.back()]);
  if (forward) std::reverse(stops.begin(), stops.end());
  for (const std::uint32_t stop : stops) path_.push(std::as_const(nodes_)[stop]);
}

void CostField::sample(std::size_t count, std::uint64_t seed) {
  const Space& space = instance_.space;
  Stream stream(seed, "", "cost field");
  std::vector<double> unit(space.degrees());
  for (double& x : unit) x = stream.uniform();
  measure::LowDiscrepancy sequence(space.degrees(), unit);
  Configuration q(space.dimension());
  std::size_t taken = 0;
  for (std::size_t i = 0; i < count * tries_per_sample && taken < count; ++i) {
    poll();
    sequence.next(unit);
    space.from_unit(unit, q);
    if (!instance_.valid(q)) continue;
    nodes_.push(q);
    index_.add(q);
    ++taken;
  }
}

void CostField::join(const std::vector<Configurations>& known) {
  const auto node_at = [&](View q) {
    const auto near = index_.nearest(q);
    if (near.squared_distance == 0.0) return near.id;
    index_.add(q);
    return nodes_.push(q);
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> legs;
  for (const auto& path : known) {
    std::uint32_t at = start_node;
    for (std::size_t i = 0; i < path.size(); ++i) legs.emplace_back(std::exchange(at, node_at(path[i])), at);
    if (!path.empty()) legs.emplace_back(at, goal_node);
  }
  edges_.assign(nodes_.size(), {});
  const auto joined = [&](std::uint32_t a, std::uint32_t b) {
    return std::any_of(edges_[a].begin(), edges_[a].end(), [&](const Edge& e) { return e.to == b; });
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    const double length = instance_.space.distance(std::as_const(nodes_)[a], std::as_const(nodes_)[b]);
    edges_[a].push_back({b, length});
    edges_[b].push_back({a, length});
  };
  for (const auto& [a, b] : legs) {
    if (a != b && !joined(a, b)) add(a, b);
  }
  for (std::uint32_t id = 0; id < nodes_.size(); ++id) {
    poll();
    const View q = std::as_const(nodes_)[id];
    index_.k_nearest(q, neighbours_ + 1, near_);  // includes q itself
    for (const auto& near : near_) {
      if (near.id == id || joined(id, near.id)) continue;
      if (instance_.valid_motion(q, std::as_const(nodes_)[near.id])) add(id, near.id);
    }
  }
}

CostField::CostTree CostField::search(std::uint32_t root) const {
  const std::size_t n = nodes_.size();
  CostTree tree{std::vector<double>(n, infinity), std::vector<std::uint32_t>(n, root)};
  std::vector<char> done(n, 0);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  tree.cost[root] = 0.0;
  queue.emplace(0.0, root);
  while (!queue.empty()) {
    poll();
    const std::uint32_t v = queue.top().second;
    queue.pop();
    if (done[v] != 0) continue;
    done[v] = 1;
    // The paths to all nodes before are final, so this node's path can only become shorter.
    while (tree.before[v] != root) {
      const std::uint32_t u = tree.before[tree.before[v]];
      if (!instance_.valid_motion(std::as_const(nodes_)[u], std::as_const(nodes_)[v])) break;
      tree.before[v] = u;
      const double straight = instance_.space.distance(std::as_const(nodes_)[u], std::as_const(nodes_)[v]);
      tree.cost[v] = std::min(tree.cost[v], tree.cost[u] + straight);
    }
    for (const auto& edge : edges_[v]) {
      const double cost = tree.cost[v] + edge.length;
      if (done[edge.to] == 0 && cost < tree.cost[edge.to]) {
        tree.cost[edge.to] = cost;
        tree.before[edge.to] = v;
        queue.emplace(cost, edge.to);
      }
    }
  }
  return tree;
}

double CostField::reach(const CostTree& tree, View q) const {
  candidates_.clear();
  const auto offer = [&](std::uint32_t id) {
    if (tree.cost[id] < infinity) {
      candidates_.emplace_back(tree.cost[id] + instance_.space.distance(std::as_const(nodes_)[id], q), id);
    }
  };
  for (const auto& near : near_) {
    offer(near.id);
    offer(tree.before[near.id]);
  }
  std::sort(candidates_.begin(), candidates_.end());
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  for (const auto& [cost, id] : candidates_) {
    if (instance_.valid_motion(std::as_const(nodes_)[id], q)) return cost;
  }
  return infinity;
}

double CostField::cost(View q) const {
  if (!instance_.valid(q)) return infinity;
  index_.k_nearest(q, neighbours_, near_);
  const double come = reach(from_start_, q);
  return come < infinity ? come + reach(to_goal_, q) : infinity;
}

}  // namespace trellis
