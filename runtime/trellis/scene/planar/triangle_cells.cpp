// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/triangle_cells.hpp>

#include <algorithm>
#include <numbers>
#include <utility>

namespace trellis {

TriangleCells::TriangleCells(Triangulation triangulation)
    : triangulation_(std::move(triangulation)),
      largest_(std::numbers::sqrt3 * triangulation_.size() * triangulation_.size()) {
  for (const auto& triangle : triangulation_.triangles()) mean_ += std::min(triangle.area, largest_);
  mean_ /= static_cast<double>(triangulation_.triangles().size());
  neighbours_.reserve(size());
  for (const auto& triangle : triangulation_.triangles()) {
    auto& mine = neighbours_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      if (!triangle.neighbours[k]) continue;
      const Vec2 middle = 0.5 * (triangle.corners[(k + 1) % 3] + triangle.corners[(k + 2) % 3]);
      mine.push_back({*triangle.neighbours[k], {middle.x, middle.y, 0.0}});
    }
  }
}

void TriangleCells::centre(std::uint32_t cell, MutableView out) const {
  const Vec2 p = triangulation_.triangles()[cell].centroid();
  out[0] = p.x;
  out[1] = p.y;
}

void TriangleCells::sample(std::uint32_t cell, Stream& stream, MutableView out) const {
  const Vec2 p = triangulation_.sample(cell, stream);
  out[0] = p.x;
  out[1] = p.y;
}

}  // namespace trellis
