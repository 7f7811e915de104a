// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <trellis/strategy/run_facts.hpp>

namespace trellis {

struct LevelSummary;

/// A reason to solve a level again.
struct ResolveReason {
  const char* name;  ///< in the JSON document
  const char* text;  ///< in reports
  std::uint64_t Resolves::*count;
};
inline constexpr std::array<ResolveReason, 8> resolve_reasons = {{
    {"invalid_path", "its path proved invalid in C", &Resolves::invalid_path},
    {"rejections", "C rejected guided proposals", &Resolves::rejections},
    {"lost_place", "another level refuted a place on its path", &Resolves::lost_place},
    {"presumed_valid", "a configuration that it presumes valid is invalid", &Resolves::presumed_valid},
    {"changed_world", "its obstacles changed", &Resolves::changed_world},
    {"new_turn", "its turn came with new samples", &Resolves::new_turn},
    {"further_path", "its guide asked for another path", &Resolves::further_path},
    {"refuted_path", "its path could not be certified", &Resolves::refuted_path},
}};

/// Returns "solved again 12 times: its path proved invalid in C (9), C rejected guided proposals (3); no other path in
/// 1 run". "" where the level was not solved again and its path was not refuted at the limit.
std::string resolves_text(const LevelSummary& level);

}  // namespace trellis
