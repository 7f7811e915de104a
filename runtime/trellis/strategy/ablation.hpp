// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/strategy/spec.hpp>

namespace trellis {

/// A strategy without one of its guides, to measure the effect of that guide.
struct Ablation {
  std::string guide;      ///< text of the removed guide, numbered if it occurs more than once
  std::string level;      ///< name of its level, LevelRecord::name
  std::size_t among = 0;  ///< index among the guides of that name, the root's first
  bool skipped = false;   ///< the guide's own guide replaces it; else uniform sampling does
  StrategySpec strategy;
  /// "without shrink(0.5)", "skipping shrink(0.5)".
  [[nodiscard]] std::string text() const { return (skipped ? "skipping " : "without ") + guide; }
};

/// The strategy without each of its guides in turn, the root's first. Each guide is replaced by uniform sampling,
/// together with all that guided it. A guide that is itself guided is also skipped: its own guide takes its place.
/// Empty for a strategy without guides.
std::vector<Ablation> ablations(const StrategySpec& strategy);

}  // namespace trellis
