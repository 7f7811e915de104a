// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <queue>

#include <trellis/base/error.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/guide/kinds.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/planner/nearest.hpp>
#include <trellis/scene/skeleton.hpp>

namespace trellis {

namespace {

struct SkeletonSettings {
  double region = 2.0;
  double explore = 0.5;
  double decay = 0.9;
  double clearance = 0.0;
  double penetration = 0.5;
  std::int64_t drop = 0;
  std::int64_t patience = 200;
  std::int64_t resolves = 5;
};

const Settings<SkeletonSettings>& skeleton_settings() {
  static const Settings<SkeletonSettings> settings =
      Settings<SkeletonSettings>(
          Component::Kind::guide, "skeleton",
          "the medial axis of the free workspace as a graph; dynamic regions travel along it, directed from start to "
          "goal, and proposals come from them",
          "Denny, Sandstrom, Bregger and Amato 2016, Dynamic region-biased RRT")
          .number(
              "region", &SkeletonSettings::region, "bounding radii", Range::positive(),
              "radius of a region, in bounding radii of the robot; of a point, in hundredths of the world's diagonal")
          .number("explore", &SkeletonSettings::explore, "share of proposals", Range::share(),
                  "e: share that is spread evenly over the regions and the whole space; the rest follows the weights")
          .number("decay", &SkeletonSettings::decay, "factor", {.lo = 0, .hi = 1, .open_lo = true},
                  "what a region's successes and attempts are multiplied by before each new one is counted")
          .number("penetration", &SkeletonSettings::penetration, "share of its diameter", Range::share(),
                  "how much of the robot's bounding circle, in its diameters, is inside a region where a node moves "
                  "it on; 0.5: the reference point is inside; 1: the whole circle")
          .integer("drop", &SkeletonSettings::drop, "proposals", Range::non_negative(),
                   "proposals of a region without a new node, in a row, after which it is dropped; 0: never")
          .number("clearance", &SkeletonSettings::clearance, "m", Range::non_negative(),
                  "edges of the skeleton with less clearance than this are left out")
          .integer("patience", &SkeletonSettings::patience, "proposals", Range::at_least(1),
                   "proposals of a region without progress after which it is stuck; when all are, the edges they are "
                   "stuck on are made dearer and the graph is searched again")
          .integer("resolves", &SkeletonSettings::resolves, "re-solves", Range::non_negative(),
                   "how often the graph may be searched again");
  return settings;
}

/// How much dearer an edge becomes on which every region is stuck.
constexpr double stuck_penalty = 4.0;
/// Points of the skeleton, nearest first, that start and goal try to see.
constexpr std::size_t most_sights = 100;

/// The skeleton's edges as a Graph, with start and goal joined to the nearest points of it that they see.
class GraphBuilder {
 public:
  GraphBuilder(const Skeleton& skeleton, double clearance, Instance& instance) : instance_(instance) {
    graph_.vertices = Configurations(2);
    for (const Vec2 v : skeleton.vertices) graph_.vertices.push(std::array{v.x, v.y});
    for (const auto& edge : skeleton.edges) {
      const double least = *std::min_element(edge.clearance.begin(), edge.clearance.end());
      if (least < clearance) continue;
      Configurations points(2);
      for (const Vec2 p : edge.points) points.push(std::array{p.x, p.y});
      add_edge(edge.from, edge.to, std::move(points));
    }
    graph_.start = join(instance.start);
    graph_.goal = join(instance.goal);
  }
  [[nodiscard]] Graph take() { return std::move(graph_); }

 private:
  void add_edge(std::uint32_t from, std::uint32_t to, Configurations points) {
    const double length = path_length(instance_.space, points);
    graph_.edges.push_back({from, to, length, std::move(points)});
  }

  std::uint32_t join(const Configuration& q) {
    const std::uint32_t vertex = graph_.vertices.push(q);
    struct Sight {
      double distance;
      std::size_t edge;
      std::size_t point;
    };
    std::vector<Sight> sights;
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      const auto& points = std::as_const(graph_.edges[e].points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        sights.push_back({instance_.space.distance(q, points[i]), e, i});
      }
    }
    std::stable_sort(sights.begin(), sights.end(),
                     [](const Sight& a, const Sight& b) { return a.distance < b.distance; });
    if (sights.size() > most_sights) sights.resize(most_sights);
    for (const auto& sight : sights) {
      const View p = std::as_const(graph_.edges[sight.edge].points)[sight.point];
      if (sight.distance > 0.0 && !instance_.motion(q, p).valid) continue;
      Configurations way(2);
      way.push(q);
      way.push(p);
      const std::uint32_t foot = split(sight.edge, sight.point);
      add_edge(vertex, foot, std::move(way));
      break;
    }
    return vertex;
  }

