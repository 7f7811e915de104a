// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/spatial/shapes.hpp>

namespace trellis {

class DistanceFields;

/// A closed obstacle of a world in space.
struct Obstacle3 {
  std::string name;  ///< its name in messages: "obstacle 3 (maze.obj)"
  Solid solid;
};

/// What the bounds of a world must contain.
enum class Contain : std::uint8_t {
  robot,      ///< every point of the robot
  reference,  ///< the robot's reference point
  none        ///< nothing: the bounds only limit where configurations are drawn
};

/// The space that a robot moves in: a box, and closed obstacles. Immutable: copies share their content and what is
/// cached for it, so that robots of several sizes in one world share them.
class World3 {
 public:
  /// An empty cube of 1 m.
  World3() : World3(Box3{{0, 0, 0}, {1, 1, 1}}, {}) {}
  /// Validates the bounds and the obstacles.
  /// \param bounds  metres, within `most_distant` of 0 and with a volume
  /// \param obstacles  may overlap each other and the boundary; one without a name is called "obstacle 1" by its number
  /// \param contain  what the bounds must contain at each valid configuration
  /// \param surface  whether a closed mesh is only its surface, so that a body inside it is not in collision, as in
  ///     FCL and in planners that use it directly
  /// \param stated  whether the user stated `contain`; else `for_fixed_base` may change it
  /// \throws Error that names the obstacle, or the boundary, and for too many obstacles
  World3(Box3 bounds, std::vector<Obstacle3> obstacles, Contain contain = Contain::robot, bool surface = false,
         bool stated = true);

  /// The box that the robot is in, metres.
  [[nodiscard]] const Box3& bounds() const { return content_->bounds; }
  [[nodiscard]] const std::vector<Obstacle3>& obstacles() const { return content_->obstacles; }
  /// What the bounds must contain.
  [[nodiscard]] Contain contain() const { return content_->contain; }
  /// Whether a closed mesh is only its surface.
  [[nodiscard]] bool surface() const { return content_->surface; }
  /// Returns a world with these obstacles and otherwise the same.
  /// \param obstacles  replace the present ones
  /// \throws Error that names the obstacle
  [[nodiscard]] World3 with(std::vector<Obstacle3> obstacles) const {
    return {bounds(), std::move(obstacles), contain(), surface(), content_->stated};
  }
  /// Returns the world of a robot with a fixed base: its bounds contain nothing unless the user stated what they
  /// contain. Copies of this world return the same one.
  [[nodiscard]] World3 for_fixed_base() const;
  /// Returns a pointer that identifies the content: copies have the same pointer, and no other living world has it.
  [[nodiscard]] std::shared_ptr<const void> identity() const { return content_; }
  /// Returns the distance fields of the obstacles, which copies of this world share: made at the first call.
  [[nodiscard]] std::shared_ptr<const DistanceFields> distances() const;

 private:
  struct Content {
    Content(Box3 box, std::vector<Obstacle3> all, Contain inside, bool only_surface, bool given)
        : bounds(box), obstacles(std::move(all)), contain(inside), surface(only_surface), stated(given) {}

    Box3 bounds;
    std::vector<Obstacle3> obstacles;
    Contain contain;
    bool surface;
    bool stated;  ///< the user stated `contain`
    mutable std::once_flag distances_made;
    mutable std::shared_ptr<const DistanceFields> distances;
    mutable std::once_flag unbounded_made;
    mutable std::shared_ptr<const Content> unbounded;  ///< of for_fixed_base
  };
  std::shared_ptr<const Content> content_;
};

}  // namespace trellis
