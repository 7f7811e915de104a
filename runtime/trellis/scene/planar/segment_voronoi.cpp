// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/segment_voronoi.hpp>

#include <boost/polygon/voronoi_builder.hpp>
#include <boost/polygon/voronoi_diagram.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/planar_box_tree.hpp>

namespace trellis {

namespace {

using Diagram = boost::polygon::voronoi_diagram<double>;

/// A point of the grid. Products of differences fit into 64 bits.
struct GridPoint {
  std::int64_t x = 0, y = 0;
  // clang-tidy 14 takes the comparison with 0 in it for a pointer.
  friend auto operator<=>(const GridPoint&, const GridPoint&) = default;  // NOLINT(modernize-use-nullptr)
};

GridPoint operator-(GridPoint a, GridPoint b) { return {a.x - b.x, a.y - b.y}; }
std::int64_t cross(GridPoint a, GridPoint b) { return a.x * b.y - a.y * b.x; }

/// A grid about points. Its cells are a power of two wide and it contains the origin, so that it has coordinates of few
/// bits exactly where its axes are the world's.
class Grid {
 public:
  /// \param x_axis  its direction, a unit vector
  Grid(const std::vector<Vec2>& points, Vec2 x_axis) : x_axis_(x_axis) {
    const Box2 extent = bounding_box(points);
    const Vec2 size = extent.hi - extent.lo;
    const double longest = std::max({size.x, size.y, std::numeric_limits<double>::min()});
    // 2^30 for half the length, and room for moving the centre and for turning.
    const double room = x_axis == Vec2{1.0, 0.0} ? 1.5 : 2.2;
    cells_per_metre_ = std::exp2(std::floor(31.0 - std::log2(room * longest)));
    const double unit = std::exp2(std::floor(std::log2(longest))) / 4.0;
    centre_ = 0.5 * (extent.lo + extent.hi);
    centre_ = {std::round(centre_.x / unit) * unit, std::round(centre_.y / unit) * unit};
  }

  [[nodiscard]] GridPoint operator()(Vec2 p) const {
    const Vec2 from = p - centre_;
    return {std::llround(dot(x_axis_, from) * cells_per_metre_), std::llround(cross(x_axis_, from) * cells_per_metre_)};
  }
  [[nodiscard]] Vec2 position(Vec2 cell) const {
    const Vec2 along = (1.0 / cells_per_metre_) * cell;
    return centre_ + Vec2{x_axis_.x * along.x - x_axis_.y * along.y, x_axis_.y * along.x + x_axis_.x * along.y};
  }

 private:
  Vec2 x_axis_;
  Vec2 centre_;
  double cells_per_metre_ = 1.0;
};

/// Segments on the grid that share end points only.
class GridSegments {
 public:
  struct Segment {
    std::uint32_t from = 0, to = 0;                                     ///< points, from the lesser to the greater
    std::uint32_t source = 0;                                           ///< index of the given segment
    friend auto operator<=>(const Segment&, const Segment&) = default;  // NOLINT(modernize-use-nullptr)
  };

  GridSegments(const Grid& grid, const std::vector<Vec2>& points,
               const std::vector<std::pair<std::size_t, std::size_t>>& segments)
      : grid_(grid) {
    std::vector<std::pair<GridPoint, std::uint32_t>> rounded;
    rounded.reserve(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) rounded.emplace_back(grid(points[i]), i);
    std::sort(rounded.begin(), rounded.end());
    std::vector<std::uint32_t> number(points.size());
    for (const auto& [at, source] : rounded) {
      if (points_.empty() || points_.back() != at) {
        points_.push_back(at);
        positions_.push_back(points[source]);
        sources_.push_back(source);
      }
      number[source] = static_cast<std::uint32_t>(points_.size() - 1);
    }
    given_ = points_.size();
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
      const auto [from, to] = std::minmax({number[segments[i].first], number[segments[i].second]});
      if (from != to) segments_.push_back({from, to, i});
    }
    unite();
    // Each round divides segments at points of the others; almost always, the first one finds none.
    constexpr int most_rounds = 100;
    for (int round = 0; divide(); ++round) {
      if (round == most_rounds) throw Error("Voronoi diagram: segments still cross after they were divided 100 times");
    }
  }

  [[nodiscard]] const std::vector<Segment>& segments() const { return segments_; }
  [[nodiscard]] const std::vector<GridPoint>& points() const { return points_; }
  /// Returns the site of a point: with the coordinates of a given point where it is one.
  [[nodiscard]] SegmentVoronoi::Site site(std::uint32_t point) const {
    return {positions_[point], positions_[point], true, sources_[point]};
  }

