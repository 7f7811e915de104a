// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/combinators.hpp>

#include <utility>

#include <trellis/strategy/combinator_settings.hpp>

namespace trellis {

namespace {

GuideClaims claims(std::string f, std::string h, std::string density, std::string feedback, std::string no_path,
                   std::string example = "examples/mixtures.lua") {
  return {.category = GuideClaims::Category::combinator,
          .f = std::move(f),
          .h = std::move(h),
          .closed_form = true,
          .density = std::move(density),
          .feedback = std::move(feedback),
          .relaxes = true,
          .invalid_ends = "as in each part",
          .fallback = GuideClaims::Fallback::own,
          .no_path = std::move(no_path),
          .example = std::move(example)};
}

}  // namespace

const std::vector<Combinator>& combinators() {
  static const std::string framework =
      "Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, A framework for guided motion planning";
  static const std::vector<Combinator> all = {
      {"nesting", "a >> b", "a guides the search in b's space; guide >> planner is a strategy", framework,
       claims("that of a after that of b", "that of b, whose instance in S is searched with that of a", "as of b",
              "each level receives the outcomes of its own planner's proposals", "as b says")},
      {"mixture", "0.7*a + 0.3*b", "a mixture of guides", framework,
       claims("those of the parts", "that of a part drawn with its weight",
              "the weighted sum, where every part has one", "every part receives every outcome, and which part drew",
              "the part without one does as it says")},
      {"sequence", "a .. b", sequence_settings().component().summary, framework,
       claims("those of the parts", "that of the part whose turn it is", "as of the part whose turn it is",
              "as a mixture's; the path of the part whose turn ends informs the search of the next",
              "the part without one works as it does alone, and informs no other part")},
      {"blend", "blend { a, b }", blend_settings().component().summary, blend_settings().component().source,
       claims("those of the parts", "that of a part drawn with a probability that follows what its proposals achieved",
              "the weighted sum with the weights of the moment, where every part has one",
              "as a mixture's; successes and attempts of each part make its weight",
              "the part without one does as it says")},
      {"schedule", "schedule { a, b }", schedule_settings().component().summary, schedule_settings().component().source,
       claims("those of the parts", "that of the part that serves; the next one's when it is refuted",
              "as of the part that serves",
              "as a mixture's; the path of the part that is refuted informs the search of the next",
              "the next part takes over at once; the last does as it says", "examples/combinators.lua")},
      {"race", "race { a, b }", race_settings().component().summary, race_settings().component().source,
       claims("those of the parts", "that of the part whose search found a path first", "as of the part that leads",
              "as a mixture's; where the leader is refuted the other searches continue",
              "another part leads; where none has a path, the first with a path to the nearest node",
              "examples/combinators.lua")},
      {"split", "split { planner }", split_settings().component().summary, split_settings().component().source,
       claims("the identity, on each half of the instance", "that of the guide, made for each half",
              "the mean over the halves, weighted by their proposals",
              "each half's guide receives the outcomes of that half's proposals; where a half is not solved another "
              "sub-goal is tried",
              "a sub-goal is drawn from valid proposals; in the end the instance is solved undivided",
              "examples/combinators.lua")},
  };
  return all;
}

}  // namespace trellis
