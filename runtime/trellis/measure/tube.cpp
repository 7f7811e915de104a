// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/tube.hpp>

#include <utility>

#include <trellis/measure/ball_tube.hpp>
#include <trellis/measure/grid_tube.hpp>

namespace trellis::measure {

std::shared_ptr<const Tube> make_tube(const Frame& frame, const Configurations& path, std::vector<std::size_t> axes,
                                      double radius) {
  // A grid's cover bounds all axes but three by boxes: of 13 axes a ball fills a 9000th part of its box, of 61 4e-37.
  constexpr std::size_t most_grid_axes = 16;
  if (frame.flat() && axes.size() <= most_grid_axes)
    return std::make_shared<const GridTube>(frame, path, std::move(axes), radius);
  return std::make_shared<const BallTube>(frame, path, std::move(axes), radius);
}

}  // namespace trellis::measure
