// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/world.hpp>

#include <fmt/format.h>

#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/spatial/distance_field.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

void check_bounds(const Box3& box) {
  const auto fail = [&](const std::string& needed) {
    throw Error(fmt::format("the world's boundary: a box needs {}, got ({}, {}, {}) to ({}, {}, {})", needed, box.lo.x,
                            box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z));
  };
  // Also true of coordinates that are not numbers.
  if (!(box.lo.x < box.hi.x && box.lo.y < box.hi.y && box.lo.z < box.hi.z)) {
    fail("xmin < xmax, ymin < ymax and zmin < zmax");
  }
  if (!in_range(box.lo) || !in_range(box.hi)) fail(fmt::format("coordinates within {:g} m of 0", most_distant));
  check_precision({Cuboid{box.hi - box.lo}, {}}, farthest_of(box), "the world's boundary");
}

}  // namespace

World3::World3(Box3 bounds, std::vector<Obstacle3> obstacles, Contain contain, bool surface, bool stated) {
  if (obstacles.size() > most_obstacles) {
    throw Error(fmt::format("a world has at most {} obstacles, got {}", most_obstacles, obstacles.size()));
  }
  check_bounds(bounds);
  const double farthest = farthest_of(bounds);
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (obstacles[i].name.empty()) obstacles[i].name = fmt::format("obstacle {}", i + 1);
    check_solid(obstacles[i].solid, obstacles[i].name);
    check_precision(obstacles[i].solid, farthest, obstacles[i].name);
  }
  content_ = std::make_shared<const Content>(bounds, std::move(obstacles), contain, surface, stated);
}

World3 World3::for_fixed_base() const {
  if (content_->stated || contain() == Contain::none) return *this;
  std::call_once(content_->unbounded_made, [&] {
    content_->unbounded =
        std::make_shared<const Content>(bounds(), obstacles(), Contain::none, surface(), content_->stated);
  });
  World3 world = *this;
  world.content_ = content_->unbounded;
  return world;
}

std::shared_ptr<const DistanceFields> World3::distances() const {
  std::call_once(content_->distances_made,
                 [&] { content_->distances = std::make_shared<const DistanceFields>(*this); });
  return content_->distances;
}

}  // namespace trellis
