// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

namespace trellis {

/// Shortest paths between the first two vertices of an undirected graph, while vertices and edges are added or removed
/// and edge costs change: an incremental bidirectional search. A tree grows from either end; each is repaired as in
/// lifelong planning A* (Koenig, Likhachev and Furcy 2004). Before the search continues, it raises the costs of all
/// descendants of a removed edge (Lim and Tsiotras 2021, Lifelong generalized lazy search). The search ends when no
/// path can be shorter than the shortest path over an edge between the trees (Dellin 2016, Completing manipulation
/// tasks efficiently in complex environments, chapter 4). An edge removed between the two trees, where planners find
/// most invalid edges, changes neither tree. The search never restarts from scratch. The result depends only on the
/// sequence of calls.
class LifelongSearch {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t start = 0;
  static constexpr std::uint32_t goal = 1;

  /// \param to_goal  lower bound of the cost from the vertex to the goal, consistent with the edge costs
  /// \param to_start  lower bound of the cost from the start to the vertex, consistent with the edge costs
  std::uint32_t add_vertex(double to_goal, double to_start = 0.0);
  /// Adds an edge of cost > 0 and returns its id.
  std::uint32_t add_edge(std::uint32_t a, std::uint32_t b, double cost);
  /// Changes the cost of an edge to `cost` > 0. No effect on a removed edge.
  void set_cost(std::uint32_t id, double cost);
  /// Removes an edge. No effect on a removed edge.
  void remove_edge(std::uint32_t id) { remove_edges({&id, 1}); }
  /// Removes edges one after another, but updates each vertex once.
  void remove_edges(std::span<const std::uint32_t> ids);
  /// Removes all edges of a vertex.
  void isolate(std::uint32_t vertex) { isolate({&vertex, 1}); }
  /// Removes all edges of several vertices.
  void isolate(std::span<const std::uint32_t> vertices);