 private:
  /// Removes equal segments.
  void unite() {
    std::sort(segments_.begin(), segments_.end());
    const auto same = [](const Segment& a, const Segment& b) { return a.from == b.from && a.to == b.to; };
    segments_.erase(std::unique(segments_.begin(), segments_.end(), same), segments_.end());
  }

  /// Divides the segments that cross each other or pass through the cell of an end point of another. Returns whether
  /// there are any.
  bool divide() {
    std::vector<Box2> boxes;
    boxes.reserve(segments_.size());
    for (const Segment& segment : segments_) boxes.push_back(box_of(segment));
    const PlanarBoxTree tree(boxes);
    // A segment, and the point to divide it at.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> cuts;
    for (std::uint32_t i = 0; i < segments_.size(); ++i) {
      const Box2& box = boxes[i];
      tree.each([&](const Box2& other) { return boxes_meet(box, other); },
                [&](std::uint32_t j) {
                  if (j > i) compare(i, j, cuts);
                });
    }
    if (cuts.empty()) return false;
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    for (auto first = cuts.begin(); first != cuts.end();) {
      const auto last = std::find_if(first, cuts.end(), [&](const auto& cut) { return cut.first != first->first; });
      divide(first->first, first, last);
      first = last;
    }
    unite();
    return true;
  }

  template <class Cut>
  void divide(std::uint32_t segment, Cut first, Cut last) {
    const Segment whole = segments_[segment];
    const GridPoint start = points_[whole.from], along = points_[whole.to] - start;
    const auto before = [&](const auto& a, const auto& b) {
      const GridPoint left = points_[a.second] - start, right = points_[b.second] - start;
      return along.x * left.x + along.y * left.y < along.x * right.x + along.y * right.y;
    };
    std::stable_sort(first, last, before);
    std::uint32_t from = whole.from;
    const auto piece = [&](std::uint32_t to) {
      const auto [least, greatest] = std::minmax({from, to}, [&](auto a, auto b) { return points_[a] < points_[b]; });
      from = to;
      return Segment{least, greatest, whole.source};
    };
    segments_[segment] = piece(first->second);
    for (auto cut = first + 1; cut != last; ++cut) segments_.push_back(piece(cut->second));
    segments_.push_back(piece(whole.to));
  }

  /// Adds where two segments divide each other.
  void compare(std::uint32_t i, std::uint32_t j, std::vector<std::pair<std::uint32_t, std::uint32_t>>& cuts) {
    const Segment a = segments_[i], b = segments_[j];
    const std::size_t known = cuts.size();
    for (const std::uint32_t point : {b.from, b.to}) {
      if (passes(a, point)) cuts.emplace_back(i, point);
    }
    for (const std::uint32_t point : {a.from, a.to}) {
      if (passes(b, point)) cuts.emplace_back(j, point);
    }
    if (cuts.size() != known || a.from == b.from || a.from == b.to || a.to == b.from || a.to == b.to) return;
    const GridPoint along_a = points_[a.to] - points_[a.from], along_b = points_[b.to] - points_[b.from];
    const std::int64_t before_b = cross(along_a, points_[b.from] - points_[a.from]);
    const std::int64_t after_b = cross(along_a, points_[b.to] - points_[a.from]);
    const std::int64_t before_a = cross(along_b, points_[a.from] - points_[b.from]);
    const std::int64_t after_a = cross(along_b, points_[a.to] - points_[b.from]);
    if ((before_b < 0) == (after_b < 0) || (before_a < 0) == (after_a < 0)) return;
    if (before_b == 0 || after_b == 0 || before_a == 0 || after_a == 0) return;
    const double share = static_cast<double>(before_a) / (static_cast<double>(before_a) - static_cast<double>(after_a));
    const GridPoint start = points_[a.from];
    const GridPoint crossing{start.x + std::llround(share * static_cast<double>(along_a.x)),
                             start.y + std::llround(share * static_cast<double>(along_a.y))};
    const std::uint32_t point = number_of(crossing);
    if (point != a.from && point != a.to) cuts.emplace_back(i, point);
    if (point != b.from && point != b.to) cuts.emplace_back(j, point);
  }

  /// Whether a segment passes, between its ends, through the cell about a point that is none of its ends.
  [[nodiscard]] bool passes(const Segment& segment, std::uint32_t point) const {
    if (point == segment.from || point == segment.to) return false;
    const GridPoint along = points_[segment.to] - points_[segment.from];
    const GridPoint off = points_[point] - points_[segment.from];
    const bool steep = std::abs(along.y) > std::abs(along.x);
    const std::int64_t whole = steep ? along.y : along.x, part = steep ? off.y : off.x;
    if (whole > 0 ? part <= 0 || part >= whole : part >= 0 || part <= whole) return false;
    return 2 * std::abs(cross(along, off)) < std::abs(along.x) + std::abs(along.y);
  }

