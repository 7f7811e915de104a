// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/strategy/run_facts.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// A strategy without one of its guides, to measure the effect of that guide.
struct Ablation {
  std::string guide;     ///< text of the removed guide, numbered if it occurs more than once
  std::string key;       ///< of the removed guide and its level: LevelRecord::key, without the halves of split searches
  bool skipped = false;  ///< the guide's own guide takes its place; else that is removed too
  StrategySpec strategy;
  /// "without shrink(0.5)", "skipping shrink(0.5)".
  [[nodiscard]] std::string text() const { return (skipped ? "skipping " : "without ") + guide; }
};

/// The strategy without each of its guides in turn, the root's first. The parts of a combination that remain keep their
/// order, options and relative weights; where no guide remains the level searches without one. A guide that is itself
/// guided is removed twice: together with all that guided it, and skipped. Empty for a strategy without guides.
std::vector<Ablation> ablations(const StrategySpec& strategy);

/// Those that decide whether a guide pays, one for each guide: skipped where it is guided.
std::vector<Ablation> decisive_ablations(const StrategySpec& strategy);

}  // namespace trellis
