// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/aligned_lift.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/guide/position_guide.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/skeleton.hpp>
#include <trellis/scene/set_up_cache.hpp>
#include <trellis/scene/spatial/ball_graph.hpp>
#include <trellis/scene/spatial/box_tree.hpp>
#include <trellis/scene/spatial/ranges.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

namespace {

struct SkeletonSettings {
  bool follow_regions = false;
  bool prune = true;
  double spacing = 0.0;
  double radius = 0.0;
  std::vector<std::string> point;
  std::int64_t evidence = 60;
  double region = 2.0;
  double explore = 0.5;
  double decay = 0.9;
  double emphasis = 2.0;
  double clearance = 0.0;
  double penetration = 0.5;
  double alignment = -1.0;
  std::int64_t drop = 0;
  std::int64_t patience = 200;
  std::int64_t resolves = 1000;
};

const Settings<SkeletonSettings>& skeleton_settings() {
  static const Settings<SkeletonSettings> settings = with_point(
      Settings<SkeletonSettings>(Component::Kind::guide, "skeleton",
                                 "the medial axis of the free workspace as a graph, in space one of overlapping "
                                 "maximal balls; dynamic regions "
                                 "travel along it, directed from start to goal, and proposals come from them",
                                 "Denny, Sandstrom, Bregger and Amato 2016, Dynamic region-biased RRT")
          .choice("follow", &SkeletonSettings::follow_regions, {{"path", false}, {"regions", true}},
                  "\"path\": the path found on the axis is validated in C at points `spacing` apart, with the angles "
                  "that are nearest to those before, and proposals are a step of the planner ahead of the node that "
                  "came farthest along it; \"regions\": dynamic regions along the whole axis, or along the path found "
                  "where a guide guides the search. Where there is a motion model, always regions")
          .boolean(
              "prune", &SkeletonSettings::prune,
              "leave out edges that are narrower than the largest disc or ball about the reference point inside the "
              "robot, which it cannot pass, or inside a larger robot of a level above, which its path would not help; "
              "without "
              "effect for an arm that is fixed to its base, whose tip is a point")
          .number(
              "spacing", &SkeletonSettings::spacing, "m", Range::non_negative(),
              "distance between the points of the path that are validated in C; 0: 0.8 of the planner's step, or the "
              "robot's bounding radius where that is more (2 % of the space's diameter for a point); 2 % of the "
              "diameter of S for an arm that is fixed to its base")
          .number(
              "radius", &SkeletonSettings::radius, "m in the metric", Range::non_negative(),
              "radius of the balls about the path that proposals are drawn from; 0: half the robot's bounding "
              "radius, or of the space's diameter 1 % for a point, 5 % for an arm and 7.5 % for a robot of a URDF file")
          .integer("evidence", &SkeletonSettings::evidence, "proposals", Range::at_least(1),
                   "guided proposals at one place of the path that C found blocked, after which the path is refuted "
                   "there and the graph searched again; of a robot of a URDF file so many for each three joints")
          .number("region", &SkeletonSettings::region, "bounding radii", Range::positive(),
                  "radius of a region, in bounding radii of the robot; of a point and an arm's tip, in hundredths of "
                  "the world's diagonal")
          .number("explore", &SkeletonSettings::explore, "share of proposals", Range::share(),
                  "e: share that is spread evenly over the regions and the whole space; the rest follows the weights")
          .number("decay", &SkeletonSettings::decay, "factor", {.lo = 0, .hi = 1, .open_lo = true},
                  "what a region's successes and attempts are multiplied by before each new one is counted")
          .number("penetration", &SkeletonSettings::penetration, "share of its diameter", Range::share(),
                  "how much of the robot's bounding circle, in its diameters, is inside a region where a node moves "
                  "it on; 0.5: the reference point is inside; 1: the whole circle")
          .number("alignment", &SkeletonSettings::alignment, "cosine", {.lo = -1, .hi = 0.99},
                  "of a robot with a motion model: the least cosine of the angle between the edge at a region and the "
                  "velocity of a proposal from it, of which a state without velocities has the one at its greatest "
                  "speed; -1: velocities are uniform")
          .integer("drop", &SkeletonSettings::drop, "proposals", Range::non_negative(),
                   "proposals of a region without a new node, in a row, after which it is dropped; 0: never")
          .number("emphasis", &SkeletonSettings::emphasis, "factor", Range::at_least(1),
                  "factor on the weight of the regions on the path found on the axis; 1: as published")
          .number("clearance", &SkeletonSettings::clearance, "m", Range::non_negative(),
                  "edges of the skeleton with less clearance than this are left out")
          .integer("patience", &SkeletonSettings::patience, "proposals", Range::at_least(1),
                   "proposals of a region without progress after which it is stuck; when all are, the edges they are "
                   "stuck on cost more and the graph is searched again")
          .integer("resolves", &SkeletonSettings::resolves, "re-solves", Range::non_negative(),
                   "how often the graph may be searched again"));
  return settings;
}

/// Factor on the cost of an edge on which all regions are stuck.
constexpr double stuck_penalty = 4.0;
/// Factor on the cost of a refuted edge.
constexpr double refuted_penalty = 1000.0;
/// Maximum number of points of the skeleton, nearest first, that start and goal try to connect to.
constexpr std::size_t most_sights = 100;

std::array<double, 2> row(Vec2 p) { return {p.x, p.y}; }
std::array<double, 3> row(const Vec3& p) { return {p.x, p.y, p.z}; }

double squared_distance(View a, View b) {
  double squared = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) squared += (a[j] - b[j]) * (a[j] - b[j]);
  return squared;
}
double distance(View a, View b) {
  const double x = a[0] - b[0];
  const double y = a[1] - b[1];
  return a.size() == 2 ? std::hypot(x, y) : std::hypot(x, y, a[2] - b[2]);
}

