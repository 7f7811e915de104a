// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <utility>

#include <trellis/guide/path_guide.hpp>

namespace trellis {

namespace {

struct ShrinkSettings : PathGuideSettings {
  double scale = 0.5;
  double resolution = 0.0;
};

const Settings<ShrinkSettings>& shrink_settings() {
  static const Settings<ShrinkSettings> settings = with_several_paths(with_path_options(
      Settings<ShrinkSettings>(
          Component::Kind::guide, "shrink",
          "the same world for a smaller robot, scaled about its reference point, or with thinner links where it is "
          "fixed to its base",
          "Bayazit, Xie and Amato 2005, Iterative relaxation of constraints; several paths: Vonasek, "
          "Penicka and Kozlikova 2020, Searching multiple approximate solutions")
          .number("scale", &ShrinkSettings::scale, "share of its size", Range{.lo = 0, .hi = 1, .open_lo = true},
                  "size of the robot in S relative to that in C; of a robot that is fixed to its base the width of its "
                  "links, whose lengths stay")
          .number("resolution", &ShrinkSettings::resolution, "m", Range::non_negative(),
                  "checking resolution in S; 0: the diameter of the largest disc about the reference point inside the "
                  "smaller robot, as no wall fits between two of its places so near to each other, but not below that "
                  "of C nor above four times that")
          .boolean("keep_tree", &ShrinkSettings::keep_tree,
                   "where the path is blocked, half of the proposals are nodes of the tree that was "
                   "grown in S, each extended from where its parent is: branches that are valid for the larger robot "
                   "are kept")
          .positional({"scale"})));
  return settings;
}

class Shrink final : public PathGuide {
 public:
  explicit Shrink(const ShrinkSettings& settings)
      : PathGuide("shrink", settings), scale_(settings.scale), resolution_(settings.resolution) {}

  std::unique_ptr<Instance> reduced(const Instance& parent) override {
    auto instance = same_instance(parent);
    instance->scene = parent.scene->shrunken(scale_);
    const double widest = 2.0 * instance->scene->inscribed_radius();
    instance->resolution =
        resolution_ > 0.0 ? resolution_ : std::clamp(widest, parent.resolution, 4.0 * parent.resolution);
    // Makes collision checks, even if the parent presumes validity: f maps the world itself.
    instance->validity = instance->validity_in(instance->scene);
    return instance;
  }

 private:
  double scale_;
  double resolution_;
};

}  // namespace

GuideKind shrink_kind() {
  return GuideKind{
      &shrink_settings().component(),
      [](const Options& o) -> std::unique_ptr<Guide> { return std::make_unique<Shrink>(shrink_settings().read(o)); },
      "rrt", [](const Options& o) { return shrink_settings().read(o).resolves; },
      path_claims(
          GuideClaims::Category::robot,
          "q -> q, for the robot scaled about its reference point; where it is fixed to its base, with links "
          "scaled across their axes",
          "S has no path; a start or goal that is valid in C stays valid where the robot is star-shaped about its "
          "reference point or fixed to its base",
          "examples/nested.lua")}
      .set_up({.run = {90, 0.125}}, {.run = {520, 4}});
}

}  // namespace trellis
