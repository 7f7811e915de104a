// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <trellis/measure/frame.hpp>

namespace trellis::measure {

/// The geometry of a tube { x in C : d(x, P) < radius }, with d over all axes or over a subset of them. Points are rows
/// of the frame. Flat spaces have a `GridTube`, those with rotations, or of many axes, a `BallTube`.
class Tube {
 public:
  virtual ~Tube() = default;
  Tube(const Tube&) = delete;
  Tube& operator=(const Tube&) = delete;

  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// The coordinates of a row that the distance is over.
  [[nodiscard]] const std::vector<std::size_t>& axes() const { return axes_; }
  /// Whether a point of C lies in the tube.
  [[nodiscard]] virtual bool contains(View y) const = 0;
  /// Returns the distance from a point to P over the tube's axes.
  [[nodiscard]] virtual double distance(View y) const = 0;
  /// Returns the length of P over the tube's axes, and the arc length at the point of P nearest to y.
  [[nodiscard]] virtual double length() const = 0;
  [[nodiscard]] virtual double along(View y) const = 0;

  /// Returns the logarithm of the volume of the cover, which contains the whole tube within C.
  [[nodiscard]] virtual double log_cover_volume() const = 0;
  /// Returns the number of coordinates of the unit cube that `draw` maps.
  [[nodiscard]] virtual std::size_t unit_dimension() const = 0;
  /// Maps a point of the unit cube to the cover with uniform density. \return whether the point lies in the tube: the
  /// share of such points, times the cover's volume, is the tube's volume, and they are uniform in it
  virtual bool draw(View unit, MutableView y) const = 0;

 protected:
  Tube(const Frame& frame, std::vector<std::size_t> axes, double radius)
      : frame_(frame), axes_(std::move(axes)), radius_(radius) {}

  Frame frame_;
  std::vector<std::size_t> axes_;
  double radius_;
};

/// \param path    at least one configuration of the space
/// \param axes    the coordinates of the distance, at least one; of a rotation, one stands for all four
/// \param radius  > 0, metres of the metric
std::shared_ptr<const Tube> make_tube(const Frame& frame, const Configurations& path, std::vector<std::size_t> axes,
                                      double radius);

}  // namespace trellis::measure