/// What the graphs of all runs in a world share: the skeleton's edges that are wide enough, without start and goals.
struct SkeletonBase {
  Graph graph;
  std::vector<std::vector<double>> clearances;  ///< for each edge, along its points, metres
  /// For each edge, the two points in its middle, which are the same one where the number of its points is odd.
  Configurations middles;
  BoxTree tree;  ///< of the edges; in the plane, z is 0
};

/// Which edges of a skeleton a graph has.
struct Passable {
  double clearance = 0.0;  ///< the least along an edge, metres
  bool parts = false;      ///< also the parts of narrower edges that have this clearance
  friend auto operator<=>(const Passable&, const Passable&) = default;
};

/// The choice of edges, and the weights of the axes that edges are measured with.
using SkeletonKey = std::pair<Passable, std::vector<double>>;

Vec3 corner_of(View p) { return {p[0], p[1], p.size() > 2 ? p[2] : 0.0}; }

/// \param vertices  of the skeleton
template <class Skeleton>
SkeletonBase make_base(const Skeleton& skeleton, const Space& space, const Passable& passable,
                       Configurations vertices) {
  SkeletonBase base;
  base.graph.vertices = std::move(vertices);
  base.middles = Configurations(space.dimension());
  base.middles.reserve(2 * skeleton.edges.size());
  std::vector<Box3> boxes;
  // Adds the points [first, end) of an edge, all of it or a part.
  const auto add = [&](const auto& edge, std::size_t first, std::size_t end) {
    Configurations points(space.dimension());
    points.reserve(end - first);
    for (std::size_t i = first; i < end; ++i) points.push(row(edge.points[i]));
    const auto& rows = std::as_const(points);
    Box3 box{corner_of(rows[0]), corner_of(rows[0])};
    for (std::size_t i = 1; i < rows.size(); ++i) {
      box = {least_of(box.lo, corner_of(rows[i])), greatest_of(box.hi, corner_of(rows[i]))};
    }
    boxes.push_back(box);
    base.middles.push(rows[rows.size() / 2]);
    base.middles.push(rows[(rows.size() - 1) / 2]);
    const double length = path_length(space, points);
    const std::uint32_t from = first == 0 ? edge.from : base.graph.vertices.push(rows[0]);
    const std::uint32_t to = end == edge.points.size() ? edge.to : base.graph.vertices.push(rows[rows.size() - 1]);
    base.graph.edges.push_back({from, to, length, std::move(points)});
    const auto clearances = edge.clearance.begin();
    base.clearances.emplace_back(clearances + static_cast<std::ptrdiff_t>(first),
                                 clearances + static_cast<std::ptrdiff_t>(end));
  };
  for (const auto& edge : skeleton.edges) {
    const std::size_t n = edge.points.size();
    const auto wide = [&](std::size_t i) { return edge.clearance[i] >= passable.clearance; };
    std::size_t first = 0;
    for (std::size_t i = 0; i <= n; ++i) {
      if (i < n && wide(i)) continue;
      const bool whole = first == 0 && i == n;
      if (i >= first + 2 && (whole || passable.parts)) add(edge, first, i);
      first = i + 1;
    }
  }
  base.tree = BoxTree(boxes);
  return base;
}

std::shared_ptr<const SkeletonBase> cached_base(const Scene& scene, const Space& space, const Passable& passable) {
  SkeletonKey key{passable, {}};
  for (const Axis& axis : space.axes()) key.second.push_back(axis.weight);
  if (scene.planar() != nullptr) {
    static SetUpCache<SkeletonBase, SkeletonKey> cache;
    return cache.get(planar(scene).world, key, [&](const World& world) {
      const auto skeleton = cached_medial_axis(world);
      Configurations vertices(space.dimension());
      for (const Vec2 v : skeleton->vertices) vertices.push(row(v));
      return make_base(*skeleton, space, passable, std::move(vertices));
    });
  }
  static SetUpCache<SkeletonBase, SkeletonKey> cache;
  return cache.get(spatial(scene).world, key, [&](const World3& world) {
    const auto balls = cached_ball_graph(world);
    Configurations vertices(space.dimension());
    for (const auto& ball : balls->balls) vertices.push(row(ball.centre));
    return make_base(*balls, space, passable, std::move(vertices));
  });
}

/// What the edges of one run's graph have beside their points: most share it with other runs.
class EdgeTable {
 public:
  explicit EdgeTable(std::shared_ptr<const SkeletonBase> base)
      : base_(std::move(base)), changed_(base_->clearances.size(), 0) {}

  /// Sets the clearances along an edge that was added or changed.
  void set(std::size_t edge, std::vector<double> clearance) {
    if (edge < changed_.size()) changed_[edge] = 1;
    own_[edge] = std::move(clearance);
  }
  /// Whether the edge is one of this run alone.
  [[nodiscard]] bool own(std::size_t edge) const { return edge >= changed_.size() || changed_[edge] != 0; }
  /// Returns the edges of this run alone.
  [[nodiscard]] const std::map<std::size_t, std::vector<double>>& own() const { return own_; }
  /// Returns the clearance of an edge's points, metres; 0 if unknown.
  [[nodiscard]] const std::vector<double>& clearance(std::size_t edge) const {
    return own(edge) ? own_.at(edge) : base_->clearances[edge];
  }
  [[nodiscard]] const SkeletonBase& base() const { return *base_; }

 private:
  std::shared_ptr<const SkeletonBase> base_;
  std::vector<char> changed_;                       ///< of the base's edges
  std::map<std::size_t, std::vector<double>> own_;  ///< clearances of the edges of this run alone
};

