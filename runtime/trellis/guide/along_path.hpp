// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/base/configurations.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/space/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Weighs the edges of an explicit graph by their distance from a guiding path. A graph has no tree to stay ahead of,
/// so the whole path counts at once.
class AlongPath {
 public:
  /// \param instance  whose space contains the path
  AlongPath(const Instance& instance, const Configurations& path);

  /// Whether there is no path to follow.
  [[nodiscard]] bool empty() const { return index_.size() == 0; }
  /// Factor on the cost of a motion: 1 + d / r, where d is the distance of its middle from the path and r the radius of
  /// the tube about the path that proposals are drawn from by default.
  [[nodiscard]] double factor(View a, View b) const;

 private:
  Space space_;
  double radius_;
  NearestIndex index_;  ///< of points of the path, a radius apart
  mutable Configuration middle_;
};

}  // namespace trellis
