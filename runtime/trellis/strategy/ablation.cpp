// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/ablation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>

namespace trellis {

namespace {

enum class How { uniform, skip };

/// The component without its guide. Its planner is kept only if the script names it.
GuideSpec bare(const GuideSpec& guide) {
  GuideSpec plain = guide.alone();
  if (!guide.planner_given()) return plain;
  if (guide.custom()) return GuideSpec::make(guide.custom(), guide.planner(), guide.origin());
  return GuideSpec::make(guide.name(), guide.options().entries(), guide.planner(), guide.origin());
}

/// Collects the components of a guide, each before those that guide it.
void collect(const GuideSpec& guide, std::vector<const GuideSpec*>& components) {
  if (guide.kind() != GuideSpec::Kind::component) {
    for (const auto& term : guide.terms()) collect(term.guide, components);
    return;
  }
  components.push_back(&guide);
  if (guide.below() != nullptr) collect(*guide.below(), components);
}

/// The guide without its component number `which`.
GuideSpec without(const GuideSpec& guide, std::size_t& which, How how) {
  if (guide.kind() == GuideSpec::Kind::component) {
    if (which-- == 0) return how == How::skip ? *guide.below() : GuideSpec::make("uniform", {});
    if (guide.below() == nullptr) return guide;
    return without(*guide.below(), which, how) >> bare(guide);
  }
  std::vector<GuideSpec> parts;
  parts.reserve(guide.terms().size());
  for (const auto& term : guide.terms()) parts.push_back(without(term.guide, which, how));
  return guide.with_parts(parts);
}

}  // namespace

std::vector<Ablation> ablations(const StrategySpec& strategy) {
  std::vector<Ablation> result;
  if (strategy.guide() == nullptr) return result;
  std::vector<const GuideSpec*> components;
  collect(*strategy.guide(), components);
  std::vector<std::string> names;
  names.reserve(components.size());
  for (const GuideSpec* component : components) names.push_back(bare(*component).text());
  std::vector<std::string> levels;
  for (std::size_t i = 0; i < components.size(); ++i) {
    std::string name = names[i];
    const std::string level = components[i]->text_alone();
    const auto among = static_cast<std::size_t>(std::count(levels.begin(), levels.end(), level));
    levels.push_back(level);
    if (std::count(names.begin(), names.end(), name) > 1) {
      const auto end = names.begin() + static_cast<std::ptrdiff_t>(i) + 1;
      name += fmt::format(" #{}", std::count(names.begin(), end, names[i]));
    }
    for (const How how : {How::uniform, How::skip}) {
      if (how == How::skip && components[i]->below() == nullptr) continue;
      std::size_t which = i;
      GuideSpec rest = without(*strategy.guide(), which, how);
      result.push_back({name, level, among, how == How::skip, StrategySpec(strategy.planner(), std::move(rest))});
    }
  }
  return result;
}

}  // namespace trellis
