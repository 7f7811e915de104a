// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/kernels.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/guide/set_up.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

namespace {

struct PathDatabaseSettings {
  std::string db = "experience.db";
  std::int64_t candidates = 50;
  double radius = 0.0;
  double repair = 10.0;
  std::int64_t evidence = 5;
  bool any_robot = false;
};

const Settings<PathDatabaseSettings>& path_database_settings() {
  static const Settings<PathDatabaseSettings> settings =
      Settings<PathDatabaseSettings>(
          Component::Kind::guide, "path_database",
          "stored paths of earlier problems give each node of the tree a cost to go; h names the node with the least "
          "one to extend, towards the next point of the paths; motions that C blocks leave the database",
          "after Attali, Telagi, Morales and Amato 2025, Path Database Guidance for motion planning, arXiv 2504.05550")
          .file("db", &PathDatabaseSettings::db,
                "the library of solved problems, as trellis run SCRIPT --learn makes it")
          .integer("candidates", &PathDatabaseSettings::candidates, "paths", {.lo = 1, .hi = 10000},
                   "paths that are retrieved: those whose ends are nearest to start and goal, in either direction")
          .number("radius", &PathDatabaseSettings::radius, "m in the metric", Range::non_negative(),
                  "a node within this distance of a point of a path is on it; where the motion to the next point was "
                  "blocked, proposals are uniform on a ball of this radius about it; 0: half the robot's bounding "
                  "radius, or of the space's diameter 1 % for a point and 5 % for a robot that is fixed to its base")
          .number("repair", &PathDatabaseSettings::repair, "metres", Range::at_least(1),
                  "cost of a metre between a node and a path, between two paths, or from a path to a goal, relative to "
                  "one along a path")
          .integer("evidence", &PathDatabaseSettings::evidence, "proposals", Range::at_least(1),
                   "proposals in a row from one node that C found blocked, after which the motion to the next point "
                   "leaves the database, or, where the node is on no path, the node is not extended any more")
          .choice("robots", &PathDatabaseSettings::any_robot, {{"same", false}, {"any", true}},
                  R"(whose paths: "same", of the same robot in the same space; "any", of any in the same space)")
          .positional({"db"});
  return settings;
}

/// The points of stored paths, at most a spacing apart, with their costs to go to the nearest goal. A metre along a
/// path costs 1, in either direction; one between two paths, or from a path to a goal, costs `apart`.
class PathDatabase {
 public:
  /// Where a configuration continues: to a point near it or, from that point, to the next one.
  struct Lead {
    std::uint32_t from = 0;  ///< the point near it
    std::uint32_t to = 0;    ///< the point to extend towards; `from` if the configuration is not on it
    double cost = 0.0;       ///< to go
  };

  PathDatabase(const Instance& instance, double spacing, double radius, double apart)
      : space_(instance.space),
        spacing_(spacing),
        apart_(apart),
        ball_(space_, radius),
        index_(space_),
        points_(space_.dimension()) {
    for (const Configuration& goal : instance.goals) add(goal);
    goals_ = points_.size();
  }

