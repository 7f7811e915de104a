// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of meshes and of clouds of points. The first byte chooses the format, as the ending of the name does in a
// folder.
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/point_cloud_file.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>

#include <cmath>
#include <cstdlib>
#include <string>

#include "fuzz.hpp"

namespace {

/// What every mesh that was read has; else the program ends, which is a finding.
void check(const trellis::Mesh& mesh) {
  const trellis::Vec3 middle = 0.5 * (mesh.bounds().lo + mesh.bounds().hi);
  bool good = !mesh.triangles().empty() && std::isfinite(mesh.volume());
  for (const trellis::Triangle& t : mesh.triangles()) {
    for (const std::uint32_t v : t) good = good && v < mesh.vertices().size();
  }
  good = good && !std::isnan(trellis::distance_to_surface(mesh, middle));
  // Whatever the order of the triangles, what bounds a solid has its inside counted positive.
  if (mesh.convex()) good = good && mesh.closed() && mesh.volume() >= 0.0;
  static_cast<void>(trellis::contains(mesh, middle));
  if (!good) std::abort();
}

/// The same of points: the balls of a thinned cloud contain the others.
void check(const trellis::PointCloudFile& file) {
  const trellis::PointCloud cloud(file.points, 0.1, "points");
  const trellis::PointCloud thin = cloud.thinned(0.05);
  constexpr double largest = 0.15 * (1.0 + 1e-9);
  bool good = !file.points.empty() && thin.radius() <= largest;
  for (const trellis::Vec3& p : cloud.points()) good = good && thin.nearest(p).distance + 0.1 <= thin.radius();
  if (!good) std::abort();
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile stl("mesh.stl"), obj("mesh.obj"), ply("mesh.ply"), off("mesh.off"), byu("mesh.g");
  static trellis::fuzz::InputFile pcd("points.pcd"), xyz("points.xyz"), vertices("points.ply");
  if (size == 0) return 0;
  trellis::fuzz::InputFile* file = nullptr;
  switch (data[0]) {
    case 's': file = &stl; break;
    case 'o': file = &obj; break;
    case 'p': file = &ply; break;
    case 'f': file = &off; break;
    case 'c': file = &pcd; break;
    case 't': file = &xyz; break;
    case 'v': file = &vertices; break;
    default: file = &byu;
  }
  if (file == &pcd || file == &xyz || file == &vertices) {
    return trellis::fuzz::examine(
        [&] { check(trellis::read_point_cloud(file->write(data + 1, size - 1), {.skip_nan = data[0] == 'c'})); });
  }
  return trellis::fuzz::examine([&] { check(*trellis::read_mesh(file->write(data + 1, size - 1)).mesh); });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
