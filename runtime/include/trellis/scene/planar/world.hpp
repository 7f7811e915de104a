// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// A closed obstacle of a planar world.
struct Obstacle {
  std::string name;  ///< its name in messages: "obstacle 3 (box 4 0 6 4.75)"
  Shape shape;
};

/// A planar workspace: a boundary box that contains the whole robot, and closed obstacles. Immutable: copies share
/// their content and the results cached for it, so that robots of several sizes in one world share them.
class World {
 public:
  /// A convex piece of an obstacle.
  struct Part {
    ConvexShape shape;
    std::size_t obstacle = 0;  ///< index into obstacles()
  };

  /// An empty square of 1 m.
  World() : World(Box2{{0, 0}, {1, 1}}, {}) {}
  /// Validates the obstacles (finite, positive extents and radii, simple polygons) and splits non-convex polygons into
  /// convex parts.
  /// \param bounds  metres, within `most_distant` of 0 and with an area
  /// \param obstacles  may overlap each other and the boundary; one without a name is called "obstacle 1" by its number
  /// \throws Error that names the obstacle, or the boundary, and for too many obstacles
  World(Box2 bounds, std::vector<Obstacle> obstacles);

  /// The rectangle that the robot is in, metres.
  [[nodiscard]] const Box2& bounds() const { return content_->bounds; }
  [[nodiscard]] const std::vector<Obstacle>& obstacles() const { return content_->obstacles; }
  /// The convex pieces of all obstacles, in the order of these.
  [[nodiscard]] const std::vector<Part>& parts() const { return content_->parts; }
  /// Returns a pointer that identifies the content: copies have the same pointer, and no other living world has it.
  [[nodiscard]] std::shared_ptr<const void> identity() const { return content_; }

 private:
  struct Content {
    Box2 bounds;
    std::vector<Obstacle> obstacles;
    std::vector<Part> parts;
  };
  std::shared_ptr<const Content> content_;
};

}  // namespace trellis
