// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <utility>
#include <variant>
#include <vector>

#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/scene/polygon.hpp>

namespace trellis {

namespace {

struct WidenSettings : PathGuideSettings {
  double distance = 0.0;
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
          .positional({"distance"})));
  return settings;
}

/// What is left of an obstacle that lost all within `d` of its outside.
std::vector<Shape> eroded(const Shape& shape, double d) {
  if (const auto* box = std::get_if<Box2>(&shape)) {
    const Box2 inner{{box->lo.x + d, box->lo.y + d}, {box->hi.x - d, box->hi.y - d}};
    if (inner.lo.x < inner.hi.x && inner.lo.y < inner.hi.y) return {inner};
    return {};
  }
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    if (disc->radius > d) return {Disc{disc->centre, disc->radius - d}};
    return {};
  }
  std::vector<Shape> rest;
  // What has no holes has none when it is eroded.
  for (auto& piece : polygon_offset(std::get<Polygon>(shape), -d)) rest.emplace_back(std::move(piece.outer));
  return rest;
}

class Widen final : public PathGuide {
 public:
  explicit Widen(const WidenSettings& settings) : PathGuide("widen", settings), distance_(settings.distance) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    const World& world = parent.scene->world;
    const double robot = parent.scene->robot.bounding_radius();
    const double plain = robot > 0.0 ? 0.25 * robot : 0.005 * norm(world.bounds().hi - world.bounds().lo);
    const double d = distance_ > 0.0 ? distance_ : plain;
    std::vector<Obstacle> obstacles;
    for (const Obstacle& obstacle : world.obstacles()) {
      const auto rest = eroded(obstacle.shape, d);
      for (std::size_t i = 0; i < rest.size(); ++i) {
        const std::string number = rest.size() > 1 ? fmt::format(", piece {}", i + 1) : "";
        obstacles.push_back({fmt::format("{} eroded by {:g}{}", obstacle.name, d, number), rest[i]});
      }
    }
    instance->scene = std::make_shared<Scene>(Scene{World(world.bounds(), std::move(obstacles)), parent.scene->robot});
    // Checked for real, whatever the parent presumes: the guide's instance is the world, not the parent's view of it.
    instance->validity = parent.validity_in(instance->scene);
    return instance;
  }

 private:
  double distance_;
};

}  // namespace

GuideKind widen_kind() {
  return {&widen_settings().component(),
          [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Widen>(widen_settings().read(o)); },
          "rrt_connect", [](const Options& o) { return widen_settings().read(o).resolves; },
          path_claims(GuideClaims::Category::environment, "q -> q, among obstacles eroded by `distance`",
                      "S has no path; no end that is valid in C becomes invalid", "examples/widen.lua")};
}

}  // namespace trellis
