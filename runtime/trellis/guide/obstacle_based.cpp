// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <limits>

#include <trellis/guide/bias.hpp>
#include <trellis/guide/rays.hpp>
#include <trellis/instance/search_cost.hpp>

namespace trellis {

namespace {

struct ObstacleBasedSettings {
  std::int64_t tries = 100;
};

const Settings<ObstacleBasedSettings>& obstacle_based_settings() {
  static const Settings<ObstacleBasedSettings> settings =
      Settings<ObstacleBasedSettings>(
          Component::Kind::guide, "obstacle_based",
          "configurations at the surface of obstacles: from an invalid one along a random ray until it is valid; S = "
          "{0}",
          "Amato and Wu 1996, A randomized roadmap method for path and manipulation planning (OBPRM)")
          .integer("tries", &ObstacleBasedSettings::tries, "configurations", Range::at_least(1),
                   "configurations tried as the inside of an obstacle before a uniform proposal is made instead");
  return settings;
}

class ObstacleBased final : public Heuristic {
 public:
  ObstacleBased(Instance& parent, const ObstacleBasedSettings& settings)
      : parent_(parent), settings_(settings), ray_(parent), inside_(parent.space.dimension()) {}

  Source sample(Stream& stream, MutableView out) override {
    for (std::int64_t i = 0; i < settings_.tries; ++i) {
      parent_.spend(search_cost::coordinate * static_cast<double>(inside_.size()));
      parent_.space.sample_uniform(stream, inside_);
      if (parent_.valid(inside_)) continue;
      ray_.draw_direction(stream);
      if (ray_.walk(inside_, out) < std::numeric_limits<double>::infinity()) return 0;
    }
    parent_.space.sample_uniform(stream, out);
    return 1;
  }
  [[nodiscard]] std::vector<std::string> sources() const override {
    return {"obstacle_based", "obstacle_based: uniform"};
  }

 private:
  Instance& parent_;
  ObstacleBasedSettings settings_;
  SurfaceRay ray_;
  Configuration inside_;
};

}  // namespace

GuideKind obstacle_based_kind() {
  return sampling_kind(
      obstacle_based_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> {
        return bias([settings = obstacle_based_settings().read(o)](Instance& parent) -> std::unique_ptr<Heuristic> {
          return std::make_unique<ObstacleBased>(parent, settings);
        });
      },
      "the first valid configuration on a random ray out of an obstacle; the ray's checks are C's",
      "it lies about the surface of what is invalid, which has no formula", false);
}

}  // namespace trellis