  /// Updates the search. If it finds no path, further calls cost nothing until a new edge may connect the two parts of
  /// the graph.
  /// \return whether a path to the goal exists
  bool search();
  /// Grows only the tree from the start, until `triggered` returns true for the expanded vertex or the tree contains
  /// the shortest path to the goal. A further call continues.
  /// \return that vertex or the goal; none if the goal cannot be reached
  template <class Triggered>
  std::uint32_t search_until(const Triggered& triggered);
  /// As `search`, and expands the tree from the start to all vertices that it can reach.
  bool search_all();
  /// The cost of the shortest path to the goal after search(); infinite if there is none.
  [[nodiscard]] double cost() const { return cost_; }
  /// The edges of the path from the start to `vertex`, in order. The goal has a path after a search that found one,
  /// other vertices if the tree from the start contains them. Else empty.
  void path(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const;
  /// Whether the tree from the start contains the vertex.
  [[nodiscard]] bool reached(std::uint32_t vertex) const { return consistent(from_start, vertex); }

  struct Edge {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    double cost = 0.0;
    bool removed = false;
  };
  [[nodiscard]] std::size_t vertices() const { return vertices_.size(); }
  [[nodiscard]] std::size_t edges() const { return edges_.size(); }
  [[nodiscard]] const Edge& edge(std::uint32_t id) const { return edges_[id]; }
  [[nodiscard]] std::uint32_t other(std::uint32_t edge, std::uint32_t vertex) const {
    return edges_[edge].a == vertex ? edges_[edge].b : edges_[edge].a;
  }
  /// Appends the neighbours of a vertex.
  void neighbours(std::uint32_t vertex, std::vector<std::uint32_t>& out) const {
    for (const Arc& arc : vertices_[vertex].arcs) out.push_back(arc.to);
  }
  /// Appends the edges of a vertex.
  void edges_of(std::uint32_t vertex, std::vector<std::uint32_t>& out) const {
    for (const Arc& arc : vertices_[vertex].arcs) out.push_back(arc.edge);
  }
  /// Vertices expanded so far: the total cost of all searches.
  [[nodiscard]] std::uint64_t expanded() const { return expanded_; }
  /// Edges considered so far, by searches and repairs.
  [[nodiscard]] std::uint64_t looked_at() const { return looked_at_; }

 private:
  /// Counts edges that a search or a repair considers, and announces them (slice_monitor.hpp).
  void look_at(std::size_t edges);

  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr std::size_t from_start = 0;
  static constexpr std::size_t from_goal = 1;

  struct Entry {
    double estimate;
    double cost;
    std::uint32_t vertex;
    std::uint32_t stamp;
    friend bool operator>(const Entry& a, const Entry& b) {
      if (a.estimate != b.estimate) return a.estimate > b.estimate;
      if (a.cost != b.cost) return a.cost > b.cost;
      return a.vertex > b.vertex;
    }
  };
  using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

  // Contiguous in memory, as the data of an edge are: a repair visits many vertices and edges.
  struct Label {
    double cost = infinity;            ///< g: at the last expansion
    double ahead = infinity;           ///< rhs: one-step look-ahead value
    std::uint32_t parent_edge = none;  ///< edge that attains rhs
    std::uint32_t stamp = 0;           ///< of the vertex's only valid entry in the queue
  };
  struct Arc {
    double cost;
    std::uint32_t to;
    std::uint32_t edge;
  };
  /// The part of a disconnected graph that contains a vertex: all that one complete tree reaches, or the rest.
  enum class Part : std::uint8_t { none, inside, outside };
  struct Vertex {
    /// Half the difference of the two bounds. Costs from the start add it and costs from the goal subtract it, so that
    /// both trees use the same non-negative edge costs (Ikeda et al. 1994).
    double potential;
    std::array<Label, 2> of;  ///< in the tree from the start, and in the tree from the goal
    std::vector<Arc> arcs;    ///< to its neighbours
    Part part = Part::none;   ///< none for a vertex added since, until it has an edge
  };
  /// An edge between the trees. It is valid while its ends have the costs at which it was inserted.
  struct Meeting {
    double total;        ///< cost of the path through it
    std::uint32_t from;  ///< its end in the tree from the start
    std::uint32_t edge;
    friend bool operator>(const Meeting& a, const Meeting& b) {
      if (a.total != b.total) return a.total > b.total;
      if (a.edge != b.edge) return a.edge > b.edge;
      return a.from > b.from;
    }
  };

  [[nodiscard]] bool consistent(std::size_t side, std::uint32_t vertex) const {
    const Label& label = vertices_[vertex].of[side];
    return label.cost < infinity && label.cost == label.ahead;
  }
  [[nodiscard]] double estimate(std::size_t side, std::uint32_t vertex, double cost) const {
    return side == from_start ? cost + vertices_[vertex].potential : cost - vertices_[vertex].potential;
  }
  /// Called when the tree of one side contains all that it can reach, without the other end: marks the parts.
  void set_apart(std::size_t side);
  void erase_arc(std::uint32_t vertex, std::uint32_t edge);
  /// Raises the costs of the vertices in `changed_`, whose tree edges were removed, and of all their descendants to the
  /// best remaining costs.
  void raise_changed();
  void requeue(std::size_t side, std::uint32_t vertex);
  void look_ahead(std::size_t side, std::uint32_t vertex);
  void offer(std::size_t side, const Arc& arc, double cost);
  /// Inserts the edge into the meetings if it connects a vertex of one tree to a vertex of the other.
  void enter(std::size_t side, std::uint32_t vertex, const Arc& arc);
  void enter_all(std::size_t side, std::uint32_t vertex);
  [[nodiscard]] bool counts(const Meeting& meeting) const;
  /// The first valid entry of a queue, or nullptr.
  const Entry* top(std::size_t side);
  void expand(std::size_t side);
  /// Resets the path found.
  void begin_search();
  /// Whether the tree from the start alone contains the shortest path to the goal. If so, stores it as the path found.
  bool goal_is_final();
  void branch(std::size_t side, std::uint32_t vertex, std::vector<std::uint32_t>& edges) const;

  std::vector<Edge> edges_;
  std::vector<Vertex> vertices_;
  std::array<Queue, 2> queues_;
  std::priority_queue<Meeting, std::vector<Meeting>, std::greater<>> meetings_;
  Meeting meeting_{infinity, none, none};  ///< of the path found
  double cost_ = infinity;
  bool apart_ = false;  ///< the last search found no path, and no later edge connects the parts
  std::uint64_t expanded_ = 0;
  std::uint64_t looked_at_ = 0;
  std::vector<std::pair<std::size_t, std::uint32_t>> changed_;  ///< tree and vertex, for `raise_changed`
};

template <class Triggered>
std::uint32_t LifelongSearch::search_until(const Triggered& triggered) {
  begin_search();
  if (vertices() < 2 || apart_) return none;
  for (;;) {
    if (goal_is_final()) return goal;
    const Entry* next = top(from_start);
    if (next == nullptr) {
      set_apart(from_start);
      return none;
    }
    const std::uint32_t vertex = next->vertex;
    expand(from_start);
    if (vertex != goal && reached(vertex) && triggered(vertex)) return vertex;
  }
}

}  // namespace trellis
