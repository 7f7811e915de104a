// SPDX-License-Identifier: GPL-3.0-or-later
// The probabilistic roadmap and its lazy form: one roadmap, checked when it is built or only along the path found.
#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/planner/kinds.hpp>
#include <trellis/planner/loop.hpp>
#include <trellis/planner/roadmap.hpp>

namespace trellis {

namespace {

struct RoadmapSettings : CommonSettings {
  RoadmapSettings() { goal_bias = 0.0; }
  std::int64_t neighbours = 10;
  double radius = std::numeric_limits<double>::infinity();
};

struct PrmSettings : RoadmapSettings {
  std::int64_t batch = 10;
};

struct LazyPrmSettings : RoadmapSettings {
  std::int64_t samples = 100;
  std::int64_t batch = 20;
};

template <class S>
Settings<S> with_roadmap(Settings<S> settings) {
  settings
      .integer("neighbours", &S::neighbours, "nodes", Range::at_least(1), "nearest nodes that a new node is joined to")
      .number("radius", &S::radius, "m in the metric", Range::positive(), "longest edge of the roadmap");
  return with_common(std::move(settings));
}

const Settings<PrmSettings>& prm_settings() {
  static const Settings<PrmSettings> settings = with_roadmap(
      Settings<PrmSettings>(Component::Kind::planner, "prm",
                            "probabilistic roadmap: valid samples joined by valid motions to their neighbours, until "
                            "start and goal are connected",
                            "Kavraki, Svestka, Latombe and Overmars 1996")
          .integer("batch", &PrmSettings::batch, "proposals", Range::at_least(1),
                   "proposals added when another path is asked for"));
  return settings;
}

const Settings<LazyPrmSettings>& lazy_prm_settings() {
  static const Settings<LazyPrmSettings> settings = with_roadmap(
      Settings<LazyPrmSettings>(Component::Kind::planner, "lazy_prm",
                                "roadmap that checks only what lies on the shortest path, from its ends inwards; the "
                                "search is repaired, never begun again",
                                "Bohlin and Kavraki 2000, Path planning using lazy PRM")
          .integer("samples", &LazyPrmSettings::samples, "proposals", Range::at_least(1),
                   "proposals before the first search")
          .integer("batch", &LazyPrmSettings::batch, "proposals", Range::at_least(1),
                   "proposals added when start and goal are not connected, or another path is asked for"));
  return settings;
}

enum class Known : std::uint8_t { unknown, valid, invalid };

class RoadmapPlanner final : public Planner {
 public:
  struct Mode {
    bool lazy = false;
    std::int64_t samples = 0;  ///< before the first search
    std::int64_t batch = 1;
  };

  RoadmapPlanner(const RoadmapSettings& settings, Mode mode, Task task)
      : settings_(settings),
        mode_(mode),
        task_(std::move(task)),
        index_(task_.instance.space),
        sample_(dimension()),
        blocked_(dimension()) {}

  Solution solve(const Budget& budget) override {
    auto& instance = task_.instance;
    Meter meter(task_, budget);
    if (paths_.vertices() == 0) {
      if (auto nothing = invalid_ends(instance)) return std::move(*nothing);
      if (instance.space.distance(instance.start, instance.goal) <= instance.goal_tolerance) {
        Solution solution{Status::solved, Configurations(dimension())};
        task_.search.nodes.push(instance.start);
        task_.search.parents.push_back(no_node);
        solution.path.push(instance.start);
        return solution;
      }
      epoch_ = instance.validity->epoch();
      insert(instance.start, Known::valid);
      insert(instance.goal, Known::valid);
      owed_ = mode_.samples;
    } else if (epoch_ != instance.validity->epoch()) {
      // What was found valid may not be so any more; only what the next paths use is looked at again.
      epoch_ = instance.validity->epoch();
      for (auto& known : nodes_) known = known == Known::valid ? Known::unknown : known;
      for (auto& known : edges_) known = known == Known::valid ? Known::unknown : known;
      nodes_[0] = nodes_[1] = Known::valid;
    } else if (solved_) {
      owed_ = mode_.batch;
    }
    solved_ = false;
    for (;;) {
      for (; owed_ > 0; --owed_) {
        if (const auto reason = meter.spent()) return finish(*reason);
        grow();
      }
      if (!paths_.search()) {
        owed_ = mode_.lazy ? mode_.batch : 1;
        continue;
      }
      if (validated()) {
        solved_ = true;
        return finish(Status::solved);
      }
      // Each round removes at least one edge, so without new proposals this ends; the budget of checks still holds.
      if (const auto reason = meter.spent()) return finish(*reason);
    }
  }

 private:
  static constexpr std::uint32_t goal = LifelongSearch::goal;

  [[nodiscard]] std::size_t dimension() const { return task_.instance.space.dimension(); }
  [[nodiscard]] View node(std::uint32_t id) const { return std::as_const(task_.search.nodes)[rows_[id]]; }

  void grow() {
    auto& instance = task_.instance;
    propose(task_, sample_);
    Outcome outcome;
    outcome.proposal = sample_;
    if (!mode_.lazy && !instance.valid(sample_)) {
      outcome.blocked_at = sample_;
      settle(task_, outcome);
      return;
    }
    if (index_.nearest(sample_).squared_distance == 0.0) {
      settle(task_, outcome);
      return;
    }
    insert(sample_, mode_.lazy ? Known::unknown : Known::valid);
    outcome.fate = Fate::reached;
    outcome.added = sample_;
    settle(task_, outcome, no_node, rows_.back());
  }