/// Makes a Graph of the skeleton's edges, with start and goals connected to the nearest visible points of it.
class GraphBuilder {
 public:
  /// \param clearance  edges with less are left out
  GraphBuilder(const Scene& scene, double clearance, Instance& instance)
      : instance_(instance),
        dimension_(instance.space.dimension()),
        clearance_(clearance),
        table_(cached_base(scene, instance.space, {clearance})) {
    if (scene.planar() != nullptr && clearance > 0.0) {
      const auto disc = std::make_shared<PlanarScene>(planar(scene).world, Robot::disc(clearance));
      disc_step_ = std::min(instance.resolution, clearance);
      disc_ = make_validity("planar", disc, instance.space, disc_step_, nullptr);
    }
    if (build(scene) || !disc_) return;
    // An end lies where the axis is wide and leads to a narrow place.
    table_ = EdgeTable(cached_base(scene, instance.space, {clearance, true}));
    parts_ = true;
    graph_ = {};
    build(scene);
  }
  [[nodiscard]] Graph take() { return std::move(graph_); }
  [[nodiscard]] EdgeTable take_table() { return std::move(table_); }

 private:
  /// Makes the graph. Returns whether the disc of the least clearance can move from each end to the axis: only then the
  /// graph has a path where the disc has one.
  bool build(const Scene& scene) {
    const Graph& base = table_.base().graph;
    joined_ = true;
    // Start and goals add a vertex each, and may split an edge each.
    const std::size_t added = 2 * (1 + instance_.goals.size());
    graph_.vertices = Configurations(dimension_);
    graph_.vertices.reserve(base.vertices.size() + added);
    for (std::size_t v = 0; v < base.vertices.size(); ++v) graph_.vertices.push(base.vertices[v]);
    graph_.edges.reserve(base.edges.size() + added);
    graph_.edges = base.edges;
    graph_.start = join(instance_.start);
    for (const Configuration& goal : instance_.goals) graph_.goals.push_back(join(goal));
    // A world without obstacles has no medial axis, and the straight motion is valid.
    const bool empty = scene.obstacle_count() == 0 && graph_.edges.empty();
    for (const std::uint32_t goal : graph_.goals) {
      Configurations straight(dimension_);
      straight.push(instance_.start);
      straight.push(std::as_const(graph_.vertices)[goal]);
      const auto& ends = std::as_const(straight);
      // An end that is not joined to the axis may see the other end.
      const bool seen = parts_ && !joined_ && disc_moves(ends.front(), ends.back());
      if (empty || seen) add_edge(graph_.start, goal, std::move(straight), {0.0, 0.0});
    }
    return joined_;
  }
  /// Whether the disc of the least clearance can move between two places: in steps as long as its distance from the
  /// obstacles, or as the resolution where that is longer. Each distance counts.
  bool disc_moves(View a, View b) {
    if (!disc_) return true;
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    Configuration q(dimension_);
    for (double done = 0.0;; done = std::min(length, done)) {
      instance_.space.interpolate(a, b, length > 0.0 ? done / length : 0.0, q);
      const Instance::Announced before = instance_.open_checks();
      const double room = disc_->clearance(q);
      instance_.count_distance(before);
      if (!(room > 0.0)) return false;
      if (done >= length) return true;
      done += std::max(room, disc_step_);
    }
  }
  /// Whether the disc of the least clearance is free at a place. The check counts.
  bool disc_stands(View q) {
    return instance_.check_one([&] { return disc_->state(q); });
  }

  void add_edge(std::uint32_t from, std::uint32_t to, Configurations points, std::vector<double> clearance) {
    const double length = path_length(instance_.space, points);
    table_.set(graph_.edges.size(), std::move(clearance));
    graph_.edges.push_back({from, to, length, std::move(points)});
  }

  /// A point of an edge that a configuration may connect to. Sights are in order of distance.
  struct Sight {
    double distance = std::numeric_limits<double>::infinity();
    std::size_t edge = 0;
    std::size_t point = 0;
    friend bool operator<(const Sight& a, const Sight& b) {
      return std::tie(a.distance, a.edge, a.point) < std::tie(b.distance, b.edge, b.point);
    }
  };

  /// Adds q as a vertex and connects it to the nearest visible point of the edges.
  std::uint32_t join(const Configuration& q) {
    const std::uint32_t vertex = graph_.vertices.push(q);
    // The nearest point is usually visible; then the other points need no sorting.
    const Sight nearest = nearest_sight(q);
    const bool there = std::isfinite(nearest.distance);
    const bool seen = there && sees(q, nearest);
    // Without room for the disc at q, the real robot has no path.
    std::optional<bool> stands;
    const auto suits = [&](const Sight& sight) {
      if (leads_to(q, sight)) return true;
      if (!stands) stands = disc_stands(q);
      return !*stands;
    };
    if (seen && suits(nearest)) return connect(vertex, nearest);
    std::vector<Sight> sights = all_sights(q);
    const std::size_t most = parts_ ? sights.size() : std::min(most_sights, sights.size());
    const auto last = sights.begin() + static_cast<std::ptrdiff_t>(most);
    std::partial_sort(sights.begin(), last, sights.end());
    const Sight* visible = seen ? &nearest : nullptr;
    for (auto sight = sights.begin() + (there ? 1 : 0); sight != last; ++sight) {
      if (!sees(q, *sight)) continue;
      if (suits(*sight)) return connect(vertex, *sight);
      if (visible == nullptr) visible = &*sight;
    }
    if (disc_ && !stands) stands = disc_stands(q);
    joined_ = joined_ && !stands.value_or(false);
    // The nearest visible point is better than none.
    return visible != nullptr ? connect(vertex, *visible) : vertex;
  }
  [[nodiscard]] View point(const Sight& sight) const {
    return std::as_const(graph_.edges[sight.edge].points)[sight.point];
  }
  /// Whether the motion of a point from q to a point of the axis is valid.
  bool sees(View q, const Sight& sight) { return sight.distance == 0.0 || instance_.motion(q, point(sight)).valid; }
  /// Whether the disc of the least clearance, too, can move there: always where the clearance at that point shows it.
  bool leads_to(View q, const Sight& sight) {
    const double room = table_.clearance(sight.edge)[sight.point] - clearance_;
    return !disc_ || sight.distance <= room || disc_moves(q, point(sight));
  }

