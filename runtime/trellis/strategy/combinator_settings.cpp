// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/combinator_settings.hpp>

namespace trellis {

const Settings<SequenceSettings>& sequence_settings() {
  static const auto settings =
      Settings<SequenceSettings>(Component::Kind::combinator, "sequence", "guides that take turns",
                                 "sequences of guiding spaces: Attali, Ashur, Love, McBeth, Motes, Morales and Amato "
                                 "2024, arXiv 2404.03133")
          .integer("turn", &SequenceSettings::turn, "proposals", Range::at_least(1),
                   "proposals that each part serves before the next one's turn; the turn ends earlier where evidence "
                   "refutes its path or its search finds none");
  return settings;
}

const Settings<BlendSettings>& blend_settings() {
  static const auto settings =
      Settings<BlendSettings>(
          Component::Kind::combinator, "blend", "a mixture whose weights follow what each guide's proposals achieved",
          "the rule of Denny, Sandstrom, Bregger and Amato 2016 for regions, with guides in their place; exp3: Auer, "
          "Cesa-Bianchi, Freund and Schapire 2002, The nonstochastic multiarmed bandit problem; combining "
          "guides: Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, arXiv 2404.03133")
          .number("floor", &BlendSettings::floor, "share of proposals", {.lo = 0, .hi = 1, .open_lo = true},
                  "share that is spread evenly over the parts, so that none starves; the rest follows successes over "
                  "attempts; 1: an even mixture")
          .number("decay", &BlendSettings::decay, "factor", {.lo = 0, .hi = 1, .open_lo = true},
                  "what a part's successes and attempts are multiplied by before each new one is counted; 1 / (1 - "
                  "decay) of its proposals are remembered; not used by exp3")
          .choice("credit", &BlendSettings::credit, {"node", "reach", "efficiency"},
                  "what a success is: \"node\", 1 for each proposal that led to a node; \"reach\", the length of the "
                  "extension to that node, by the longest of the run so far; \"efficiency\", by each part's density "
                  "where the search came nearer to its end than ever, so that the weights lower the sampling "
                  "efficiency there; a part without a density in closed form is credited with what it drew itself")
          .choice("rule", &BlendSettings::rule, {"rates", "exp3"},
                  "how credit makes weights: \"rates\", successes over attempts; \"exp3\", exponential weights, with "
                  "floor for their exploration; efficiency has its own rule and takes \"rates\" only");
  return settings;
}

const Settings<ScheduleSettings>& schedule_settings() {
  static const auto settings =
      Settings<ScheduleSettings>(
          Component::Kind::combinator, "schedule", "guides that serve in order, each until it is refuted",
          "iterative relaxation: Bayazit, Xie and Amato 2005, with any guides for its rounds; sequences of guiding "
          "spaces: Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, arXiv 2404.03133")
          .integer("rounds", &ScheduleSettings::rounds, "rounds", Range::at_least(1),
                   "how often a guide may be refuted before the next takes over; in between its space is solved again")
          .number("turn", &ScheduleSettings::turn, "proposals", Range::at_least(1),
                  "proposals after which the next takes over in any case");
  return settings;
}

const Settings<RaceSettings>& race_settings() {
  static const auto settings =
      Settings<RaceSettings>(
          Component::Kind::combinator, "race", "guides whose spaces are searched in turn; the first path found guides",
          "the doubling of budgets after Luby, Sinclair and Zuckerman 1993, Optimal speedup of Las Vegas algorithms; "
          "combining guides: Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, arXiv 2404.03133")
          .integer("slice", &RaceSettings::slice, "proposals", Range::at_least(1),
                   "budget of each space's search in the first round; it doubles with every round");
  return settings;
}

const Settings<SplitSettings>& split_settings() {
  static const auto settings =
      Settings<SplitSettings>(Component::Kind::combinator, "split",
                              "an instance divided at a sub-goal, each half solved by the same strategy",
                              "divide and conquer of planning problems at sub-goals: Faverjon and Tournassoud 1987; as "
                              "recursion of guiding "
                              "spaces: Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, arXiv 2404.03133")
          .integer("depth", &SplitSettings::depth, "levels", {.lo = 1, .hi = 6},
                   "how often an instance is divided; 2: each half once more")
          .integer("tries", &SplitSettings::tries, "sub-goals", {.lo = 1, .hi = 64},
                   "sub-goals that are tried before the instance is solved undivided")
          .integer("effort", &SplitSettings::effort, "proposals", Range::at_least(1),
                   "what the search of each half may spend before another sub-goal is tried");
  return settings;
}

}  // namespace trellis
