// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/surface.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// An edge of a triangle as seen from its vertex with the smaller index.
struct Side {
  std::uint32_t to = 0;  ///< the larger index
  std::uint32_t triangle = 0;
  std::uint8_t edge = 0;
  bool upwards = false;  ///< whether the triangle runs from the smaller index to the larger one
};

/// Sides by their vertex with the smaller index: those of vertex v are begin[v] to begin[v + 1].
struct Sides {
  std::vector<std::size_t> begin;
  std::vector<Side> all;
};

Sides sides_of(std::size_t vertices, std::span<const Triangle> triangles) {
  Sides sides;
  sides.begin.assign(vertices + 1, 0);
  sides.all.resize(3 * triangles.size());
  const auto each = [&](auto&& visit) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::uint8_t edge = 0; edge < 3; ++edge) {
        const std::uint32_t from = triangles[t][edge];
        const std::uint32_t to = triangles[t][(edge + 1U) % 3U];
        visit(std::min(from, to), Side{std::max(from, to), static_cast<std::uint32_t>(t), edge, from < to});
      }
    }
  };
  each([&](std::uint32_t v, const Side&) { ++sides.begin[v + 1U]; });
  for (std::size_t v = 0; v < vertices; ++v) sides.begin[v + 1] += sides.begin[v];
  std::vector<std::size_t> next(sides.begin.begin(), sides.begin.end() - 1);
  each([&](std::uint32_t v, const Side& side) { sides.all[next[v]++] = side; });
  return sides;
}

/// The components of a closed mesh: triangles that are joined by edges.
struct Components {
  std::vector<std::uint32_t> of;     ///< by triangle
  std::vector<std::uint32_t> first;  ///< of each component: a triangle
  std::vector<double> volume;        ///< of each component, negative where it is clockwise
  std::vector<Box3> bounds;          ///< of each component
};

Components components_of(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                         const std::vector<Neighbours>& neighbours) {
  constexpr std::uint32_t none = 0xffffffff;
  Components result;
  result.of.assign(triangles.size(), none);
  std::vector<std::uint32_t> front;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (result.of[t] != none) continue;
    const auto id = static_cast<std::uint32_t>(result.first.size());
    const Vec3 about = vertices[triangles[t][0]];
    Box3 bounds{about, about};
    double volume = 0.0;
    result.first.push_back(t);
    result.of[t] = id;
    front.assign(1, t);
    while (!front.empty()) {
      const std::uint32_t at = front.back();
      front.pop_back();
      volume += signed_volume(vertices, {&triangles[at], 1}, about);
      for (const std::uint32_t v : triangles[at]) {
        bounds = {least_of(bounds.lo, vertices[v]), greatest_of(bounds.hi, vertices[v])};
      }
      for (const std::uint32_t other : neighbours[at]) {
        if (result.of[other] != none) continue;
        result.of[other] = id;
        front.push_back(other);
      }
    }
    result.volume.push_back(volume);
    result.bounds.push_back(bounds);
  }
  return result;
}

bool within(const Box3& inner, const Box3& outer) {
  return outer.lo.x < inner.lo.x && outer.lo.y < inner.lo.y && outer.lo.z < inner.lo.z && inner.hi.x < outer.hi.x &&
         inner.hi.y < outer.hi.y && inner.hi.z < outer.hi.z;
}

double size_of(const Box3& box) { return norm(box.hi - box.lo); }

