// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/search_state.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace trellis {

namespace {

constexpr double lattice = 256;  // cells along the longer side

/// Inserts into a sorted list without duplicates; returns whether the value was new.
bool insert(std::vector<std::int32_t>& sorted, std::int32_t value) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), value);
  if (at != sorted.end() && *at == value) return false;
  sorted.insert(at, value);
  return true;
}

/// Calls `visit` with the neighbours of a value in a sorted list, at most one on either side.
template <class Visit>
void beside(const std::vector<std::int32_t>& sorted, std::int32_t value, const Visit& visit) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), value);
  if (at != sorted.end()) visit(*at);
  if (at != sorted.begin()) visit(*std::prev(at));
}

}  // namespace

InvalidPositions::InvalidPositions(const Box2& box) : box_(box) {
  const Vec2 extent = box.hi - box.lo;
  const double longer = std::max(extent.x, extent.y);
  if (longer > 0.0) side_ = longer / lattice;
  cells_ = {static_cast<std::int32_t>(std::max(1.0, std::ceil(extent.x / side_))),
            static_cast<std::int32_t>(std::max(1.0, std::ceil(extent.y / side_)))};
  columns_.resize(static_cast<std::size_t>(cells_[0]));
  rows_.resize(static_cast<std::size_t>(cells_[1]));
}

std::array<std::int32_t, 2> InvalidPositions::cell_of(Vec2 position) const {
  const auto place = [&](double x, std::int32_t cells) {
    return static_cast<std::int32_t>(std::clamp(std::floor(x / side_), 0.0, cells - 1.0));
  };
  return {place(position.x - box_.lo.x, cells_[0]), place(position.y - box_.lo.y, cells_[1])};
}

Vec2 InvalidPositions::centre(std::int32_t column, std::int32_t row) const {
  return box_.lo + Vec2{(column + 0.5) * side_, (row + 0.5) * side_};
}

void InvalidPositions::add(Vec2 position) {
  const auto [column, row] = cell_of(position);
  if (!insert(columns_[static_cast<std::size_t>(column)], row)) return;
  insert(rows_[static_cast<std::size_t>(row)], column);
  ++count_;
}

std::optional<InvalidPositions::Nearest> InvalidPositions::nearest(Vec2 position) const {
  if (empty()) return std::nullopt;
  const std::array<std::int32_t, 2> cell = cell_of(position);
  const std::int32_t column = cell[0];
  const std::int32_t row = cell[1];
  struct Best {
    Vec2 point;
    double distance = std::numeric_limits<double>::infinity();
    void offer(Vec2 p, double d) {
      if (d < distance) *this = {p, d};
    }
  };
  // Visits lines at most `offset` lines away, by increasing distance; stops when `done` returns true after an offset.
  const auto outward = [](const Lines& lines, std::int32_t from, const auto& look, const auto& done) {
    const auto count = static_cast<std::int32_t>(lines.size());
    for (std::int32_t offset = 0; offset < count && !done(offset); ++offset) {
      if (from + offset < count)
        look(lines[static_cast<std::size_t>(from) + static_cast<std::size_t>(offset)], from + offset);
      if (offset > 0 && from >= offset)
        look(lines[static_cast<std::size_t>(from) - static_cast<std::size_t>(offset)], from - offset);
    }
  };
  Best any;
  Best in_x;
  Best in_y;
  outward(
      columns_, column,
      [&](const std::vector<std::int32_t>& line, std::int32_t at) {
        beside(line, row, [&](std::int32_t r) {
          const Vec2 p = centre(at, r);
          any.offer(p, norm(p - position));
        });
      },
      // A column `offset` away is at least offset - 1 lattice cells away from a position within its own cell.
      [&](std::int32_t offset) { return (offset - 1) * side_ > any.distance; });
  const auto found = [](const Best& best) { return std::isfinite(best.distance); };
  outward(
      columns_, column,
      [&](const std::vector<std::int32_t>& line, std::int32_t at) {
        beside(line, row, [&](std::int32_t r) { in_x.offer(centre(at, r), norm(centre(at, r) - position)); });
      },
      [&](std::int32_t) { return found(in_x); });
  outward(
      rows_, row,
      [&](const std::vector<std::int32_t>& line, std::int32_t at) {
        beside(line, column, [&](std::int32_t c) { in_y.offer(centre(c, at), norm(centre(c, at) - position)); });
      },
      [&](std::int32_t) { return found(in_y); });
  return Nearest{any.point, in_x.point, in_y.point};
}

SearchState::SearchState(const Graph& graph) : graph_(graph), vertices_(graph.vertices.size()) {
  if (!planar() || graph.vertices.empty()) return;
  box_ = {position(graph.vertices[0]), position(graph.vertices[0])};
  for (std::size_t v = 1; v < graph.vertices.size(); ++v) {
    const Vec2 p = position(graph.vertices[v]);
    box_ = united(box_, {p, p});
  }
  if (norm(box_.hi - box_.lo) > 0.0) scale_ = norm(box_.hi - box_.lo);
  double length = 0.0;
  for (const auto& edge : graph.edges) {
    length += norm(position(graph.vertices[edge.to]) - position(graph.vertices[edge.from]));
  }
  if (length > 0.0) mean_edge_ = length / static_cast<double>(graph.edges.size());
  invalid_.emplace(box_);
}

Vec2 SearchState::nearest_goal(Vec2 p) const {
  Vec2 nearest = position(graph_.vertices[graph_.goals.front()]);
  for (const std::uint32_t goal : graph_.goals) {
    const Vec2 other = position(graph_.vertices[goal]);
    if (norm(other - p) < norm(nearest - p)) nearest = other;
  }
  return nearest;
}

void SearchState::add_invalid(View q) {
  if (invalid_) invalid_->add(position(q));
}

std::array<double, search_features> SearchState::features(std::uint32_t vertex) const {
  const Vec2 p = position(graph_.vertices[vertex]);
  const Vec2 goal = nearest_goal(p);
  std::array<double, search_features> out{};
  std::size_t at = 0;
  const auto put = [&](double x) { out[at++] = x; };
  const auto share = [&](double length) { put(length / scale_); };
  share(p.x - box_.lo.x);
  share(p.y - box_.lo.y);
  share(vertices_[vertex].cost);
  share(norm(goal - p));
  share(std::abs(goal.x - p.x) + std::abs(goal.y - p.y));
  share(vertices_[vertex].depth * mean_edge_);
  share(goal.x - box_.lo.x);
  share(goal.y - box_.lo.y);
  const auto nearest = invalid_->nearest(p);
  const auto invalid = [&](Vec2 q, double distance) {
    if (!nearest) {
      for (const double x : {-1.0, 0.0, 0.0}) put(x);
      return;
    }
    share(distance);
    share(q.x - p.x);
    share(q.y - p.y);
  };
  const InvalidPositions::Nearest found = nearest.value_or(InvalidPositions::Nearest{p, p, p});
  invalid(found.any, norm(found.any - p));
  invalid(found.in_x, std::abs(found.in_x.x - p.x));
  invalid(found.in_y, std::abs(found.in_y.y - p.y));
  return out;
}

}  // namespace trellis
