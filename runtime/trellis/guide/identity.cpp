// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include <trellis/guide/path_guide.hpp>

namespace trellis {

namespace {

const Settings<PathGuideSettings>& identity_settings() {
  static const Settings<PathGuideSettings> settings = with_several_paths(with_path_options(Settings<PathGuideSettings>(
      Component::Kind::guide, "identity",
      "S = C, f the identity: the instance itself is solved first, and its path guides, by proposals "
      "a step ahead that lie close to it; that costs the fewest checks, and is a set much "
      "thinner than the target of the measure, so its expansions score below uniform ones",
      "Attali et al. 2022, the trivial guiding space S = C")));
  return settings;
}

class Identity final : public PathGuide {
 public:
  explicit Identity(const PathGuideSettings& settings) : PathGuide("identity", settings) {}
  std::unique_ptr<Instance> reduced(const Instance& parent) override { return same_instance(parent); }

 protected:
  [[nodiscard]] bool relaxes() const override { return false; }
};

}  // namespace

GuideKind identity_kind() {
  GuideClaims claims =
      path_claims(GuideClaims::Category::trivial, "q -> q, in the instance itself",
                  "S has no path: f changes nothing, so they are invalid in C too", "examples/catalogue.lua");
  claims.h =
      "a point of the path found in S, a step ahead of the tree, then uniform on a ball about it of a quarter of "
      "`radius`, which grows where that fails. `tube { delta = r, distance = \"full\" }` is the set that identity { "
      "follow = \"tube\", radius = r } proposes in, about its own path";
  return GuideKind{&identity_settings().component(),
                   [](const Options& o) -> std::unique_ptr<Guide> {
                     return std::make_unique<Identity>(identity_settings().read(o));
                   },
                   "rrt_connect", [](const Options& o) { return identity_settings().read(o).resolves; },
                   std::move(claims)}
      .set_up({.run = {30}}, {.run = {60}});
}

}  // namespace trellis
