// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// An affine map of SVG: (x, y) -> (a x + c y + e, b x + d y + f).
struct SvgTransform {
  double a = 1.0, b = 0.0, c = 0.0, d = 1.0, e = 0.0, f = 0.0;

  [[nodiscard]] Vec2 operator()(Vec2 p) const { return {a * p.x + c * p.y + e, b * p.x + d * p.y + f}; }
  /// The map that applies `inner` first.
  [[nodiscard]] SvgTransform after(const SvgTransform& inner) const;
};

/// Reads the value of the attribute `transform`.
/// \throws Error without file and line
SvgTransform svg_transform(std::string_view text);

/// Returns the points of a path's data, the attribute `d`; curves and arcs become 32 chords each.
/// \throws Error without file and line
std::vector<Vec2> svg_path(std::string_view text);

/// Reads numbers separated by blanks and commas: of `points`, of `viewBox`.
/// \throws Error without file and line
std::vector<double> svg_numbers(std::string_view text);

}  // namespace trellis