  void add(const Configurations& path) {
    Configuration q(space_.dimension());
    constexpr double most_pieces = 1000.0;
    std::uint32_t before = add(path.front());
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const double wanted = std::ceil(space_.distance(path[i], path[i + 1]) / spacing_);
      const auto pieces = static_cast<std::size_t>(std::clamp(wanted, 1.0, most_pieces));
      for (std::size_t k = 1; k <= pieces; ++k) {
        space_.interpolate(path[i], path[i + 1], static_cast<double>(k) / static_cast<double>(pieces), q);
        const std::uint32_t at = add(q);
        join(before, at, 1.0);
        before = at;
      }
    }
  }
  /// Joins near points of different paths, and all points to the goals, and finds the costs to go.
  void finish() {
    std::vector<NearestIndex::Neighbour> found;
    for (std::uint32_t p = 0; p < points_.size(); ++p) {
      index_.k_nearest(point(p), neighbours, found);
      for (const auto& other : found) {
        if (other.id < p && !joined(p, other.id)) join(p, other.id, apart_);
      }
      for (std::uint32_t goal = 0; goal < goals_; ++goal) {
        if (p >= goals_ && !joined(p, goal)) join(p, goal, apart_);
      }
    }
    search();
  }
  [[nodiscard]] bool empty() const { return points_.size() == goals_; }
  [[nodiscard]] View point(std::uint32_t p) const { return std::as_const(points_)[p]; }
  [[nodiscard]] const BallKernel& ball() const { return ball_; }
  /// A counter that grows with each motion removed.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// Where a configuration continues at the least cost; none if it leads to no goal.
  [[nodiscard]] std::optional<Lead> lead(View q) {
    index_.k_nearest(q, neighbours, near_);
    std::optional<Lead> best;
    for (const auto& neighbour : near_) {
      const double distance = std::sqrt(neighbour.squared_distance);
      std::uint32_t from = neighbour.id;
      std::uint32_t to = neighbour.id;
      if (distance <= ball_.radius()) {
        // Paths meet in points of the same place, which a motion has behind it.
        to = next_[from];
        while (to != nowhere && space_.distance(q, point(to)) <= meeting * spacing_)
          from = std::exchange(to, next_[to]);
      }
      const double cost = apart_ * distance + to_go_[neighbour.id];
      if (to == nowhere || !std::isfinite(cost)) continue;
      if (!best || cost < best->cost) best = Lead{from, to, cost};
    }
    return best;
  }
  /// Whether the configuration that a lead was found for is on its point.
  [[nodiscard]] static bool on_path(const Lead& lead) { return lead.from != lead.to; }

  /// Removes the motion that a lead follows.
  void refute(const Lead& lead) {
    for (const auto& [a, b] : {std::pair(lead.from, lead.to), std::pair(lead.to, lead.from)}) {
      std::erase_if(edges_[a], [to = b](const Edge& edge) { return edge.to == to; });
    }
    search();
    ++revision_;
  }
  /// The points from one to a goal.
  [[nodiscard]] Configurations path_from(std::uint32_t p) const {
    Configurations path(space_.dimension());
    for (; p != nowhere; p = next_[p]) path.push(point(p));
    return path;
  }

 private:
  static constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::size_t neighbours = 8;
  /// Two configurations count as one if they are nearer than this share of the spacing.
  static constexpr double meeting = 1e-6;
  struct Edge {
    std::uint32_t to = 0;
    double cost = 0.0;
  };

  std::uint32_t add(View q) {
    index_.add(q);
    edges_.emplace_back();
    return points_.push(q);
  }
  [[nodiscard]] bool joined(std::uint32_t a, std::uint32_t b) const {
    return a == b || std::any_of(edges_[a].begin(), edges_[a].end(), [b](const Edge& edge) { return edge.to == b; });
  }
  void join(std::uint32_t a, std::uint32_t b, double factor) {
    const double cost = factor * space_.distance(point(a), point(b));
    edges_[a].push_back({b, cost});
    edges_[b].push_back({a, cost});
  }

  /// Finds the costs to go (Dijkstra's algorithm, from the goals).
  void search() {
    to_go_.assign(points_.size(), std::numeric_limits<double>::infinity());
    next_.assign(points_.size(), nowhere);
    using Entry = std::pair<double, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    for (std::uint32_t goal = 0; goal < goals_; ++goal) {
      to_go_[goal] = 0.0;
      open.push({0.0, goal});
    }
    while (!open.empty()) {
      const auto [cost, at] = open.top();
      open.pop();
      if (cost > to_go_[at]) continue;
      for (const Edge& edge : edges_[at]) {
        const double further = cost + edge.cost;
        if (further >= to_go_[edge.to]) continue;
        to_go_[edge.to] = further;
        next_[edge.to] = at;
        open.push({further, edge.to});
      }
    }
  }

  Space space_;
  double spacing_;
  double apart_;
  BallKernel ball_;
  NearestIndex index_;
  Configurations points_;  ///< the goals first
  std::size_t goals_ = 0;
  std::vector<std::vector<Edge>> edges_;  ///< of each point
  std::vector<double> to_go_;
  std::vector<std::uint32_t> next_;  ///< of each point, the next one on the path to a goal
  std::vector<NearestIndex::Neighbour> near_;
  std::uint64_t revision_ = 0;
};

