// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/octree_cells.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/scene/spatial/free_distance.hpp>

namespace trellis {

OctreeCells::OctreeCells(const World3& world, double size, double needed) : bounds_(world.bounds()) {
  const Vec3 extent = bounds_.hi - bounds_.lo;
  const std::array<double, 3> sides = {extent.x, extent.y, extent.z};
  double first = 1.0;
  for (const double side : sides) first *= std::max(1.0, std::ceil(side / size));
  if (!(size > 0.0) || !(first <= static_cast<double>(most_cells))) {
    throw Error(fmt::format("cells of {:g} m would be more than {:d} in a world of {:g} x {:g} x {:g} m", size,
                            most_cells, extent.x, extent.y, extent.z));
  }
  for (std::size_t i = 0; i < 3; ++i) counts_[i] = static_cast<std::size_t>(std::max(1.0, std::ceil(sides[i] / size)));
  half_ = {0.5 * extent.x / static_cast<double>(counts_[0]), 0.5 * extent.y / static_cast<double>(counts_[1]),
           0.5 * extent.z / static_cast<double>(counts_[2])};
  smallest_ = 2.0 * half_;

  const FreeDistance distance(world);
  std::vector<std::uint32_t> mixed;  // neither free nor blocked for certain, of the same size
  std::size_t free = 0;
  const auto enter = [&](const Vec3& centre, int divisions, std::vector<std::uint32_t>& undecided) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({centre, divisions});
    const double reach = norm(half(divisions));
    const double here = distance(centre);
    if (here > reach) {
      nodes_[at].cell = 0;
      ++free;
    } else if (here > -reach) {
      undecided.push_back(at);
    }
  };
  for (std::size_t k = 0; k < counts_[2]; ++k) {
    for (std::size_t j = 0; j < counts_[1]; ++j) {
      for (std::size_t i = 0; i < counts_[0]; ++i) {
        const auto along = [](std::size_t n, double lo, double h) {
          return lo + (2.0 * static_cast<double>(n) + 1.0) * h;
        };
        enter({along(i, bounds_.lo.x, half_.x), along(j, bounds_.lo.y, half_.y), along(k, bounds_.lo.z, half_.z)}, 0,
              mixed);
      }
    }
  }
  for (int divisions = 1; divisions <= most_divisions && !mixed.empty(); ++divisions) {
    // A point as far from obstacles as a cell is long from corner to corner is in a free cell.
    if (2.0 * norm(half(divisions - 1)) <= needed) break;
    // Most of the new cells are free at one side of what bounds them.
    if (free + 4 * mixed.size() > most_cells) break;
    std::vector<std::uint32_t> next;
    const Vec3 h = half(divisions);
    for (const std::uint32_t parent : mixed) {
      nodes_[parent].children = static_cast<std::uint32_t>(nodes_.size());
      const Vec3 centre = nodes_[parent].centre;
      for (const double z : {-h.z, h.z}) {
        for (const double y : {-h.y, h.y}) {
          for (const double x : {-h.x, h.x}) enter(centre + Vec3{x, y, z}, divisions, next);
        }
      }
    }
    mixed = std::move(next);
    smallest_ = 2.0 * h;
  }

  for (std::uint32_t at = 0; at < nodes_.size(); ++at) {
    if (nodes_[at].cell == none) continue;
    nodes_[at].cell = static_cast<std::uint32_t>(leaves_.size());
    leaves_.push_back(at);
    volume_ += volume(nodes_[at].cell);
  }
  join();
}

/// Joins each cell with those of its size or larger beyond its sides.
void OctreeCells::join() {
  neighbours_.resize(leaves_.size());
  for (std::uint32_t cell = 0; cell < leaves_.size(); ++cell) {
    const Node& mine = nodes_[leaves_[cell]];
    const Vec3 h = half(mine.divisions);
    for (const Vec3& side : {Vec3{h.x, 0, 0}, Vec3{0, h.y, 0}, Vec3{0, 0, h.z}}) {
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 middle = mine.centre + sign * side;
        const Vec3 beyond = mine.centre + (1.001 * sign) * side;
        const bool inside = beyond.x >= bounds_.lo.x && beyond.y >= bounds_.lo.y && beyond.z >= bounds_.lo.z &&
                            beyond.x <= bounds_.hi.x && beyond.y <= bounds_.hi.y && beyond.z <= bounds_.hi.z;
        if (!inside) continue;
        const Node& other = nodes_[leaf_at(beyond)];
        // Smaller cells join themselves to this one; of two of one size, the first does.
        if (other.cell == none || other.divisions > mine.divisions) continue;
        if (other.divisions == mine.divisions && other.cell < cell) continue;
        neighbours_[cell].push_back({other.cell, {middle.x, middle.y, middle.z}});
        neighbours_[other.cell].push_back({cell, {middle.x, middle.y, middle.z}});
      }
    }
  }
  for (auto& near : neighbours_) {
    std::sort(near.begin(), near.end(), [](const Neighbour& a, const Neighbour& b) { return a.cell < b.cell; });
  }
}

std::uint32_t OctreeCells::leaf_at(const Vec3& p) const {
  const auto place = [](double along, double h, std::size_t count) {
    const double n = std::floor(along / (2.0 * h));
    return static_cast<std::size_t>(std::clamp(n, 0.0, static_cast<double>(count - 1)));
  };
  const std::size_t i = place(p.x - bounds_.lo.x, half_.x, counts_[0]);
  const std::size_t j = place(p.y - bounds_.lo.y, half_.y, counts_[1]);
  const std::size_t k = place(p.z - bounds_.lo.z, half_.z, counts_[2]);
  auto at = static_cast<std::uint32_t>((k * counts_[1] + j) * counts_[0] + i);
  while (nodes_[at].children != none) {
    const Vec3& centre = nodes_[at].centre;
    at = nodes_[at].children + (p.x >= centre.x ? 1U : 0U) + (p.y >= centre.y ? 2U : 0U) + (p.z >= centre.z ? 4U : 0U);
  }
  return at;
}

Box3 OctreeCells::box(std::uint32_t cell) const {
  const Node& node = nodes_[leaves_[cell]];
  const Vec3 h = half(node.divisions);
  return {node.centre - h, node.centre + h};
}

void OctreeCells::centre(std::uint32_t cell, MutableView out) const {
  const Vec3& c = nodes_[leaves_[cell]].centre;
  out[0] = c.x;
  out[1] = c.y;
  out[2] = c.z;
}

std::optional<std::uint32_t> OctreeCells::find(View p) const {
  const Vec3 at{p[0], p[1], p[2]};
  const bool inside = at.x >= bounds_.lo.x && at.y >= bounds_.lo.y && at.z >= bounds_.lo.z && at.x <= bounds_.hi.x &&
                      at.y <= bounds_.hi.y && at.z <= bounds_.hi.z;
  if (!inside) return std::nullopt;
  const std::uint32_t cell = nodes_[leaf_at(at)].cell;
  return cell == none ? std::nullopt : std::optional(cell);
}

void OctreeCells::sample(std::uint32_t cell, Stream& stream, MutableView out) const {
  const Box3 box = this->box(cell);
  // Clamp: rounding must not move the point out of the world.
  out[0] = std::clamp(stream.uniform(box.lo.x, box.hi.x), bounds_.lo.x, bounds_.hi.x);
  out[1] = std::clamp(stream.uniform(box.lo.y, box.hi.y), bounds_.lo.y, bounds_.hi.y);
  out[2] = std::clamp(stream.uniform(box.lo.z, box.hi.z), bounds_.lo.z, bounds_.hi.z);
}

}  // namespace trellis
