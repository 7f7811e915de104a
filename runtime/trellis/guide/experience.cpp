// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/set_up.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

struct ExperienceSettings : PathGuideSettings {
  ExperienceSettings() {
    follow = Follow::waypoints;
    evidence = 100;
    resolves = 10;
  }
  std::string db = "experience.db";
  std::int64_t candidates = 10;
  double join = 0.0;
  double repair = 10.0;
  bool any_robot = false;
};

const Settings<ExperienceSettings>& experience_settings() {
  static const Settings<ExperienceSettings> settings = with_path_options(
      Settings<ExperienceSettings>(
          Component::Kind::guide, "experience",
          "stored paths of earlier problems, joined into a graph where they come near each other; h follows the path "
          "in this graph that needs the least repair",
          "Berenson, Abbeel and Goldberg 2012, A robot path planning framework that learns from experience "
          "(Lightning); "
          "paths joined into a graph: Phillips, Cohen, Chitta and Likhachev 2012, E-Graphs; what is checked first: "
          "Dellin and Srinivasa 2016, Lazy shortest paths")
          .file("db", &ExperienceSettings::db, "the library of solved problems, as trellis run SCRIPT --learn makes it")
          .integer("candidates", &ExperienceSettings::candidates, "paths", {.lo = 1, .hi = 1000},
                   "paths that are retrieved: those whose ends are nearest to start and goal, in either direction")
          .number("join", &ExperienceSettings::join, "m in the metric", Range::non_negative(),
                  "distance within which two retrieved paths are joined, so that a path may change from one to the "
                  "other; 0: the robot's bounding radius; of the space's diameter 2 % for a point, 10 % for a robot "
                  "that is fixed to its "
                  "base")
          .number("repair", &ExperienceSettings::repair, "metres", Range::at_least(1),
                  "cost of a metre that is invalid in the present world, relative to a valid one")
          .choice("robots", &ExperienceSettings::any_robot, {{"same", false}, {"any", true}},
                  R"(whose paths: "same", of the same robot in the same space; "any", of any in the same space)")
          .integer("paths", &ExperienceSettings::paths, "paths", {.lo = 1, .hi = 64},
                   "paths in the graph that guide at once; each search increases the cost of the paths before it")
          .positional({"db"}));
  return settings;
}

/// Factor on the cost of an edge that an earlier path contains, or on which the planner is stuck.
constexpr double avoided = 4.0;

/// The sum of the distances of a path's ends from start and goal.
double apart(const Space& space, View start, View goal, const Configurations& path) {
  return space.distance(start, path.front()) + space.distance(goal, path.back());
}

/// h along a retrieved path whose valid motions are verified in C. Its other motions are gaps. If a tree has reached
/// one end of a gap, half of the proposals repair the gap by a local search towards its other end. They come from balls
/// about the gap, which grow until the gap is closed.
class RepairedPath final : public Wrapping<PathFollower, PathFollower> {
 public:
  /// \param gaps  indices of the first points of the motions to repair
  /// \param ends  share of a gap's proposals that are its far end
  /// \param reach  distance within which a node counts as at an end of a gap, in metres in the metric
  /// \param evidence  number of blocked proposals at one gap that refutes the path
  RepairedPath(const Instance& instance, std::unique_ptr<PathFollower> path, const std::vector<std::size_t>& gaps,
               double ends, double reach, std::int64_t evidence, const std::array<const ReachedIndex*, 2>& reached)
      : Wrapping(std::move(path)), space_(instance.space), ends_(ends), reach_(reach), evidence_(evidence) {
    const Configurations points = part()->lifted_path();
    for (const std::size_t i : gaps) {
      Configurations motion(space_.dimension());
      motion.push(points[i]);
      motion.push(points[i + 1]);
      const double least = std::max(part()->radius(), 0.5 * path_length(space_, motion));
      Gap& gap = gaps_.emplace_back(motion);
      for (std::size_t k = 0; k < sizes; ++k) {
        gap.kernels.emplace_back(space_, motion, least * std::exp2(0.5 * static_cast<double>(k)));
      }
      for (std::size_t side = 0; side < 2; ++side) {
        for (std::size_t end = 0; end < 2; ++end) {
          gap.has[side][end] = reached[side]->squared_distance(std::as_const(motion)[end]) <= reach_ * reach_;
        }
      }
    }
    choose();
  }

