// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <trellis/base/component.hpp>

namespace trellis {

/// The default turn of a sequence, in proposals.
inline constexpr std::int64_t default_turn = 200;

/// Each part serves a turn and informs the next; after the last the first again.
struct SequenceSettings {
  std::int64_t turn = default_turn;
};

/// How a blend follows what its parts achieved. Part i of n draws with probability
///
///     floor / n + (1 - floor) * w_i / sum w.
///
/// rule "rates": w_i = successes_i / attempts_i, both begun at 1 and multiplied by `decay` before each outcome of a
/// proposal of part i is counted. It is the rule by which dynamic regions are chosen (Denny et al. 2016), with the
/// parts for regions. rule "exp3": w_i is multiplied by exp(floor r / (n p_i)) for a proposal of part i that was drawn
/// with probability p_i and rewarded with r (Auer et al. 2002).
///
/// credit "efficiency" has a rule of its own: a step of expectation maximisation towards the weights that lower
/// D_KL(T || Q). T is what the places are drawn from at which the search came nearer to its end than ever before; each
/// counts once. Q is made of the parts' densities as they were over the proposals so far, the way the report measures
/// them: q_i is the mean of part i's. (What a part proposes now lies beyond what is reached; it has proposed at a place
/// before that was reached.) At such a place x part i is responsible for p_i q_i(x) / sum p_j q_j(x), and w_i is the
/// mean of that over the places.
struct BlendSettings {
  double floor = 0.2;
  double decay = 0.98;
  /// What a proposal's success is. "node": 1 where it led to a node. "reach": how long the extension to that node was,
  /// by the longest of the run so far; a node amid others is worth little.
  std::string credit = "node";
  std::string rule = "rates";
};

/// The parts serve in order; the next takes over when the present one is refuted, or its turn is over; the last stays.
struct ScheduleSettings {
  std::int64_t rounds = 1;
  double turn = std::numeric_limits<double>::infinity();
};

/// The parts' spaces are searched in turn, by slices that double; the first path found guides until it is refuted.
struct RaceSettings {
  std::int64_t slice = 100;
};

/// An instance is divided at a sub-goal, and each half solved by the same strategy, down to a depth.
struct SplitSettings {
  std::int64_t depth = 1;
  std::int64_t tries = 3;
  std::int64_t effort = 2000;
};

// The settings described, for scripts and help.
const Settings<SequenceSettings>& sequence_settings();
const Settings<BlendSettings>& blend_settings();
const Settings<ScheduleSettings>& schedule_settings();
const Settings<RaceSettings>& race_settings();
const Settings<SplitSettings>& split_settings();

}  // namespace trellis
