// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/space/rotation.hpp>

namespace trellis {

struct PointCloudOptions {
  std::string unit = "m";  ///< of the file's coordinates, as MeshOptions::unit
  bool skip_nan = false;   ///< leaves points out whose coordinates are not numbers, as those of depth images
};

/// The points of a file, in metres.
struct PointCloudFile {
  std::vector<Vec3> points;
  std::string format;       ///< "PCD, binary"
  std::size_t skipped = 0;  ///< points that were left out
  std::vector<std::string> warnings;
};

/// The endings of the files that read_point_cloud reads, in lower case.
const std::vector<std::string>& point_cloud_endings();

/// Reads points from a file in the format that its ending names: PLY (the vertices; faces are left out), PCD (ASCII,
/// binary, compressed; the viewpoint is left out), or lines of text (.xyz, .pts, .txt, .csv): the columns that the
/// header calls x, y and z, or without a header the first three.
/// \throws Error with file, line or byte, and reason: the file cannot be read, has more than 256 MiB or 5 million
///     points, is malformed, has no points, or one with a coordinate that is no number
PointCloudFile read_point_cloud(const std::string& path, const PointCloudOptions& options = {});

}  // namespace trellis