  /// Returns the nearest point of the edges; with an infinite distance where there is none.
  [[nodiscard]] Sight nearest_sight(const Configuration& q) const {
    Sight nearest;
    double least = std::numeric_limits<double>::infinity();
    const auto visit = [&](std::size_t e) {
      const auto& points = graph_.edges[e].points;
      for (std::size_t i = 0; i < points.size(); ++i) {
        // Only a point that is nearer, up to rounding, needs its exact distance.
        const double squared = squared_distance(points[i], q);
        if (squared > least) continue;
        const Sight sight{distance(points[i], q), e, i};
        if (!(sight < nearest)) continue;
        nearest = sight;
        least = squared * (1.0 + 1e-9);
      }
    };
    const Vec3 at = corner_of(q);
    const auto bound = [&](const Box3& box) {
      const double x = std::max({box.lo.x - at.x, at.x - box.hi.x, 0.0});
      const double y = std::max({box.lo.y - at.y, at.y - box.hi.y, 0.0});
      const double z = std::max({box.lo.z - at.z, at.z - box.hi.z, 0.0});
      return x * x + y * y + z * z;
    };
    const BoxTree& tree = table_.base().tree;
    tree.nearest(least, bound, [&](std::size_t rank) {
      if (!table_.own(tree.order()[rank])) visit(tree.order()[rank]);
    });
    for (const auto& own : table_.own()) visit(own.first);
    return nearest;
  }

  [[nodiscard]] std::vector<Sight> all_sights(const Configuration& q) const {
    std::vector<Sight> sights;
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      const auto& points = graph_.edges[e].points;
      for (std::size_t i = 0; i < points.size(); ++i) {
        sights.push_back({distance(points[i], q), e, i});
      }
    }
    return sights;
  }

  /// Adds the edge from a vertex to a point of an edge. Returns the vertex.
  std::uint32_t connect(std::uint32_t vertex, const Sight& sight) {
    Configurations motion(dimension_);
    motion.push(std::as_const(graph_.vertices)[vertex]);
    motion.push(point(sight));
    const std::uint32_t foot = split(sight.edge, sight.point);
    add_edge(vertex, foot, std::move(motion), {0.0, 0.0});
    return vertex;
  }

  /// The vertex at a point of an edge. Splits the edge if the point is not one of its ends.
  std::uint32_t split(std::size_t e, std::size_t i) {
    const Graph::Edge edge = graph_.edges[e];  // a copy: the edge changes
    if (i == 0) return edge.from;
    if (i + 1 == edge.points.size()) return edge.to;
    Configurations first(dimension_);
    Configurations second(dimension_);
    first.reserve(i + 1);
    second.reserve(edge.points.size() - i);
    for (std::size_t k = 0; k <= i; ++k) first.push(edge.points[k]);
    for (std::size_t k = i; k < edge.points.size(); ++k) second.push(edge.points[k]);
    const std::uint32_t middle = graph_.vertices.push(edge.points[i]);
    const double length = path_length(instance_.space, first);
    graph_.edges[e] = {edge.from, middle, length, std::move(first)};
    const std::vector<double> clearance = table_.clearance(e);
    const auto cut = clearance.begin() + static_cast<std::ptrdiff_t>(i);
    table_.set(e, {clearance.begin(), cut + 1});
    add_edge(middle, edge.to, std::move(second), {cut, clearance.end()});
    return middle;
  }

  Instance& instance_;
  std::size_t dimension_;
  double clearance_;
  EdgeTable table_;
  std::shared_ptr<Validity> disc_;  ///< of the least clearance; nullptr: none is asked for
  double disc_step_ = 0.0;          ///< the resolution of its motions, metres
  bool parts_ = false;              ///< the graph has parts of edges
  bool joined_ = true;
  Graph graph_;
};

/// A path in terms of a graph: the edges that it contains, and lower bounds of its clearance.
class PathOnGraph {
 public:
  /// \param path  outlives this object
  PathOnGraph(const Graph& graph, const EdgeTable& table, const Configurations& path)
      : path_(path), buckets_(std::bit_ceil(2 * path.size() + 1), none), next_(path.size(), none) {
    for (std::uint32_t i = 0; i < path.size(); ++i) {
      next_[i] = std::exchange(buckets_[bucket(path[i])], i);
    }
    along_.reserve(graph.edges.size());
    // An edge is on the path if its middle point is; of an edge with two points, both must be.
    const Configurations& middles = table.base().middles;
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      const auto& points = graph.edges[e].points;
      const std::size_t n = points.size();
      const bool own = table.own(e);
      const bool on_path =
          contains(own ? points[n / 2] : middles[2 * e]) && contains(own ? points[(n - 1) / 2] : middles[2 * e + 1]);
      along_.push_back(on_path ? 1 : 0);
    }
  }

  /// For each edge of the graph, whether the path contains it.
  [[nodiscard]] const std::vector<char>& along() const { return along_; }

  /// For each point of the path, its clearance in metres; 0 if no edge contains the point.
  [[nodiscard]] std::vector<double> clearance(const Graph& graph, const EdgeTable& table) const {
    std::vector<double> most(path_.size(), 0.0);
    for (std::size_t e = 0; e < along_.size(); ++e) {
      if (along_[e] == 0) continue;
      const auto& points = graph.edges[e].points;
      const std::vector<double>& clearances = table.clearance(e);
      for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::uint32_t p = first(points[i]); p != none; p = next(p, points[i])) {
          most[p] = std::max(most[p], clearances[i]);
        }
      }
    }
    return most;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// The hash table's bucket of a position.
  [[nodiscard]] std::size_t bucket(View position) const {
    // The sum with 0 gives both zeros the same bits.
    const auto bits = [&](std::size_t j) { return std::bit_cast<std::uint64_t>(position[j] + 0.0); };
    const std::uint64_t z = position.size() > 2 ? bits(2) : 0;
    const std::uint64_t mixed = (bits(0) ^ std::rotl(bits(1), 29) ^ std::rotl(z, 47)) * 0x9e3779b97f4a7c15ULL;
    return (mixed >> 32U) & (buckets_.size() - 1);
  }
  /// The first of the points from p on, in the same bucket, that is at a position; `none` if there is none.
  [[nodiscard]] std::uint32_t from(std::uint32_t p, View position) const {
    const auto elsewhere = [&](View q) { return !std::equal(q.begin(), q.end(), position.begin()); };
    while (p != none && elsewhere(path_[p])) p = next_[p];
    return p;
  }
  [[nodiscard]] std::uint32_t first(View position) const { return from(buckets_[bucket(position)], position); }
  [[nodiscard]] std::uint32_t next(std::uint32_t p, View position) const { return from(next_[p], position); }
  [[nodiscard]] bool contains(View position) const { return first(position) != none; }

  const Configurations& path_;
  std::vector<std::uint32_t> buckets_;  ///< last point of the path in each bucket
  std::vector<std::uint32_t> next_;     ///< for each point, another point in its bucket
  std::vector<char> along_;
};

