// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/mesh.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/ranges.hpp>
#include <trellis/scene/spatial/surface.hpp>

namespace trellis {

namespace {

constexpr std::uint32_t none = 0xffffffff;

std::string text_of(const Vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

void check_counts(std::size_t vertices, std::size_t triangles, const std::string& what) {
  if (triangles == 0) throw Error(fmt::format("{}: a mesh needs at least one triangle", what));
  if (triangles > Mesh::most_triangles) {
    throw Error(fmt::format("{}: a mesh has at most {} triangles, got {}", what, Mesh::most_triangles, triangles));
  }
  // Three of each triangle where none are shared.
  if (vertices > 3 * Mesh::most_triangles) {
    throw Error(fmt::format("{}: a mesh has at most {} vertices, got {}", what, 3 * Mesh::most_triangles, vertices));
  }
}

void check_vertices(std::vector<Vec3>& vertices, const std::string& what) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!in_range(vertices[i])) {
      throw Error(fmt::format("{}: vertex {} must lie within {:g} m of 0 in x, y and z, got {}", what, i + 1,
                              most_distant, text_of(vertices[i])));
    }
    // -0 and 0 are one coordinate.
    vertices[i] = vertices[i] + Vec3{};
  }
}

std::uint64_t bits_of(const Vec3& v) {
  std::uint64_t hash = 0x9e3779b97f4a7c15;
  for (const double x : {v.x, v.y, v.z}) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0xff51afd7ed558ccd;
    hash ^= hash >> 32U;
  }
  return hash;
}

/// Returns, for each vertex, the first one with its coordinates.
std::vector<std::uint32_t> first_alike(const std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> table(std::bit_ceil(2 * vertices.size()), none);
  const std::size_t mask = table.size() - 1;
  std::vector<std::uint32_t> first(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    std::size_t slot = bits_of(vertices[i]) & mask;
    while (table[slot] != none && vertices[table[slot]] != vertices[i]) slot = (slot + 1) & mask;
    if (table[slot] == none) table[slot] = i;
    first[i] = table[slot];
  }
  return first;
}

void check_triangles(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                     const std::string& what) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    for (const std::uint32_t v : t) {
      if (v < vertices.size()) continue;
      throw Error(fmt::format("{}: triangle {} names vertex {}, but there are {}", what, i + 1, std::uint64_t{v} + 1U,
                              vertices.size()));
    }
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      throw Error(fmt::format("{}: triangle {} names vertices {}, {} and {}; they must be three different ones", what,
                              i + 1, t[0] + 1U, t[1] + 1U, t[2] + 1U));
    }
    const Vec3& a = vertices[t[0]];
    if (cross(vertices[t[1]] - a, vertices[t[2]] - a) == Vec3{}) {
      throw Error(fmt::format("{}: triangle {} has no area: its vertices {}, {} and {} lie on a line", what, i + 1,
                              text_of(a), text_of(vertices[t[1]]), text_of(vertices[t[2]])));
    }
  }
}

/// Makes vertices with the same coordinates one, and drops those of no triangle.
void merge_vertices(std::vector<Vec3>& vertices, std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> place = first_alike(vertices);
  std::vector<char> used(vertices.size(), 0);
  for (Triangle& t : triangles) {
    for (std::uint32_t& v : t) {
      v = place[v];
      used[v] = 1;
    }
  }
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (used[i] == 0) continue;
    vertices[count] = vertices[i];
    place[i] = count++;
  }
  vertices.resize(count);
  vertices.shrink_to_fit();
  for (Triangle& t : triangles) {
    for (std::uint32_t& v : t) v = place[v];
  }
}

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  // Neither has padding.
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::uint64_t hash_of(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  const std::array<std::uint64_t, 2> parts{stable_hash(bytes_of(vertices)), stable_hash(bytes_of(triangles))};
  return stable_hash({reinterpret_cast<const char*>(parts.data()), sizeof(parts)});
}

}  // namespace

Mesh::Mesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles, const std::string& what)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)) {
  check_counts(vertices_.size(), triangles_.size(), what);
  check_vertices(vertices_, what);
  check_triangles(vertices_, triangles_, what);
  merge_vertices(vertices_, triangles_);
  if (vertices_.size() > most_triangles) {
    throw Error(
        fmt::format("{}: a mesh has at most {} different vertices, got {}", what, most_triangles, vertices_.size()));
  }
  analyse(what);
}

void Mesh::analyse(const std::string& what) {
  bounds_ = bounds_of(vertices_);
  const auto neighbours = neighbours_of(vertices_.size(), triangles_);
  closed_ = !neighbours.empty();
  if (closed_) {
    turn_outwards(vertices_, triangles_, neighbours, what);
    convex_ = is_convex(vertices_, triangles_, neighbours);
  }
  hash_ = hash_of(vertices_, triangles_);
}

double Mesh::volume() const {
  return closed_ ? signed_volume(vertices_, triangles_, 0.5 * (bounds_.lo + bounds_.hi)) : 0.0;
}

Mesh Mesh::scaled(double factor) const {
  Mesh result = *this;
  for (Vec3& v : result.vertices_) v = factor * v;
  result.bounds_ = {factor * bounds_.lo, factor * bounds_.hi};
  if (!(factor > 0.0) || !in_range(result.bounds_.lo) || !in_range(result.bounds_.hi)) {
    throw Error(
        fmt::format("a mesh with bounds {} to {} cannot be scaled by {}: the factor must be greater than 0, and "
                    "vertices must stay within {:g} m of 0",
                    text_of(bounds_.lo), text_of(bounds_.hi), factor, most_distant));
  }
  result.hash_ = hash_of(result.vertices_, result.triangles_);
  return result;
}

bool contains(const Mesh& mesh, const Vec3& p) {
  const Box3& box = mesh.bounds();
  if (!mesh.closed() || least_of(box.lo, p) != box.lo || greatest_of(box.hi, p) != box.hi) return false;
  int winding = 0;
  for (const Triangle& t : mesh.triangles()) winding += crossing(p, mesh.vertices(), t);
  return winding > 0;
}

double distance_to_surface(const Mesh& mesh, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  const auto& v = mesh.vertices();
  for (const Triangle& t : mesh.triangles())
    least = std::min(least, distance_to_triangle(p, v[t[0]], v[t[1]], v[t[2]]));
  return least;
}

// Source: Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return norm(ap);
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return norm(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return norm(ap - d1 / (d1 - d3) * ab);
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return norm(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return norm(ap - d2 / (d2 - d6) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return norm(bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
  }
  const Vec3 normal = cross(ab, ac);
  return std::abs(dot(normal, ap)) / norm(normal);
}

}  // namespace trellis
