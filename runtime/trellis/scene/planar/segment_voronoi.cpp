// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/segment_voronoi.hpp>

#include <CGAL/Segment_Delaunay_graph_2.h>
#include <CGAL/Segment_Delaunay_graph_filtered_traits_2.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <tuple>
#include <unordered_map>

namespace trellis {

namespace {

// Traits that allow crossings: segments of a union rounded to doubles may cross by a rounding error.
using Traits = CGAL::Segment_Delaunay_graph_filtered_traits_2<CGAL::Simple_cartesian<double>>;
using Graph = CGAL::Segment_Delaunay_graph_2<Traits>;

Vec2 vec(const Traits::Point_2& p) { return {p.x(), p.y()}; }

bool before(Vec2 a, Vec2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); }

template <class Handle>
struct AddressHash {
  std::size_t operator()(const Handle& handle) const { return std::hash<const void*>{}(&*handle); }
};

}  // namespace

SegmentVoronoi segment_voronoi(const std::vector<Vec2>& points,
                               const std::vector<std::pair<std::size_t, std::size_t>>& segments) {
  std::vector<Traits::Point_2> given;
  given.reserve(points.size());
  for (const Vec2 p : points) given.emplace_back(p.x, p.y);
  Graph graph;
  graph.insert_segments(given, segments.begin(), segments.end());

  // The graph has no indices, and the order and direction of its edges depend on addresses. So sort all elements by
  // their coordinates and compute the vertices from their sites in that order.
  std::vector<std::pair<SegmentVoronoi::Site, Graph::Vertex_handle>> found;
  for (auto v = graph.finite_vertices_begin(); v != graph.finite_vertices_end(); ++v) {
    const auto& site = v->site();
    if (site.is_point()) {
      found.emplace_back(SegmentVoronoi::Site{vec(site.point()), vec(site.point()), true}, v);
    } else {
      const Vec2 a = vec(site.source()), b = vec(site.target());
      found.emplace_back(before(b, a) ? SegmentVoronoi::Site{b, a, false} : SegmentVoronoi::Site{a, b, false}, v);
    }
  }
  const auto site_key = [](const SegmentVoronoi::Site& s) { return std::tuple(s.a.x, s.a.y, s.b.x, s.b.y, s.point); };
  std::sort(found.begin(), found.end(),
            [&](const auto& a, const auto& b) { return site_key(a.first) < site_key(b.first); });

  SegmentVoronoi diagram;
  std::unordered_map<Graph::Vertex_handle, std::uint32_t, AddressHash<Graph::Vertex_handle>> site_of;
  for (const auto& [site, handle] : found) {
    site_of.emplace(handle, static_cast<std::uint32_t>(diagram.sites.size()));
    diagram.sites.push_back(site);
  }

  std::vector<std::pair<SegmentVoronoi::Vertex, Graph::Face_handle>> faces;
  for (auto f = graph.finite_faces_begin(); f != graph.finite_faces_end(); ++f) {
    std::array<int, 3> corner = {0, 1, 2};
    const auto number = [&](int i) { return site_of.at(f->vertex(i)); };
    // Rotate, do not sort: the sites of a vertex go around it counter-clockwise.
    std::rotate(corner.begin(),
                std::min_element(corner.begin(), corner.end(), [&](int a, int b) { return number(a) < number(b); }),
                corner.end());
    const auto centre = graph.geom_traits().construct_svd_vertex_2_object()(
        f->vertex(corner[0])->site(), f->vertex(corner[1])->site(), f->vertex(corner[2])->site());
    faces.push_back({{vec(centre), {number(corner[0]), number(corner[1]), number(corner[2])}}, f});
  }
  std::sort(faces.begin(), faces.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first.sites, a.first.position.x, a.first.position.y) <
           std::tie(b.first.sites, b.first.position.x, b.first.position.y);
  });
  std::unordered_map<Graph::Face_handle, std::uint32_t, AddressHash<Graph::Face_handle>> vertex_of;
  for (const auto& [vertex, handle] : faces) {
    vertex_of.emplace(handle, static_cast<std::uint32_t>(diagram.vertices.size()));
    diagram.vertices.push_back(vertex);
  }

  for (auto e = graph.finite_edges_begin(); e != graph.finite_edges_end(); ++e) {
    const Graph::Face_handle face = e->first;
    const int i = e->second;
    const auto one = vertex_of.find(face), other = vertex_of.find(face->neighbor(i));
    if (one == vertex_of.end() || other == vertex_of.end()) continue;  // an unbounded edge
    const auto [from, to] = std::minmax(one->second, other->second);
    const auto [first, second] =
        std::minmax(site_of.at(face->vertex(Graph::ccw(i))), site_of.at(face->vertex(Graph::cw(i))));
    diagram.edges.push_back({from, to, first, second});
  }
  std::sort(diagram.edges.begin(), diagram.edges.end(), [](const auto& a, const auto& b) {
    return std::tie(a.from, a.to, a.first_site, a.second_site) < std::tie(b.from, b.to, b.first_site, b.second_site);
  });
  return diagram;
}

}  // namespace trellis