/// Uniform on a ball.
class BallDensity final : public Density {
 public:
  BallDensity(BallKernel ball, View centre) : ball_(std::move(ball)), centre_(centre.begin(), centre.end()) {}
  [[nodiscard]] double at(View q) const override { return ball_.density(centre_, q); }

 private:
  BallKernel ball_;
  Configuration centre_;
};

/// h: the node of the tree with the least cost to go, and the point that it continues to.
class PathDatabaseHeuristic final : public Heuristic {
 public:
  PathDatabaseHeuristic(const Instance& parent, std::shared_ptr<PathDatabase> database, std::int64_t evidence)
      : start_(parent.start), database_(std::move(database)), evidence_(evidence), uniform_(parent.space) {
    plant();
  }

  void select_tree(TreeSide side) override {
    const bool from_goal = side == TreeSide::goal;
    if (std::exchange(from_goal_, from_goal) != from_goal) ++epoch_;
  }

  Source sample(Stream& stream, MutableView out) override {
    if (!guides()) {
      uniform_.sample(stream, out);
      return 1;
    }
    const View to = database_->point(aim_->lead.to);
    if (itself()) {
      std::copy(to.begin(), to.end(), out.begin());
    } else {
      database_->ball().sample(to, stream, out);
    }
    return 0;
  }
  [[nodiscard]] std::uint32_t vertex() const override { return guides() ? nodes_[aim_->node].row : no_node; }

  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override {
    if (!guides()) {
      uniform_.record(record, share);
    } else if (itself()) {
      record.add_atoms(share);
    } else {
      record.add(aim_->density, share);
    }
  }

  void observe(const Outcome& outcome, bool mine) override {
    const bool drew = mine && guides();
    if (drew) {
      Node& node = nodes_[aim_->node];
      // A node that was extended is less likely to be extended again.
      ++node.extended;
      const bool blocked = outcome.fate == Fate::rejected && !outcome.blocked_at.empty();
      node.blocked = blocked ? node.blocked + 1 : 0;
      if (node.blocked >= evidence_ && PathDatabase::on_path(aim_->lead)) {
        database_->refute(aim_->lead);
        node.blocked = 0;
      } else if (node.blocked >= evidence_) {
        node.exhausted = true;
      }
    }
    const bool grown = !outcome.added.empty() && outcome.connected && !outcome.from_goal;
    if (grown) add(outcome.added, outcome.added_row);
    if (drew || grown) aim();
  }

  void restart() override { plant(); }

  [[nodiscard]] Configurations lifted_path() const override {
    return aim_ ? database_->path_from(aim_->lead.from) : Configurations{};
  }
  [[nodiscard]] std::vector<std::string> sources() const override {
    return {"path_database", "path_database: no path leads on"};
  }

 private:
  struct Node {
    Configuration q;
    std::uint32_t row = no_node;
    std::int64_t extended = 0;  ///< number of proposals from it
    std::int64_t blocked = 0;   ///< the last ones of them, without another, that were blocked
    bool exhausted = false;     ///< it reaches no path
  };
  /// A node in the queue, with its priority when it was queued.
  struct Entry {
    double priority = 0.0;
    std::uint32_t node = 0;
    std::uint64_t revision = 0;  ///< of the database
    PathDatabase::Lead lead;
    friend bool operator<(const Entry& a, const Entry& b) {
      return a.priority != b.priority ? a.priority > b.priority : a.node > b.node;
    }
  };
  struct Aim {
    std::uint32_t node = 0;
    PathDatabase::Lead lead;
    std::shared_ptr<const Density> density;
  };

  [[nodiscard]] bool guides() const { return aim_ && !from_goal_; }
  /// Whether the next proposal is the point itself: it is, until the motion from the node to it was blocked.
  [[nodiscard]] bool itself() const { return nodes_[aim_->node].blocked == 0; }

  void plant() {
    nodes_.clear();
    queue_ = {};
    aim_.reset();
    add(start_, no_node);
    aim();
  }

  void add(View q, std::uint32_t row) {
    nodes_.push_back({Configuration(q.begin(), q.end()), row});
    queue(static_cast<std::uint32_t>(nodes_.size() - 1));
  }

