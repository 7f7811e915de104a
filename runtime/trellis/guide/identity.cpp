// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/kinds.hpp>
#include <trellis/guide/path_guide.hpp>

namespace trellis {

namespace {

const Settings<PathGuideSettings>& identity_settings() {
  static const Settings<PathGuideSettings> settings = with_several_paths(with_path_options(
      Settings<PathGuideSettings>(Component::Kind::guide, "identity",
                                  "S = C, f the identity: the instance itself is solved first, and its path guides",
                                  "Attali et al. 2022, the perfect guiding space")));
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
  return {&identity_settings().component(),
          [](const Options& o) -> std::unique_ptr<Guide> {
            return std::make_unique<Identity>(identity_settings().read(o));
          },
          "rrt_connect", [](const Options& o) { return identity_settings().read(o).resolves; },
          path_claims(GuideClaims::Category::trivial, "q -> q, in the instance itself",
                      "S has no path: f changes nothing, so they are invalid in C too", "examples/catalogue.lua")};
}

}  // namespace trellis
