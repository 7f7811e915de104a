// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>

namespace trellis {

namespace {

struct LazySettings : PathGuideSettings {
  LazySettings() { resolves = 1000; }
  double margin = 0.0;
};

const Settings<LazySettings>& lazy_settings() {
  static const Settings<LazySettings> settings = with_path_options(
      Settings<LazySettings>(
          Component::Kind::guide, "lazy",
          "the world without obstacle checks: everything is presumed valid until C finds it is not; what it finds "
          "invalid is taken out of S, and S is solved again",
          "Bohlin and Kavraki 2000, Path planning using lazy PRM")
          .number(
              "margin", &LazySettings::margin, "m in the metric", Range::non_negative(),
              "radius about a configuration found invalid that S takes for invalid too; 0: the checking resolution"));
  return settings;
}

/// Validity presumed until the opposite was seen: invalid is only what lies within `margin` of a configuration that C
/// found invalid. Costs no collision checks.
class PresumedValidity final : public Validity {
 public:
  PresumedValidity(const Space& space, double margin) : invalid_(space, margin) {}

  void forbid(View q) {
    if (invalid_.contains(q)) return;
    invalid_.add(q);
    ++epoch_;
  }

  [[nodiscard]] bool state(View q) override { return !invalid_.contains(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    if (const auto t = invalid_.entered(a, b)) return {false, 0, *t};
    return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  }
  [[nodiscard]] double clearance(View) override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool spends_checks() const override { return false; }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }

 private:
  ExcludedBalls invalid_;
  std::uint64_t epoch_ = 0;
};

class Lazy final : public PathGuide {
 public:
  explicit Lazy(const LazySettings& settings) : PathGuide("lazy", settings), margin_(settings.margin) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    validity_ = std::make_shared<PresumedValidity>(parent.space, margin_ > 0.0 ? margin_ : parent.resolution);
    instance->validity = validity_;
    return instance;
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    auto h = PathGuide::heuristic(parent, sub, found);
    parent_ = &parent;
    path_ = found->path;
    looked_at_.assign(path_.size(), 0);
    return h;
  }

  /// What C found invalid, S forgets that it presumed valid. Where that happened beside a leg of the path found in S,
  /// the leg is checked in C, once: an edge is taken out of S on evidence only.
  void learn(const Outcome& outcome) override {
    PathGuide::learn(outcome);
    if (outcome.blocked_at.empty()) return;
    validity_->forbid(outcome.blocked_at);
    if (path_heuristic() == nullptr) return;
    const double reach = 2.0 * path_heuristic()->radius();
    for (std::size_t i = 0; i + 1 < path_.size(); ++i) {
      if (looked_at_[i] != 0) continue;
      const View a = std::as_const(path_)[i];
      const View b = std::as_const(path_)[i + 1];
      if (nearest_on_motion(parent_->space, a, b, outcome.blocked_at).squared_distance > reach * reach) continue;
      looked_at_[i] = 1;
      const MotionReport report = parent_->motion(a, b);
      if (report.valid) continue;
      Configuration invalid(a.size());
      parent_->space.interpolate(a, b, report.invalid_at, invalid);
      validity_->forbid(invalid);
      path_heuristic()->refute();
      return;
    }
  }

 private:
  double margin_;
  Instance* parent_ = nullptr;
  Configurations path_;          ///< found in S
  std::vector<char> looked_at_;  ///< which of its legs were checked in C
  std::shared_ptr<PresumedValidity> validity_;
};

}  // namespace

GuideKind lazy_kind() {
  GuideClaims claims = path_claims(GuideClaims::Category::environment, "q -> q, where everything is presumed valid",
                                   "they are presumed valid, until C finds something invalid within `margin` of them",
                                   "examples/nested.lua");
  claims.feedback =
      "what C finds invalid is taken out of S; a leg of the path beside it is checked in C, once, and S is solved again "
      "where that is invalid";
  return {&lazy_settings().component(),
          [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Lazy>(lazy_settings().read(o)); },
          "lazy_prm", [](const Options& o) { return lazy_settings().read(o).resolves; }, std::move(claims)};
}

}  // namespace trellis
