// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/scene/spatial/shapes.hpp>

namespace trellis {

/// A shape of a scene in VRML.
struct VrmlShape {
  Shape3 shape;
  Pose3 pose;                       ///< in the scene's frame
  std::vector<std::string> groups;  ///< the names (DEF) of the nodes that it lies in, outermost first
  std::vector<Pose3> frames;        ///< of these nodes, in the scene's frame
};

/// Reads a scene in VRML 2.0 of Transform, Group, Inline, and Shape with Box, Sphere or Cylinder, which have an inside.
/// It skips what is only seen: appearance, lights, viewpoints. \throws Error with file and line, also for other shapes
/// and for scaled ones
std::vector<VrmlShape> read_vrml(const std::string& path);

}  // namespace trellis
