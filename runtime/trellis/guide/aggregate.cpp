// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <utility>

#include <trellis/guide/changing_world.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/characteristic_length.hpp>

namespace trellis {

namespace {

struct AggregateSettings : PathGuideSettings {
  double error = 0.0;
  std::int64_t refinements = 3;
};

const Settings<AggregateSettings>& aggregate_settings() {
  static const Settings<AggregateSettings> settings = with_path_options(
      Settings<AggregateSettings>(Component::Kind::guide, "aggregate",
                                  "obstacles near one another are merged into convex hulls, coarse at first: every "
                                  "path found in S is valid in C",
                                  "Ghosh, Thomas, Morales, Rodriguez and Amato 2016, Motion planning using "
                                  "hierarchical aggregation of workspace "
                                  "obstacles")
          .number(
              "error", &AggregateSettings::error, "m", Range::non_negative(),
              "how far a hull may be from the obstacles that it stands for, at first; 0: the robot's bounding radius, "
              "or 2 % of the world's diagonal for a point")
          .integer("refinements", &AggregateSettings::refinements, "times", {.lo = 0, .hi = 16},
                   "how often the error is halved where S has no path; then S has the obstacles themselves")
          .integer("effort", &AggregateSettings::effort, "proposals", Range::at_least(1),
                   "budget of the search among hulls of one error, and among the obstacles themselves")
          .positional({"error"}));
  return settings;
}

class Aggregate final : public PathGuide {
 public:
  explicit Aggregate(const AggregateSettings& settings)
      : PathGuide("aggregate", settings), settings_(settings), left_(settings.refinements) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    whole_ = parent.scene;
    error_ = settings_.error > 0.0 ? settings_.error : size_or(*parent.scene, 0.02 * parent.scene->diagonal());
    validity_ = std::make_shared<ChangingWorld>(parent, whole_->aggregated(error_));
    instance->validity = validity_;
    // A hull may contain the start or a goal. If an obstacle of C does too, no refinement helps.
    const auto valid = [&](const Configuration& end) { return instance->valid(end); };
    while (!(valid(instance->start) && std::all_of(instance->goals.begin(), instance->goals.end(), valid)) &&
           refine()) {
    }
    instance->scene = validity_->scene();
    return instance;
  }

  void attach(Instance& sub) override {
    PathGuide::attach(sub);
    sub_ = &sub;
  }
  [[nodiscard]] double effort(bool again) const override {
    return again ? PathGuide::effort(again) : static_cast<double>(settings_.effort);
  }

  /// Refines the hulls if S has no path.
  std::int64_t another(const Solution* found) override {
    if (found != nullptr || !refine()) return 0;
    return settings_.effort;
  }

 protected:
  /// A path that avoids the hulls is valid in C.
  [[nodiscard]] bool relaxes() const override { return false; }

 private:
  /// Halves the error; sets it to 0 after the last refinement. Returns whether it was greater than 0 before.
  bool refine() {
    if (error_ == 0.0) return false;
    error_ = left_ > 0 ? 0.5 * error_ : 0.0;
    --left_;
    validity_->set(whole_->aggregated(error_));
    if (sub_ != nullptr) sub_->scene = validity_->scene();
    return true;
  }

  AggregateSettings settings_;
  std::shared_ptr<const Scene> whole_;  ///< the parent's
  Instance* sub_ = nullptr;
  double error_ = 0.0;
  std::int64_t left_;  ///< remaining refinements
  std::shared_ptr<ChangingWorld> validity_;
};

}  // namespace

GuideKind aggregate_kind() {
  GuideClaims claims =
      path_claims(GuideClaims::Category::environment, "q -> q, among hulls of obstacles",
                  "hulls are refined until start and goals are valid, to the obstacles themselves if need be; S has no "
                  "path where they are invalid among these",
                  "examples/aggregate.lua");
  claims.relaxes = false;
  claims.no_path =
      "the error is halved and S solved again, `refinements` times, then without hulls; without a path there, h goes "
      "along the path to the node nearest to the goal";
  return GuideKind{&aggregate_settings().component(),
                   [](const Options& o) -> std::unique_ptr<Guide> {
                     return std::make_unique<Aggregate>(aggregate_settings().read(o));
                   },
                   "rrt_connect", [](const Options& o) { return aggregate_settings().read(o).resolves; },
                   std::move(claims)}
      .set_up({.world = {300, 110}, .run = {100}}, {.world = {1300, 15000}, .run = {400}});
}

}  // namespace trellis
