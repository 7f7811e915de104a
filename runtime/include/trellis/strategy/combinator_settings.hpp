// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <trellis/base/component.hpp>

namespace trellis {

/// The default turn of a sequence, in proposals.
inline constexpr std::int64_t default_turn = 200;

/// Options of a sequence: the parts take turns, and each passes what it found to the next; the first follows the last.
struct SequenceSettings {
  std::int64_t turn = default_turn;
};

/// Options of a blend, whose weights adapt to the results of its parts. Part i of n draws with probability
///
/// floor / n + (1 - floor) * w_i / sum w.
///
/// rule "rates": w_i = successes_i / attempts_i. Both counts start at 1 and are multiplied by `decay` before each
/// outcome of a proposal of part i is added. Dynamic regions are chosen by this rule (Denny et al. 2016), with regions
/// in place of parts. rule "exp3": w_i is multiplied by exp(floor r / (n p_i)) for each proposal of part i that was
/// drawn with probability p_i and had reward r (Auer et al. 2002).
///
/// credit "efficiency" has its own rule: a step of expectation maximisation towards the weights that minimise D_KL(T ||
/// Q). T is the distribution of the nodes at which the search came nearer to its goal than before; each counts once. Q
/// is the mixture of the parts' densities, averaged over the proposals so far, as in the report: q_i is the mean
/// density of part i. (The current density of a part lies beyond the reached nodes; its earlier ones cover them.) At
/// such a node x, the responsibility of part i is p_i q_i(x) / sum p_j q_j(x), and w_i is its mean over the nodes.
struct BlendSettings {
  double floor = 0.2;
  double decay = 0.98;
  /// The success of a proposal. "node": 1 if it added a node. "reach": the length of the extension to the added node,
  /// divided by the longest extension of the run so far, so that a node among others counts little.
  std::string credit = "node";
  std::string rule = "rates";
};

/// Options of a schedule: the parts guide in order. The next one starts when the current one is refuted or its turn
/// ends; the last one remains.
struct ScheduleSettings {
  std::int64_t rounds = 1;
  double turn = std::numeric_limits<double>::infinity();
};

/// Options of a race: the parts' spaces are searched alternately, by slices that double. The first path found guides
/// until it is refuted.
struct RaceSettings {
  std::int64_t slice = 100;
};

/// Options of a split: it divides an instance at a sub-goal and solves each half by the same strategy, down to a depth.
struct SplitSettings {
  std::int64_t depth = 1;
  std::int64_t tries = 3;
  std::int64_t effort = 2000;
};

// The settings with descriptions, for scripts and help.
// The options of the combinators, as scripts give them.
const Settings<SequenceSettings>& sequence_settings();
const Settings<BlendSettings>& blend_settings();
const Settings<ScheduleSettings>& schedule_settings();
const Settings<RaceSettings>& race_settings();
const Settings<SplitSettings>& split_settings();

}  // namespace trellis
