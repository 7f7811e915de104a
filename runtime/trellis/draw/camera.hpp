// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/draw/surface.hpp>

/// Where a world of space is seen from: far away, so that all lines of sight are parallel.
namespace trellis::draw {

/// The direction from which a picture of space is seen, in degrees.
struct Camera {
  double azimuth = -60.0;   ///< from the x axis, counter-clockwise seen from above
  double elevation = 30.0;  ///< above the horizon, in [-90, 90]

  [[nodiscard]] Point3 direction() const;  ///< towards the camera
  [[nodiscard]] Point3 right() const;      ///< of the picture
  [[nodiscard]] Point3 up() const;
};

/// Returns the default view of a box: the flatter it is, the more from above.
Camera camera_for(const Point3& lo, const Point3& hi);

/// Whether an obstacle closes the view into a box: it lies before a side that faces the camera, and covers most of it.
bool closes_view(const Surface& surface, const Point3& lo, const Point3& hi, const Camera& camera);

}  // namespace trellis::draw
