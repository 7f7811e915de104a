// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <trellis/scene/spatial/body_sphere.hpp>
#include <trellis/scene/spatial/shapes.hpp>

// Balls that cover the shapes of a link, for collision checking.

namespace trellis {

/// How balls cover a link.
struct CoverOptions {
  double excess = 0.008;         ///< how far the balls may protrude beyond the shapes, in metres
  double most_excess = 0.03;     ///< how far they may where more than `most_balls` would be needed otherwise
  std::size_t most_balls = 200;  ///< of a link
  double work = 1.0;             ///< how many times as long as usual the cover of a large link may take
  friend bool operator==(const CoverOptions&, const CoverOptions&) = default;
};

/// Balls that cover the shapes of a link.
struct MedialCover {
  std::vector<BodySphere> balls;
  /// A bound on the distance of the balls' points from the shapes: 0 where all shapes are spheres.
  double excess = 0.0;
};

/// Covers shapes by balls. All centres are on the surface of a shape or inside one; those inside are near its medial
/// axis. A sphere is covered by itself.
///
/// Every point of a surface lies in a ball. So does every point inside a solid whose depth is `excess` or more. This
/// holds for all meshes, whatever their orientation and however many parts they have: only where there is an inside
/// depends on these. A mesh that is not closed has no inside; there, points count as inside that its triangles enclose
/// along all six directions of the axes.
///
/// The balls protrude at most `options.excess` beyond the solids. Where a link needs more than `options.most_balls` the
/// excess grows, at most to `options.most_excess`. For very large links, it grows further: to `least_cover_excess`, so
/// that the time is bounded.
///
/// The result depends on the arguments alone: it uses no random numbers, and no functions whose rounding differs
/// between machines.
/// \param solids   of one link, in its frame; no clouds of points
/// \param options  how far the balls may protrude, and how many there are
MedialCover medial_cover(std::span<const Solid> solids, const CoverOptions& options = {});

/// Returns the least excess that `medial_cover` gives solids which are not spheres and capsules, in metres: the square
/// root of a 4000th of their area with `work` = 1, or a 138th of the cube root of their box's volume, whichever is
/// greater. 0 of others.
double least_cover_excess(std::span<const Solid> solids, const CoverOptions& options = {});

/// Raise it where `medial_cover` returns other balls than before: stored covers are made anew then.
constexpr int medial_cover_version = 1;

}  // namespace trellis