/// Returns, for each component, the largest one that it lies inside, or none.
std::vector<std::optional<std::uint32_t>> outermost_containers(const std::vector<Vec3>& vertices,
                                                               const std::vector<Triangle>& triangles,
                                                               const Components& components, const std::string& what) {
  constexpr std::size_t most_comparisons = 400'000'000;
  const std::size_t count = components.first.size();
  // One point of each component, by its y.
  std::vector<std::pair<double, std::uint32_t>> points;
  points.reserve(count);
  for (std::uint32_t c = 0; c < count; ++c) points.emplace_back(vertices[triangles[components.first[c]][0]].y, c);
  std::sort(points.begin(), points.end());
  // (inner, outer, winding number) of the triangles on rays from these points.
  struct Hit {
    std::uint32_t inner;
    std::uint32_t outer;
    int winding;
  };
  std::vector<Hit> hits;
  std::size_t comparisons = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t outer = components.of[t];
    const auto [lo, hi] =
        std::minmax({vertices[triangles[t][0]].y, vertices[triangles[t][1]].y, vertices[triangles[t][2]].y});
    auto at = std::lower_bound(points.begin(), points.end(), std::pair(lo, std::uint32_t{0}));
    for (; at != points.end() && at->first <= hi; ++at) {
      if (++comparisons > most_comparisons) {
        throw Error(
            fmt::format("{}: {} parts, of which some run clockwise, are too many to find which are cavities of "
                        "others; turn their triangles counter-clockwise from outside",
                        what, count));
      }
      if (at->second == outer || !within(components.bounds[at->second], components.bounds[outer])) continue;
      const Vec3& p = vertices[triangles[components.first[at->second]][0]];
      if (const int winding = crossing(p, vertices, triangles[t])) hits.push_back({at->second, outer, winding});
    }
  }
  std::sort(hits.begin(), hits.end(),
            [](const Hit& a, const Hit& b) { return std::pair(a.inner, a.outer) < std::pair(b.inner, b.outer); });
  std::vector<std::optional<std::uint32_t>> containers(count);
  for (std::size_t i = 0; i < hits.size();) {
    const Hit& hit = hits[i];
    int winding = 0;
    for (; i < hits.size() && hits[i].inner == hit.inner && hits[i].outer == hit.outer; ++i) winding += hits[i].winding;
    auto& container = containers[hit.inner];
    if (winding == 0) continue;
    if (!container || size_of(components.bounds[*container]) < size_of(components.bounds[hit.outer])) {
      container = hit.outer;
    }
  }
  return containers;
}

/// The side of the directed edge a b, in the plane of y and z, that p lies on: 1 left, -1 right. A point on the edge's
/// line counts as moved a little along y, then a lot less along z; 0 where a and b coincide there.
int side_of(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double along_y = b.y - a.y;
  const double along_z = b.z - a.z;
  const double area = along_y * (p.z - a.z) - along_z * (p.y - a.y);
  for (const double sign : {area, -along_z, along_y}) {
    if (sign != 0.0) return sign > 0.0 ? 1 : -1;
  }
  return 0;
}

/// The same from both triangles at the edge, up to the sign: the vertex with the smaller index comes first.
int side_of(const Vec3& p, const std::vector<Vec3>& vertices, std::uint32_t a, std::uint32_t b) {
  return a < b ? side_of(p, vertices[a], vertices[b]) : -side_of(p, vertices[b], vertices[a]);
}

}  // namespace

std::vector<Neighbours> neighbours_of(std::size_t vertices, std::span<const Triangle> triangles) {
  std::vector<Neighbours> neighbours(triangles.size());
  Sides sides = sides_of(vertices, triangles);
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::span<Side> here(sides.all.data() + sides.begin[v], sides.begin[v + 1] - sides.begin[v]);
    // Of each edge, first the triangles that run upwards, then the others.
    std::sort(here.begin(), here.end(), [](const Side& a, const Side& b) {
      return std::tuple(a.to, !a.upwards, a.triangle) < std::tuple(b.to, !b.upwards, b.triangle);
    });
    for (std::size_t first = 0; first < here.size();) {
      std::size_t middle = first;
      while (middle < here.size() && here[middle].to == here[first].to && here[middle].upwards) ++middle;
      std::size_t last = middle;
      while (last < here.size() && here[last].to == here[first].to) ++last;
      if (middle - first != last - middle) return {};
      for (; middle < last; ++first, ++middle) {
        neighbours[here[first].triangle][here[first].edge] = here[middle].triangle;
        neighbours[here[middle].triangle][here[middle].edge] = here[first].triangle;
      }
      first = last;
    }
  }
  return neighbours;
}

