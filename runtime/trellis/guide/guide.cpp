// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/guide.hpp>

#include <algorithm>

#include <trellis/base/error.hpp>
#include <trellis/guide/kinds.hpp>

namespace trellis {

const std::vector<GuideKind>& guide_kinds() {
  static const std::vector<GuideKind> kinds = {uniform_kind(),  goal_bias_kind(), gaussian_kind(), bridge_test_kind(),
                                               identity_kind(), skeleton_kind(),  shrink_kind(),   joints_kind(),
                                               pca_kind(),      lazy_kind()};
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

const GuideKind* find_guide(std::string_view name) {
  const auto& kinds = guide_kinds();
  const auto it = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.component->name == name; });
  return it != kinds.end() ? &*it : nullptr;
}

}  // namespace trellis
