// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/characteristic_length.hpp>

namespace trellis {

namespace {

struct WidenSettings : PathGuideSettings {
  double distance = 0.0;
  std::int64_t repair = 10;
};

const Settings<WidenSettings>& widen_settings() {
  static const Settings<WidenSettings> settings = with_several_paths(with_path_options(
      Settings<WidenSettings>(
          Component::Kind::guide, "widen",
          "the same robot in a world whose obstacles are eroded, each by itself: wider passages",
          "Hsu, Sanchez-Ante, Cheng and Latombe 2006, Multi-level free-space dilation; Saha, Latombe, "
          "Chang and Prinz 2005")
          .number(
              "distance", &WidenSettings::distance, "m", Range::non_negative(),
              "how far the sides of obstacles move inwards; what is not twice as thick vanishes; 0: a quarter of the "
              "robot's bounding radius, or half a percent of the world's diagonal for a point")
          .integer("repair", &WidenSettings::repair, "configurations", Range::non_negative(),
                   "how many configurations about a point of the path that is invalid in C are tried in its place, "
                   "farther and farther from it; 0: the point stays. Without effect where the path is followed by "
                   "\"steps\", which lifts every point to a valid one")
          .positional({"distance"})));
  return settings;
}

class Widen final : public PathGuide {
 public:
  explicit Widen(const WidenSettings& settings)
      : PathGuide("widen", settings), distance_(settings.distance), repair_(settings.repair) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    instance->scene = parent.scene->eroded(erosion(parent));
    // Makes collision checks, even if the parent presumes validity: f maps the world itself.
    instance->validity = parent.validity_in(instance->scene);
    return instance;
  }

  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    parent_ = &parent;
    return PathGuide::heuristic(parent, sub, found);
  }

 protected:
  /// The path with its invalid points moved to valid configurations of C. C counts the checks.
  [[nodiscard]] Configurations followed(Configurations path) const override {
    // Following by steps lifts each point to a valid configuration anyway.
    if (repair_ == 0 || path_settings().follow == Follow::steps) return path;
    Stream stream(paths_repaired_++, "widen", "repair");
    for (std::size_t i = 0; i < path.size(); ++i) retract(path[i], stream);
    return path;
  }

 private:
  [[nodiscard]] double erosion(const Instance& parent) const {
    if (distance_ > 0.0) return distance_;
    return 0.25 * size_or(*parent.scene, 0.02 * parent.scene->diagonal());
  }

  /// Moves a point that is invalid in C to a valid configuration: samples shells about it, beyond the region known to
  /// be invalid, up to four times the width that the obstacles lost. Leaves the point unchanged if none is valid.
  void retract(MutableView point, Stream& stream) const {
    if (parent_->valid(point)) return;
    const Space& space = parent_->space;
    const double inner = parent_->validity->invalid_radius(point);
    const double shell = 4.0 * erosion(*parent_) / static_cast<double>(repair_);
    Configuration q(point.size());
    std::vector<double> direction(space.degrees());
    for (std::int64_t k = 0; k < repair_; ++k) {
      double squares = 0.0;
      for (double& x : direction) {
        x = stream.normal();
        squares += x * x;
      }
      const double distance = inner + shell * (static_cast<double>(k) + stream.uniform());
      if (!space.flat()) {
        for (double& x : direction) x *= distance / std::sqrt(squares);
        space.exp(point, direction, q);
      }
      for (std::size_t j = 0; space.flat() && j < q.size(); ++j) {
        q[j] = point[j] + distance * direction[j] / std::sqrt(squares) / space.axes()[j].weight;
      }
      space.reflect(q);
      if (!parent_->valid(q)) continue;
      std::copy(q.begin(), q.end(), point.begin());
      return;
    }
  }

  double distance_;
  std::int64_t repair_;
  Instance* parent_ = nullptr;
  mutable std::uint64_t paths_repaired_ = 0;
};

}  // namespace

GuideKind widen_kind() {
  GuideClaims claims =
      path_claims(GuideClaims::Category::environment, "q -> q, among obstacles eroded by `distance`",
                  "S has no path; a start or goal that is valid in C stays valid", "examples/widen.lua");
  claims.h +=
      "; points of the path that are invalid in C are retracted first, to valid ones near them where `repair` "
      "tries find one";
  return GuideKind{
      &widen_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Widen>(widen_settings().read(o)); },
      "rrt_connect", [](const Options& o) { return widen_settings().read(o).resolves; }, std::move(claims)}
      .set_up({.run = {80, 1}}, {.run = {650, 17}});
}

}  // namespace trellis
