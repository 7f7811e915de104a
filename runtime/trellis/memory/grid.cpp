// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/grid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <queue>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

constexpr double nowhere = std::numeric_limits<double>::infinity();

struct Step {
  int columns;
  int rows;
};
constexpr std::array<Step, 8> around = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

/// Returns the neighbouring cell in a direction; none outside of the grid.
std::optional<std::size_t> beside(const WorldGrid& grid, std::size_t cell, const Step& step) {
  const auto column = static_cast<long>(cell % grid.columns()) + step.columns;
  const auto row = static_cast<long>(cell / grid.columns()) + step.rows;
  if (column < 0 || row < 0 || column >= static_cast<long>(grid.columns()) || row >= static_cast<long>(grid.rows())) {
    return {};
  }
  return static_cast<std::size_t>(row) * grid.columns() + static_cast<std::size_t>(column);
}

/// Computes shortest paths over the grid from some cells; `may` decides whether a step is allowed.
template <class May>
std::vector<double> spread_from(const WorldGrid& grid, const std::vector<std::size_t>& from, const May& may) {
  std::vector<double> length(grid.size(), nowhere);
  std::array<double, around.size()> steps{};
  for (std::size_t k = 0; k < around.size(); ++k) {
    steps[k] = std::hypot(around[k].columns * grid.width(), around[k].rows * grid.height());
  }
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::size_t cell : from) {
    length[cell] = 0.0;
    queue.emplace(0.0, cell);
  }
  while (!queue.empty()) {
    const auto [d, cell] = queue.top();
    queue.pop();
    if (d > length[cell]) continue;
    for (std::size_t k = 0; k < around.size(); ++k) {
      const auto next = beside(grid, cell, around[k]);
      if (!next || !may(cell, *next, around[k])) continue;
      const double reached = d + steps[k];
      if (reached < length[*next]) {
        length[*next] = reached;
        queue.emplace(reached, *next);
      }
    }
  }
  return length;
}

}  // namespace

WorldGrid::WorldGrid(const World& world, const Box2& box, std::size_t cells) : box_(box) {
  const Vec2 side = box.hi - box.lo;
  const double cell = std::max(side.x, side.y) / static_cast<double>(cells);
  const auto count = [&](double length) { return static_cast<std::size_t>(std::max(1.0, std::round(length / cell))); };
  columns_ = count(side.x);
  rows_ = count(side.y);
  width_ = side.x / static_cast<double>(columns_);
  height_ = side.y / static_cast<double>(rows_);
  free_.assign(columns_ * rows_, 0);

  // A cell whose side only touches an obstacle's side or the boundary is still free.
  constexpr double inner = 0.49;
  const auto scene = std::make_shared<const PlanarScene>(
      world, Robot::rigid({Box2{{-inner * width_, -inner * height_}, {inner * width_, inner * height_}}}, false));
  const auto checker = make_checker("planar", scene, scene->default_space(1.0), cell);
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Vec2 p = centre(i);
    free_[i] = checker->valid(std::array{p.x, p.y}) ? 1 : 0;
  }

  std::vector<std::size_t> blocked;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const bool outer =
        i % columns_ == 0 || i % columns_ + 1 == columns_ || i / columns_ == 0 || i / columns_ + 1 == rows_;
    if (outer || free_[i] == 0) blocked.push_back(i);
  }
  clearance_ = spread_from(*this, blocked, [](std::size_t, std::size_t, const Step&) { return true; });
}

Vec2 WorldGrid::corner(std::size_t cell) const {
  const std::size_t row = cell / columns_;
  return {box_.lo.x + width_ * static_cast<double>(cell % columns_), box_.lo.y + height_ * static_cast<double>(row)};
}

Vec2 WorldGrid::centre(std::size_t cell) const { return corner(cell) + Vec2{0.5 * width_, 0.5 * height_}; }

std::size_t WorldGrid::at(Vec2 point) const {
  const auto place = [](double x, double size, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(std::floor(x / size), 0.0, static_cast<double>(count - 1)));
  };
  return place(point.y - box_.lo.y, height_, rows_) * columns_ + place(point.x - box_.lo.x, width_, columns_);
}