/// Lower bounds of the clearance along a path.
class PathClearance {
 public:
  /// \param clearance  at each point of the path, metres
  PathClearance(const Configurations& path, const std::vector<double>& clearance) {
    points_.reserve(path.size());
    double at = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (i > 0) at += distance(path[i], path[i - 1]);
      points_.emplace_back(at, clearance[i]);
    }
  }

  /// The bound at an arc length: clearance is 1-Lipschitz in arc length.
  [[nodiscard]] double at(double s) const {
    const auto next = std::lower_bound(points_.begin(), points_.end(), std::pair(s, 0.0));
    double most = 0.0;
    if (next != points_.end()) most = next->second - (next->first - s);
    if (next != points_.begin()) most = std::max(most, (next - 1)->second - (s - (next - 1)->first));
    return most;
  }

 private:
  std::vector<std::pair<double, double>> points_;  ///< arc length, clearance
};

/// The graph, directed away from the start by path cost from the start. Edges that do not lead to a goal are removed,
/// if any edge leads to one.
struct DirectedGraph {
  struct Edge {
    std::uint32_t edge = 0;
    bool forward = true;
  };
  std::vector<std::vector<Edge>> out;  ///< per vertex
};

/// \param only  for each edge, whether the directed graph may contain it; nullptr: it may contain all
DirectedGraph directed(const Graph& graph, const std::vector<char>* only) {
  const std::size_t n = graph.vertices.size();
  std::vector<std::vector<std::uint32_t>> adjacency(n);
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    if (only != nullptr && (*only)[e] == 0) continue;
    adjacency[graph.edges[e].from].push_back(e);
    if (graph.edges[e].to != graph.edges[e].from) adjacency[graph.edges[e].to].push_back(e);
  }
  const auto far_end = [&](std::uint32_t e, std::uint32_t v) {
    return graph.edges[e].from == v ? graph.edges[e].to : graph.edges[e].from;
  };
  std::vector<double> cost(n, std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  cost[graph.start] = 0.0;
  queue.emplace(0.0, graph.start);
  while (!queue.empty()) {
    const auto [c, v] = queue.top();
    queue.pop();
    if (c != cost[v]) continue;
    for (const std::uint32_t e : adjacency[v]) {
      const std::uint32_t next = far_end(e, v);
      if (c + graph.edges[e].cost < cost[next]) {
        cost[next] = c + graph.edges[e].cost;
        queue.emplace(cost[next], next);
      }
    }
  }
  const auto leads = [&](std::uint32_t from, std::uint32_t to) {
    return std::isfinite(cost[from]) && (cost[from] < cost[to] || (cost[from] == cost[to] && from < to));
  };
  std::vector<char> useful(n, 1);
  std::vector<std::uint32_t> open;
  for (const std::uint32_t goal : graph.goals) {
    if (std::isfinite(cost[goal])) open.push_back(goal);
  }
  if (!open.empty()) {
    std::fill(useful.begin(), useful.end(), 0);
    for (const std::uint32_t goal : open) useful[goal] = 1;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (const std::uint32_t e : adjacency[v]) {
        const std::uint32_t before = far_end(e, v);
        if (leads(before, v) && useful[before] == 0) {
          useful[before] = 1;
          open.push_back(before);
        }
      }
    }
  }
  DirectedGraph result;
  result.out.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    for (const std::uint32_t e : adjacency[v]) {
      const std::uint32_t next = far_end(e, v);
      if (next != v && leads(v, next) && useful[next] != 0) result.out[v].push_back({e, graph.edges[e].from == v});
    }
  }
  return result;
}

/// h: balls that move along the directed skeleton ahead of the planner's nodes. Published as dynamic regions.
class DynamicRegions final : public Heuristic {
 public:
  /// \param only_path  regions travel along the path found alone, which a guide of S has chosen
  DynamicRegions(std::shared_ptr<const PositionProjection> projection, const Instance& parent,
                 std::shared_ptr<const Graph> graph, const EdgeTable& table, const Configurations& path,
                 Configurations lifted, const SkeletonSettings& settings, double radius, double robot,
                 const ReachedIndex& reached, bool only_path)
      : projection_(std::move(projection)),
        parent_(parent.space),
        model_(settings.alignment > -1.0 && AlignedLift::applies(parent) ? parent.motion_model : nullptr),
        graph_(std::move(graph)),
        on_path_(PathOnGraph(*graph_, table, path).along()),
        directed_(directed(*graph_, only_path ? &on_path_ : nullptr)),
        settings_(settings),
        uniform_density_(std::exp(-parent_.log_volume())),
        ball_(projection_->space(), radius),
        step_(step_length(parent)),
        presumed_(!parent.validity->spends_checks()),
        // A disc of radius r is inside the region by the share p of its diameter if d <= R + r - 2 p r.
        reach_(std::max(0.0, ball_.radius() + robot * (1.0 - 2.0 * settings.penetration))),
        spawned_(graph_->vertices.size(), 0),
        lifted_(std::move(lifted)),
        position_(projection_->space().dimension()) {
    for (std::uint32_t v = 0; v < directed_.out.size(); ++v) {
      if (!directed_.out[v].empty()) unvisited_.push_back(v);
    }
    for (std::size_t i = 1; i < path.size(); ++i) length_ += projection_->space().distance(path[i - 1], path[i]);
    spawn(graph_->start);
    // Regions skip the parts that the planner reached before this search of the graph.
    const auto squared_distance = [&](View at) { return reached.squared_distance(at); };
    spawn_near(squared_distance);
    advance([&](View centre) { return squared_distance(centre) <= reach_ * reach_; });
    before_ = connected_;
  }

