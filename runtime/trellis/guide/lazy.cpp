// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>

namespace trellis {

namespace {

struct LazySettings : PathGuideSettings {
  LazySettings() { follow = "waypoints"; }
  double margin = 0.0;
  double sparse = 0.0;
  std::string selector = "alternate";
  double lambda = 0.99;
};

const Settings<LazySettings>& lazy_settings() {
  static const Settings<LazySettings> settings = with_path_options(
      Settings<LazySettings>(
          Component::Kind::guide, "lazy",
          "the world without obstacle checks: everything is presumed valid; the path found is validated in C, edge by "
          "edge, and what is found invalid is taken out of S, whose search continues",
          "Bohlin and Kavraki 2000, Path planning using lazy PRM; edge selectors: Dellin and Srinivasa 2016, Lazy "
          "shortest paths (LazySP); effort: Dellin 2016 (LEMUR); first a sparse check: Strub and Gammell 2022, EIT*")
          .choice("selector", &LazySettings::selector, {"alternate", "forward", "backward"},
                  "order in which the edges of a candidate path are validated: \"alternate\", from both ends inwards; "
                  "\"forward\", from the start; \"backward\", from the goal")
          .number(
              "effort", &LazySettings::lambda, "share", {.lo = 0, .hi = 1, .open_hi = true},
              "lambda: share of the effort to validate an edge in its cost for a search of a roadmap in S; the rest "
              "is its length. An edge validated before has no effort. Without effect where a tree searches S")
          .number("sparse", &LazySettings::sparse, "m in the metric", Range::non_negative(),
                  "distance between single configurations of a candidate path that are checked before its edges are, "
                  "once a candidate was refuted; "
                  "0: 1.2 of the planner's step, or the diameter of the robot's bounding circle where that is more")
          .number("margin", &LazySettings::margin, "m in the metric", Range::non_negative(),
                  "radius about a configuration found invalid that S takes for invalid too, at least; 0: the checking "
                  "resolution. Where the checker knows how deep the configuration lies, S loses all that is known"));
  return settings;
}

/// Validity presumed until the opposite was seen: invalid is only what lies near a configuration that C found invalid.
/// Costs no collision checks.
class PresumedValidity final : public Validity {
 public:
  /// \param verified  motions found valid in C
  PresumedValidity(const Space& space, double margin, double effort, std::shared_ptr<const VerifiedMotions> verified)
      : unverified_(1.0 / (1.0 - effort)), verified_(std::move(verified)) {
    for (double radius = margin; sizes_.size() < sizes; radius *= 2.0) sizes_.emplace_back(space, radius);
  }

  /// \param radius  about q within which everything is known to be invalid
  void forbid(View q, double radius) {
    std::size_t size = 0;
    while (size + 1 < sizes && sizes_[size + 1].radius() <= radius) ++size;
    for (std::size_t k = size; k < sizes; ++k) {
      if (sizes_[k].contains(q)) return;
    }
    sizes_[size].add(q);
    ++epoch_;
  }

  [[nodiscard]] bool state(View q) override {
    return std::none_of(sizes_.begin(), sizes_.end(), [&](const auto& balls) { return balls.contains(q); });
  }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    for (auto& balls : sizes_) {
      if (const auto t = balls.entered(a, b)) return {false, 0, *t};
    }
    return {true, 0, std::numeric_limits<double>::quiet_NaN()};
  }
  [[nodiscard]] double clearance(View) override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] double effort_factor(View a, View b) const override {
    return verified_->contain(a, b) ? 1.0 : unverified_;
  }
  [[nodiscard]] bool spends_checks() const override { return false; }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }

 private:
  static constexpr std::size_t sizes = 6;
  double unverified_;
  std::shared_ptr<const VerifiedMotions> verified_;
  std::vector<ExcludedBalls> sizes_;  ///< of radii that double
  std::uint64_t epoch_ = 0;
};