std::vector<MeshComponent> components_of(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices().size());
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto root_of = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  // The root is the first vertex of its component.
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    a = root_of(a);
    b = root_of(b);
    parent[std::max(a, b)] = std::min(a, b);
  };
  for (const auto& [a, b, c] : mesh.triangles()) {
    join(a, b);
    join(b, c);
  }
  const auto& vertices = mesh.vertices();
  std::vector<std::size_t> place(parent.size());
  std::vector<MeshComponent> result;
  for (std::uint32_t i = 0; i < parent.size(); ++i) {
    if (parent[i] == i) {
      place[i] = result.size();
      result.push_back({vertices[i], vertices[i], vertices[i]});
    } else {
      place[i] = place[root_of(i)];
      MeshComponent& part = result[place[i]];
      if (norm(vertices[i] - part.vertex) > norm(part.second - part.vertex)) part.second = vertices[i];
    }
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i) {
    MeshComponent& part = result[place[i]];
    const Vec3 along = part.second - part.vertex;
    const auto from_line = [&](const Vec3& p) { return norm(cross(along, p - part.vertex)); };
    if (from_line(vertices[i]) > from_line(part.third)) part.third = vertices[i];
  }
  return result;
}

void turn_outwards(const std::vector<Vec3>& vertices, std::vector<Triangle>& triangles,
                   const std::vector<Neighbours>& neighbours, const std::string& what) {
  const Components components = components_of(vertices, triangles, neighbours);
  const auto clockwise = [&](std::uint32_t component) { return components.volume[component] < 0.0; };
  const std::size_t count = components.first.size();
  if (std::none_of(components.volume.begin(), components.volume.end(), [](double v) { return v < 0.0; })) return;
  std::vector<std::optional<std::uint32_t>> containers(count);
  if (count > 1) containers = outermost_containers(vertices, triangles, components, what);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t component = components.of[t];
    if (clockwise(containers[component].value_or(component))) std::swap(triangles[t][1], triangles[t][2]);
  }
}

bool is_convex(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
               const std::vector<Neighbours>& neighbours) {
  const Box3 bounds = bounds_of(vertices);
  const double rounding = 1e-10 * size_of(bounds);
  Vec3 middle;
  for (const Vec3& v : vertices) middle = middle + 1.0 / static_cast<double>(vertices.size()) * v;
  int winding = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vec3& a = vertices[triangles[t][0]];
    const Vec3 normal = cross(vertices[triangles[t][1]] - a, vertices[triangles[t][2]] - a);
    const double most = rounding * norm(normal);
    if (dot(normal, middle - a) >= -most) return false;
    for (const std::uint32_t other : neighbours[t]) {
      for (const std::uint32_t v : triangles[other]) {
        if (dot(normal, vertices[v] - a) > most) return false;
      }
    }
    winding += crossing(middle, vertices, triangles[t]);
  }
  // A surface may bend outwards at each edge and still wind about its middle twice, as several convex parts may.
  return winding == 1;
}

int crossing(const Vec3& p, const std::vector<Vec3>& vertices, const Triangle& triangle) {
  const Vec3& a = vertices[triangle[0]];
  const Vec3& b = vertices[triangle[1]];
  const Vec3& c = vertices[triangle[2]];
  if (a.x <= p.x && b.x <= p.x && c.x <= p.x) return 0;
  const int side = side_of(p, vertices, triangle[0], triangle[1]);
  if (side == 0 || side_of(p, vertices, triangle[1], triangle[2]) != side ||
      side_of(p, vertices, triangle[2], triangle[0]) != side) {
    return 0;
  }
  const double height = dot(cross(b - a, c - a), p - a);
  return height * side < 0.0 ? side : 0;
}

double signed_volume(const std::vector<Vec3>& vertices, std::span<const Triangle> triangles, const Vec3& about) {
  double six = 0.0;
  for (const Triangle& t : triangles) {
    six += dot(vertices[t[0]] - about, cross(vertices[t[1]] - about, vertices[t[2]] - about));
  }
  return six / 6.0;
}

}  // namespace trellis
