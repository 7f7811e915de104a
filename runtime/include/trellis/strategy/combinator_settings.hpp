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
/// Source: Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, arXiv 2404.03133.
struct SequenceSettings {
  std::int64_t turn = default_turn;  ///< proposals, at least 1
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
  double floor = 0.2;   ///< share of the proposals that all parts divide evenly, in (0, 1]
  double decay = 0.98;  ///< factor in (0, 1]; not used by "exp3"
  /// The success of a proposal. "node": 1 if it added a node. "reach": the length of the extension to the added node,
  /// divided by the longest extension of the run so far, so that a node among others counts little.
  std::string credit = "node";
  std::string rule = "rates";  ///< "rates" or "exp3", as above
};

/// Options of a schedule: the parts guide in order. The next one starts when the current one is refuted or its turn
/// ends; the last one remains. Source of iterative relaxation: Bayazit, Xie and Amato 2005.
struct ScheduleSettings {
  std::int64_t rounds = 1;  ///< how often a guide is refuted before the next one starts, at least 1
  double turn = std::numeric_limits<double>::infinity();  ///< proposals, at least 1
};

/// Options of a race: the parts' spaces are searched alternately, by slices that double. The first path found guides
/// until it is refuted. Source of the doubling: Luby, Sinclair and Zuckerman 1993, Optimal speedup of Las Vegas
/// algorithms.
struct RaceSettings {
  std::int64_t slice = 100;  ///< proposals of each search in the first round, at least 1
};

/// Options of a split: it divides an instance at a sub-goal and solves each half by the same strategy, down to a depth.
/// Source: Faverjon and Tournassoud 1987.
struct SplitSettings {
  std::int64_t depth = 1;      ///< divisions one after the other, from 1 to 6
  std::int64_t tries = 3;      ///< sub-goals tried before an instance is solved undivided, from 1 to 64
  std::int64_t effort = 2000;  ///< proposals of the search of each half before the next sub-goal, at least 1
};

// The settings with descriptions, for scripts and help.
// The options of the combinators, as scripts give them.
const Settings<SequenceSettings>& sequence_settings();
const Settings<BlendSettings>& blend_settings();
const Settings<ScheduleSettings>& schedule_settings();
const Settings<RaceSettings>& race_settings();
const Settings<SplitSettings>& split_settings();

}  // namespace trellis
