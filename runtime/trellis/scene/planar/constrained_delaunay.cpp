// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/constrained_delaunay.hpp>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <tuple>
#include <unordered_map>

namespace trellis {

namespace {

// Predicates are exact, so the result is a valid triangulation. Crossings of segments are rounded, which suffices for a
// guide. Exact constructions would cost several times the compile time.
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Default, CGAL::Exact_predicates_tag>;

Vec2 vec(const Kernel::Point_2& p) { return {p.x(), p.y()}; }

}  // namespace

std::vector<DelaunayTriangle> constrained_delaunay(const std::vector<Vec2>& points,
                                                   const std::vector<std::pair<std::size_t, std::size_t>>& segments) {
  Cdt cdt;
  std::vector<Cdt::Vertex_handle> vertices;
  vertices.reserve(points.size());
  for (const Vec2 p : points) vertices.push_back(cdt.insert(Kernel::Point_2(p.x, p.y)));
  for (const auto& [a, b] : segments) {
    if (vertices[a] != vertices[b]) cdt.insert_constraint(vertices[a], vertices[b]);
  }

  // CGAL's order of faces is arbitrary: rotate each face to begin with its least corner, then sort the faces by their
  // corners.
  struct Found {
    Cdt::Face_handle face;
    int first = 0;
    DelaunayTriangle triangle;
  };
  std::vector<Found> found;
  for (auto face = cdt.finite_faces_begin(); face != cdt.finite_faces_end(); ++face) {
    Found f{face, 0, {}};
    const auto key = [&](int i) {
      const Vec2 p = vec(face->vertex(i)->point());
      return std::pair(p.x, p.y);
    };
    for (int i = 1; i < 3; ++i) {
      if (key(i) < key(f.first)) f.first = i;
    }
    for (int i = 0; i < 3; ++i) {
      f.triangle.corners[static_cast<std::size_t>(i)] = vec(face->vertex((f.first + i) % 3)->point());
    }
    found.push_back(f);
  }
  std::sort(found.begin(), found.end(), [](const Found& x, const Found& y) {
    const auto& [a, b, c] = x.triangle.corners;
    const auto& [d, e, f] = y.triangle.corners;
    return std::tie(a.x, a.y, b.x, b.y, c.x, c.y) < std::tie(d.x, d.y, e.x, e.y, f.x, f.y);
  });
  std::unordered_map<const void*, std::uint32_t> number;
  for (std::uint32_t i = 0; i < found.size(); ++i) number.emplace(&*found[i].face, i);
  std::vector<DelaunayTriangle> triangles;
  triangles.reserve(found.size());
  for (auto& f : found) {
    for (int i = 0; i < 3; ++i) {
      const auto across = number.find(&*f.face->neighbor((f.first + i) % 3));
      f.triangle.neighbours[static_cast<std::size_t>(i)] =
          across != number.end() ? across->second : DelaunayTriangle::none;
    }
    triangles.push_back(f.triangle);
  }
  return triangles;
}

}  // namespace trellis
