// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of meshes. The first byte chooses the format, as the ending of the name does in a folder.
#include <trellis/reader/mesh_file.hpp>

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

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile stl("mesh.stl"), obj("mesh.obj"), ply("mesh.ply"), off("mesh.off"), byu("mesh.g");
  if (size == 0) return 0;
  trellis::fuzz::InputFile* file = nullptr;
  switch (data[0]) {
    case 's': file = &stl; break;
    case 'o': file = &obj; break;
    case 'p': file = &ply; break;
    case 'f': file = &off; break;
    default: file = &byu;
  }
  return trellis::fuzz::examine([&] { check(*trellis::read_mesh(file->write(data + 1, size - 1)).mesh); });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
