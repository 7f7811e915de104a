// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace trellis {

/// A position in the plane and a heading.
struct CurvePose {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;
};

/// A piece of a curve with constant curvature.
struct CurvePiece {
  double length = 0.0;  ///< metres; negative: backwards
  int turn = 0;         ///< 1: left at the least radius, -1: right, 0: straight
};

/// A curve of bounded curvature, as a sequence of pieces.
struct Curve {
  std::vector<CurvePiece> pieces;
  double radius = 1.0;

  [[nodiscard]] double length() const;
  /// Returns the pose after `s` metres from `start`; the end of the curve where `s` exceeds its length.
  [[nodiscard]] CurvePose at(const CurvePose& start, double s) const;
};

/// Returns the shortest forward curve with a turning radius of at least `radius` > 0, in metres (Dubins 1957).
Curve dubins(const CurvePose& from, const CurvePose& to, double radius);
/// Returns the shortest curve with forward and backward pieces (Reeds and Shepp 1990).
Curve reeds_shepp(const CurvePose& from, const CurvePose& to, double radius);

}  // namespace trellis
