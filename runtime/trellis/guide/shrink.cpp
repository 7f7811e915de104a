// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>

namespace trellis {

namespace {

struct ShrinkSettings : PathGuideSettings {
  double scale = 0.5;
};

const Settings<ShrinkSettings>& shrink_settings() {
  static const Settings<ShrinkSettings> settings = with_several_paths(with_path_options(
      Settings<ShrinkSettings>(
          Component::Kind::guide, "shrink", "the same world for a smaller robot, scaled about its reference point",
          "Bayazit, Xie and Amato 2005, Iterative relaxation of constraints; several paths: Vonasek, "
          "Penicka and Kozlikova 2020, Searching multiple approximate solutions")
          .number("scale", &ShrinkSettings::scale, "share of its size", Range{.lo = 0, .hi = 1, .open_lo = true},
                  "size of the robot in S relative to that in C")
          .positional({"scale"})));
  return settings;
}

class Shrink final : public PathGuide {
 public:
  explicit Shrink(const ShrinkSettings& settings) : PathGuide("shrink", settings), scale_(settings.scale) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    instance->scene = std::make_shared<Scene>(Scene{parent.scene->world, parent.scene->robot.scaled(scale_)});
    // Checked for real, whatever the parent presumes: the guide's instance is the world, not the parent's view of it.
    instance->validity = parent.validity_in(instance->scene);
    return instance;
  }

 private:
  double scale_;
};

}  // namespace

GuideKind shrink_kind() {
  GuideClaims claims =
      path_claims(GuideClaims::Category::robot, "q -> q, for the robot scaled about its reference point",
                  "S has no path; no end that is valid in C becomes invalid where the robot is star-shaped about its "
                  "reference point. A robot fixed to its base is another matter: a shorter arm may touch what the long "
                  "one reaches past",
                  "examples/nested.lua");
  claims.relaxes_arms = false;
  return {
      &shrink_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Shrink>(shrink_settings().read(o)); },
      "rrt", [](const Options& o) { return shrink_settings().read(o).resolves; }, std::move(claims)};
}

}  // namespace trellis
