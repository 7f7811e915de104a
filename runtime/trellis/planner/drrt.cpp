// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/planner/tree_planner.hpp>
#include <trellis/scene/team_times.hpp>

namespace trellis {

namespace {

struct DrrtSettings : CommonSettings {
  DrrtSettings() { goal_bias = 0.2; }
  std::int64_t roadmap = 200;
  std::int64_t neighbours = 8;
};

const Settings<DrrtSettings>& drrt_settings() {
  static const Settings<DrrtSettings> settings = with_common(
      Settings<DrrtSettings>(
          Component::Kind::planner, "drrt",
          "for teams: a tree in the product of the roadmaps of single robots, which is never made as a whole. An "
          "extension moves each robot to the neighbour in its roadmap that lies most in the direction of the proposal; "
          "a proposal that is the goal, on along its shortest path. The node nearest to the goal is connected to it "
          "where the robots can move there one after another",
          "Solovey, Salzman and Halperin 2016, Finding a needle in an exponential haystack: discrete RRT")
          .integer("roadmap", &DrrtSettings::roadmap, "vertices", {.lo = 1, .hi = 100000},
                   "vertices of each robot's roadmap beside its start and goal; their checks are of that robot alone. "
                   "After 10 proposals for each of them there are twice as many")
          .integer("neighbours", &DrrtSettings::neighbours, "vertices", {.lo = 1, .hi = 1000},
                   "nearest vertices that a vertex of a roadmap is connected to"));
  return settings;
}

/// A robot of the team, and its roadmap among the obstacles alone.
struct RobotRoadmap {
  static constexpr std::uint32_t start = 0;
  static constexpr std::uint32_t goal = 1;

  std::vector<std::size_t> axes;  ///< of the team
  Space space;
  std::shared_ptr<Validity> validity;
  Configurations vertices;
  std::vector<std::vector<std::uint32_t>> neighbours;
  /// The next vertex on the shortest path to the goal; no_node without one.
  std::vector<std::uint32_t> on;
};

class Drrt final : public StartTreePlanner {
 public:
  Drrt(const DrrtSettings& settings, PlannerContext context)
      : StartTreePlanner(std::move(context)), settings_(settings) {
    const Instance& instance = context_.instance;
    std::vector<TeamMember> members;
    if (instance.scene != nullptr && !instance.validity_of) members = instance.scene->members();
    if (members.empty()) {
      members.emplace_back().axes.resize(instance.space.dimension());
      std::iota(members.front().axes.begin(), members.front().axes.end(), std::size_t{0});
    }
    for (const TeamMember& member : members) {
      RobotRoadmap& robot = robots_.emplace_back();
      robot.axes = member.axes;
      robot.space = space_of(instance.space, member);
      robot.vertices = Configurations(member.axes.size());
    }
  }

  [[nodiscard]] bool draws() const override { return StartTreePlanner::draws() && !growing_; }

  Plan plan() override { return {.proposal = !repairing() && !growing_ && !full()}; }

  Outcome extend(View proposal) override {
    const auto near = tree_->to_extend(proposal);
    const bool to_goal = context_.instance.to_goal(proposal) <= context_.instance.goal_tolerance;
    Place next = places_[near.id];
    for (std::size_t i = 0; i < robots_.size(); ++i) next[i] = towards(robots_[i], next[i], proposal, to_goal);
    Outcome outcome;
    outcome.proposal = proposal;
    added_ = no_node;
    if (!seen_.contains(next)) {
      const std::size_t before = tree_->size();
      const std::uint32_t reached = move(near.id, next, outcome);
      if (tree_->size() > before) added_ = reached;
    }
    outcome.near = (*tree_)[near.id];
    outcome.near_row = tree_->row(near.id);
    if (added_ != no_node) {
      outcome.added = (*tree_)[added_];
      outcome.added_row = tree_->row(added_);
    }
    return outcome;
  }

  std::optional<Status> follow() override {
    if (added_ != no_node && best_ == added_ && !solved_) connect_goal(added_);
    return ended();
  }

  std::optional<Status> work() override {
    if (repairing()) return StartTreePlanner::work();
    if (growing_) {
      grow();
    } else {
      // Larger roadmaps may have a path.
      drawn_before_ = context_.search.proposals.size();
      wanted_ *= 2;
      rounds_ = 0;
      growing_ = true;
    }
    return ended();
  }

 protected:
  void plant() override {
    places_.clear();
    seen_.clear();
    places_.emplace_back(robots_.size(), RobotRoadmap::start);
    seen_.emplace(places_.front(), 0);
    StartTreePlanner::plant();
  }

