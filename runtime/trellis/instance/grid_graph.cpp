// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/grid_graph.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace trellis {

Graph grid_graph(const Instance& instance, double cell) {
  const auto& axes = instance.space.axes();
  // A plane is a layer of cells.
  const bool flat = instance.space.dimension() != 3;
  const std::size_t n = flat ? 2 : 3;
  std::array<std::uint32_t, 3> cells{};
  std::array<double, 3> step{};
  for (std::size_t j = 0; j < n; ++j) {
    const double extent = axes[j].hi - axes[j].lo;
    const double count = std::max(1.0, std::ceil(extent / cell));
    cells[j] = static_cast<std::uint32_t>(count);
    step[j] = extent / count;
  }
  Graph graph;
  graph.verified = false;
  graph.vertices = Configurations(n);
  const std::uint32_t row = cells[0] + 1;
  const auto at = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (z * (cells[1] + 1) + y) * row + x; };
  const auto for_each = [&](const std::array<std::uint32_t, 3>& from, const std::array<std::uint32_t, 3>& to,
                            const auto& visit) {
    for (std::uint32_t z = from[2]; z <= to[2]; ++z) {
      for (std::uint32_t y = from[1]; y <= to[1]; ++y) {
        for (std::uint32_t x = from[0]; x <= to[0]; ++x) visit(x, y, z);
      }
    }
  };
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    const double length = instance.space.distance(std::as_const(graph.vertices)[a], std::as_const(graph.vertices)[b]);
    graph.edges.push_back({a, b, length, Configurations()});
  };
  for_each({}, cells, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const std::array q{axes[0].lo + x * step[0], axes[1].lo + y * step[1], flat ? 0.0 : axes[2].lo + z * step[2]};
    graph.vertices.push(View(q).first(n));
  });
  if (flat) graph.edges.reserve(std::size_t{4} * row * (cells[1] + 1) + 64);
  for_each({}, cells, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const std::uint32_t here = at(x, y, z);
    if (flat) {
      if (x < cells[0]) join(here, here + 1);
      if (y == cells[1]) return;
      join(here, here + row);
      if (x < cells[0]) join(here, here + row + 1);
      if (x > 0) join(here, here + row - 1);
      return;
    }
    // Of the 26 neighbours of a vertex, half: those that come later in the order of vertices.
    const std::array<std::uint32_t, 3> from{x == 0 ? 0 : x - 1, y == 0 ? 0 : y - 1, z};
    const std::array<std::uint32_t, 3> to{std::min(x + 1, cells[0]), std::min(y + 1, cells[1]),
                                          std::min(z + 1, cells[2])};
    for_each(from, to, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
      if (at(i, j, k) > here) join(here, at(i, j, k));
    });
  });
  const auto join_end = [&](const Configuration& q) {
    const std::uint32_t vertex = graph.vertices.push(q);
    std::array<std::uint32_t, 3> from{};
    std::array<std::uint32_t, 3> to{};
    for (std::size_t j = 0; j < n; ++j) {
      // The cell of q and the cells around it.
      const double place = std::clamp(std::floor((q[j] - axes[j].lo) / step[j]), 0.0, cells[j] - 1.0);
      from[j] = static_cast<std::uint32_t>(std::max(place - 1.0, 0.0));
      to[j] = std::min(static_cast<std::uint32_t>(place) + 2, cells[j]);
    }
    for_each(from, to, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) { join(vertex, at(x, y, z)); });
    return vertex;
  };
  const double diagonal = flat ? std::hypot(step[0], step[1]) : std::hypot(step[0], step[1], step[2]);
  graph.start = join_end(instance.start);
  for (const Configuration& goal : instance.goals) {
    graph.goals.push_back(join_end(goal));
    if (instance.space.distance(instance.start, goal) <= 2.0 * diagonal) join(graph.start, graph.goals.back());
  }
  return graph;
}

}  // namespace trellis
