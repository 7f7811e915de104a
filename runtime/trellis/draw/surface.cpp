// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/surface.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace trellis::draw {

double dot(const Point3& a, const Point3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Point3 cross(const Point3& a, const Point3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Point3 unit(const Point3& a) {
  const double length = std::sqrt(dot(a, a));
  return length > 0.0 ? (1.0 / length) * a : a;
}

void append(Surface& whole, const Surface& part) {
  whole.closed = whole.closed && part.closed;
  const auto offset = static_cast<std::uint32_t>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  whole.triangles.reserve(whole.triangles.size() + part.triangles.size());
  for (const auto& t : part.triangles) whole.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

Surface clustered(const Surface& surface, double cell) {
  using Cell = std::tuple<double, double, double>;
  const auto count = surface.vertices.size();
  std::vector<std::pair<Cell, std::uint32_t>> order;
  order.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Point3& p = surface.vertices[i];
    order.emplace_back(Cell{std::floor(p.x / cell), std::floor(p.y / cell), std::floor(p.z / cell)}, i);
  }
  std::sort(order.begin(), order.end());
  Surface out{.closed = surface.closed};
  std::vector<std::uint32_t> merged(count, 0);
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin;
    Point3 sum;
    for (; end < count && order[end].first == order[begin].first; ++end) {
      sum = sum + surface.vertices[order[end].second];
      merged[order[end].second] = static_cast<std::uint32_t>(out.vertices.size());
    }
    out.vertices.push_back((1.0 / static_cast<double>(end - begin)) * sum);
    begin = end;
  }
  for (const auto& t : surface.triangles) {
    std::array<std::uint32_t, 3> moved{merged[t[0]], merged[t[1]], merged[t[2]]};
    if (moved[0] == moved[1] || moved[1] == moved[2] || moved[2] == moved[0]) continue;
    std::rotate(moved.begin(), std::min_element(moved.begin(), moved.end()), moved.end());
    out.triangles.push_back(moved);
  }
  std::sort(out.triangles.begin(), out.triangles.end());
  out.triangles.erase(std::unique(out.triangles.begin(), out.triangles.end()), out.triangles.end());
  return out;
}

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

std::vector<Point3> normals_of(const Surface& surface) {
  std::vector<Point3> normals;
  normals.reserve(surface.triangles.size());
  for (const auto& t : surface.triangles) {
    const auto& v = surface.vertices;
    normals.push_back(unit(cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]])));
  }
  return normals;
}

/// Calls f for each edge, ascending, with the edge and the range of its sides: pairs of the edge and a triangle.
template <class F>
void for_each_edge(const Surface& surface, const F& f) {
  std::vector<std::pair<Edge, std::uint32_t>> sides;
  sides.reserve(3 * surface.triangles.size());
  for (std::uint32_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k];
      const std::uint32_t b = t[(k + 1) % 3];
      sides.emplace_back(Edge{std::min(a, b), std::max(a, b)}, i);
    }
  }
  std::sort(sides.begin(), sides.end());
  for (auto begin = sides.begin(); begin != sides.end();) {
    auto end = begin + 1;
    while (end != sides.end() && end->first == begin->first) ++end;
    f(begin->first, begin, end);
    begin = end;
  }
}

/// Whether the triangles at an edge meet at an angle whose cosine is less than `least`, or are not two.
template <class Side>
bool is_sharp(const Surface& surface, const std::vector<Point3>& normals, Side begin, Side end, double least) {
  if (end - begin != 2) return true;
  const double agree = dot(normals[begin->second], normals[(begin + 1)->second]);
  return (surface.closed ? agree : std::abs(agree)) < least;
}

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> feature_edges(const Surface& surface, double degrees) {
  const std::vector<Point3> normals = normals_of(surface);
  const double least = cosine(degrees);
  std::vector<Edge> edges;
  for_each_edge(surface, [&](const Edge& edge, auto begin, auto end) {
    if (is_sharp(surface, normals, begin, end, least)) edges.push_back(edge);
  });
  return edges;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> drawn_edges(const Surface& surface, const Point3& to_camera) {
  constexpr double degrees = 25.0;
  const std::vector<Point3> normals = normals_of(surface);
  const double least = cosine(degrees);
  std::vector<Edge> edges;
  for_each_edge(surface, [&](const Edge& edge, auto begin, auto end) {
    const auto faces = [&](const auto& side) { return dot(normals[side.second], to_camera) > 0.0; };
    const auto facing = std::count_if(begin, end, faces);
    const bool outline = facing > 0 && facing < end - begin;
    const bool seen = facing > 0 || !surface.closed;
    if (outline || (seen && is_sharp(surface, normals, begin, end, least))) edges.push_back(edge);
  });
  return edges;
}

}  // namespace trellis::draw