std::optional<std::size_t> WorldGrid::free_near(Vec2 point) const {
  std::optional<std::size_t> best;
  double least = nowhere;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (free_[i] == 0) continue;
    const double distance = norm(centre(i) - point);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

std::vector<double> path_lengths_to(const WorldGrid& grid, std::size_t to) {
  if (!grid.free(to)) {
    std::vector<double> none(grid.size(), nowhere);
    return none;
  }
  return spread_from(grid, {to}, [&](std::size_t cell, std::size_t next, const Step& step) {
    if (!grid.free(next)) return false;
    if (step.columns == 0 || step.rows == 0) return true;
    return grid.free(*beside(grid, cell, {step.columns, 0})) && grid.free(*beside(grid, cell, {0, step.rows}));
  });
}

namespace {

/// Computes the features of the cells of one grid.
class CellFeatures {
 public:
  CellFeatures(const WorldGrid& grid, Vec2 start, Vec2 goal)
      : grid_(grid),
        start_(start),
        goal_(goal),
        reference_length_(std::max(norm(goal - start), std::hypot(grid.width(), grid.height()))),
        along_((1.0 / reference_length_) * (goal - start)),
        diagonal_(std::hypot(static_cast<double>(grid.columns()) * grid.width(),
                             static_cast<double>(grid.rows()) * grid.height())) {
    // Sums over all cells to the lower left, to count the blocked cells in a window.
    sums_.assign((grid.columns() + 1) * (grid.rows() + 1), 0.0);
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      for (std::size_t column = 0; column < grid.columns(); ++column) {
        const double blocked = grid.free(row * grid.columns() + column) ? 0.0 : 1.0;
        sum(column + 1, row + 1) = blocked + sum(column, row + 1) + sum(column + 1, row) - sum(column, row);
      }
    }
  }

  void look(std::size_t cell, double* out) {
    const Vec2 p = grid_.centre(cell);
    const double from_start = norm(p - start_);
    const double to_goal = norm(goal_ - p);
    *out++ = from_start / reference_length_;
    *out++ = to_goal / reference_length_;
    *out++ = (from_start + to_goal) / reference_length_ - 1.0;
    *out++ = dot(p - start_, along_) / reference_length_;
    *out++ = cross(along_, p - start_) / reference_length_;
    *out++ = (p.x - grid_.corner(0).x) / diagonal_;
    *out++ = (p.y - grid_.corner(0).y) / diagonal_;
    *out++ = grid_.clearance()[cell] / diagonal_;
    // Visible distances, beginning in the direction from start to goal.
    constexpr int directions = 8;
    for (int i = 0; i < directions; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / directions;
      const Vec2 towards{along_.x * std::cos(angle) - along_.y * std::sin(angle),
                         along_.x * std::sin(angle) + along_.y * std::cos(angle)};
      *out++ = sight(p, towards) / diagonal_;
    }
    *out++ = blocked_between(start_, p);
    *out++ = blocked_between(p, goal_);
    for (const std::size_t reach : {2U, 6U, 12U}) *out++ = blocked_about(cell, reach);
  }

 private:
  double& sum(std::size_t column, std::size_t row) { return sums_[row * (grid_.columns() + 1) + column]; }

  [[nodiscard]] bool blocked(Vec2 p) const {
    const Vec2 q = p - grid_.corner(0);
    const bool inside = q.x >= 0.0 && q.y >= 0.0 && q.x < static_cast<double>(grid_.columns()) * grid_.width() &&
                        q.y < static_cast<double>(grid_.rows()) * grid_.height();
    return !inside || !grid_.free(grid_.at(p));
  }

  [[nodiscard]] double sight(Vec2 from, Vec2 towards) const {
    const double step = 0.5 * std::min(grid_.width(), grid_.height());
    const auto most = static_cast<int>(std::ceil(diagonal_ / step));
    int i = 1;
    while (i <= most && !blocked(from + (step * i) * towards)) ++i;
    return step * (i - 1);
  }

  [[nodiscard]] double blocked_between(Vec2 a, Vec2 b) const {
    const double step = 0.5 * std::min(grid_.width(), grid_.height());
    const auto count = static_cast<int>(std::ceil(norm(b - a) / step));
    int hits = 0;
    for (int i = 1; i < count; ++i) hits += blocked(a + (static_cast<double>(i) / count) * (b - a)) ? 1 : 0;
    return count > 1 ? static_cast<double>(hits) / (count - 1) : 0.0;
  }

  double blocked_about(std::size_t cell, std::size_t reach) {
    const std::size_t column = cell % grid_.columns();
    const std::size_t row = cell / grid_.columns();
    const std::size_t left = column - std::min(column, reach);
    const std::size_t low = row - std::min(row, reach);
    const std::size_t right = std::min(grid_.columns(), column + reach + 1);
    const std::size_t high = std::min(grid_.rows(), row + reach + 1);
    const double count = sum(right, high) - sum(left, high) - sum(right, low) + sum(left, low);
    return count / static_cast<double>((right - left) * (high - low));
  }

  const WorldGrid& grid_;
  Vec2 start_;
  Vec2 goal_;
  double reference_length_;
  Vec2 along_;
  double diagonal_;
  std::vector<double> sums_;
};

}  // namespace

std::vector<double> features(const WorldGrid& grid, Vec2 start, Vec2 goal) {
  std::vector<double> all(grid.size() * cell_features, 0.0);
  CellFeatures of_cell(grid, start, goal);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (grid.free(cell)) of_cell.look(cell, all.data() + cell * cell_features);
  }
  return all;
}

}  // namespace trellis
