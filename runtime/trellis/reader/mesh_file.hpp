// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <trellis/scene/spatial/mesh.hpp>

namespace trellis {

struct MeshOptions {
  /// The unit of the file's coordinates, which none of the formats states: "m", "mm", "cm", "inch", or the number of
  /// metres.
  std::string unit = "m";
  /// Of COLLADA: turns a file in which z or x is up such that y is up, (x, y, z) to (x, z, -y) or (-y, x, z), and joins
  /// equal vertices, as programs do that load it through assimp. Otherwise its axes are kept.
  bool y_up = false;
  /// Factors along the axes, none 0, by which vertices are multiplied after the unit. Where an odd number of them is
  /// negative the mesh is mirrored, and its triangles are turned.
  Vec3 scale = {1.0, 1.0, 1.0};
};

/// A mesh, and what was found in its file.
struct MeshFile {
  std::shared_ptr<const Mesh> mesh;
  std::string format;            ///< "STL, binary"
  std::size_t polygons = 0;      ///< of the file; those with more than three vertices become several triangles
  std::size_t without_area = 0;  ///< triangles that were left out
  Vec3 vertex_mean;              ///< of all vertices of the file, repeated ones included
  char up = '\0';                ///< the axis that points up by a file of COLLADA: 'x', 'y', 'z'; 0 of other formats
  double metres_in_unit = 1.0;   ///< by MeshOptions, or by a file of COLLADA
  std::string unit_name = {};    ///< the name that a file of COLLADA gives its unit: "inch"
  std::vector<std::string> warnings;
  std::string up_warning = {};  ///< where another axis than z is up: what turns it, for a scene that does not; or ""
};

/// The endings of the files that read_mesh reads, in lower case: "stl", "obj", "ply", "off", "g", "dae".
const std::vector<std::string>& mesh_endings();
/// Whether a file's ending is one of mesh_endings.
bool has_mesh_ending(const std::string& path);

/// Returns the number of metres of a unit. \throws Error that names the units
double metres_in(const std::string& unit);

/// Reads a mesh from a file in the format that its ending names: STL (ASCII or binary), OBJ, PLY (ASCII or binary),
/// OFF, BYU (.g), or COLLADA (.dae), which states its unit. Polygons are cut into triangles; triangles without area are
/// left out. \throws Error with file, line and reason: the file cannot be read, has more than 64 MiB, 2 million
/// triangles or 1000
///     vertices in a polygon, is malformed, or has no triangle
MeshFile read_mesh(const std::string& path, const MeshOptions& options = {});

}  // namespace trellis
