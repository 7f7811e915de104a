// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <trellis/instance/instance.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

/// Invalid positions of a search, on a lattice of 256 cells along the longer side of a box, for nearest neighbour
/// queries.
class InvalidPositions {
 public:
  explicit InvalidPositions(const Box2& box);

  /// Moves a position outside of the box to the nearest one within.
  void add(Vec2 position);
  [[nodiscard]] bool empty() const { return count_ == 0; }

  /// The centres of the nearest lattice cells.
  struct Nearest {
    Vec2 any;   ///< the nearest one
    Vec2 in_x;  ///< the nearest of those with the least difference in x
    Vec2 in_y;  ///< the nearest of those with the least difference in y
  };
  /// Returns none before the first `add`.
  [[nodiscard]] std::optional<Nearest> nearest(Vec2 position) const;

 private:
  /// Lattice rows (or columns) in ascending order, one list for each column (or row).
  using Lines = std::vector<std::vector<std::int32_t>>;
  [[nodiscard]] std::array<std::int32_t, 2> cell_of(Vec2 position) const;
  [[nodiscard]] Vec2 centre(std::int32_t column, std::int32_t row) const;

  Box2 box_;
  double side_ = 1.0;  ///< of a lattice cell, metres
  std::array<std::int32_t, 2> cells_{};
  Lines columns_;
  Lines rows_;
  std::size_t count_ = 0;
};

/// The number of features of a learnt search heuristic.
inline constexpr std::size_t search_features = 17;

/// The state of a search of an explicit graph.
class SearchState {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Vertex {
    double cost = std::numeric_limits<double>::infinity();  ///< from the start along the tree
    double penalty = 0.0;                                   ///< the sum of the cost penalties along the tree
    std::uint32_t edge = none;                              ///< of the graph, from the parent in the tree
    std::uint32_t depth = 0;                                ///< edges from the start along the tree
    bool expanded = false;
  };

  /// The graph must outlive the state.
  explicit SearchState(const Graph& graph);

  [[nodiscard]] const Graph& graph() const { return graph_; }
  [[nodiscard]] const Vertex& at(std::uint32_t vertex) const { return vertices_[vertex]; }
  [[nodiscard]] Vertex& at(std::uint32_t vertex) { return vertices_[vertex]; }
  /// The first two coordinates of a configuration of the graph's space.
  [[nodiscard]] static Vec2 position(View q) { return {q[0], q[1]}; }
  /// Whether the graph lies in the plane, which the features require.
  [[nodiscard]] bool planar() const { return graph_.vertices.dimension() == 2; }
  /// Returns the position of the goal that is nearest to a position.
  [[nodiscard]] Vec2 nearest_goal(Vec2 p) const;
  /// Records an invalid configuration.
  void add_invalid(View q);

  /// Returns the unit of the features: the diagonal of the bounding box of all vertices, metres.
  [[nodiscard]] double scale() const { return scale_; }
  /// Returns the features of a vertex that the search has generated, where the graph is planar; lengths are shares of
  /// `scale`. Position; cost from the start; Euclidean and Manhattan distance to the nearest goal; depth in mean
  /// edges; position of that goal; then the distance and the offset from the vertex to the nearest invalid position, to
  /// the one nearest in x and to the one nearest in y (distance -1 and offset 0 without an invalid position).
  [[nodiscard]] std::array<double, search_features> features(std::uint32_t vertex) const;

 private:
  const Graph& graph_;
  std::vector<Vertex> vertices_;
  Box2 box_;
  double scale_ = 1.0;
  double mean_edge_ = 1.0;
  std::optional<InvalidPositions> invalid_;  ///< of a planar graph
};

}  // namespace trellis
