// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <trellis/scene/spatial/mesh.hpp>

// How the triangles of a mesh lie together.

namespace trellis {

/// The triangles on the far sides of a triangle's edges 0-1, 1-2 and 2-0.
using Neighbours = std::array<std::uint32_t, 3>;

/// Returns each triangle's neighbours where the mesh is closed: each directed edge occurs as often as its opposite. Of
/// an edge with more than two triangles, the first ones of either direction are neighbours, then the second ones, as
/// where solids of one file touch. Returns nothing for another mesh.
std::vector<Neighbours> neighbours_of(std::size_t vertices, std::span<const Triangle> triangles);

/// A part of a mesh that is connected: triangles with a common vertex are.
struct MeshComponent {
  Vec3 vertex;         ///< the first one
  Vec3 second, third;  ///< far from it, and far from the line through both, so that the three show how large it is
};
/// Returns the components of a mesh, in the order of their first vertices.
std::vector<MeshComponent> components_of(const Mesh& mesh);

/// Turns the triangles of a closed mesh such that they run counter-clockwise from outside, cavities from inside.
/// \throws Error where too many components would have to be compared
void turn_outwards(const std::vector<Vec3>& vertices, std::vector<Triangle>& triangles,
                   const std::vector<Neighbours>& neighbours, const std::string& what);

/// Whether a closed mesh whose triangles run counter-clockwise from outside is convex within rounding.
bool is_convex(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
               const std::vector<Neighbours>& neighbours);

/// Returns how often the ray from p along x leaves minus how often it enters through the triangle: 1, 0 or -1. Summed
/// over a closed mesh it is the winding number of p, also where the ray meets edges or vertices.
int crossing(const Vec3& p, const std::vector<Vec3>& vertices, const Triangle& triangle);

/// Returns the volume between the triangles and the point `about`, counted negative where they run clockwise.
double signed_volume(const std::vector<Vec3>& vertices, std::span<const Triangle> triangles, const Vec3& about);

}  // namespace trellis