class Lazy final : public PathGuide {
 public:
  explicit Lazy(const LazySettings& settings) : PathGuide("lazy", settings), settings_(settings) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    verified_ = std::make_shared<VerifiedMotions>();
    verified_->hold_at(parent.epoch());
    // What guides the search of S may have verified motions, too.
    instance->verified = verified_;
    // What was found invalid in a world that has changed may be valid now.
    validity_ = std::make_shared<PresumedValidity>(parent.space, margin(parent), settings_.lambda, verified_);
    checked_ = parent.validity;
    margin_ = margin(parent);
    instance->validity = validity_;
    return instance;
  }

  /// The candidate path is validated in C, and refuted where an edge of it is invalid.
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    parent_ = &parent;
    parent.verified = verified_;
    verified_->hold_at(parent.epoch());
    const bool holds = !found->solved() || validated(found->path);
    refuted_before_ = refuted_before_ || !holds;
    auto h = PathGuide::heuristic(parent, sub, found);
    if (!holds && path_heuristic() != nullptr) path_heuristic()->refute();
    return h;
  }

  /// What C found invalid elsewhere S forgets that it presumed valid, too.
  void learn(const Outcome& outcome) override {
    PathGuide::learn(outcome);
    if (!outcome.blocked_at.empty()) forbid(outcome.blocked_at);
  }

 protected:
  [[nodiscard]] bool excludes() const override { return false; }

 private:
  [[nodiscard]] double margin(const Instance& parent) const {
    return settings_.margin > 0.0 ? settings_.margin : parent.resolution;
  }

  void forbid(View q) { validity_->forbid(q, std::max(margin_, checked_->invalid_radius(q))); }

  /// Validates the edges of a path in the selector's order, first sparsely, and forbids the first configuration found
  /// invalid. An edge that was found valid once is not checked again.
  bool validated(const Configurations& path) {
    const std::size_t edges = path.size() - 1;
    const double sparse = settings_.sparse > 0.0 ? settings_.sparse : 2.0 * sparse_spacing(*parent_);
    Configuration q(path.dimension());
    const auto ordered = [&](std::size_t i) {
      if (settings_.selector == "forward") return i;
      if (settings_.selector == "backward") return edges - 1 - i;
      return i % 2 == 0 ? i / 2 : edges - 1 - i / 2;
    };
    std::array<double, 2> walked = {0.0, 0.0};  // since the last configuration that was checked
    // The first candidate is likely to hold where something guides the search of S; nothing is known of it otherwise.
    for (const bool whole : {false, true}) {
      if (!whole && !refuted_before_) continue;
      for (std::size_t i = 0; i < edges; ++i) {
        const View a = path[ordered(i)];
        const View b = path[ordered(i) + 1];
        if (parent_->verified->contain(a, b)) continue;
        if (whole) {
          const MotionReport report = parent_->motion(a, b);
          if (report.valid) {
            parent_->verified->add(a, b);
            continue;
          }
          parent_->space.interpolate(a, b, report.invalid_at, q);
          forbid(q);
          return false;
        }
        // The ends of the path are valid.
        double& since = walked[2 * i < edges || settings_.selector != "alternate" ? 0 : 1];
        const double length = parent_->space.distance(a, b);
        for (; since + length >= sparse; since -= sparse) {
          parent_->space.interpolate(a, b, std::clamp((sparse - since) / length, 0.0, 1.0), q);
          if (parent_->valid(q)) continue;
          forbid(q);
          return false;
        }
        since += length;
      }
    }
    return true;
  }

  LazySettings settings_;
  Instance* parent_ = nullptr;
  bool refuted_before_ = false;                ///< a candidate path was
  std::shared_ptr<Validity> checked_;          ///< of C
  std::shared_ptr<VerifiedMotions> verified_;  ///< motions of C
  double margin_ = 0.0;
  std::shared_ptr<PresumedValidity> validity_;
};

}  // namespace

GuideKind lazy_kind() {
  GuideClaims claims = path_claims(GuideClaims::Category::environment, "q -> q, where everything is presumed valid",
                                   "they are presumed valid, until C finds something invalid within `margin` of them",
                                   "examples/nested.lua");
  claims.feedback =
      "edges of the path found in S are validated in C before it guides, at C's expense and once; what C finds "
      "invalid, "
      "there or by proposals, is taken out of S, whose search continues where the path was refuted";
  return {&lazy_settings().component(),
          [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Lazy>(lazy_settings().read(o)); },
          "lazy_prm",
          [](const Options& o) { return lazy_settings().read(o).resolves; },
          std::move(claims),
          false,
          // A tree follows what guides it; a roadmap would look for short cuts. What is not guided would go through
          // obstacles, where everything is presumed valid.
          {"rrt", {{"goal_bias", 0.0}, {"uniform", 0.0}}}};
}

}  // namespace trellis
