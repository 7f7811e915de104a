// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>

#include <trellis/guide/set_up.hpp>
#include <trellis/strategy/checks.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

namespace {

std::unique_ptr<SearchedGuidance> make_guidance_at(Run& run, Level& level, const GuideSpec& spec,
                                                   const std::string& key) {
  if (spec.kind() == GuideSpec::Kind::component) return make_component(run, level, spec, key);
  std::vector<double> weights;
  std::vector<std::unique_ptr<SearchedGuidance>> parts;
  for (const auto& term : spec.terms()) {
    weights.push_back(term.weight);
    // The key is the location in the hierarchy, so that no level's random stream depends on its neighbours.
    parts.push_back(make_guidance_at(run, level, term.guide, fmt::format("{}.{}", key, parts.size())));
  }
  const Options& options = spec.options();
  switch (spec.kind()) {
    case GuideSpec::Kind::mixture: return make_mixture(weights, std::move(parts));
    case GuideSpec::Kind::sequence: return make_sequence(sequence_settings().read(options), std::move(parts));
    case GuideSpec::Kind::blend: return make_blend(blend_settings().read(options), level.instance(), std::move(parts));
    case GuideSpec::Kind::schedule: return make_schedule(schedule_settings().read(options), std::move(parts));
    case GuideSpec::Kind::race: return make_race(race_settings().read(options), std::move(parts));
    case GuideSpec::Kind::component: break;
  }
  throw Fault("unknown kind of guide");
}

}  // namespace

namespace {

void add_set_up(const GuideSpec& spec, const Scene& scene, double queries, std::set<std::string>& prepared,
                double& sum) {
  for (const auto& term : spec.terms()) add_set_up(term.guide, scene, queries, prepared, sum);
  if (spec.kind() != GuideSpec::Kind::component) return;
  const SetUp work = [&] {
    if (spec.custom()) return set_up_of_custom();
    try {
      return set_up_of(spec.name(), spec.options(), scene);
    } catch (const Error& error) {
      throw Error(where(spec.origin()) + error.what());
    }
  }();
  sum += work.run;
  if (work.world > 0.0 && prepared.insert(spec.name()).second) sum += work.world / queries;
  if (spec.below() != nullptr) add_set_up(*spec.below(), scene, queries, prepared, sum);
}

}  // namespace

double set_up_work(const GuideSpec& guides, const Scene& scene, double queries) {
  std::set<std::string> prepared;
  double sum = 0.0;
  add_set_up(guides, scene, queries, prepared, sum);
  return sum;
}

std::unique_ptr<SearchedGuidance> make_guidance(Run& run, Level& level, const GuideSpec& spec) {
  return make_guidance_at(run, level, spec, level.record().key + "/0");
}

}  // namespace trellis
