// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/world.hpp>

#include <fmt/format.h>

#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/planar/valid_shapes.hpp>

namespace trellis {

World::World(Box2 bounds, std::vector<Obstacle> obstacles) {
  if (obstacles.size() > most_obstacles) {
    throw Error(fmt::format("a world has at most {} obstacles, got {}", most_obstacles, obstacles.size()));
  }
  auto content = std::make_shared<Content>();
  content->bounds = bounds;
  content->obstacles = std::move(obstacles);
  check_box(content->bounds, "the world's boundary");
  const double farthest = farthest_of(content->bounds);
  for (std::size_t i = 0; i < content->obstacles.size(); ++i) {
    auto& obstacle = content->obstacles[i];
    if (obstacle.name.empty()) obstacle.name = fmt::format("obstacle {}", i + 1);
    std::vector<ConvexShape> parts;
    validate(obstacle.shape, obstacle.name, false, parts);
    check_precision(obstacle.shape, farthest, obstacle.name);
    for (auto& part : parts) content->parts.push_back({std::move(part), i});
  }
  content_ = std::move(content);
}

}  // namespace trellis
