// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/space/rotation.hpp>

namespace trellis {

/// A ball of a robot's body, in the body's frame.
struct BodySphere {
  Vec3 centre;
  double radius = 0.0;
  friend bool operator==(const BodySphere&, const BodySphere&) = default;
};

}  // namespace trellis
