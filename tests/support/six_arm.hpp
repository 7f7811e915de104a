// SPDX-License-Identifier: GPL-3.0-or-later
// The robot of six joints, read from its files.
#pragma once

#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/manipulators.hpp"

namespace trellis::test {

/// \param mobile  whether its base moves in the plane
inline SphereModel six_arm(const std::string& group = "arm", bool mobile = false) {
  const Folder folder;
  ManipulatorFiles files;
  files.urdf = folder.write("six.urdf", six_joints);
  files.srdf = folder.write("six.srdf", six_joints_srdf);
  files.group = group;
  if (mobile) files.base = Joint::Kind::planar;
  std::vector<std::string> warnings;
  SphereModel robot = read_manipulator(files, warnings);
  CHECK(warnings.empty());
  return robot;
}

/// A point of a cube.
inline Vec3 drawn(Stream& stream, double lo, double hi) {
  return {stream.uniform(lo, hi), stream.uniform(lo, hi), stream.uniform(lo, hi)};
}

}  // namespace trellis::test