  /// Returns the number of a point, a new one if necessary.
  std::uint32_t number_of(GridPoint p) {
    const auto added = points_.begin() + static_cast<std::ptrdiff_t>(given_);
    auto found = std::lower_bound(points_.begin(), added, p);
    if (found == added || *found != p) found = std::find(added, points_.end(), p);
    if (found != points_.end()) return static_cast<std::uint32_t>(found - points_.begin());
    points_.push_back(p);
    positions_.push_back(grid_.position({static_cast<double>(p.x), static_cast<double>(p.y)}));
    sources_.push_back(SegmentVoronoi::no_source);
    return static_cast<std::uint32_t>(points_.size() - 1);
  }

  /// Returns the box of a segment and the cells about its ends.
  [[nodiscard]] Box2 box_of(const Segment& segment) const {
    const GridPoint a = points_[segment.from], b = points_[segment.to];
    const auto corner = [](std::int64_t x, std::int64_t y) {
      return Vec2{static_cast<double>(x), static_cast<double>(y)};
    };
    return {corner(std::min(a.x, b.x) - 1, std::min(a.y, b.y) - 1),
            corner(std::max(a.x, b.x) + 1, std::max(a.y, b.y) + 1)};
  }

  Grid grid_;
  std::vector<GridPoint> points_;     ///< different: the given ones in order, then crossings
  std::size_t given_ = 0;             ///< of points_
  std::vector<Vec2> positions_;       ///< of the points
  std::vector<std::size_t> sources_;  ///< of the points: the first given one there
  std::vector<Segment> segments_;
};

/// The sites of a diagram, in the order of its cells.
class Sites {
 public:
  Sites(const Diagram& diagram, const GridSegments& given) : diagram_(diagram), given_(given) {
    using boost::polygon::SOURCE_CATEGORY_SEGMENT_END_POINT;
    using boost::polygon::SOURCE_CATEGORY_SEGMENT_START_POINT;
    for (const auto& cell : diagram.cells()) {
      const auto& segment = given.segments()[cell.source_index()];
      if (cell.source_category() == SOURCE_CATEGORY_SEGMENT_START_POINT) {
        ends_.emplace_back(segment.from, segment.from);
      } else if (cell.source_category() == SOURCE_CATEGORY_SEGMENT_END_POINT) {
        ends_.emplace_back(segment.to, segment.to);
      } else {
        ends_.emplace_back(segment.from, segment.to);
      }
    }
  }

  [[nodiscard]] std::vector<SegmentVoronoi::Site> all() const {
    std::vector<SegmentVoronoi::Site> sites;
    sites.reserve(ends_.size());
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const auto [from, to] = ends_[i];
      sites.push_back(given_.site(from));
      if (from == to) continue;
      sites.back() = {sites.back().a, given_.site(to).a, false,
                      given_.segments()[diagram_.cells()[i].source_index()].source};
    }
    return sites;
  }

  /// Returns the number of the site of a cell.
  [[nodiscard]] std::uint32_t number(const Diagram::cell_type* cell) const {
    return static_cast<std::uint32_t>(cell - diagram_.cells().data());
  }

