// SPDX-License-Identifier: GPL-3.0-or-later
// `trellis explain`: the hierarchy and the settings of a strategy, as text and as JSON.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/strategy/explanation.hpp>

namespace trellis {

/// The explanation of one strategy on one problem.
struct ExplainedStrategy {
  std::string name;                  ///< its name in the script
  std::string text;                  ///< the strategy in the syntax of a script
  std::string problem;               ///< its name; bounds, graphs and numbers refer to this problem
  std::vector<std::string> similar;  ///< other problems in the same space, with the same hierarchy
  LevelExplanation root;
};

/// Returns the hierarchy as an indented tree, the root first: each level's space, planner, proposals, bound, limits and
/// checks, and for each guide f, h, density and the conditions for solving its space again. Lines have at most `width`
/// columns, except for longer words. UTF-8; ends with a newline.
std::string explanation_text(const ExplainedStrategy& explained, std::size_t width);

/// Returns several explanations as a JSON document (docs/formats.md); ends with a newline.
/// \param script  the path of the script as given
std::string explanation_json(const std::vector<ExplainedStrategy>& explained, const std::string& script);

}  // namespace trellis
