// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/ablation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>

namespace trellis {

namespace {

enum class How { remove, skip };

/// The component without its guide. Its planner is kept only if the script names it.
GuideSpec bare(const GuideSpec& guide) {
  GuideSpec plain = guide.alone();
  if (!guide.planner_given()) return plain;
  if (guide.custom()) return GuideSpec::make(guide.custom(), guide.planner(), guide.origin());
  return GuideSpec::make(guide.name(), guide.options().entries(), guide.planner(), guide.origin());
}

struct PlacedGuide {
  const GuideSpec* guide;
  std::string key;
};

/// Collects the components of a guide with their keys in a run, each before those that guide it.
void collect(const GuideSpec& guide, const std::string& key, std::vector<PlacedGuide>& components) {
  if (guide.kind() != GuideSpec::Kind::component) {
    for (std::size_t i = 0; i < guide.terms().size(); ++i) {
      collect(guide.terms()[i].guide, fmt::format("{}.{}", key, i), components);
    }
    return;
  }
  components.push_back({&guide, key});
  if (guide.below() != nullptr) collect(*guide.below(), key + "/0", components);
}

/// The guide without its component number `which`; none if nothing is left of it.
std::optional<GuideSpec> without(const GuideSpec& guide, std::size_t& which, How how) {
  if (guide.kind() == GuideSpec::Kind::component) {
    if (which-- == 0) return how == How::skip ? std::optional(*guide.below()) : std::nullopt;
    if (guide.below() == nullptr) return guide;
    const auto below = without(*guide.below(), which, how);
    return below ? *below >> bare(guide) : bare(guide);
  }
  std::vector<std::optional<GuideSpec>> parts;
  parts.reserve(guide.terms().size());
  for (const auto& term : guide.terms()) parts.push_back(without(term.guide, which, how));
  return guide.with_parts(parts);
}

}  // namespace

std::vector<Ablation> ablations(const StrategySpec& strategy) {
  std::vector<Ablation> result;
  if (strategy.guide() == nullptr) return result;
  std::vector<PlacedGuide> components;
  collect(*strategy.guide(), "0/0", components);
  std::vector<std::string> names;
  names.reserve(components.size());
  for (const PlacedGuide& component : components) names.push_back(bare(*component.guide).text());
  for (std::size_t i = 0; i < components.size(); ++i) {
    std::string name = names[i];
    if (std::count(names.begin(), names.end(), name) > 1) {
      const auto end = names.begin() + static_cast<std::ptrdiff_t>(i) + 1;
      name += fmt::format(" #{}", std::count(names.begin(), end, names[i]));
    }
    for (const How how : {How::remove, How::skip}) {
      if (how == How::skip && components[i].guide->below() == nullptr) continue;
      std::size_t which = i;
      auto rest = without(*strategy.guide(), which, how);
      result.push_back({name, components[i].key, how == How::skip,
                        rest ? StrategySpec(strategy.planner(), std::move(*rest)) : StrategySpec(strategy.planner())});
    }
  }
  return result;
}

std::vector<Ablation> decisive_ablations(const StrategySpec& strategy) {
  std::vector<Ablation> decisive;
  for (Ablation& ablation : ablations(strategy)) {
    if (!decisive.empty() && decisive.back().key == ablation.key) decisive.pop_back();
    decisive.push_back(std::move(ablation));
  }
  return decisive;
}

std::string guide_key(const std::string& level_key) {
  std::string key;
  bool half = false;
  for (std::size_t at = 0; at < level_key.size();) {
    const std::size_t end = std::min(level_key.find('/', at), level_key.size());
    // A guide's number is 0; the number of a try to divide an instance is at least 1.
    half = level_key[at] != '0';
    if (!half) {
      if (!key.empty()) key += '/';
      key.append(level_key, at, end - at);
    }
    at = end + 1;
  }
  return half || key == "0" ? "" : key;
}

}  // namespace trellis
