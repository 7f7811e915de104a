// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/roadmap.hpp>

#include <algorithm>

namespace trellis {

std::uint32_t LifelongSearch::add_vertex(double heuristic) {
  const auto id = static_cast<std::uint32_t>(adjacency_.size());
  adjacency_.emplace_back();
  heuristic_.push_back(heuristic);
  cost_.push_back(infinity);
  ahead_.push_back(id == start ? 0.0 : infinity);
  parent_edge_.push_back(none);
  stamp_.push_back(0);
  if (id == start) requeue(id);
  return id;
}

void LifelongSearch::requeue(std::uint32_t vertex) {
  // Older entries of the vertex no longer count.
  ++stamp_[vertex];
  if (cost_[vertex] == ahead_[vertex]) return;
  const double cost = std::min(cost_[vertex], ahead_[vertex]);
  queue_.push({cost + heuristic_[vertex], cost, vertex, stamp_[vertex]});
}

void LifelongSearch::offer(std::uint32_t vertex, std::uint32_t edge, std::uint32_t through) {
  const double way = cost_[through] + edges_[edge].cost;
  if (vertex == start || way >= ahead_[vertex]) return;
  ahead_[vertex] = way;
  parent_edge_[vertex] = edge;
  requeue(vertex);
}

void LifelongSearch::look_ahead(std::uint32_t vertex) {
  if (vertex != start) {
    ahead_[vertex] = infinity;
    parent_edge_[vertex] = none;
    for (const std::uint32_t id : adjacency_[vertex]) {
      const double way = cost_[other(id, vertex)] + edges_[id].cost;
      if (way < ahead_[vertex]) {
        ahead_[vertex] = way;
        parent_edge_[vertex] = id;
      }
    }
  }
  requeue(vertex);
}

std::uint32_t LifelongSearch::add_edge(std::uint32_t a, std::uint32_t b, double cost) {
  const auto id = static_cast<std::uint32_t>(edges_.size());
  edges_.push_back({a, b, cost, false});
  adjacency_[a].push_back(id);
  adjacency_[b].push_back(id);
  offer(b, id, a);
  offer(a, id, b);
  return id;
}

void LifelongSearch::remove_edge(std::uint32_t id) {
  Edge& edge = edges_[id];
  if (edge.removed) return;
  edge.removed = true;
  for (const std::uint32_t end : {edge.a, edge.b}) {
    auto& list = adjacency_[end];
    list.erase(std::find(list.begin(), list.end(), id));
  }
  for (const std::uint32_t end : {edge.a, edge.b}) {
    if (parent_edge_[end] == id) look_ahead(end);
  }
}

void LifelongSearch::isolate(std::uint32_t vertex) {
  const std::vector<std::uint32_t> edges = adjacency_[vertex];
  for (const std::uint32_t id : edges) remove_edge(id);
}

bool LifelongSearch::search() {
  if (vertices() < 2) return false;
  while (!queue_.empty()) {
    const Entry top = queue_.top();
    if (top.stamp != stamp_[top.vertex]) {
      queue_.pop();
      continue;
    }
    // Strictly beyond the goal's own estimate nothing can change its path. Rounding makes equal ways differ in the last
    // bits, so a little more than equal is still looked at.
    const double bound = std::min(cost_[goal], ahead_[goal]) * (1.0 + 1e-12);
    if (cost_[goal] == ahead_[goal] && top.estimate > bound) break;
    queue_.pop();
    const std::uint32_t v = top.vertex;
    ++expanded_;
    if (cost_[v] > ahead_[v]) {
      cost_[v] = ahead_[v];
      ++stamp_[v];
      for (const std::uint32_t id : adjacency_[v]) offer(other(id, v), id, v);
    } else {
      cost_[v] = infinity;
      for (const std::uint32_t id : adjacency_[v]) {
        const std::uint32_t next = other(id, v);
        if (parent_edge_[next] == id) look_ahead(next);
      }
      look_ahead(v);
    }
  }
  return cost_[goal] < infinity;
}

void LifelongSearch::path(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const {
  edges.clear();
  std::uint32_t at = vertex;
  while (at != start) {
    const std::uint32_t id = parent_edge_[at];
    if (id == none || edges.size() > vertices()) {
      edges.clear();
      return;
    }
    edges.push_back(id);
    at = other(id, at);
  }
  std::reverse(edges.begin(), edges.end());
}

}  // namespace trellis
