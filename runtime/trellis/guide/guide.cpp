// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/guide.hpp>

#include <algorithm>

#include <trellis/base/error.hpp>
#include <trellis/guide/kinds.hpp>

namespace trellis {

#define TRELLIS_DECLARED(name) GuideKind name##_kind();
TRELLIS_GUIDES(TRELLIS_DECLARED)
#undef TRELLIS_DECLARED

Repairs& Guide::repairs() {
  static class : public Repairs {
  } none;
  return none;
}

void SamplingGuide::project(View, MutableView) const { throw Fault("S = {0} has no coordinates"); }
void SamplingGuide::lift(View, Stream&, MutableView) const { throw Fault("S = {0} has no coordinates"); }
double SamplingGuide::log_fibre_density(View) const { throw Fault("S = {0} has no coordinates"); }

const std::vector<GuideKind>& guide_kinds() {
#define TRELLIS_MADE(name) name##_kind(),
  static const std::vector<GuideKind> kinds = {TRELLIS_GUIDES(TRELLIS_MADE)};
#undef TRELLIS_MADE
  return kinds;
}

std::string_view to_string(GuideClaims::Category category) {
  switch (category) {
    case GuideClaims::Category::trivial: return "trivial, S = C";
    case GuideClaims::Category::robot: return "robot modification";
    case GuideClaims::Category::environment: return "environment modification";
    case GuideClaims::Category::experience: return "experience";
    case GuideClaims::Category::sampling: return "sampling, S = {0}";
    case GuideClaims::Category::combinator: return "combinator";
  }
  throw Fault("unknown category of guides");
}

std::string_view to_string(GuideClaims::Needs needs) {
  switch (needs) {
    case GuideClaims::Needs::nothing: return "";
    case GuideClaims::Needs::position:
      return "a robot whose reference point moves in the plane, or an arm of two links or more that is fixed to its "
             "base";
    case GuideClaims::Needs::position_axes: return "a robot whose reference point moves in the plane";
    case GuideClaims::Needs::robot_axes: return "a space whose axes are the robot's";
    case GuideClaims::Needs::team: return "a team of robots";
  }
  throw Fault("unknown need of guides");
}

const GuideKind* find_guide(std::string_view name) {
  const auto& kinds = guide_kinds();
  const auto it = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.component->name == name; });
  return it != kinds.end() ? &*it : nullptr;
}

}  // namespace trellis