  void select_tree(TreeSide side) override {
    Wrapping::select_tree(side);
    choose();
  }
  Source sample(Stream& stream, MutableView out) override {
    repairs_ = gap_ && stream.uniform() < share();
    if (!repairs_) return part()->sample(stream, out);
    if (ends_ > 0.0 && stream.uniform() < ends_) {
      const View end = std::as_const(gaps_[*gap_].ends)[1 - tree()];
      std::copy(end.begin(), end.end(), out.begin());
    } else {
      kernel().sample(stream, out);
    }
    return 0;
  }
  [[nodiscard]] std::uint64_t epoch() const override { return changes_ + Wrapping::epoch(); }
  void record(DensityRecord& record, double of) const override {
    part()->record(record, of * (1.0 - share()));
    if (!gap_) return;
    record.add_atoms(of * share() * ends_);
    record.add(kernel().density(), of * share() * (1.0 - ends_));
  }
  void observe(const Outcome& outcome, bool mine) override {
    Wrapping::observe(outcome, mine);
    if (part()->stale()) refute();
    if (!outcome.added.empty() && outcome.connected) note(outcome.added, outcome.from_goal ? 1 : 0);
    if (mine && gap_) {
      Gap& gap = gaps_[*gap_];
      const std::size_t before = size();
      ++gap.tries;
      if (size() != before) ++changes_;
      if (outcome.fate == Fate::rejected && !outcome.blocked_at.empty() && ++gap.blocked >= evidence_) refute();
    }
    choose();
  }
  [[nodiscard]] Configurations lifted_path() const override { return part()->lifted_path(); }
  [[nodiscard]] double radius() const override { return part()->radius(); }
  [[nodiscard]] std::optional<Configuration> refuted_place() const override { return part()->refuted_place(); }

 private:
  static constexpr std::size_t sizes = 4;
  static constexpr std::int64_t tries_per_size = 20;
  struct Gap {
    explicit Gap(Configurations of) : ends(std::move(of)) {}
    Configurations ends;
    std::vector<TubeKernel> kernels;           ///< in order of increasing radius
    std::array<std::array<bool, 2>, 2> has{};  ///< for each tree, whether it has reached the first and the second end
    std::int64_t tries = 0;                    ///< guided proposals
    std::int64_t blocked = 0;
  };

  [[nodiscard]] Guidance* drew_last() const override { return repairs_ ? nullptr : part(); }
  [[nodiscard]] std::size_t tree() const { return static_cast<std::size_t>(side()); }
  [[nodiscard]] double share() const { return gap_ ? 0.5 : 0.0; }
  [[nodiscard]] TubeKernel& kernel() { return gaps_[*gap_].kernels[size()]; }
  [[nodiscard]] const TubeKernel& kernel() const { return gaps_[*gap_].kernels[size()]; }
  [[nodiscard]] std::size_t size() const {
    return std::min(sizes - 1, static_cast<std::size_t>(gaps_[*gap_].tries / tries_per_size));
  }
  void note(View q, std::size_t side) {
    for (Gap& gap : gaps_) {
      for (std::size_t end = 0; end < 2; ++end) {
        if (space_.squared_distance(std::as_const(gap.ends)[end], q) <= reach_ * reach_) gap.has[side][end] = true;
      }
    }
  }
  /// Chooses the gap for the current tree: the farthest along its path with a reached near end and an unreached far
  /// end.
  void choose() {
    std::optional<std::size_t> chosen;
    for (std::size_t k = 0; k < gaps_.size(); ++k) {
      const std::size_t i = tree() == 0 ? k : gaps_.size() - 1 - k;
      if (gaps_[i].has[tree()][tree()] && !gaps_[i].has[tree()][1 - tree()]) chosen = i;
    }
    if (chosen != gap_) ++changes_;
    gap_ = chosen;
  }