  /// The vertex at a point of an edge; the edge is cut in two where the point is not one of its ends.
  std::uint32_t split(std::size_t e, std::size_t i) {
    Graph::Edge edge = graph_.edges[e];
    if (i == 0) return edge.from;
    if (i + 1 == edge.points.size()) return edge.to;
    Configurations first(2);
    Configurations second(2);
    for (std::size_t k = 0; k <= i; ++k) first.push(std::as_const(edge.points)[k]);
    for (std::size_t k = i; k < edge.points.size(); ++k) second.push(std::as_const(edge.points)[k]);
    const std::uint32_t middle = graph_.vertices.push(std::as_const(edge.points)[i]);
    graph_.edges[e] = {edge.from, middle, path_length(instance_.space, first), std::move(first)};
    add_edge(middle, edge.to, std::move(second));
    return middle;
  }

  Instance& instance_;
  Graph graph_;
};

/// The graph directed away from the start by the cost of getting there, without what does not lead to the goal (where
/// anything does).
struct DirectedGraph {
  struct Edge {
    std::uint32_t edge = 0;
    bool forward = true;
  };
  std::vector<std::vector<Edge>> out;  ///< per vertex
};

DirectedGraph directed(const Graph& graph) {
  const std::size_t n = graph.vertices.size();
  std::vector<std::vector<std::uint32_t>> adjacency(n);
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
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
  if (std::isfinite(cost[graph.goal])) {
    std::fill(useful.begin(), useful.end(), 0);
    useful[graph.goal] = 1;
    std::vector<std::uint32_t> open = {graph.goal};
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

/// h: balls that travel along the directed skeleton ahead of the planner's nodes. Published as dynamic regions.
class DynamicRegions final : public Heuristic {
 public:
  DynamicRegions(std::shared_ptr<const AxisProjection> projection, Space parent, std::shared_ptr<const Graph> graph,
                 Configurations lifted, const SkeletonSettings& settings, double radius, double robot,
                 const NearestIndex& reached)
      : projection_(std::move(projection)),
        parent_(std::move(parent)),
        graph_(std::move(graph)),
        directed_(directed(*graph_)),
        settings_(settings),
        uniform_density_(std::exp(-parent_.log_volume())),
        ball_(projection_->space(), radius),
        // The circle of radius r is inside by the share p of its diameter where d <= R + r - 2 p r.
        reach_(std::max(0.0, ball_.radius() + robot * (1.0 - 2.0 * settings.penetration))),
        spawned_(graph_->vertices.size(), 0),
        lifted_(std::move(lifted)),
        position_(2) {
    spawn(graph_->start);
    // What the planner reached before the graph was searched again need not be reached twice.
    advance([&](View centre) { return reached.nearest(centre).squared_distance <= reach_ * reach_; });
  }

  Source sample(Stream& stream, MutableView out) override {
    const std::size_t n = regions_.size();
    drawn_ = pick(stream);
    if (drawn_ == n) {
      parent_.sample_uniform(stream, out);
      return 1;
    }
    ball_.sample(centre(regions_[drawn_]), stream, position_);
    projection_->lift(position_, stream, out);
    return 0;
  }

  [[nodiscard]] double density(View q) const override {
    Configuration s(2);
    projection_->project(q, s);
    double sum = whole_share() * uniform_density_;
    const double total = total_weight();
    for (const auto& region : regions_) {
      sum += share(region, total) * ball_.density(centre(region), s) * std::exp(-projection_->log_fibre_volume());
    }
    return sum;
  }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double weight) const override {
    record.add_uniform(weight * whole_share(), uniform_density_);
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
    if (!outcome.added.empty()) {
      projection_->project(outcome.added, position_);
      advance([&](View c) { return projection_->space().squared_distance(c, position_) <= reach_ * reach_; });
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

  /// The edges that regions are stuck on.
  [[nodiscard]] std::vector<std::uint32_t> stuck_edges() const {
    std::vector<std::uint32_t> edges;
    for (const auto& region : regions_) {
      if (region.idle >= settings_.patience) edges.push_back(region.edge.edge);
    }
    return edges;
  }

  [[nodiscard]] Configurations lifted_path() const override { return lifted_; }

 private:
  struct Region {
    DirectedGraph::Edge edge;
    std::size_t point = 0;  ///< along the edge in its direction
    double successes = 1.0;
    double attempts = 1.0;
    std::int64_t idle = 0;                             ///< own proposals since it last moved
    std::int64_t failures = 0;                         ///< own proposals in a row that led to no node
    std::shared_ptr<const Density> density = nullptr;  ///< over the planner's space
    [[nodiscard]] double weight() const { return successes / attempts; }
  };

  [[nodiscard]] View centre(const Region& region) const {
    const auto& points = graph_->edges[region.edge.edge].points;
    return points[region.edge.forward ? region.point : points.size() - 1 - region.point];
  }

  [[nodiscard]] double total_weight() const {
    return std::accumulate(regions_.begin(), regions_.end(), 0.0,
                           [](double sum, const Region& r) { return sum + r.weight(); });
  }

  /// The probability that a region draws the next proposal, `total` the weight of all.
  [[nodiscard]] double share(const Region& region, double total) const {
    const auto n = static_cast<double>(regions_.size());
    const double follow = total > 0.0 ? region.weight() / total : 1.0 / n;
    return settings_.explore / (n + 1.0) + (1.0 - settings_.explore) * follow;
  }
  /// The probability that the whole space does.
  [[nodiscard]] double whole_share() const {
    return regions_.empty() ? 1.0 : settings_.explore / (static_cast<double>(regions_.size()) + 1.0);
  }

  /// Region i with probability e/(n+1) + (1-e) w_i / sum w, the whole space (index n) with e/(n+1).
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
      regions_.push_back({.edge = edge});
      place(regions_.back());
    }
    ++epoch_;
  }

  /// Gives a region the density of where it is.
  void place(Region& region) const {
    Configurations centre_alone(2);
    centre_alone.push(centre(region));
    region.density = std::make_shared<LiftedDensity>(
        projection_, 2, TubeKernel(projection_->space(), std::move(centre_alone), ball_.radius()).density());
  }

  /// Moves every region on while `inside(centre)`; at the end of its edge it makes room for those of the edges beyond.
  template <class Inside>
  void advance(const Inside& inside) {
    for (std::size_t i = 0; i < regions_.size();) {
      bool arrived = false;
      const std::size_t before = regions_[i].point;
      while (!arrived && inside(centre(regions_[i]))) {
        regions_[i].idle = 0;
        if (++regions_[i].point == graph_->edges[regions_[i].edge.edge].points.size()) arrived = true;
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

  std::shared_ptr<const AxisProjection> projection_;
  Space parent_;
  std::shared_ptr<const Graph> graph_;
  DirectedGraph directed_;
  SkeletonSettings settings_;
  double uniform_density_;
  BallKernel ball_;
  double reach_;  ///< of a node from a region's centre, at which the region moves on
  std::vector<Region> regions_;
  std::vector<char> spawned_;
  std::size_t drawn_ = 0;
  std::uint64_t epoch_ = 0;
  Configurations lifted_;
  Configuration position_;
};

class SkeletonGuide final : public Guide {
 public:
  explicit SkeletonGuide(const SkeletonSettings& settings) : settings_(settings) {}

  std::unique_ptr<Instance> project(const Instance& parent) override {
    projection_ = std::make_shared<PositionProjection>("skeleton", parent);
    reached_.emplace(projection_->space());
    auto instance = projection_->point_instance(parent);
    graph_ = std::make_shared<Graph>(
        GraphBuilder(*cached_medial_axis(parent.scene->world), settings_.clearance, *instance).take());
    instance->graph = graph_;
    reached_->add(instance->start);
    return instance;
  }

  void project(View q, MutableView s) const override { projection_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { projection_->lift(s, stream, q); }
  [[nodiscard]] double log_fibre_density(View) const override { return -projection_->log_fibre_volume(); }

  void learn(const Outcome& outcome) override {
    if (outcome.added.empty()) return;
    std::array<double, 2> position{};
    projection_->project(outcome.added, position);
    reached_->add(position);
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution* found) override {
    // A region is as large as the robot needs; a point has no size, so the world gives one.
    const double robot = parent.scene->robot.bounding_radius();
    const double unit = robot > 0.0 ? robot : 0.01 * projection_->space().diameter();
    auto h = std::make_unique<DynamicRegions>(projection_, parent.space, graph_,
                                              projection_->lifted(found->path, parent.start, parent.goal), settings_,
                                              settings_.region * unit, robot, *reached_);
    current_ = h.get();
    return h;
  }

  void before_resolve() override {
    for (const std::uint32_t e : current_->stuck_edges()) graph_->edges[e].cost *= stuck_penalty;
  }

 private:
  SkeletonSettings settings_;
  std::shared_ptr<const PositionProjection> projection_;
  std::optional<NearestIndex> reached_;
  std::shared_ptr<Graph> graph_;
  DynamicRegions* current_ = nullptr;
};

}  // namespace

GuideKind skeleton_kind() {
  return {
      &skeleton_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<SkeletonGuide>(skeleton_settings().read(o));
      },
      "graph_search",
      [](const Options& o) { return skeleton_settings().read(o).resolves; },
      {.category = GuideClaims::Category::robot,
       .f = "q -> the position of the reference point, on the medial axis of the free workspace",
       .h = "a ball that travels along the directed axis ahead of the tree, with uniform angles; the whole space "
            "with a share of `explore`",
       .closed_form = true,
       .density = "of the mixture of balls and the whole space",
       .feedback = "a node in a ball moves it on; successes and attempts weigh the balls; where all are stuck their "
                   "edges are made dearer and the graph is searched again",
       .relaxes = true,
       .invalid_ends = "an end whose position is inside an obstacle is not joined to the axis, so S has no path",
       .fallback = GuideClaims::Fallback::own,
       .no_path = "balls travel along all of the axis that the start is joined to; uniform where it is joined to "
                  "none",
       .example = "examples/nested.lua",
       .needs = GuideClaims::Needs::position}};
}

}  // namespace trellis
