// SPDX-License-Identifier: GPL-3.0-or-later
// The probabilistic roadmap planner and its lazy form. Both end with the first path.
#include <limits>

#include <trellis/planner/roadmap_planner.hpp>

namespace trellis {

namespace {

struct RoadmapSettings : CommonSettings {
  RoadmapSettings() { goal_bias = 0.0; }
  std::int64_t neighbours = 10;
  double radius = std::numeric_limits<double>::infinity();

  [[nodiscard]] Connection connection() const { return {neighbours, radius}; }
};

struct PrmSettings : RoadmapSettings {
  std::int64_t batch = 10;
};

struct LazyPrmSettings : RoadmapSettings {
  std::int64_t samples = 100;
  std::int64_t batch = 20;
  bool remove_first = false;
  bool coarse_to_fine = false;
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
          .choice("remove", &LazyPrmSettings::remove_first, {{"all", false}, {"first", true}},
                  "which of a path's nodes go before the next search: \"all\" that are invalid, since each would have "
                  "to; \"first\", as published, the first that is found")
          .choice("edges", &LazyPrmSettings::coarse_to_fine, {{"in_turn", false}, {"coarse_to_fine", true}},
                  "how a path's edges are checked: \"in_turn\", each to its end; \"coarse_to_fine\", as published, all "
                  "at their middles, then all at their quarters, and so on")
          .number("enhance", &LazyPrmSettings::enhance, "nodes per proposal", {.lo = 0, .hi = 100},
                  "nodes placed about the middles of edges that were removed though both ends are valid, for each "
                  "proposal after the first `samples`; they are no proposals")
          .number("spread", &LazyPrmSettings::spread, "edge lengths", Range::positive(),
                  "standard deviation of such a node from the middle, along every axis, by the length of the edge"));
  return settings;
}

}  // namespace

PlannerKind prm_kind() {
  return {&prm_settings().component(), [](const Options& o) { return common_of(prm_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            const PrmSettings settings = prm_settings().read(o);
            return std::make_unique<RoadmapPlanner>(
                settings.connection(), RoadmapPlanner::Mode{.between_components = true, .again = settings.batch},
                std::move(context));
          },
          false};
}

PlannerKind lazy_prm_kind() {
  return {&lazy_prm_settings().component(), [](const Options& o) { return common_of(lazy_prm_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            const LazyPrmSettings settings = lazy_prm_settings().read(o);
            return std::make_unique<RoadmapPlanner>(settings.connection(),
                                                    RoadmapPlanner::Mode{.lazy_nodes = true,
                                                                         .lazy_edges = true,
                                                                         .samples = settings.samples,
                                                                         .batch = settings.batch,
                                                                         .again = settings.batch,
                                                                         .proposals = settings.proposals,
                                                                         .remove_first = settings.remove_first,
                                                                         .coarse_to_fine = settings.coarse_to_fine,
                                                                         .enhance = settings.enhance,
                                                                         .spread = settings.spread},
                                                    std::move(context));
          },
          false, true};
}

}  // namespace trellis