  Source sample(Stream& stream, MutableView out) override {
    const std::size_t n = regions_.size();
    drawn_ = pick(stream);
    if (drawn_ == n) {
      parent_.sample_uniform(stream, out);
      return 1;
    }
    ball_.sample(centre(regions_[drawn_]), stream, position_);
    regions_[drawn_].lift->lift(position_, stream, out);
    return 0;
  }

  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double weight) const override {
    record.add_uniform(weight * whole_share(), uniform_density_);
    if (!regions_.empty() && !projection_->closed_form()) {
      record.add_unknown(weight * (1.0 - whole_share()));
      return;
    }
    const double total = total_weight();
    for (const auto& region : regions_) record.add(region.density, weight * share(region, total));
  }

  void observe(const Outcome& outcome, bool mine) override {
    const bool success = outcome.fate != Fate::rejected;
    if (mine && drawn_ < regions_.size()) {
      auto& region = regions_[drawn_];
      region.successes = settings_.decay * region.successes + (success ? 1.0 : 0.0);
      region.attempts = settings_.decay * region.attempts + 1.0;
      ++region.idle;
      ++epoch_;
      region.failures = success ? 0 : region.failures + 1;
      if (settings_.drop > 0 && region.failures >= settings_.drop) {
        regions_.erase(regions_.begin() + static_cast<std::ptrdiff_t>(drawn_));
      }
    }
    if (!outcome.added.empty() && outcome.connected) {
      projection_->project(outcome.added, position_);
      const auto squared_distance = [&](View at) { return projection_->space().squared_distance(at, position_); };
      spawn_near(squared_distance);
      advance([&](View centre) { return squared_distance(centre) <= reach_ * reach_; });
    }
    drawn_ = regions_.size();
  }

  [[nodiscard]] std::vector<std::string> sources() const override {
    return {"skeleton: region", "skeleton: whole space"};
  }

  [[nodiscard]] bool stale() const override {
    return !regions_.empty() &&
           std::all_of(regions_.begin(), regions_.end(), [&](const Region& r) { return r.idle >= settings_.patience; });
  }

  /// The edges with stuck regions.
  [[nodiscard]] std::vector<std::uint32_t> stuck_edges() const {
    std::vector<std::uint32_t> edges;
    for (const auto& region : regions_) {
      if (region.idle >= settings_.patience) edges.push_back(region.edge.edge);
    }
    return edges;
  }

  [[nodiscard]] Configurations lifted_path() const override { return lifted_; }
  /// 0 if f does not contract: lengths in S then do not bound those in C.
  [[nodiscard]] double progress() const override { return projection_->contracts() ? connected_ - before_ : 0.0; }
  [[nodiscard]] double connected() const override { return projection_->contracts() ? connected_ : 0.0; }
  /// Where validity is presumed, a motion to the goal is valid wherever it begins: the end of the path comes first.
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    const double reach = 2.0 * step_;
    return !presumed_ || length_ - connected_ <= reach || parent_.squared_distance(from, to) <= reach * reach;
  }

 private:
  struct Region {
    DirectedGraph::Edge edge;
    std::size_t point = 0;  ///< index along the edge in its direction
    double successes = 1.0;
    double attempts = 1.0;
    std::int64_t idle = 0;      ///< own proposals since the region last moved
    std::int64_t failures = 0;  ///< consecutive own proposals without a new node
    std::shared_ptr<const Projection> lift = nullptr;
    std::shared_ptr<const Density> density = nullptr;  ///< over the planner's space
    double share = 1.0;                                ///< factor on its weight: `emphasis` on the path found in S
    [[nodiscard]] double weight() const { return share * successes / attempts; }
  };

  /// The i-th point of an edge in its direction.
  [[nodiscard]] View point(const DirectedGraph::Edge& edge, std::size_t i) const {
    const auto& points = graph_->edges[edge.edge].points;
    return points[edge.forward ? i : points.size() - 1 - i];
  }
  [[nodiscard]] View centre(const Region& region) const { return point(region.edge, region.point); }

  /// The unit vector from a point of an edge to its next different point; none if there is no such point.
  [[nodiscard]] std::optional<Vec2> onward(const DirectedGraph::Edge& edge, std::size_t from) const {
    const View a = point(edge, from);
    for (std::size_t i = from + 1; i < graph_->edges[edge.edge].points.size(); ++i) {
      const View b = point(edge, i);
      const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
      if (length > 0.0) return Vec2{(b[0] - a[0]) / length, (b[1] - a[1]) / length};
    }
    return {};
  }

  /// The directions in which a region moves next: along its edge; at the edge's end, along the following edges; without
  /// those, in the direction in which it arrived.
  [[nodiscard]] std::vector<Vec2> directions(const Region& region) const {
    if (const auto along = onward(region.edge, region.point)) return {*along};
    const auto& edge = graph_->edges[region.edge.edge];
    std::vector<Vec2> beyond;
    for (const auto& next : directed_.out[region.edge.forward ? edge.to : edge.from]) {
      if (const auto along = onward(next, 0)) beyond.push_back(*along);
    }
    for (std::size_t i = region.point; i > 0 && beyond.empty(); --i) {
      if (const auto along = onward(region.edge, i - 1)) beyond.push_back(*along);
    }
    return beyond;
  }

  [[nodiscard]] double total_weight() const {
    return std::accumulate(regions_.begin(), regions_.end(), 0.0,
                           [](double sum, const Region& r) { return sum + r.weight(); });
  }

  /// The probability that a region draws the next proposal.
  /// \param total  sum of the weights of all regions
  [[nodiscard]] double share(const Region& region, double total) const {
    const auto n = static_cast<double>(regions_.size());
    const double follow = total > 0.0 ? region.weight() / total : 1.0 / n;
    return settings_.explore / (n + 1.0) + (1.0 - settings_.explore) * follow;
  }
  /// The probability that the next proposal is uniform on the whole space.
  [[nodiscard]] double whole_share() const {
    return regions_.empty() ? 1.0 : settings_.explore / (static_cast<double>(regions_.size()) + 1.0);
  }

  /// Returns region i with probability e/(n+1) + (1-e) w_i / sum w, the whole space (index n) with e/(n+1).
  std::size_t pick(Stream& stream) const {
    const std::size_t n = regions_.size();
    if (n == 0) return 0;
    if (stream.uniform() < settings_.explore) return stream.below(n + 1);
    const double total = total_weight();
    if (total <= 0.0) return stream.below(n);
    double u = stream.uniform() * total;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      u -= regions_[i].weight();
      if (u < 0.0) return i;
    }
    return n - 1;
  }

  void spawn(std::uint32_t vertex) {
    if (spawned_[vertex] != 0) return;
    spawned_[vertex] = 1;
    for (const auto& edge : directed_.out[vertex]) {
      regions_.push_back({.edge = edge, .share = on_path_[edge.edge] != 0 ? settings_.emphasis : 1.0});
      place(regions_.back());
    }
    ++epoch_;
  }

  /// Adds a region at every unvisited vertex that has a node within the radius of a region.
  template <class SquaredDistance>
  void spawn_near(const SquaredDistance& squared_distance) {
    const double radius = ball_.radius();
    const auto visited = [&](std::uint32_t v) {
      if (spawned_[v] == 0 && squared_distance(std::as_const(graph_->vertices)[v]) < radius * radius) spawn(v);
      return spawned_[v] != 0;
    };
    unvisited_.erase(std::remove_if(unvisited_.begin(), unvisited_.end(), visited), unvisited_.end());
  }

  /// Updates the lift and density of a region to its position.
  void place(Region& region) const {
    Configurations centre_alone(position_.size());
    centre_alone.push(centre(region));
    region.lift = projection_;
    if (model_) {
      auto towards = directions(region);
      if (!towards.empty()) {
        region.lift = std::make_shared<AlignedLift>(projection_, model_, std::move(towards), settings_.alignment);
      }
    }
    region.density = std::make_shared<LiftedDensity>(
        region.lift, position_.size(),
        TubeKernel(projection_->space(), std::move(centre_alone), ball_.radius()).density());
  }

  /// Advances every region while `inside(centre)`. At the end of its edge, regions of the following edges replace it.
  template <class Inside>
  void advance(const Inside& inside) {
    for (std::size_t i = 0; i < regions_.size();) {
      bool arrived = false;
      const std::size_t before = regions_[i].point;
      while (!arrived && inside(centre(regions_[i]))) {
        regions_[i].idle = 0;
        const View passed = centre(regions_[i]);
        if (++regions_[i].point == graph_->edges[regions_[i].edge.edge].points.size()) {
          arrived = true;
        } else if (on_path_[regions_[i].edge.edge] != 0) {
          connected_ += projection_->space().distance(passed, centre(regions_[i]));
        }
      }
      if (regions_[i].point != before) ++epoch_;
      if (!arrived) {
        if (regions_[i].point != before) place(regions_[i]);
        ++i;
        continue;
      }
      const auto& edge = graph_->edges[regions_[i].edge.edge];
      const std::uint32_t end = regions_[i].edge.forward ? edge.to : edge.from;
      regions_.erase(regions_.begin() + static_cast<std::ptrdiff_t>(i));
      spawn(end);
    }
  }

  std::shared_ptr<const PositionProjection> projection_;
  Space parent_;
  std::shared_ptr<const MotionModel> model_;  ///< nullptr: velocities are not aligned
  std::shared_ptr<const Graph> graph_;
  std::vector<char> on_path_;  ///< per edge
  DirectedGraph directed_;
  SkeletonSettings settings_;
  double uniform_density_;
  BallKernel ball_;
  double step_;    ///< longest extension of the planner, metres in the metric
  bool presumed_;  ///< the planner's space presumes validity
  double reach_;   ///< distance of a node from a region's centre at which the region advances, metres
  std::vector<Region> regions_;
  std::vector<char> spawned_;
  std::vector<std::uint32_t> unvisited_;  ///< vertices that get a region when a node is near
  std::size_t drawn_ = 0;
  double connected_ = 0.0;  ///< length of the path found that regions have travelled, metres in S's metric
  double length_ = 0.0;     ///< of the path found, metres in S's metric
  double before_ = 0.0;     ///< part of it that the planner reached before this search of the graph
  std::uint64_t epoch_ = 0;
  Configurations lifted_;
  Configuration position_;
};