  Space space_;
  double ends_;
  double reach_;
  std::int64_t evidence_;
  std::vector<Gap> gaps_;
  std::optional<std::size_t> gap_;  ///< gap that the current tree repairs
  bool repairs_ = false;            ///< the last proposal was drawn for the gap
  std::uint64_t changes_ = 0;       ///< number of changes of the gap and of its balls
};

/// The graph of the retrieved paths, with start and goals. Equal configurations share one vertex.
class ExperienceGraph {
 public:
  ExperienceGraph(const Instance& instance, double join) : space_(instance.space), join_(join), places_(space_) {
    graph_.vertices = Configurations(space_.dimension());
    graph_.start = vertex(instance.start);
    for (const Configuration& goal : instance.goals) graph_.goals.push_back(vertex(goal));
  }

  void add(const Configurations& path) {
    // Limits the number of pieces of a path, however small `join` is.
    constexpr double most_pieces = 1000.0;
    const double piece = std::max(join_, path_length(space_, path) / most_pieces);
    NearestIndex& own = indices_.emplace_back(space_);
    std::vector<std::uint32_t>& ids = ids_.emplace_back();
    const auto visit = [&](View q) {
      own.add(q);
      ids.push_back(vertex(q));
    };
    visit(path[0]);
    Configuration q(space_.dimension());
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const auto pieces =
          static_cast<std::size_t>(std::max(1.0, std::ceil(space_.distance(path[i], path[i + 1]) / piece)));
      for (std::size_t k = 1; k <= pieces; ++k) {
        space_.interpolate(path[i], path[i + 1], static_cast<double>(k) / static_cast<double>(pieces), q);
        visit(q);
        edge(ids[ids.size() - 2], ids.back());
      }
    }
    const auto& vertices = std::as_const(graph_.vertices);
    for (const std::uint32_t goal : graph_.goals) {
      const bool backwards = apart(space_, vertices[goal], vertices[graph_.start], path) <
                             apart(space_, vertices[graph_.start], vertices[goal], path);
      join(graph_.start, backwards ? ids.back() : ids.front());
      join(goal, backwards ? ids.front() : ids.back());
    }
    join(graph_.start, ids[own.nearest(vertices[graph_.start]).id]);
    for (const std::uint32_t goal : graph_.goals) join(goal, ids[own.nearest(vertices[goal]).id]);
    for (std::size_t other = 0; other + 1 < indices_.size(); ++other) {
      for (const std::uint32_t id : ids) {
        const auto near = indices_[other].nearest(vertices[id]);
        if (near.squared_distance <= join_ * join_) edge(id, ids_[other][near.id]);
      }
    }
  }

  [[nodiscard]] Graph take() { return std::move(graph_); }

 private:
  std::uint32_t vertex(View q) {
    if (places_.size() > 0) {
      const auto near = places_.nearest(q);
      if (near.squared_distance == 0.0) return near.id;
    }
    places_.add(q);
    return graph_.vertices.push(q);
  }

  /// Connects the start or a goal to a point of a path. Never connects start and goals directly, because no stored path
  /// contains that motion.
  void join(std::uint32_t end, std::uint32_t point) {
    if (point != graph_.start && !graph_.is_goal(point)) edge(end, point);
  }

  void edge(std::uint32_t from, std::uint32_t to) {
    if (from == to || !known_.emplace(std::minmax(from, to)).second) return;
    Graph::Edge edge{from, to, 0.0, Configurations(space_.dimension())};
    edge.points.push(std::as_const(graph_.vertices)[from]);
    edge.points.push(std::as_const(graph_.vertices)[to]);
    edge.cost = space_.distance(edge.points[0], edge.points[1]);
    graph_.edges.push_back(std::move(edge));
  }

  const Space& space_;
  double join_;
  NearestIndex places_;
  Graph graph_;
  std::vector<NearestIndex> indices_;            ///< points of each path
  std::vector<std::vector<std::uint32_t>> ids_;  ///< vertices of each path's points
  std::set<std::pair<std::uint32_t, std::uint32_t>> known_;
};