  void pruned(const std::vector<std::uint32_t>& ids) override {
    seen_.clear();
    std::vector<Place> kept;
    for (std::size_t id = 0; id < ids.size(); ++id) {
      if (ids[id] == no_node) continue;
      seen_.emplace(places_[id], ids[id]);
      kept.push_back(std::move(places_[id]));
    }
    places_ = std::move(kept);
  }

 private:
  /// The vertex of each robot in its roadmap.
  using Place = std::vector<std::uint32_t>;

  /// Whether the tree has filled its roadmaps.
  [[nodiscard]] bool full() const {
    constexpr std::size_t proposals_per_vertex = 10;
    return context_.search.proposals.size() - drawn_before_ >= proposals_per_vertex * wanted_;
  }

  static Configuration part_of(const RobotRoadmap& robot, View q) {
    Configuration part;
    for (const std::size_t axis : robot.axes) part.push_back(q[axis]);
    return part;
  }

  /// Adds a vertex to each roadmap that is not complete.
  void grow() {
    Instance& instance = context_.instance;
    bool complete = true;
    for (RobotRoadmap& robot : robots_) {
      if (robot.vertices.empty()) {
        make_validity_of(robot);
        add(robot, part_of(robot, instance.start));
        add(robot, part_of(robot, instance.goals[instance.nearest_goal(instance.start).goal]));
      }
      if (robot.vertices.size() >= wanted_ + 2) continue;
      complete = false;
      Configuration q(robot.space.dimension());
      constexpr int attempts = 100;
      for (int k = 0; k < attempts; ++k) {
        robot.space.sample_uniform(context_.proposals, q);
        if (!instance.check_one([&] { return robot.validity->state(q); })) {
          report(q, {}, q);
          continue;
        }
        add(robot, q);
        break;
      }
    }
    // A robot without room keeps a smaller roadmap.
    if (!complete && ++rounds_ < 2 * wanted_) return;
    for (RobotRoadmap& robot : robots_) find_paths(robot);
    growing_ = false;
  }

  void make_validity_of(RobotRoadmap& robot) const {
    const Instance& instance = context_.instance;
    if (robots_.size() == 1) {
      robot.validity = instance.validity;
      return;
    }
    robot.validity = make_validity(instance.collision, instance.scene->reduced(robot.axes), robot.space,
                                   instance.resolution, nullptr);
  }

  /// Reports what is invalid in a roadmap to the guidance, where the robot is alone: else it is no configuration of the
  /// team.
  void report(View q, View near, View blocked) {
    if (robots_.size() > 1) return;
    Outcome outcome;
    outcome.proposal = q;
    outcome.near = near;
    outcome.blocked_at = blocked;
    context_.guidance.observe(outcome, false);
  }

  void add(RobotRoadmap& robot, View q) {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t v = 0; v < robot.vertices.size(); ++v) {
      near.emplace_back(robot.space.squared_distance(std::as_const(robot.vertices)[v], q), v);
    }
    const auto most = std::min(near.size(), static_cast<std::size_t>(settings_.neighbours));
    if (!near.empty()) std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(most), near.end());
    const std::uint32_t added = robot.vertices.push(q);
    robot.neighbours.emplace_back();
    for (std::size_t k = 0; k < most; ++k) {
      const std::uint32_t v = near[k].second;
      const MotionReport report =
          context_.instance.check_motion([&] { return robot.validity->motion(std::as_const(robot.vertices)[v], q); });
      if (!report.valid) {
        Configuration blocked(q.size());
        robot.space.interpolate(std::as_const(robot.vertices)[v], q, report.invalid_at, blocked);
        this->report(q, robot.vertices[v], blocked);
        continue;
      }
      robot.neighbours[v].push_back(added);
      robot.neighbours[added].push_back(v);
    }
  }

  /// Finds the shortest paths of a robot to its goal.
  void find_paths(RobotRoadmap& robot) const {
    using Entry = std::pair<double, std::uint32_t>;
    std::vector<double> cost(robot.vertices.size(), std::numeric_limits<double>::infinity());
    robot.on.assign(robot.vertices.size(), no_node);
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    cost[RobotRoadmap::goal] = 0.0;
    robot.on[RobotRoadmap::goal] = RobotRoadmap::goal;
    open.emplace(0.0, RobotRoadmap::goal);
    while (!open.empty()) {
      const auto [so_far, v] = open.top();
      open.pop();
      if (so_far > cost[v]) continue;
      for (const std::uint32_t u : robot.neighbours[v]) {
        const double through =
            so_far + robot.space.distance(std::as_const(robot.vertices)[u], std::as_const(robot.vertices)[v]);
        if (through >= cost[u]) continue;
        cost[u] = through;
        robot.on[u] = v;
        open.emplace(through, u);
      }
    }
  }

