// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/reader/mesh_formats.hpp>

namespace trellis {

// What the readers of the formats of clouds share; callers use read_point_cloud.

/// The points of a file, as they are read.
class PointSink {
 public:
  PointSink(const MeshSource& source, bool skip_nan) : source_(source), skip_nan_(skip_nan) {}

  std::string format;
  std::vector<std::string> warnings;  ///< what the file contains and the cloud does not

  /// Adds a point from its coordinates in the file's unit. \param line  of the point, 0 in a binary file
  void add(const Vec3& given, std::size_t line);
  /// \throws Error where a file declares more points than a cloud may have
  void check_limit(double count, std::size_t line) const;

  [[nodiscard]] std::vector<Vec3>& points() { return points_; }
  [[nodiscard]] std::size_t skipped() const { return skipped_; }

 private:
  const MeshSource& source_;
  bool skip_nan_;
  std::size_t seen_ = 0;
  std::size_t skipped_ = 0;
  std::vector<Vec3> points_;
};

void read_ply_points(const MeshSource& source, PointSink& sink);
void read_pcd(const MeshSource& source, PointSink& sink);
void read_xyz(const MeshSource& source, PointSink& sink);

}  // namespace trellis
