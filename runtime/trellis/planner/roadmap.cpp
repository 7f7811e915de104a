// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/roadmap.hpp>

#include <algorithm>

namespace trellis {

std::uint32_t LifelongSearch::add_vertex(double heuristic) {
  const auto id = static_cast<std::uint32_t>(vertices_.size());
  arcs_.emplace_back();
  vertices_.push_back({heuristic});
  if (id == start) {
    vertices_[id].ahead = 0.0;
    requeue(id);
  }
  return id;
}

void LifelongSearch::requeue(std::uint32_t vertex) {
  // Older entries of the vertex no longer count.
  Vertex& v = vertices_[vertex];
  ++v.stamp;
  if (v.cost == v.ahead) return;
  const double cost = std::min(v.cost, v.ahead);
  queue_.push({cost + v.heuristic, cost, vertex, v.stamp});
}

/// A way to the arc's end, through its start, which costs `cost`.
void LifelongSearch::offer(const Arc& arc, double cost) {
  Vertex& v = vertices_[arc.to];
  const double way = cost + arc.cost;
  if (arc.to == start || way >= v.ahead) return;
  v.ahead = way;
  v.parent_edge = arc.edge;
  requeue(arc.to);
}

void LifelongSearch::look_ahead(std::uint32_t vertex) {
  if (vertex != start) {
    double ahead = infinity;
    std::uint32_t parent_edge = none;
    for (const Arc& arc : arcs_[vertex]) {
      const double way = vertices_[arc.to].cost + arc.cost;
      if (way < ahead) {
        ahead = way;
        parent_edge = arc.edge;
      }
    }
    vertices_[vertex].ahead = ahead;
    vertices_[vertex].parent_edge = parent_edge;
  }
  requeue(vertex);
}

std::uint32_t LifelongSearch::add_edge(std::uint32_t a, std::uint32_t b, double cost) {
  const auto id = static_cast<std::uint32_t>(edges_.size());
  edges_.push_back({a, b, cost, false});
  arcs_[a].push_back({cost, b, id});
  arcs_[b].push_back({cost, a, id});
  offer(arcs_[a].back(), vertices_[a].cost);
  offer(arcs_[b].back(), vertices_[b].cost);
  return id;
}

void LifelongSearch::remove_edge(std::uint32_t id) {
  Edge& edge = edges_[id];
  if (edge.removed) return;
  edge.removed = true;
  for (const std::uint32_t end : {edge.a, edge.b}) {
    auto& list = arcs_[end];
    list.erase(std::find_if(list.begin(), list.end(), [&](const Arc& arc) { return arc.edge == id; }));
  }
  for (const std::uint32_t end : {edge.a, edge.b}) {
    if (vertices_[end].parent_edge == id) look_ahead(end);
  }
}

void LifelongSearch::isolate(std::uint32_t vertex) {
  const std::vector<Arc> arcs = arcs_[vertex];
  for (const Arc& arc : arcs) remove_edge(arc.edge);
}

bool LifelongSearch::search() {
  if (vertices() < 2) return false;
  while (!queue_.empty()) {
    const Entry top = queue_.top();
    const std::uint32_t id = top.vertex;
    Vertex& v = vertices_[id];
    if (top.stamp != v.stamp) {
      queue_.pop();
      continue;
    }
    // Strictly beyond the goal's own estimate nothing can change its path. Rounding makes equal ways differ in the last
    // bits, so a little more than equal is still looked at.
    const Vertex& end = vertices_[goal];
    const double bound = std::min(end.cost, end.ahead) * (1.0 + 1e-12);
    if (end.cost == end.ahead && top.estimate > bound) break;
    queue_.pop();
    ++expanded_;
    if (v.cost > v.ahead) {
      v.cost = v.ahead;
      ++v.stamp;
      for (const Arc& arc : arcs_[id]) offer(arc, v.cost);
    } else {
      v.cost = infinity;
      for (const Arc& arc : arcs_[id]) {
        if (vertices_[arc.to].parent_edge == arc.edge) look_ahead(arc.to);
      }
      look_ahead(id);
    }
  }
  return vertices_[goal].cost < infinity;
}

void LifelongSearch::path(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const {
  edges.clear();
  std::uint32_t at = vertex;
  while (at != start) {
    const std::uint32_t id = vertices_[at].parent_edge;
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
