// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/combinators.hpp>

#include <utility>

#include <trellis/strategy/spec.hpp>

namespace trellis {

namespace {

GuideClaims claims(std::string f, std::string h, std::string density, std::string feedback, std::string no_path) {
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
          .example = "examples/mixtures.lua"};
}

}  // namespace

const std::vector<Combinator>& combinators() {
  static const std::string framework =
      "Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, A framework for guided motion planning";
  static const std::vector<Combinator> all = {
      {"nesting", "a >> b", framework,
       claims("that of a after that of b", "that of b, whose instance in S is searched with that of a", "as of b",
              "each level is told what became of its own planner's proposals", "as b says")},
      {"mixture", "0.7*a + 0.3*b", framework,
       claims("those of the parts", "that of a part drawn with its weight", "the weighted sum, where every part has one",
              "every part is told of every outcome, and which part drew", "the part without one does as it says")},
      {"sequence", "a .. b", framework,
       claims("those of the parts", "that of the part whose turn it is", "as of the part whose turn it is",
              "as a mixture's; the path of the part whose turn ends informs the search of the next",
              "the part without one does as it says, and informs nobody")},
      {"blend", "blend { a, b }", blend_settings().component().source,
       claims("those of the parts", "that of a part drawn with a probability that follows what its proposals achieved",
              "the weighted sum with the weights of the moment, where every part has one",
              "as a mixture's; successes and attempts of each part make its weight",
              "the part without one does as it says")},
  };
  return all;
}

}  // namespace trellis
