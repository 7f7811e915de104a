// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace trellis {

/// Shortest paths from the first vertex of an undirected graph to the second while vertices and edges come and go:
/// lifelong planning A* (Koenig, Likhachev and Furcy 2004). A change repairs only the part of the search tree that it
/// touches and that lies on the way to the goal; nothing is ever searched from scratch. The result depends only on the
/// sequence of calls.
class LifelongSearch {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t start = 0;
  static constexpr std::uint32_t goal = 1;

  /// \param heuristic  a lower bound of the cost from the vertex to the goal, consistent with the edges' costs
  std::uint32_t add_vertex(double heuristic);
  /// An edge of cost > 0; returns its id.
  std::uint32_t add_edge(std::uint32_t a, std::uint32_t b, double cost);
  /// Removing an edge twice is harmless.
  void remove_edge(std::uint32_t id);
  /// Removes all edges of a vertex.
  void isolate(std::uint32_t vertex);

  /// Brings the search up to date; whether there is a path to the goal.
  bool search();
  /// The cost of the shortest path to the goal, after search(); infinite without one.
  [[nodiscard]] double cost() const { return vertices_[goal].cost; }
  /// Edges of the path from the start to `vertex` in the search tree, in order; empty where the tree does not hold it.
  void path(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const;
  /// Whether the search tree holds the vertex, after search(). All reachable ones are held when the goal is not.
  [[nodiscard]] bool reached(std::uint32_t vertex) const {
    return vertices_[vertex].cost < infinity && vertices_[vertex].cost == vertices_[vertex].ahead;
  }

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
  /// Vertices expanded so far: what all searches together cost.
  [[nodiscard]] std::uint64_t expanded() const { return expanded_; }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  struct Entry {
    double estimate;  ///< of the whole way through the vertex
    double cost;
    std::uint32_t vertex;
    std::uint32_t stamp;
    friend bool operator>(const Entry& a, const Entry& b) {
      if (a.estimate != b.estimate) return a.estimate > b.estimate;
      if (a.cost != b.cost) return a.cost > b.cost;
      return a.vertex > b.vertex;
    }
  };

  // What a repair asks of a vertex lies together, and so does what it asks of an edge: it visits many of both.
  struct Vertex {
    double heuristic;
    double cost = infinity;            ///< g: as of the last expansion
    double ahead = infinity;           ///< rhs: one step of look-ahead
    std::uint32_t parent_edge = none;  ///< that gives rhs
    std::uint32_t stamp = 0;           ///< of the vertex's entry in the queue that counts
  };
  struct Arc {
    double cost;
    std::uint32_t to;
    std::uint32_t edge;
  };

  void requeue(std::uint32_t vertex);
  void look_ahead(std::uint32_t vertex);
  void offer(const Arc& arc, double cost);

  std::vector<Edge> edges_;
  std::vector<Vertex> vertices_;
  std::vector<std::vector<Arc>> arcs_;  ///< of each vertex, to its neighbours
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::uint64_t expanded_ = 0;
};

}  // namespace trellis
