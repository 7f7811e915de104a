// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/scene/limits.hpp>

namespace trellis {

namespace {

/// Occupied cells of a row, from column `begin` to before `end`; `top` is the first row that has them.
struct Run {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t top = 0;
};

}  // namespace

std::vector<Obstacle> boxes_of(const std::string& path, std::size_t columns, std::size_t rows,
                               const std::function<bool(std::size_t, std::size_t)>& occupied, Vec2 origin,
                               double side) {
  std::vector<Obstacle> boxes;
  const auto metres = [&](std::size_t cells) { return side * static_cast<double>(cells); };
  const auto close = [&](const Run& run, std::size_t bottom) {
    if (boxes.size() == most_obstacles)
      throw Error(fmt::format("{}: the grid has more than {} boxes", path, most_obstacles));
    boxes.push_back({fmt::format("box {}", boxes.size() + 1),
                     Box2{{origin.x + metres(run.begin), origin.y + metres(rows - bottom)},
                          {origin.x + metres(run.end), origin.y + metres(rows - run.top)}}});
  };
  std::vector<Run> open;  // of the row before, in the order of columns
  std::vector<Run> now;
  for (std::size_t row = 0; row <= rows; ++row) {
    now.clear();
    for (std::size_t column = 0; row < rows && column < columns; ++column) {
      if (!occupied(column, row)) continue;
      Run run{column, column, row};
      while (run.end < columns && occupied(run.end, row)) ++run.end;
      column = run.end;
      now.push_back(run);
    }
    auto next = now.begin();
    for (const Run& before : open) {
      while (next != now.end() && next->begin < before.begin) ++next;
      if (next != now.end() && next->begin == before.begin && next->end == before.end) {
        next->top = before.top;
      } else {
        close(before, row);
      }
    }
    std::swap(open, now);
  }
  return boxes;
}

}  // namespace trellis
