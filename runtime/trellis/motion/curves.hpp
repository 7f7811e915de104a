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

/// A piece of constant curvature of a curve.
struct CurvePiece {
  double length = 0.0;  ///< metres; negative: driven backwards
  int turn = 0;         ///< 1: to the left at the least radius, -1: to the right, 0: straight
};

/// A curve of bounded curvature, as its pieces.
struct Curve {
  std::vector<CurvePiece> pieces;
  double radius = 1.0;

  [[nodiscard]] double length() const;
  /// Where it has come to after `s` metres, from a start; beyond its length, its end.
  [[nodiscard]] CurvePose at(const CurvePose& start, double s) const;
};

/// The shortest curve that is driven forwards with a turning radius of at least `radius` > 0 (Dubins 1957).
Curve dubins(const CurvePose& from, const CurvePose& to, double radius);
/// The shortest that may also be driven backwards (Reeds and Shepp 1990).
Curve reeds_shepp(const CurvePose& from, const CurvePose& to, double radius);

}  // namespace trellis
