// SPDX-License-Identifier: GPL-3.0-or-later
// Asymptotically optimal roadmaps: PRM*, and planners that check an edge only when the shortest path contains it.
#include <trellis/planner/roadmap_planner.hpp>

namespace trellis {

namespace {

struct PrmStarSettings : AnytimeSettings {
  PrmStarSettings() { goal_bias = 0.0; }
};

struct LazyRrgStarSettings : PrmStarSettings {
  double step = 0.5;
};

constexpr const char* hauser =
    "Hauser 2015, Lazy collision checking in asymptotically-optimal motion planning; the search is repaired by "
    "lifelong "
    "planning A*, Koenig, Likhachev and Furcy 2004";

const Settings<PrmStarSettings>& prm_star_settings() {
  static const Settings<PrmStarSettings> settings = with_anytime(
      Settings<PrmStarSettings>(Component::Kind::planner, "prm_star",
                                "PRM*: a roadmap whose nodes have more neighbours the more nodes it has, so that its "
                                "paths converge to the shortest; continues after its first path",
                                "Karaman and Frazzoli 2011, Sampling-based algorithms for optimal motion planning"));
  return settings;
}

const Settings<PrmStarSettings>& lazy_prm_star_settings() {
  static const Settings<PrmStarSettings> settings = with_anytime(Settings<PrmStarSettings>(
      Component::Kind::planner, "lazy_prm_star",
      "Lazy-PRM*: the paths of PRM*; checks only edges that have been on a shortest path; continues after its first "
      "path",
      hauser));
  return settings;
}

const Settings<LazyRrgStarSettings>& lazy_rrg_star_settings() {
  static const Settings<LazyRrgStarSettings> settings = with_anytime(
      Settings<LazyRrgStarSettings>(
          Component::Kind::planner, "lazy_rrg_star",
          "Lazy-RRG*: a graph that grows from start and goal towards proposals; checks only edges that have been on a "
          "shortest path; continues after its first path",
          hauser)
          .number("step", &LazyRrgStarSettings::step, "m in the metric", Range::at_least(1e-6),
                  "how far a new node may be from the nearest one"));
  return settings;
}

std::unique_ptr<Planner> make(const AnytimeSettings& settings, RoadmapPlanner::Mode mode, PlannerContext context) {
  mode.improve = settings.improve;
  const Connection connection = settings.connection(context.instance.space);
  return std::make_unique<RoadmapPlanner>(connection, mode, std::move(context));
}

}  // namespace

PlannerKind prm_star_kind() {
  return {&prm_star_settings().component(), [](const Options& o) { return common_of(prm_star_settings().read(o)); },
          [](const Options& o, PlannerContext context) {
            return make(prm_star_settings().read(o), {}, std::move(context));
          },
          false};
}

PlannerKind lazy_prm_star_kind() {
  return {&lazy_prm_star_settings().component(),
          [](const Options& o) { return common_of(lazy_prm_star_settings().read(o)); },
          [](const Options& o, PlannerContext context) {
            return make(lazy_prm_star_settings().read(o), {.lazy_edges = true}, std::move(context));
          },
          false};
}

PlannerKind lazy_rrg_star_kind() {
  return {&lazy_rrg_star_settings().component(),
          [](const Options& o) { return common_of(lazy_rrg_star_settings().read(o)); },
          [](const Options& o, PlannerContext context) {
            const LazyRrgStarSettings settings = lazy_rrg_star_settings().read(o);
            return make(settings, {.lazy_edges = true, .step = settings.step}, std::move(context));
          },
          false};
}

}  // namespace trellis
