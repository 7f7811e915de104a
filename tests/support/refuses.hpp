// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <variant>

#include <trellis/guide/arm_projection.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis::test {

/// Whether a guide rejects the space of the other one in a problem, because the space lacks a requirement.
inline bool refuses(const GuideKind& above, const GuideKind& guided, const Problem& problem) {
  const auto parent = make_instance(problem);
  const auto sub = guided.make(Options::validate(*guided.component, {}))->project(*parent);
  switch (above.claims.needs) {
    case GuideClaims::Needs::nothing: return false;
    case GuideClaims::Needs::position:
      return sub->position_axes.size() != 2 && !std::holds_alternative<ArmChain>(arm_chain(*sub));
    case GuideClaims::Needs::position_axes: return sub->position_axes.size() != 2;
    case GuideClaims::Needs::robot_axes: return static_cast<bool>(sub->validity_of);
    case GuideClaims::Needs::team: return sub->scene->members().size() < 2;
  }
  return false;
}

}  // namespace trellis::test
