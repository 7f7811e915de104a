// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <trellis/scene/spatial/shapes.hpp>

namespace trellis {

/// A tree of balls about a solid. Each node is responsible for a part of the solid: all of it at the root, and its
/// children's parts together are its own.
class SphereCover {
 public:
  struct Node {
    Vec3 centre;
    double outer = 0.0;       ///< the radius of a ball about the centre that contains the node's part
    double inner = 0.0;       ///< the radius of a ball about the centre inside the solid; negative where there is none
    std::uint32_t first = 0;  ///< the first child; children follow each other, and come after their parents
    std::uint32_t count = 0;  ///< of children; 0 at a leaf
  };

  /// The number of balls after which no ball is divided any more.
  static constexpr std::size_t most_nodes = 2048;
  /// A mesh of more triangles has one ball.
  static constexpr std::size_t most_divided_triangles = 20'000;

  /// \param surface  whether a closed mesh is only its surface, as one that is not closed always is: then it has no
  /// inner
  ///     balls
  /// \param finest  the radius of balls that need no division, in metres
  SphereCover(const Solid& solid, bool surface, double finest);

  /// Returns the nodes, the root first, in the frame that the solid's pose refers to.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  std::vector<Node> nodes_;
};

}  // namespace trellis