class SkeletonGuide final : public PositionGuide {
 public:
  explicit SkeletonGuide(const SkeletonSettings& settings)
      : PositionGuide("skeleton", settings.evidence, settings.radius, settings.point), settings_(settings) {}

  using PositionGuide::project;
  std::unique_ptr<Instance> project(const Instance& parent) override {
    auto instance = point_instance(parent);
    double clearance = settings_.clearance;
    if (settings_.prune && !projection()->arm()) {
      // Clearance is exact, to rounding, at the points of the axis. In space, edges are straight between such points.
      double needed = (1.0 - 1e-6) * std::max(parent.needed_clearance, parent.scene->inscribed_radius());
      if (const SpatialScene* scene = instance->scene->spatial()) needed -= cached_ball_graph(scene->world)->resolution;
      clearance = std::max(clearance, needed);
    }
    GraphBuilder builder(*instance->scene, clearance, *instance);
    auto made = std::make_shared<Graph>(builder.take());
    table_.emplace(builder.take_table());
    refuted_edges_.assign(made->edges.size(), 0);
    begin(parent, *instance, std::move(made), !settings_.follow_regions && !parent.motion_model, settings_.spacing);
    return instance;
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    regions_ = nullptr;
    const Configuration& goal = begin_heuristic(parent, found->path);
    if (lifts() && found->solved()) return along_axis(parent, goal);
    // The radius of a region is a multiple of the robot's; a point and a tip have no size, so the world's size replaces
    // it.
    const double robot = projection()->arm() ? 0.0 : parent.scene->bounding_radius();
    const double unit = robot > 0.0 ? robot : 0.01 * projection()->space().diameter();
    auto h = std::make_unique<DynamicRegions>(
        projection(), parent, graph(), *table_, path(), projection()->lifted(path(), parent.start, goal), settings_,
        settings_.region * unit, robot, reached(), sub->guided && found->solved());
    regions_ = h.get();
    return h;
  }

