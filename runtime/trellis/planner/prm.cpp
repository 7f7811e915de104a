// SPDX-License-Identifier: GPL-3.0-or-later
// The probabilistic roadmap and its lazy form: one roadmap, checked when it is built or only along the path found.
#include <algorithm>
#include <array>
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
  std::string remove = "all";
  std::string edges = "in_turn";
  double enhance = 0.0;
  double spread = 0.25;
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
                   "proposals added when start and goal are not connected, or another path is asked for")
          .choice("remove", &LazyPrmSettings::remove, {"all", "first"},
                  "which of a path's nodes go before the next search: \"all\" that are invalid, since each would have "
                  "to; \"first\", as published, the first that is found")
          .choice("edges", &LazyPrmSettings::edges, {"in_turn", "coarse_to_fine"},
                  "how a path's edges are checked: \"in_turn\", each to its end; \"coarse_to_fine\", as published, all "
                  "at their middles, then all at their quarters, and so on")
          .number("enhance", &LazyPrmSettings::enhance, "nodes per proposal", {.lo = 0, .hi = 100},
                  "nodes placed about the middles of edges that were removed though both ends are valid, for each "
                  "proposal after the first `samples`; they are no proposals")
          .number("spread", &LazyPrmSettings::spread, "edge lengths", Range::positive(),
                  "standard deviation of such a node from the middle, along every axis, by the length of the edge"));
  return settings;
}

enum class Known : std::uint8_t { unknown, valid, invalid };

class RoadmapPlanner final : public Planner {
 public:
  struct Mode {
    bool lazy = false;
    std::int64_t samples = 0;  ///< before the first search
    std::int64_t batch = 1;
    bool remove_first = false;
    bool coarse_to_fine = false;
    double enhance = 0.0;
    double spread = 0.25;
  };