class Experience final : public PathGuide {
 public:
  explicit Experience(const ExperienceSettings& settings)
      : PathGuide("experience", searching_itself(settings)), settings_(settings) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    library_ = known_paths(settings_.db);
    ExperienceGraph graph(*instance, settings_.join > 0.0 ? settings_.join : characteristic_length(parent));
    for (const StoredPath* stored : retrieved(parent)) graph.add(stored->path);
    graph_ = std::make_shared<Graph>(graph.take());
    edges_.clear();
    by_ends_.clear();
    incident_.assign(graph_->vertices.size(), {});
    valid_.assign(graph_->vertices.size(), Seen::no);
    refuted_edge_paths_.clear();
    for (std::uint32_t e = 0; e < graph_->edges.size(); ++e) {
      edges_.push_back({graph_->edges[e].cost});
      by_ends_.emplace(std::minmax(graph_->edges[e].from, graph_->edges[e].to), e);
      incident_[graph_->edges[e].from].push_back(e);
      incident_[graph_->edges[e].to].push_back(e);
    }
    touch_ = 0.5 * parent.resolution;
    places_.emplace(parent.space);
    for (std::size_t v = 0; v < graph_->vertices.size(); ++v) places_->add(std::as_const(graph_->vertices)[v]);
    instance->graph = graph_;
    return instance;
  }
  void attach(Instance& sub) override {
    PathGuide::attach(sub);
    sub_ = &sub;
  }

  /// An invalid configuration that C reports on an unvalidated edge makes the edge invalid.
  void learn(const Outcome& outcome) override {
    PathGuide::learn(outcome);
    if (!outcome.blocked_at.empty()) refute_edges_at(outcome.blocked_at);
  }

  /// Validates the currently shortest path. If that increases its cost, the graph is searched again. So the final path
  /// is the shortest one by validated costs, and only edges of candidates are checked. A refuted path is no candidate
  /// as long as there are others.
  std::int64_t another(const Solution* found) override {
    constexpr std::int64_t again = 200;  // proposals of a further search, if a guide weights the edges
    if (found != nullptr) {
      EdgePath edge_path = edges_along(found->path);
      if (!check(edge_path)) return again;
      const bool refuted = refuted_edge_paths_.contains(edge_path);
      if (refuted && edge_paths_.empty() && passed_over_ < most_passed_over) {
        ++passed_over_;
        avoid(edge_path);
        return again;
      }
      if (std::find(edge_paths_.begin(), edge_paths_.end(), edge_path) == edge_paths_.end() &&
          (!refuted || edge_paths_.empty())) {
        if (refuted) refuted_edge_paths_.clear();
        paths_.push_back(kept(edge_path));
        edge_paths_.push_back(std::move(edge_path));
        if (!refuted && static_cast<std::int64_t>(edge_paths_.size()) < settings_.paths) {
          for (const std::uint32_t e : edge_paths_.back()) graph_->multiply_cost(e, avoided);
          return again;
        }
      }
    }
    passed_over_ = 0;
    for (std::uint32_t e = 0; e < edges_.size(); ++e) set_cost(e);
    return 0;
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    current_ = nullptr;
    followed_ = std::exchange(edge_paths_, {});
    if (paths_.empty()) return PathGuide::heuristic(parent, sub, found);
    // S is C, so edges found valid in S are verified in C.
    if (!parent.verified) parent.verified = std::make_shared<VerifiedMotions>();
    parent.verified->hold_at(parent.epoch());
    for (const auto& edge_path : followed_) {
      for (const std::uint32_t e : edge_path) {
        if (edges_[e].seen != Seen::valid) continue;
        const auto& points = std::as_const(graph_->edges[e].points);
        if (parent.validity->enters_excluded(points.front(), points.back())) continue;
        parent.verified->add(points.front(), points.back());
      }
    }
    std::vector<std::unique_ptr<PathFollower>> parts;
    for (const Configurations& path : std::exchange(paths_, {})) parts.push_back(along(parent, path));
    auto h = parts.size() == 1 ? std::move(parts.front())
                               : std::unique_ptr<PathFollower>(std::make_unique<SeveralPaths>(std::move(parts)));
    current_ = h.get();
    return h;
  }

  /// Increases the cost of the first part of each path that the planner did not reach.
  void before_resolve() override {
    if (current_ == nullptr) return;
    for (const auto& edge_path : followed_) {
      avoid(edge_path);
      refuted_edge_paths_.insert(edge_path);
    }
  }

 protected:
  [[nodiscard]] bool excludes() const override { return false; }

 private:
  enum class Seen : std::uint8_t { no, valid, invalid };
  using EdgePath = std::vector<std::uint32_t>;  ///< edges from the start to a goal
  static constexpr int most_passed_over = 4;

  /// The state of an edge of the graph.
  struct EdgeState {
    double length = 0.0;
    double stuck = 1.0;
    Seen seen = Seen::no;
  };

  static PathGuideSettings searching_itself(PathGuideSettings settings) {
    settings.paths = 1;
    return settings;
  }

  /// h along a path that repairs its gaps.
  [[nodiscard]] std::unique_ptr<PathFollower> along(Instance& parent, const Configurations& path) const {
    auto h = follow_path("experience", settings_, parent, path, reached_nodes().both());
    if (settings_.follow == Follow::tube) return h;
    std::vector<std::size_t> gaps;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      if (!parent.is_verified(path[i], path[i + 1])) gaps.push_back(i);
    }
    if (gaps.empty()) return h;
    // The heuristic that follows the waypoints proposes the far end of a gap itself.
    const bool in_turn = settings_.follow == Follow::waypoints;
    const double reach = in_turn ? parent.goal_tolerance : h->radius();
    return std::make_unique<RepairedPath>(parent, std::move(h), gaps, in_turn ? 0.0 : 0.5, reach, settings_.evidence,
                                          reached_nodes().both());
  }

  /// Increases the cost of the first edge of a path whose end the planner did not reach.
  void avoid(const EdgePath& edge_path) {
    const double within = tube_radius(settings_, *sub_);
    std::uint32_t at = graph_->start;
    for (const std::uint32_t e : edge_path) {
      const auto& edge = graph_->edges[e];
      at = edge.from == at ? edge.to : edge.from;
      const View place = std::as_const(graph_->vertices)[at];
      if (reached(place, within)) continue;
      edges_[e].stuck *= avoided;
      set_cost(e);
      break;
    }
  }

  void refute_edges_at(View q) {
    if (edges_.empty()) return;
    for (const std::uint32_t e : incident_[places_->nearest(q).id]) {
      const auto& points = std::as_const(graph_->edges[e].points);
      if (edges_[e].seen != Seen::no) continue;
      if (nearest_on_motion(sub_->space, points.front(), points.back(), q).squared_distance > touch_ * touch_) continue;
      edges_[e].seen = Seen::invalid;
      set_cost(e);
    }
  }

  /// The stored paths of this space, by increasing distance of their ends from the start and the goal nearest to it.
  [[nodiscard]] std::vector<const StoredPath*> retrieved(const Instance& parent) const {
    const std::uint64_t space = identity(parent.space);
    const std::uint64_t robot = robot_hash(*parent.scene);
    std::vector<std::pair<double, const StoredPath*>> fitting;
    for (const StoredPath& stored : *library_) {
      if (stored.space != space || stored.path.dimension() != parent.space.dimension()) continue;
      if (!settings_.any_robot && stored.robot != robot) continue;
      double distance = std::numeric_limits<double>::infinity();
      for (const Configuration& goal : parent.goals) {
        distance = std::min({distance, apart(parent.space, parent.start, goal, stored.path),
                             apart(parent.space, goal, parent.start, stored.path)});
      }
      fitting.emplace_back(distance, &stored);
    }
    std::stable_sort(fitting.begin(), fitting.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    fitting.resize(std::min(fitting.size(), static_cast<std::size_t>(settings_.candidates)));
    std::vector<const StoredPath*> paths;
    paths.reserve(fitting.size());
    for (const auto& [distance, stored] : fitting) paths.push_back(stored);
    return paths;
  }

  /// The edges of a path found in the graph.
  [[nodiscard]] EdgePath edges_along(const Configurations& path) const {
    EdgePath edge_path;
    edge_path.reserve(path.size());
    std::uint32_t at = graph_->start;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const std::uint32_t next = places_->nearest(path[i]).id;
      edge_path.push_back(by_ends_.at(std::minmax(at, next)));
      at = next;
    }
    return edge_path;
  }

  /// Validates the unchecked edges of a path. Returns whether no cost increased.
  bool check(const EdgePath& edge_path) {
    bool as_thought = true;
    std::uint32_t at = graph_->start;
    for (const std::uint32_t e : edge_path) {
      const auto& edge = graph_->edges[e];
      const std::uint32_t next = edge.from == at ? edge.to : edge.from;
      if (edges_[e].seen == Seen::no) {
        const auto& vertices = std::as_const(graph_->vertices);
        if (valid_[at] == Seen::no) valid_[at] = sub_->valid(vertices[at]) ? Seen::valid : Seen::invalid;
        const bool valid = valid_[at] == Seen::valid && sub_->motion(vertices[at], vertices[next]).valid;
        if (valid) valid_[next] = Seen::valid;
        edges_[e].seen = valid ? Seen::valid : Seen::invalid;
        if (!valid) {
          graph_->multiply_cost(e, settings_.repair);
          as_thought = false;
        }
      }
      at = next;
    }
    return as_thought;
  }

  /// The waypoints of a path without the invalid ones. A gap is repaired up to its next valid waypoint.
  [[nodiscard]] Configurations kept(const EdgePath& edge_path) const {
    const auto& vertices = std::as_const(graph_->vertices);
    Configurations points(vertices.dimension());
    points.push(vertices[graph_->start]);
    std::uint32_t at = graph_->start;
    for (const std::uint32_t e : edge_path) {
      at = graph_->edges[e].from == at ? graph_->edges[e].to : graph_->edges[e].from;
      if (graph_->is_goal(at) || valid_[at] != Seen::invalid) points.push(vertices[at]);
    }
    return points;
  }

  void set_cost(std::uint32_t e) {
    const EdgeState& state = edges_[e];
    graph_->set_cost(e, state.length * state.stuck * (state.seen == Seen::invalid ? settings_.repair : 1.0));
  }

  ExperienceSettings settings_;
  std::shared_ptr<const std::vector<StoredPath>> library_;
  std::shared_ptr<Graph> graph_;
  Instance* sub_ = nullptr;
  PathFollower* current_ = nullptr;  ///< active h; its caller owns it
  double touch_ = 0.0;  ///< distance from an edge within which a configuration counts as on it, in metres in the metric
  std::vector<EdgeState> edges_;
  std::vector<std::vector<std::uint32_t>> incident_;  ///< edges of each vertex
  std::vector<Seen> valid_;                           ///< per vertex
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> by_ends_;
  std::optional<NearestIndex> places_;  ///< index of the vertices
  std::vector<Configurations> paths_;   ///< found since h was last made
  std::vector<EdgePath> edge_paths_;    ///< edges of `paths_`
  std::vector<EdgePath> followed_;
  std::set<EdgePath> refuted_edge_paths_;  ///< refuted by evidence
  int passed_over_ = 0;                    ///< refuted paths rejected in the current search
};

}  // namespace