  void before_resolve() override {
    if (follows_steps()) {
      exclude_refuted();
    } else if (regions_ != nullptr) {
      for (const std::uint32_t e : regions_->stuck_edges()) graph()->multiply_cost(e, stuck_penalty);
    }
  }

 private:
  /// h along the path found on the axis.
  std::unique_ptr<Heuristic> along_axis(Instance& parent, const Configuration& goal) {
    const PathOnGraph on_graph(*graph(), *table_, path());
    along_ = on_graph.along();
    // If the clearance of the axis exceeds the robot's radius, the robot is valid there at every angle.
    const double reach = projection()->arm() ? std::numeric_limits<double>::infinity()
                                             : std::max(parent.needed_reach, parent.scene->bounding_radius());
    const PathClearance clearance(path(), on_graph.clearance(*graph(), *table_));
    return along(parent, goal, projection()->point_lift(parent, variation()),
                 [&](double at) { return clearance.at(at) > reach; });
  }

  void exclude_on_path(View s) override { refute(nearest_edge(s, true).first); }
  std::optional<bool> exclude_near(View s) override {
    // The path of a smaller robot does not follow the axis exactly.
    const double within = 2.0 * place_radius();
    const auto [edge, squared_distance] = nearest_edge(s, false);
    if (squared_distance > within * within || refuted_edges_[edge] != 0) return std::nullopt;
    refute(edge);
    return !along_.empty() && along_[edge] != 0;
  }
  [[nodiscard]] bool path_is_excluded() const override {
    for (std::size_t e = 0; e < along_.size(); ++e) {
      if (along_[e] != 0 && refuted_edges_[e] != 0) return true;
    }
    return false;
  }

  void refute(std::uint32_t edge) {
    graph()->multiply_cost(edge, refuted_penalty);
    refuted_edges_[edge] = 1;
  }

  /// The edge nearest to s, and its squared distance.
  /// \param of_path  consider only edges of the path found
  [[nodiscard]] std::pair<std::uint32_t, double> nearest_edge(View s, bool of_path) const {
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t e = 0; e < graph()->edges.size(); ++e) {
      if (of_path && along_[e] == 0) continue;
      const auto& points = std::as_const(graph()->edges[e].points);
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const double distance = nearest_on_motion(projection()->space(), points[i], points[i + 1], s).squared_distance;
        if (distance < least) {
          least = distance;
          best = e;
        }
      }
    }
    return {best, least};
  }

  SkeletonSettings settings_;
  std::optional<EdgeTable> table_;
  std::vector<char> along_;  ///< for each edge, whether the path found contains it
  std::vector<char> refuted_edges_;
  DynamicRegions* regions_ = nullptr;  ///< active h, if it uses regions
};

}  // namespace

GuideKind skeleton_kind() {
  return GuideKind{
      &skeleton_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<SkeletonGuide>(skeleton_settings().read(o));
      },
      "graph_search",
      [](const Options& o) { return skeleton_settings().read(o).resolves; },
      {.category = GuideClaims::Category::robot,
       .f = "q -> the position of the reference point, on the medial axis of the free workspace; of an arm that is "
            "fixed to its base, that of its tip, on the medial axis of what it reaches of it",
       .h = "a ball about a point of the path found on the axis, a step ahead of the tree, with angles that are valid "
            "there; or balls that travel along the directed axis with uniform angles, and the whole space with a share "
            "of `explore`",
       .closed_form = true,
       .density = "of the mixture of balls and the whole space",
       .feedback =
           "nodes move it on; a point of the path of which no lift is valid, or `evidence` blocked proposals at "
           "one place, refute an edge, and the graph is searched again without it. Of regions, successes and "
           "attempts weigh them, and edges on which all are stuck cost more",
       .relaxes = true,
       .invalid_ends = "an end whose position is inside an obstacle is not joined to the axis, so S has no path",
       .fallback = GuideClaims::Fallback::own,
       .no_path = "balls travel along all of the axis that the start is joined to; uniform where it is joined to "
                  "none",
       .example = "examples/nested.lua",
       .needs = GuideClaims::Needs::position}}
      .set_up({.world = {8000, 300}, .run = {150, 1}}, {.world = {1.2e6, 4500}, .run = {2600, 60}});
}

}  // namespace trellis