  /// Queues a node by its cost to go, of which each earlier extension adds a tenth.
  void queue(std::uint32_t node) {
    constexpr double share = 0.1;
    if (nodes_[node].exhausted) return;
    const auto lead = database_->lead(nodes_[node].q);
    if (!lead) return;
    const double priority = lead->cost * (1.0 + share * static_cast<double>(nodes_[node].extended));
    queue_.push({priority, node, database_->revision(), *lead});
  }

  /// Chooses the node of the next proposals.
  void aim() {
    ++epoch_;
    if (aim_) queue(aim_->node);
    aim_.reset();
    while (!queue_.empty() && !aim_) {
      const Entry entry = queue_.top();
      queue_.pop();
      if (entry.revision != database_->revision()) {
        queue(entry.node);
        continue;
      }
      aim_ = Aim{entry.node, entry.lead,
                 std::make_shared<BallDensity>(database_->ball(), database_->point(entry.lead.to))};
    }
  }

  Configuration start_;
  std::shared_ptr<PathDatabase> database_;
  std::int64_t evidence_;
  UniformGuidance uniform_;
  std::vector<Node> nodes_;  ///< of the tree from the start
  std::priority_queue<Entry> queue_;
  std::optional<Aim> aim_;  ///< its node is not in the queue; none where no path leads on
  bool from_goal_ = false;
  std::uint64_t epoch_ = 0;
};

class PathDatabaseGuide final : public SamplingGuide {
 public:
  explicit PathDatabaseGuide(PathDatabaseSettings settings) : settings_(std::move(settings)) {}

  void prepare(const Instance& parent) override {
    library_ = known_paths(settings_.db);
    const double radius = settings_.radius > 0.0 ? settings_.radius : 0.5 * characteristic_length(parent);
    database_ = std::make_shared<PathDatabase>(parent, step_length(parent), radius, settings_.repair);
    const std::uint64_t space = identity(parent.space);
    const std::uint64_t robot = robot_hash(*parent.scene);
    std::vector<std::pair<double, const StoredPath*>> found;
    for (const StoredPath& stored : *library_) {
      if (stored.space != space || (!settings_.any_robot && stored.robot != robot) || stored.path.size() < 2) continue;
      const auto apart = [&](View first, View last) {
        return parent.space.distance(parent.start, first) + parent.to_goal(last);
      };
      const View front = stored.path.front();
      const View back = stored.path.back();
      found.emplace_back(std::min(apart(front, back), apart(back, front)), &stored);
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    found.resize(std::min(found.size(), static_cast<std::size_t>(settings_.candidates)));
    for (const auto& one : found) database_->add(one.second->path);
    if (!database_->empty()) database_->finish();
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    if (database_->empty()) return std::make_unique<UniformHeuristic>("path_database (no path)", parent.space);
    return std::make_unique<PathDatabaseHeuristic>(parent, database_, settings_.evidence);
  }

 private:
  PathDatabaseSettings settings_;
  std::shared_ptr<const std::vector<StoredPath>> library_;
  std::shared_ptr<PathDatabase> database_;
};

}  // namespace

GuideKind path_database_kind() {
  return GuideKind{
      &path_database_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return std::make_unique<PathDatabaseGuide>(path_database_settings().read(o));
      },
      "",
      [](const Options&) { return std::int64_t{0}; },
      {.category = GuideClaims::Category::experience,
       .f = "S = {0}; the database holds paths of C",
       .h = "the point that the node of the tree with the least cost to go continues to, on a stored path or the "
            "nearest one; after a blocked motion uniform on a ball about it; it names that node to extend",
       .closed_form = true,
       .density = "of the ball; the point itself is an atom; uniform where no path leads on",
       .feedback = "each node has a cost to go along the stored paths; extensions of a node raise its own; a motion "
                   "along a path that was blocked `evidence` times leaves the database, and all costs change",
       .relaxes = true,
       .invalid_ends = "nothing is projected",
       .fallback = GuideClaims::Fallback::none,
       .no_path = "nothing is searched; where the library has no path of this space and robot, h is uniform",
       .example = "examples/experience/use.lua"}}
      .set_up({.world = {15000}, .run = {100, 1000}}, {.world = {15000}, .run = {430, 4300}}, retrieved_paths);
}

}  // namespace trellis