  /// The neighbour of a vertex in the direction of the proposal, or the next one on the path to the goal.
  [[nodiscard]] std::uint32_t towards(const RobotRoadmap& robot, std::uint32_t vertex, View proposal,
                                      bool to_goal) const {
    if (to_goal) return robot.on[vertex] != no_node ? robot.on[vertex] : vertex;
    const std::size_t d = robot.space.degrees();
    const View from = robot.vertices[vertex];
    Configuration wanted(d);
    Configuration along(d);
    robot.space.log(from, part_of(robot, proposal), wanted);
    std::uint32_t best = vertex;
    double most = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t u : robot.neighbours[vertex]) {
      robot.space.log(from, robot.vertices[u], along);
      double dot = 0.0, squared = 0.0;
      for (std::size_t j = 0; j < d; ++j) {
        dot += wanted[j] * along[j];
        squared += along[j] * along[j];
      }
      const double cosine = squared > 0.0 ? dot / std::sqrt(squared) : 0.0;
      if (cosine <= most) continue;
      most = cosine;
      best = u;
    }
    return best;
  }

  /// Moves the team from a node to a place, if the motion is valid.
  /// \param outcome  receives the fate
  /// \return the node there; `from` where the motion is invalid
  std::uint32_t move(std::uint32_t from, const Place& place, Outcome& outcome) {
    Instance& instance = context_.instance;
    target_.assign(instance.space.dimension(), 0.0);
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      const View q = std::as_const(robots_[i].vertices)[place[i]];
      for (std::size_t j = 0; j < q.size(); ++j) target_[robots_[i].axes[j]] = q[j];
    }
    const MotionReport report = instance.motion((*tree_)[from], target_);
    if (!report.valid) {
      instance.space.interpolate((*tree_)[from], target_, report.invalid_at, blocked_);
      outcome.blocked_at = blocked_;
      return from;
    }
    outcome.fate = Fate::advanced;
    places_.push_back(place);
    const std::uint32_t id = insert(target_, from);
    seen_.emplace(place, id);
    return id;
  }

  /// Moves the robots to their goals one after another, as long as one of them gets there.
  void connect_goal(std::uint32_t from) {
    for (bool moved = true; moved && !solved_;) {
      moved = false;
      for (std::size_t i = 0; i < robots_.size() && !solved_; ++i) {
        std::uint32_t at = from;
        while (places_[at][i] != RobotRoadmap::goal) {
          Place next = places_[at];
          const std::uint32_t on = robots_[i].on[next[i]];
          if (on == no_node) break;
          next[i] = on;
          if (const auto there = seen_.find(next); there != seen_.end()) {
            at = there->second;
            continue;
          }
          Outcome outcome;
          const std::uint32_t reached = move(at, next, outcome);
          outcome.proposal = target_;
          outcome.near = (*tree_)[at];
          outcome.near_row = tree_->row(at);
          if (reached != at) {
            outcome.added = (*tree_)[reached];
            outcome.added_row = tree_->row(reached);
          }
          context_.guidance.observe(outcome, false);
          if (reached == at) break;
          at = reached;
        }
        if (at == from || places_[at][i] != RobotRoadmap::goal) continue;
        from = at;
        moved = true;
      }
    }
  }

  DrrtSettings settings_;
  std::vector<RobotRoadmap> robots_;
  std::vector<Place> places_;                                         ///< of each node of the tree
  std::map<Place, std::uint32_t> seen_;                               ///< the node at each
  bool growing_ = true;                                               ///< the roadmaps are not complete
  std::size_t wanted_ = static_cast<std::size_t>(settings_.roadmap);  ///< vertices of each roadmap
  std::size_t rounds_ = 0;                                            ///< of adding them
  std::uint32_t added_ = no_node;                                     ///< for the last proposal
  std::size_t drawn_before_ = 0;                                      ///< proposals when the roadmaps last grew
};

}  // namespace

PlannerKind drrt_kind() {
  return {&drrt_settings().component(), [](const Options& o) { return common_of(drrt_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            return std::make_unique<Drrt>(drrt_settings().read(o), std::move(context));
          },
          false};
}

}  // namespace trellis