  void insert(View q, Known known) {
    index_.k_nearest(q, static_cast<std::size_t>(settings_.neighbours), neighbours_);
    rows_.push_back(task_.search.nodes.push(q));
    task_.search.parents.push_back(no_node);
    nodes_.push_back(known);
    index_.add(q);
    const std::uint32_t id = paths_.add_vertex(task_.instance.space.distance(q, task_.instance.goal));
    for (const auto& neighbour : neighbours_) {
      const double length = std::sqrt(neighbour.squared_distance);
      if (length > settings_.radius) break;
      if (nodes_[neighbour.id] == Known::invalid) continue;
      if (!mode_.lazy && !task_.instance.motion(node(neighbour.id), node(id)).valid) continue;
      paths_.add_edge(neighbour.id, id, length);
      task_.search.edges.push_back({rows_[neighbour.id], rows_[id]});
      edges_.push_back(mode_.lazy ? Known::unknown : Known::valid);
    }
  }

  /// Looks at the shortest path, nodes first and then edges, each from both ends inwards, and removes the invalid nodes
  /// or the first invalid edge. True when the whole path is valid.
  bool validated() {
    auto& instance = task_.instance;
    paths_.path(goal, path_);
    std::vector<std::uint32_t> stops = {0};
    for (const std::uint32_t edge : path_) stops.push_back(paths_.other(edge, stops.back()));
    // All invalid nodes of the path go at once: each would have to go before this way could be ruled out, and one
    // repair of the search serves them all.
    bool sound = true;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const std::uint32_t id = stops[outside_in(i, stops.size())];
      if (nodes_[id] != Known::unknown) continue;
      if (instance.valid(node(id))) {
        nodes_[id] = Known::valid;
        continue;
      }
      sound = false;
      nodes_[id] = Known::invalid;
      paths_.isolate(id);
      const View q = node(id);
      blocked_.assign(q.begin(), q.end());
      tell_blocked();
    }
    if (!sound) return false;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const std::size_t at = outside_in(i, path_.size());
      const std::uint32_t id = path_[at];
      if (edges_[id] != Known::unknown) continue;
      const MotionReport report = instance.motion(node(stops[at]), node(stops[at + 1]));
      if (report.valid) {
        edges_[id] = Known::valid;
        continue;
      }
      edges_[id] = Known::invalid;
      instance.space.interpolate(node(stops[at]), node(stops[at + 1]), report.invalid_at, blocked_);
      paths_.remove_edge(id);
      tell_blocked();
      return false;
    }
    return true;
  }

  static std::size_t outside_in(std::size_t i, std::size_t n) { return i % 2 == 0 ? i / 2 : n - 1 - i / 2; }

  /// What was found invalid long after it was proposed is still news to h.
  void tell_blocked() {
    Outcome outcome;
    outcome.proposal = blocked_;
    outcome.blocked_at = blocked_;
    task_.guidance.observe(outcome, false);
  }

  [[nodiscard]] Solution finish(Status status) {
    Solution solution{status, Configurations(dimension())};
    std::uint32_t end = status == Status::solved ? goal : LifelongSearch::start;
    if (status != Status::solved) {
      // Of the nodes that the search tree holds, the one nearest to the goal.
      paths_.search();
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t id = 0; id < paths_.vertices(); ++id) {
        if (!paths_.reached(id) || id == goal) continue;
        const double distance = task_.instance.space.distance(node(id), task_.instance.goal);
        if (distance < least) {
          least = distance;
          end = id;
        }
      }
    }
    paths_.path(end, path_);
    std::uint32_t at = 0;
    solution.path.push(node(at));
    for (const std::uint32_t edge : path_) {
      at = paths_.other(edge, at);
      solution.path.push(node(at));
    }
    return solution;
  }

  RoadmapSettings settings_;
  Mode mode_;
  Task task_;
  NearestIndex index_;
  LifelongSearch paths_;
  std::vector<std::uint32_t> rows_;
  std::vector<Known> nodes_;
  std::vector<Known> edges_;
  std::vector<NearestIndex::Neighbour> neighbours_;
  std::vector<std::uint32_t> path_;
  Configuration sample_;
  Configuration blocked_;
  std::int64_t owed_ = 0;  ///< proposals to make before the next search
  std::uint64_t epoch_ = 0;
  bool solved_ = false;
};

}  // namespace

PlannerKind prm_kind() {
  return {&prm_settings().component(), [](const Options& o) { return prm_settings().read(o).common(); },
          [](const Options& o, Planner::Task task) -> std::unique_ptr<Planner> {
            const PrmSettings settings = prm_settings().read(o);
            return std::make_unique<RoadmapPlanner>(settings, RoadmapPlanner::Mode{false, 0, settings.batch},
                                                    std::move(task));
          },
          false};
}

PlannerKind lazy_prm_kind() {
  return {&lazy_prm_settings().component(), [](const Options& o) { return lazy_prm_settings().read(o).common(); },
          [](const Options& o, Planner::Task task) -> std::unique_ptr<Planner> {
            const LazyPrmSettings settings = lazy_prm_settings().read(o);
            return std::make_unique<RoadmapPlanner>(
                settings, RoadmapPlanner::Mode{true, settings.samples, settings.batch}, std::move(task));
          },
          false, true};
}

}  // namespace trellis