  RoadmapPlanner(const RoadmapSettings& settings, Mode mode, Task task)
      : settings_(settings),
        mode_(mode),
        task_(std::move(task)),
        index_(task_.instance.space),
        sample_(dimension()),
        blocked_(dimension()) {
    // What is presumed is looked at for nothing.
    judged_ = mode_.lazy && task_.instance.validity->spends_checks();
    task_.search.expands = !judged_ || task_.guided;
  }

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
      std::fill(passes_.begin(), passes_.end(), std::uint8_t{0});
      nodes_[0] = nodes_[1] = Known::valid;
    } else if (solved_) {
      owed_ = mode_.batch;
    }
    solved_ = false;
    for (;;) {
      for (; owed_ > 0; --owed_) {
        if (const auto reason = meter.spent()) return finish(*reason);
        grow();
        enhance();
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

  /// Places nodes about the middles of removed edges, where the way was found to be narrow.
  void enhance() {
    if (seeds_.empty()) return;
    const auto& space = task_.instance.space;
    for (enhancements_ += mode_.enhance; enhancements_ >= 1.0; enhancements_ -= 1.0) {
      const auto& [a, b] = seeds_[task_.proposals.below(seeds_.size())];
      space.interpolate(node(a), node(b), 0.5, sample_);
      const double sigma = mode_.spread * space.distance(node(a), node(b));
      for (std::size_t j = 0; j < sample_.size(); ++j) {
        sample_[j] += sigma * task_.proposals.normal() / space.axes()[j].weight;
      }
      space.reflect(sample_);
      if (space.contains(sample_) && index_.nearest(sample_).squared_distance > 0.0) insert(sample_, Known::unknown);
    }
  }

  void insert(View q, Known known) {
    index_.k_nearest(q, static_cast<std::size_t>(settings_.neighbours), neighbours_);
    rows_.push_back(task_.search.nodes.push(q));
    task_.search.parents.push_back(no_node);
    nodes_.push_back(known);
    if (judged_) task_.search.looked_at.push_back(known != Known::unknown ? 1 : 0);
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
      passes_.push_back(0);
    }
  }

  /// Looks at the shortest path, nodes first and then edges, each from both ends inwards, and removes the invalid nodes
  /// or the first invalid edge. True when the whole path is valid.
  bool validated() {
    auto& instance = task_.instance;
    paths_.path(goal, path_);
    stops_ = {0};
    for (const std::uint32_t edge : path_) stops_.push_back(paths_.other(edge, stops_.back()));
    // All invalid nodes of the path may go at once: each would have to go before this way could be ruled out, and one
    // repair of the search serves them all.
    bool sound = true;
    for (std::size_t i = 0; i < stops_.size(); ++i) {
      const std::size_t at = outside_in(i, stops_.size());
      const std::uint32_t id = stops_[at];
      if (nodes_[id] != Known::unknown) continue;
      if (judged_) task_.search.looked_at[rows_[id]] = 1;
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
      if (mode_.remove_first) return false;
    }
    if (!sound || (mode_.coarse_to_fine && !coarsely_valid())) return false;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const std::size_t at = outside_in(i, path_.size());
      const std::uint32_t id = path_[at];
      if (edges_[id] != Known::unknown) continue;
      const MotionReport report = instance.motion(node(stops_[at]), node(stops_[at + 1]));
      if (report.valid) {
        edges_[id] = Known::valid;
        continue;
      }
      remove_edge(at, report.invalid_at);
      return false;
    }
    return true;
  }

  /// Looks at the edges of the path at their middles, then at their quarters, and so on, each time from both ends of
  /// the path inwards, while what is left between is at least four times the resolution; the rest is the motions' own
  /// check. Removes the first invalid edge.
  bool coarsely_valid() {
    auto& instance = task_.instance;
    for (std::uint8_t pass = 1; pass < 32; ++pass) {
      const std::uint32_t pieces = std::uint32_t{1} << pass;
      bool looked = false;
      for (std::size_t i = 0; i < path_.size(); ++i) {
        const std::size_t at = outside_in(i, path_.size());
        const std::uint32_t id = path_[at];
        if (edges_[id] != Known::unknown || paths_.edge(id).cost / pieces < 4.0 * instance.resolution) continue;
        looked = true;
        if (passes_[id] >= pass) continue;
        for (std::uint32_t k = 1; k < pieces; k += 2) {
          const double t = static_cast<double>(k) / pieces;
          instance.space.interpolate(node(stops_[at]), node(stops_[at + 1]), t, sample_);
          if (instance.valid(sample_)) continue;
          remove_edge(at, t);
          return false;
        }
        passes_[id] = pass;
      }
      if (!looked) break;
    }
    return true;
  }

  /// Removes an edge of the path, found invalid at t.
  void remove_edge(std::size_t at, double t) {
    const std::uint32_t id = path_[at];
    edges_[id] = Known::invalid;
    task_.instance.space.interpolate(node(stops_[at]), node(stops_[at + 1]), t, blocked_);
    paths_.remove_edge(id);
    if (mode_.enhance > 0.0) seeds_.push_back({stops_[at], stops_[at + 1]});
    tell_blocked();
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
  std::vector<std::uint32_t> path_;                  ///< edges
  std::vector<std::uint32_t> stops_;                 ///< the nodes between them
  std::vector<std::uint8_t> passes_;                 ///< of each edge how finely it was looked at
  std::vector<std::array<std::uint32_t, 2>> seeds_;  ///< ends of the edges that were removed
  Configuration sample_;
  Configuration blocked_;
  std::int64_t owed_ = 0;      ///< proposals to make before the next search
  double enhancements_ = 0.0;  ///< owed
  bool judged_ = false;        ///< which nodes were looked at is kept
  std::uint64_t epoch_ = 0;
  bool solved_ = false;
};

}  // namespace

PlannerKind prm_kind() {
  return {&prm_settings().component(), [](const Options& o) { return prm_settings().read(o).common(); },
          [](const Options& o, Planner::Task task) -> std::unique_ptr<Planner> {
            const PrmSettings settings = prm_settings().read(o);
            return std::make_unique<RoadmapPlanner>(settings, RoadmapPlanner::Mode{.batch = settings.batch},
                                                    std::move(task));
          },
          false};
}

PlannerKind lazy_prm_kind() {
  return {&lazy_prm_settings().component(), [](const Options& o) { return lazy_prm_settings().read(o).common(); },
          [](const Options& o, Planner::Task task) -> std::unique_ptr<Planner> {
            const LazyPrmSettings settings = lazy_prm_settings().read(o);
            return std::make_unique<RoadmapPlanner>(
                settings,
                RoadmapPlanner::Mode{true, settings.samples, settings.batch, settings.remove == "first",
                                     settings.edges == "coarse_to_fine", settings.enhance, settings.spread},
                std::move(task));
          },
          false, true};
}

}  // namespace trellis