GuideKind experience_kind() {
  GuideClaims claims = path_claims(
      GuideClaims::Category::experience, "q -> q, on the graph of the stored paths that are nearest to start and goal",
      "they are joined to the graph too, by edges that count as invalid", "examples/experience/use.lua");
  claims.h =
      "the points in turn of the path in the graph that costs least, where invalid metres count `repair` times; where "
      "a "
      "motion between two of them is invalid, half the time a ball about it, which grows; or a tube about the path";
  claims.feedback =
      "a node at a point moves h to the next, and valid motions of the path are not checked again; after `evidence` "
      "blocked proposals at one place h follows another path; an edge on which C finds an invalid configuration counts "
      "as invalid";
  claims.fallback = GuideClaims::Fallback::own;
  claims.no_path = "the library has no path of this space and robot: h is uniform";
  return GuideKind{&experience_settings().component(),
                   [](const Options& o) -> std::unique_ptr<Guide> {
                     return std::make_unique<Experience>(experience_settings().read(o));
                   },
                   "graph_search", [](const Options& o) { return experience_settings().read(o).resolves; },
                   std::move(claims)}
      .set_up({.world = {15000}, .run = {100, 1500}}, {.world = {15000}, .run = {430, 6500}}, retrieved_paths);
}

}  // namespace trellis
