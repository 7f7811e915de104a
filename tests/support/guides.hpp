// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/guide/guide.hpp>

namespace trellis::test {

/// All guides but those that need a team of robots.
inline const std::vector<GuideKind>& guides_of_one_robot() {
  static const std::vector<GuideKind> kinds = [] {
    std::vector<GuideKind> some;
    for (const GuideKind& kind : guide_kinds()) {
      if (kind.claims.needs != GuideClaims::Needs::team) some.push_back(kind);
    }
    return some;
  }();
  return kinds;
}

}  // namespace trellis::test
