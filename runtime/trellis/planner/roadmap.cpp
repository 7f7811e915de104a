// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/roadmap.hpp>

#include <algorithm>
#include <cmath>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/instance/search_cost.hpp>

namespace trellis {

std::uint32_t LifelongSearch::add_vertex(double to_goal, double to_start) {
  const auto id = static_cast<std::uint32_t>(vertices_.size());
  vertices_.push_back({0.5 * (to_goal - to_start), {}, {}, Part::none});
  if (id <= goal) {
    const std::size_t side = id == start ? from_start : from_goal;
    vertices_[id].of[side].ahead = 0.0;
    requeue(side, id);
  }
  return id;
}

void LifelongSearch::requeue(std::size_t side, std::uint32_t vertex) {
  // Invalidates the vertex's older entries.
  Label& label = vertices_[vertex].of[side];
  ++label.stamp;
  if (label.cost == label.ahead) {
    // The meetings may have dropped its edges while the vertex was inconsistent.
    if (label.cost < infinity) enter_all(side, vertex);
    return;
  }
  const double cost = std::min(label.cost, label.ahead);
  queues_[side].push({estimate(side, vertex, cost), cost, vertex, label.stamp});
}

/// Offers a path to the arc's end through its beginning.
/// \param cost  of the path to the arc's beginning
void LifelongSearch::offer(std::size_t side, const Arc& arc, double cost) {
  Label& label = vertices_[arc.to].of[side];
  const double ahead = cost + arc.cost;
  if (arc.to == side || ahead >= label.ahead) return;
  label.ahead = ahead;
  label.parent_edge = arc.edge;
  requeue(side, arc.to);
}

void LifelongSearch::look_at(std::size_t edges) {
  announce_work(search_cost::roadmap_edge * static_cast<double>(edges));
  looked_at_ += edges;
}

void LifelongSearch::look_ahead(std::size_t side, std::uint32_t vertex) {
  if (vertex != side) {
    double ahead = infinity;
    std::uint32_t parent_edge = none;
    look_at(vertices_[vertex].arcs.size());
    for (const Arc& arc : vertices_[vertex].arcs) {
      const double cost = vertices_[arc.to].of[side].cost + arc.cost;
      if (cost < ahead) {
        ahead = cost;
        parent_edge = arc.edge;
      }
    }
    Label& label = vertices_[vertex].of[side];
    label.ahead = ahead;
    label.parent_edge = parent_edge;
  }
  requeue(side, vertex);
}

void LifelongSearch::enter(std::size_t side, std::uint32_t vertex, const Arc& arc) {
  if (!consistent(side, vertex) || !consistent(1 - side, arc.to)) return;
  const std::uint32_t from = side == from_start ? vertex : arc.to;
  const std::uint32_t to = side == from_start ? arc.to : vertex;
  meetings_.push({vertices_[from].of[from_start].cost + arc.cost + vertices_[to].of[from_goal].cost, from, arc.edge});
}

void LifelongSearch::enter_all(std::size_t side, std::uint32_t vertex) {
  look_at(vertices_[vertex].arcs.size());
  for (const Arc& arc : vertices_[vertex].arcs) enter(side, vertex, arc);
}

bool LifelongSearch::counts(const Meeting& meeting) const {
  const Edge& edge = edges_[meeting.edge];
  const std::uint32_t to = other(meeting.edge, meeting.from);
  return !edge.removed && consistent(from_start, meeting.from) && consistent(from_goal, to) &&
         meeting.total == vertices_[meeting.from].of[from_start].cost + edge.cost + vertices_[to].of[from_goal].cost;
}

std::uint32_t LifelongSearch::add_edge(std::uint32_t a, std::uint32_t b, double cost) {
  const auto id = static_cast<std::uint32_t>(edges_.size());
  edges_.push_back({a, b, cost, false});
  look_at(1);
  for (const std::uint32_t end : {a, b}) {
    constexpr std::size_t usual = 8;
    if (vertices_[end].arcs.capacity() == 0) vertices_[end].arcs.reserve(usual);
  }
  vertices_[a].arcs.push_back({cost, b, id});
  vertices_[b].arcs.push_back({cost, a, id});
  for (const std::size_t side : {from_start, from_goal}) {
    offer(side, vertices_[a].arcs.back(), vertices_[a].of[side].cost);
    offer(side, vertices_[b].arcs.back(), vertices_[b].of[side].cost);
    enter(side, a, vertices_[a].arcs.back());
  }
  if (apart_) {
    Part& of_a = vertices_[a].part;
    Part& of_b = vertices_[b].part;
    if (of_a == Part::none && of_b == Part::none) of_a = Part::outside;
    if (of_a == Part::none) of_a = of_b;
    if (of_b == Part::none) of_b = of_a;
    apart_ = of_a == of_b;
  }
  return id;
}

void LifelongSearch::set_apart(std::size_t side) {
  apart_ = true;
  for (Vertex& vertex : vertices_) vertex.part = vertex.of[side].cost < infinity ? Part::inside : Part::outside;
}

void LifelongSearch::set_cost(std::uint32_t id, double cost) {
  Edge& edge = edges_[id];
  if (edge.removed || cost == edge.cost) return;
  const bool lower = cost < edge.cost;
  edge.cost = cost;
  std::array<const Arc*, 2> arcs{};
  for (std::size_t i = 0; i < 2; ++i) {
    auto& list = vertices_[i == 0 ? edge.a : edge.b].arcs;
    Arc& arc = *std::find_if(list.begin(), list.end(), [&](const Arc& of) { return of.edge == id; });
    arc.cost = cost;
    arcs[i] = &arc;
  }
  for (const std::size_t side : {from_start, from_goal}) {
    for (std::size_t i = 0; i < 2; ++i) {
      const std::uint32_t end = i == 0 ? edge.a : edge.b;
      if (lower) {
        offer(side, *arcs[i], vertices_[end].of[side].cost);
        if (vertices_[arcs[i]->to].of[side].parent_edge == id) look_ahead(side, arcs[i]->to);
      } else if (vertices_[end].of[side].parent_edge == id) {
        look_ahead(side, end);
      }
    }
    enter(side, edge.a, *arcs[0]);
  }
}

void LifelongSearch::erase_arc(std::uint32_t vertex, std::uint32_t edge) {
  auto& list = vertices_[vertex].arcs;
  list.erase(std::find_if(list.begin(), list.end(), [&](const Arc& arc) { return arc.edge == edge; }));
}

void LifelongSearch::remove_edges(std::span<const std::uint32_t> ids) {
  changed_.clear();
  for (const std::uint32_t id : ids) {
    Edge& edge = edges_[id];
    if (edge.removed) continue;
    edge.removed = true;
    for (const std::uint32_t end : {edge.a, edge.b}) {
      erase_arc(end, id);
      for (const std::size_t side : {from_start, from_goal}) {
        if (vertices_[end].of[side].parent_edge == id) changed_.emplace_back(side, end);
      }
    }
  }
  raise_changed();
}

void LifelongSearch::isolate(std::span<const std::uint32_t> vertices) {
  changed_.clear();
  for (const std::uint32_t vertex : vertices) {
    for (const Arc& arc : vertices_[vertex].arcs) {
      edges_[arc.edge].removed = true;
      erase_arc(arc.to, arc.edge);
      for (const std::size_t side : {from_start, from_goal}) {
        if (vertices_[arc.to].of[side].parent_edge == arc.edge) changed_.emplace_back(side, arc.to);
      }
    }
    vertices_[vertex].arcs.clear();
    for (const std::size_t side : {from_start, from_goal}) changed_.emplace_back(side, vertex);
  }
  raise_changed();
}

void LifelongSearch::raise_changed() {
  // Sets the costs of all descendants to infinity before it offers any vertex a new cost. Otherwise it could choose a
  // vertex as a parent whose cost is about to increase, and would expand vertices more than once.
  for (std::size_t i = 0; i < changed_.size(); ++i) {
    const auto [side, vertex] = changed_[i];
    if (vertex == side) continue;
    Label& label = vertices_[vertex].of[side];
    const bool expanded = label.cost < infinity;
    label.cost = infinity;
    label.ahead = infinity;
    label.parent_edge = none;
    if (!expanded) continue;
    look_at(vertices_[vertex].arcs.size());
    for (const Arc& arc : vertices_[vertex].arcs) {
      if (vertices_[arc.to].of[side].parent_edge == arc.edge) changed_.emplace_back(side, arc.to);
    }
  }
  for (const auto& [side, vertex] : changed_) look_ahead(side, vertex);
}

const LifelongSearch::Entry* LifelongSearch::top(std::size_t side) {
  Queue& queue = queues_[side];
  while (!queue.empty() && queue.top().stamp != vertices_[queue.top().vertex].of[side].stamp) queue.pop();
  return queue.empty() ? nullptr : &queue.top();
}

void LifelongSearch::expand(std::size_t side) {
  const std::uint32_t id = queues_[side].top().vertex;
  queues_[side].pop();
  ++expanded_;
  look_at(vertices_[id].arcs.size());
  Label& label = vertices_[id].of[side];
  if (label.cost > label.ahead) {
    label.cost = label.ahead;
    ++label.stamp;
    for (const Arc& arc : vertices_[id].arcs) {
      offer(side, arc, label.cost);
      enter(side, id, arc);
    }
  } else {
    label.cost = infinity;
    for (const Arc& arc : vertices_[id].arcs) {
      if (vertices_[arc.to].of[side].parent_edge == arc.edge) look_ahead(side, arc.to);
    }
    look_ahead(side, id);
  }
}

void LifelongSearch::begin_search() {
  cost_ = infinity;
  meeting_ = {infinity, none, none};
}

bool LifelongSearch::goal_is_final() {
  if (!reached(goal)) return false;
  const Label& label = vertices_[goal].of[from_start];
  const Entry* next = top(from_start);
  if (next != nullptr && estimate(from_start, goal, label.cost) + 1e-12 * label.cost >= next->estimate) return false;
  cost_ = label.cost;
  meeting_ = {cost_, other(label.parent_edge, goal), label.parent_edge};
  return true;
}

bool LifelongSearch::search() {
  begin_search();
  if (vertices() < 2 || apart_) return false;
  for (;;) {
    while (!meetings_.empty() && !counts(meetings_.top())) {
      // As much work as so many edges.
      constexpr std::size_t as_edges = 6;
      look_at(as_edges);
      meetings_.pop();
    }
    const std::array<const Entry*, 2> tops = {top(from_start), top(from_goal)};
    if (meetings_.empty()) {
      // A complete tree that can reach the other root would have met it.
      if (tops[0] == nullptr || tops[1] == nullptr) {
        set_apart(tops[0] == nullptr ? from_start : from_goal);
        return false;
      }
    } else {
      // Rounding makes equal path costs differ in the last bits, so the search also expands slightly higher costs.
      const Meeting& best = meetings_.top();
      const double slack = 1e-12 * best.total;
      const auto final_cost = [&](std::size_t side, std::uint32_t vertex) {
        return tops[side] == nullptr ||
               estimate(side, vertex, vertices_[vertex].of[side].cost) + slack < tops[side]->estimate;
      };
      const bool shortest =
          tops[0] == nullptr || tops[1] == nullptr || best.total + slack < tops[0]->estimate + tops[1]->estimate;
      if (shortest && final_cost(from_start, best.from) && final_cost(from_goal, other(best.edge, best.from))) break;
      if (tops[0] == nullptr && tops[1] == nullptr) break;
    }
    expand(tops[1] == nullptr || (tops[0] != nullptr && tops[0]->cost <= tops[1]->cost) ? from_start : from_goal);
  }
  meeting_ = meetings_.top();
  std::vector<std::uint32_t> edges;
  path(goal, edges);
  cost_ = 0.0;
  for (const std::uint32_t id : edges) cost_ += edges_[id].cost;
  return true;
}

bool LifelongSearch::search_all() {
  const bool found = search();
  while (top(from_start) != nullptr) expand(from_start);
  return found;
}

void LifelongSearch::branch(std::size_t side, std::uint32_t vertex, std::vector<std::uint32_t>& edges) const {
  const std::size_t before = edges.size();
  while (vertex != side) {
    const std::uint32_t id = vertices_[vertex].of[side].parent_edge;
    if (id == none || edges.size() > before + vertices()) {
      edges.resize(before);
      return;
    }
    edges.push_back(id);
    vertex = other(id, vertex);
  }
}

void LifelongSearch::path(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const {
  edges.clear();
  if (vertex == goal && meeting_.edge == none) return;
  branch(from_start, vertex == goal ? meeting_.from : vertex, edges);
  std::reverse(edges.begin(), edges.end());
  if (vertex != goal) return;
  edges.push_back(meeting_.edge);
  branch(from_goal, other(meeting_.edge, meeting_.from), edges);
}

}  // namespace trellis
