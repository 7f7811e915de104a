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

/// Shortest paths from the first vertex of an undirected graph to the second while vertices and edges come and go and
/// edges change their cost: an incremental bidirectional search. A tree grows from either end, each repaired as in
/// lifelong planning A* (Koenig, Likhachev and Furcy 2004); what is below a removed edge is raised as a whole, before
/// the search goes on (Lim and Tsiotras 2021, Lifelong generalized lazy search). It goes on until no path can be
/// shorter than the shortest one over an edge between them (Dellin 2016, Completing manipulation tasks efficiently in
/// complex environments, chapter 4). What is removed between the ends, where planners find most of what is invalid,
/// leaves both trees as they are. Nothing is ever searched from scratch. The result depends only on the sequence of
/// calls.
class LifelongSearch {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t start = 0;
  static constexpr std::uint32_t goal = 1;

  /// \param to_goal   a lower bound of the cost from the vertex to the goal, consistent with the edges' costs
  /// \param to_start  the same to the start
  std::uint32_t add_vertex(double to_goal, double to_start = 0.0);
  /// An edge of cost > 0; returns its id.
  std::uint32_t add_edge(std::uint32_t a, std::uint32_t b, double cost);
  /// Changes the cost of an edge to one > 0, where it is not removed.
  void set_cost(std::uint32_t id, double cost);
  /// Removing an edge twice is harmless.
  void remove_edge(std::uint32_t id) { remove_edges({&id, 1}); }
  /// The same as one after another, but each vertex is brought up to date once.
  void remove_edges(std::span<const std::uint32_t> ids);
  /// Removes all edges of a vertex.
  void isolate(std::uint32_t vertex) { isolate({&vertex, 1}); }
  /// Removes all edges of some vertices.
  void isolate(std::span<const std::uint32_t> vertices);

  /// Brings the search up to date; whether there is a path to the goal. Once there is none this takes no time until an
  /// edge is added that may join the two parts of the graph.
  bool search();
  /// Grows the tree from the start alone until `triggered` holds for the vertex that it has come to, or until it holds
  /// the shortest path to the goal: that vertex, or none. Called again it continues.
  template <class Triggered>
  std::uint32_t search_until(const Triggered& triggered);
  /// The same as `search`, and completes the tree from the start: it holds all vertices that can be reached.
  bool search_all();
  /// The cost of the shortest path to the goal, after search(); infinite without one.
  [[nodiscard]] double cost() const { return cost_; }
  /// Edges of the path from the start to `vertex`, in order: to the goal after a search found one, to others that the
  /// tree from the start holds; else empty.
  void path(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const;
  /// Whether the tree from the start holds the vertex.
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
  /// Appends the vertices that edges join to a vertex.
  void neighbours(std::uint32_t vertex, std::vector<std::uint32_t>& out) const {
    for (const Arc& arc : vertices_[vertex].arcs) out.push_back(arc.to);
  }
  /// Vertices expanded so far: what all searches together cost.
  [[nodiscard]] std::uint64_t expanded() const { return expanded_; }

 private:
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

  // What a repair asks of a vertex lies together, and so does what it asks of an edge: it visits many of both.
  struct Label {
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
  /// Where a vertex lies while there is no path: in the part of the graph that one tree holds as a whole, or elsewhere.
  enum class Part : std::uint8_t { none, inside, outside };
  struct Vertex {
    /// Half the difference of the bounds: added to costs from the start, subtracted from those from the goal, so that
    /// both trees see edges of the same, non-negative costs (Ikeda et al. 1994).
    double potential;
    std::array<Label, 2> of;  ///< in the tree from the start, and in that from the goal
    std::vector<Arc> arcs;    ///< to its neighbours
    Part part = Part::none;   ///< of a vertex that was added since, none until it has an edge
  };
  /// An edge between the trees. It counts while its ends have the costs that it was entered with.
  struct Meeting {
    double total;        ///< cost of the path over it
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
  /// The tree of one side holds all that it can reach, and not the other end.
  void set_apart(std::size_t side);
  void erase_arc(std::uint32_t vertex, std::uint32_t edge);
  /// Edges of the tree to the vertices in `changed_` were removed: raises the costs of these and of all that the tree
  /// holds below them to what is left.
  void raise_changed();
  void requeue(std::size_t side, std::uint32_t vertex);
  void look_ahead(std::size_t side, std::uint32_t vertex);
  void offer(std::size_t side, const Arc& arc, double cost);
  /// Enters the edge where it leads from a vertex of the one tree to one of the other.
  void enter(std::size_t side, std::uint32_t vertex, const Arc& arc);
  void enter_all(std::size_t side, std::uint32_t vertex);
  [[nodiscard]] bool counts(const Meeting& meeting) const;
  /// The first entry of a queue that counts, or nullptr.
  const Entry* top(std::size_t side);
  void expand(std::size_t side);
  /// No path was found yet.
  void begin_search();
  /// Whether the tree from the start alone holds the shortest path to the goal, which then is the path found.
  bool goal_settled();
  void branch(std::size_t side, std::uint32_t vertex, std::vector<std::uint32_t>& edges) const;

  std::vector<Edge> edges_;
  std::vector<Vertex> vertices_;
  std::array<Queue, 2> queues_;
  std::priority_queue<Meeting, std::vector<Meeting>, std::greater<>> meetings_;
  Meeting meeting_{infinity, none, none};  ///< of the path found
  double cost_ = infinity;
  bool apart_ = false;  ///< the last search found no path, and no edge has joined the parts since
  std::uint64_t expanded_ = 0;
  std::vector<std::pair<std::size_t, std::uint32_t>> changed_;  ///< scratch
};

template <class Triggered>
std::uint32_t LifelongSearch::search_until(const Triggered& triggered) {
  begin_search();
  if (vertices() < 2 || apart_) return none;
  for (;;) {
    if (goal_settled()) return goal;
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
