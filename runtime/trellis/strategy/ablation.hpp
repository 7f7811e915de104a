// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/strategy/spec.hpp>

namespace trellis {

/// A strategy with one of its guides taken out, to measure what that guide is worth.
struct Ablation {
  std::string guide;      ///< the guide taken out, as written, numbered where it occurs more than once
  std::string level;      ///< what its level is called, LevelRecord::name
  std::size_t among = 0;  ///< of the guides that are called so, which one, the root's first
  bool skipped = false;   ///< what guided it guides in its place; else uniform sampling stands in its place
  StrategySpec strategy;
  /// "without shrink(0.5)", "skipping shrink(0.5)".
  [[nodiscard]] std::string text() const { return (skipped ? "skipping " : "without ") + guide; }
};

/// Every guide of a strategy taken out in turn, the root's first: replaced by uniform, with all that guided it, and,
/// where something guided it, left out between its neighbours. None for a strategy without a guide.
std::vector<Ablation> ablations(const StrategySpec& strategy);

}  // namespace trellis