  /// Whether a vertex is equally far from all sites about it, up to rounding. Far outside of the grid it does not
  /// matter.
  [[nodiscard]] bool equidistant(const Diagram::vertex_type& vertex) const {
    const Vec2 centre{vertex.x(), vertex.y()};
    if (!(std::max(std::abs(centre.x), std::abs(centre.y)) < 1LL << 32U)) return true;
    double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
    const auto* edge = vertex.incident_edge();
    do {
      const double distance = norm(to_site(centre, number(edge->cell())));
      least = std::min(least, distance);
      greatest = std::max(greatest, distance);
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    constexpr double cells = 4.0;
    return greatest - least <= cells;
  }

  /// Returns three sites of those about a vertex: the first, the one in the direction farthest from its, and the one
  /// that makes the largest triangle with both directions.
  [[nodiscard]] std::array<std::uint32_t, 3> about(const Diagram::vertex_type& vertex) const {
    std::vector<std::uint32_t> sites;
    const auto* edge = vertex.incident_edge();
    do {
      sites.push_back(number(edge->cell()));
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    std::sort(sites.begin(), sites.end());
    if (sites.size() > 3) {
      const Vec2 centre{vertex.x(), vertex.y()};
      const Vec2 first = direction(centre, sites[0]);
      const auto better = [&](auto begin, auto measure) {
        const auto best = std::max_element(begin, sites.end(), [&](std::uint32_t a, std::uint32_t b) {
          return measure(direction(centre, a)) < measure(direction(centre, b));
        });
        std::iter_swap(begin, best);
      };
      better(sites.begin() + 1, [&](Vec2 u) { return dot(u - first, u - first); });
      const Vec2 second = direction(centre, sites[1]);
      better(sites.begin() + 2, [&](Vec2 u) { return std::abs(cross(second - first, u - first)); });
    }
    return {sites[0], sites[1], sites[2]};
  }

 private:
  /// The vector from a position to the nearest point of a site.
  [[nodiscard]] Vec2 to_site(Vec2 from, std::uint32_t site) const {
    const auto position = [&](std::uint32_t point) {
      const GridPoint p = given_.points()[point];
      return Vec2{static_cast<double>(p.x), static_cast<double>(p.y)};
    };
    Vec2 to = position(ends_[site].first);
    if (ends_[site].first != ends_[site].second) {
      const Vec2 along = position(ends_[site].second) - to;
      to = to + std::clamp(dot(from - to, along) / dot(along, along), 0.0, 1.0) * along;
    }
    return to - from;
  }
  /// Its direction; zero where there is none.
  [[nodiscard]] Vec2 direction(Vec2 from, std::uint32_t site) const {
    const Vec2 to = to_site(from, site);
    const double length = norm(to);
    return length > 0.0 ? (1.0 / length) * to : Vec2{};
  }

  const Diagram& diagram_;
  const GridSegments& given_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_;
};

/// The diagram of segments whose points are rounded to a grid.
struct Attempt {
  SegmentVoronoi diagram;
  std::size_t wrong = 0;  ///< vertices that are not equally far from their sites
};

Attempt attempt(const Grid& grid, const std::vector<Vec2>& points,
                const std::vector<std::pair<std::size_t, std::size_t>>& segments) {
  const GridSegments given(grid, points, segments);
  boost::polygon::voronoi_builder<std::int32_t> builder;
  for (const auto& segment : given.segments()) {
    const GridPoint a = given.points()[segment.from], b = given.points()[segment.to];
    builder.insert_segment(static_cast<std::int32_t>(a.x), static_cast<std::int32_t>(a.y),
                           static_cast<std::int32_t>(b.x), static_cast<std::int32_t>(b.y));
  }
  Diagram found;
  builder.construct(&found);

  Attempt result;
  SegmentVoronoi& diagram = result.diagram;
  const Sites sites(found, given);
  diagram.sites = sites.all();
  diagram.vertices.reserve(found.num_vertices());
  std::vector<char> right;
  right.reserve(found.num_vertices());
  for (const auto& vertex : found.vertices()) {
    diagram.vertices.push_back({grid.position({vertex.x(), vertex.y()}), sites.about(vertex)});
    right.push_back(sites.equidistant(vertex) ? 1 : 0);
  }
  result.wrong = static_cast<std::size_t>(std::count(right.begin(), right.end(), 0));
  const auto number = [&](const Diagram::vertex_type* vertex) {
    return static_cast<std::uint32_t>(vertex - found.vertices().data());
  };
  for (const auto& edge : found.edges()) {
    // An edge has two halves.
    if (!edge.is_finite() || edge.twin() < &edge) continue;
    const auto [from, to] = std::minmax({number(edge.vertex0()), number(edge.vertex1())});
    const auto [first, second] = std::minmax({sites.number(edge.cell()), sites.number(edge.twin()->cell())});
    if (right[from] != 0 && right[to] != 0) diagram.edges.push_back({from, to, first, second});
  }
  return result;
}

}  // namespace

SegmentVoronoi segment_voronoi(const std::vector<Vec2>& points,
                               const std::vector<std::pair<std::size_t, std::size_t>>& segments) {
  Attempt best = attempt(Grid(points, {1.0, 0.0}), points, segments);
  // Boost.Polygon orders some events wrongly that are nearly simultaneous. Turned, the same segments have others.
  for (const Vec2 x_axis : {Vec2{0.8, 0.6}, Vec2{5.0 / 13.0, 12.0 / 13.0}, Vec2{-8.0 / 17.0, 15.0 / 17.0}}) {
    if (best.wrong == 0) break;
    Attempt next = attempt(Grid(points, x_axis), points, segments);
    if (next.wrong < best.wrong) best = std::move(next);
  }
  return std::move(best.diagram);
}

}  // namespace trellis
