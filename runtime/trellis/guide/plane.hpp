// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string_view>

#include <trellis/base/error.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// \throws Error where a guide that works in the plane alone meets a scene of space
inline void require_plane(std::string_view guide, const Instance& parent) {
  if (parent.scene->planar() != nullptr) return;
  throw Error(
      fmt::format("{}: works in the plane, and this scene is in space; of the guides that search for a path of the "
                  "position, workspace, skeleton and decomposition work there",
                  guide));
}

}  // namespace trellis
