// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/explanation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include <trellis/guide/custom.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/combinators.hpp>
#include <trellis/strategy/lengths.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

namespace {

using Levels = std::map<std::string, Level*>;  // by key

LevelExplanation explained(Level& level, const GuideSpec* guide, bool planner_given, const Levels& levels);

/// The lengths of a guide's default planner that neither are its defaults nor set by the guide.
std::vector<std::string> inherited_lengths(const GuideSpec& spec, const PlannerSpec& planner) {
  std::vector<std::string> names;
  if (spec.planner_given()) return names;
  std::vector<Options::Entry> set;
  if (!spec.custom()) set = find_guide(spec.name())->guided_planner.options;
  const Component& component = *find_planner(planner.name())->component;
  for (const auto& [name, value] : planner.options().entries()) {
    const Option& option = *component.find(name);
    const bool by_guide = std::any_of(set.begin(), set.end(), [&, &n = name](const auto& e) { return e.first == n; });
    if (is_length(option) && value != option.default_value && !by_guide) names.push_back(name);
  }
  return names;
}

const Component* combinator_component(GuideSpec::Kind kind) {
  switch (kind) {
    case GuideSpec::Kind::sequence: return &sequence_settings().component();
    case GuideSpec::Kind::blend: return &blend_settings().component();
    case GuideSpec::Kind::schedule: return &schedule_settings().component();
    case GuideSpec::Kind::race: return &race_settings().component();
    case GuideSpec::Kind::component:
    case GuideSpec::Kind::mixture: break;
  }
  return nullptr;
}

/// The registry's description of a guide, without its search and its parts.
GuideExplanation described(const GuideSpec& spec) {
  GuideExplanation guide{.spec = spec};
  if (spec.kind() != GuideSpec::Kind::component) {
    const auto& all = combinators();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Combinator& c) { return c.name == spec.name(); });
    if (found == all.end()) throw Fault("a combinator that is not in the catalogue: " + spec.name());
    guide.summary = found->summary;
    guide.claims = &found->claims;
    guide.component = combinator_component(spec.kind());
  } else if (spec.custom()) {
    guide.claims = &spec.custom()->description().claims;
    guide.resolves = spec.planner() ? spec.custom()->description().resolves : 0;
  } else {
    const GuideKind& kind = *find_guide(spec.name());
    guide.component = kind.component;
    guide.summary = kind.component->summary;
    guide.claims = &kind.claims;
    guide.resolves = kind.resolves(spec.options());
  }
  return guide;
}

/// \param key  location in the hierarchy, as in `make_guidance`
GuideExplanation explained(const GuideSpec& spec, const std::string& key, const Levels& levels) {
  GuideExplanation guide = described(spec);
  double total = 0.0;
  for (const auto& term : spec.terms()) {
    guide.parts.push_back(explained(term.guide, fmt::format("{}.{}", key, guide.parts.size()), levels));
    total += term.weight;
  }
  if (spec.kind() == GuideSpec::Kind::mixture) {
    for (const auto& term : spec.terms()) guide.shares.push_back(term.weight / total);
  }
  const auto found = levels.find(key);
  if (spec.kind() != GuideSpec::Kind::component || found == levels.end()) return guide;
  Guide& f = *found->second->projection();
  guide.effort = f.repairs().effort(false);
  guide.effort_again = f.repairs().effort(true);
  guide.validates_edges = dynamic_cast<const SpendsParentsChecks*>(&f) != nullptr;
  LevelExplanation level = explained(*found->second, spec.below(), spec.planner_given(), levels);
  level.inherited = inherited_lengths(spec, level.planner);
  guide.level = std::make_shared<const LevelExplanation>(std::move(level));
  return guide;
}

void add_levels(const GuideExplanation& guide, std::vector<int>& numbers) {
  if (guide.level) {
    numbers.push_back(guide.level->number);
    numbers.insert(numbers.end(), guide.level->below.begin(), guide.level->below.end());
  }
  for (const GuideExplanation& part : guide.parts) add_levels(part, numbers);
}

LevelExplanation explained(Level& level, const GuideSpec* guide, bool planner_given, const Levels& levels) {
  const LevelRecord& record = level.record();
  const Instance& instance = level.instance();
  LevelExplanation out{.number = record.level,
                       .name = record.name,
                       .space = instance.space,
                       .goals = instance.goals.size(),
                       .motion_model = instance.motion_model ? instance.motion_model->text() : "",
                       .presumed = record.presumed,
                       .collision = instance.collision,
                       .resolution = instance.resolution,
                       .shared_resolution = instance.shared_resolution,
                       .planner = level.planner(),
                       .kind = find_planner(level.planner().name()),
                       .planner_given = planner_given,
                       .common = level.common(),
                       .grant = level.ledger().grant()};
  if (instance.graph) {
    const auto& graph = *instance.graph;
    out.graph = {.vertices = graph.vertices.size(), .edges = graph.edges.size(), .verified = graph.verified};
  }
  if (guide != nullptr) {
    out.guide = explained(*guide, record.key + "/0", levels);
    add_levels(*out.guide, out.below);
  }
  return out;
}

}  // namespace

LevelExplanation explain(const StrategySpec& strategy, const Problem& problem) {
  check_depth(strategy);
  Run run;
  run.problem = problem.name;
  Level root(run, nullptr, "0", "root", root_instance(strategy, problem), strategy.planner(), nullptr);
  if (strategy.guide() != nullptr) root.guide_by(*strategy.guide());
  Levels levels;
  for (Level* level : run.levels) levels.emplace(level->record().key, level);
  LevelExplanation out = explained(root, strategy.guide(), true, levels);
  if (strategy.guide() != nullptr) out.set_up = set_up_work(*strategy.guide(), *problem.scene, out.common.queries);
  return out;
}

}  // namespace trellis
