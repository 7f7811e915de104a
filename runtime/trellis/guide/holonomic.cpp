// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/holonomic.hpp>

namespace trellis {

namespace {

const Settings<HolonomicSettings>& holonomic_settings() {
  static const Settings<HolonomicSettings> settings = with_holonomic_options(
      Settings<HolonomicSettings>(Component::Kind::guide, "holonomic",
                                  "the robot without its motion model: configurations without velocities, joined by "
                                  "straight motions; one path of it guides, and velocities are drawn uniformly about "
                                  "it. Leads over a decomposition, as published by Plaku, Kavraki and Vardi, are "
                                  "another guide, decomposition",
                                  "the geometric path first, then a tree of motions along it; not the leads of Plaku, "
                                  "Kavraki and Vardi 2007, Discrete search leading continuous exploration for "
                                  "kinodynamic motion planning"));
  return settings;
}

}  // namespace

GuideKind holonomic_kind() {
  GuideClaims claims = path_claims(
      GuideClaims::Category::robot,
      "(q, velocities) -> q, joined by straight motions; the identity without a motion model",
      "a start or goal that is valid in C stays valid: S drops the bounds on velocities", "examples/kinodynamic.lua");
  claims.h += "; velocities uniform, of speeds those forwards";
  return GuideKind{&holonomic_settings().component(),
                   [](const Options& o) -> std::unique_ptr<Guide> {
                     return std::make_unique<Holonomic>("holonomic", holonomic_settings().read(o));
                   },
                   "rrt_connect", [](const Options& o) { return holonomic_settings().read(o).resolves; },
                   std::move(claims)}
      .set_up({.run = {50}}, {.run = {200}});
}

}  // namespace trellis
