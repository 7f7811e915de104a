// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/scene/spatial/mesh.hpp>
#include <trellis/scene/spatial/ranges.hpp>
#include <trellis/scene/spatial/surface.hpp>

namespace trellis {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

double area_of(const std::vector<Vec3>& v, const std::vector<Triangle>& triangles) {
  double twice = 0.0;
  for (const Triangle& t : triangles) twice += norm(cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]));
  return 0.5 * twice;
}

}  // namespace

Mesh Mesh::hull(const std::vector<Vec3>& points, const std::string& what) {
  if (points.size() > 3 * most_triangles) {
    throw Error(fmt::format("{}: at most {} points, got {}", what, 3 * most_triangles, points.size()));
  }
  std::vector<Kernel::Point_3> given;
  given.reserve(points.size());
  double greatest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    if (!in_range(p)) {
      throw Error(fmt::format("{}: point {} must lie within {:g} m of 0 in x, y and z, got ({}, {}, {})", what, i + 1,
                              most_distant, p.x, p.y, p.z));
    }
    greatest = std::max({greatest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    given.emplace_back(p.x, p.y, p.z);
  }
  CGAL::Surface_mesh<Kernel::Point_3> surface;
  if (given.size() >= 4) CGAL::convex_hull_3(given.begin(), given.end(), surface);
  Mesh mesh;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    mesh.vertices_.push_back(Vec3{p.x(), p.y(), p.z()} + Vec3{});
  }
  for (const auto f : surface.faces()) {
    std::vector<std::uint32_t> corners;
    for (const auto v : CGAL::vertices_around_face(surface.halfedge(f), surface)) {
      corners.push_back(static_cast<std::uint32_t>(v));
    }
    if (corners.size() == 3) mesh.triangles_.push_back({corners[0], corners[1], corners[2]});
  }
  // Of a plate, twice the volume over the area is its thickness.
  constexpr double rounding = 1e-12;
  const Vec3 about = mesh.vertices_.empty() ? Vec3{} : mesh.vertices_.front();
  const double volume = signed_volume(mesh.vertices_, mesh.triangles_, about);
  if (!(2.0 * volume > rounding * greatest * area_of(mesh.vertices_, mesh.triangles_))) {
    throw Error(fmt::format("{}: a convex hull needs four points that do not lie in one plane, got {} in a plane", what,
                            points.size()));
  }
  mesh.analyse(what);
  // Each predicate was exact, whatever rounding finds of thin triangles.
  mesh.convex_ = true;
  return mesh;
}

}  // namespace trellis
