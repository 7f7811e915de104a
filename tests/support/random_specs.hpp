// SPDX-License-Identifier: GPL-3.0-or-later
// Random hierarchies: all combinators of guides, mixed kinds at every level.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis::test {

/// The same sequence of specs for the same seed.
class RandomSpecs {
 public:
  /// \param bound  of the planner at the root, with a random number of queries; 0: its defaults
  /// \param others  further components to draw from
  explicit RandomSpecs(std::uint64_t seed, double bound = 0.0, std::vector<GuideSpec> others = {})
      : stream_(seed, "specs", "random"), bound_(bound), others_(std::move(others)) {}

  /// As above, but all components are drawn from `components`, and the planner at the root from `roots`.
  RandomSpecs(std::uint64_t seed, double bound, std::vector<GuideSpec> components, std::vector<PlannerSpec> roots)
      : stream_(seed, "specs", "random"), bound_(bound), others_(std::move(components)), roots_(std::move(roots)) {}

  /// \param depth  of what is combined, at the most
  GuideSpec guide(int depth) {
    if (depth <= 1 || stream_.uniform() < 0.15) return component();
    switch (stream_.below(6)) {
      case 0: return nested(depth);
      case 1: {
        GuideSpec sum = weight() * guide(depth - 1);
        for (std::size_t i = stream_.below(2); i < 2; ++i) sum = sum + weight() * guide(depth - 1);
        return sum;
      }
      case 2: return sequence(parts(depth), one_of({20, 50, default_turn}));
      case 3: return blend(parts(depth), blending());
      case 4:
        return schedule(parts(depth), {.rounds = one_of({1, 2}), .turn = stream_.uniform() < 0.5 ? 60.0 : unlimited});
      default: return race(parts(depth), {.slice = one_of({10, 100})});
    }
  }

  StrategySpec strategy(int depth) {
    const StrategySpec guided = guide(depth) >> root();
    if (stream_.uniform() < 0.7) return guided;
    return split(guided, {.depth = one_of({1, 2}), .tries = one_of({1, 2}), .effort = one_of({100, 400})});
  }

 private:
  static constexpr double unlimited = std::numeric_limits<double>::infinity();

  std::int64_t one_of(const std::vector<std::int64_t>& values) { return values[stream_.below(values.size())]; }
  double weight() { return 0.1 + stream_.uniform(); }

  std::vector<GuideSpec> parts(int depth) {
    std::vector<GuideSpec> all;
    for (std::size_t i = 0; i < 1 + stream_.below(3); ++i) all.push_back(guide(depth - 1));
    return all;
  }

  /// `a >> b`, where the search at the end of b has a space for a guide.
  GuideSpec nested(int depth) {
    GuideSpec above = guide(depth - 1);
    GuideSpec guided = guide(depth - 1);
    return guidable(guided) ? above >> guided : above + guided;
  }

  static bool guidable(const GuideSpec& guide) {
    if (!guide.searches()) return false;
    if (guide.kind() == GuideSpec::Kind::component) return guide.below() == nullptr || guidable(*guide.below());
    return std::all_of(guide.terms().begin(), guide.terms().end(),
                       [](const GuideSpec::Term& term) { return !term.guide.searches() || guidable(term.guide); });
  }

  GuideSpec component() {
    const double share = roots_.empty() ? 0.6 : 1.0;
    if (!others_.empty() && stream_.uniform() < share) return others_[stream_.below(others_.size())];
    switch (stream_.below(7)) {
      case 0: return GuideSpec::make("skeleton", {});
      case 1: return searched("shrink", {{"scale", 0.3 + 0.1 * static_cast<double>(stream_.below(6))}});
      case 2: return GuideSpec::make("lazy", {});
      case 3: return searched("identity", {});
      case 4: return GuideSpec::make("gaussian", {});
      case 5: return GuideSpec::make("goal_bias", {{"share", 0.25}});
      default: return searched("shrink", {{"follow", std::string("waypoints")}, {"resolves", std::int64_t{2}}});
    }
  }

  /// With its own planner for the search, sometimes one that splits.
  GuideSpec searched(const std::string& name, const std::vector<Options::Entry>& given) {
    const PlannerSpec own =
        PlannerSpec::make(stream_.uniform() < 0.5 ? "rrt" : "rrt_connect", {{"proposals", std::int64_t{400}}});
    if (stream_.uniform() < 0.3) return GuideSpec::make(name, given, split(own, {.effort = 100}));
    return GuideSpec::make(name, given, own);
  }

  BlendSettings blending() {
    BlendSettings settings;
    settings.floor = stream_.uniform() < 0.5 ? 0.2 : 0.5;
    settings.credit = std::array{"node", "reach", "efficiency"}[stream_.below(3)];
    if (settings.credit != "efficiency" && stream_.uniform() < 0.5) settings.rule = "exp3";
    return settings;
  }

  PlannerSpec root() {
    static constexpr std::array names = {"rrt",      "rrt_connect", "prm",           "lazy_prm",
                                         "rrt_star", "prm_star",    "lazy_prm_star", "lazy_rrg_star"};
    std::vector<Options::Entry> given = {{"proposals", std::int64_t{800}}};
    if (bound_ > 0.0) {
      given.emplace_back("bound", bound_);
      given.emplace_back("queries", stream_.uniform() < 0.5 ? 1.0 : 1000.0);
    }
    if (roots_.empty()) return PlannerSpec::make(names[stream_.below(names.size())], given);
    const PlannerSpec& root = roots_[stream_.below(roots_.size())];
    for (const auto& entry : root.options().entries()) {
      if (std::ranges::find(given, entry.first, &Options::Entry::first) == given.end()) given.push_back(entry);
    }
    return PlannerSpec::make(root.name(), given);
  }

  Stream stream_;
  double bound_;
  std::vector<GuideSpec> others_;
  std::vector<PlannerSpec> roots_;
};

}  // namespace trellis::test
