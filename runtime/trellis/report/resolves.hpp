// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

struct LevelSummary;

/// Returns "solved again 12 times: its path proved invalid in C (9), C rejected guided proposals (3); no other path in
/// 1 run". "" where the level was not solved again and its path was not refuted at the limit.
std::string resolves_text(const LevelSummary& level);

}  // namespace trellis
