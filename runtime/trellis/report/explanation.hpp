// SPDX-License-Identifier: GPL-3.0-or-later
// `trellis explain`: what will run, as text and as JSON.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/strategy/explanation.hpp>

namespace trellis {

/// One strategy on one problem, explained.
struct ExplainedStrategy {
  std::string name;                  ///< as the script calls it
  std::string text;                  ///< the strategy in the language
  std::string problem;               ///< its name; bounds, graphs and numbers are this problem's
  std::vector<std::string> similar;  ///< other problems in the same space, where the hierarchy is the same
  LevelExplanation root;
};

/// The hierarchy as an indented tree, the root first: each level's space, planner, proposals, bound, limits and checks,
/// and of each guide f, h, density and when its space is solved again. Lines have at most `width` columns, except for
/// words longer than that. UTF-8; ends with a newline.
std::string explanation_text(const ExplainedStrategy& explained, std::size_t width);

/// The same of several as a JSON document (docs/formats.md); ends with a newline.
/// \param script  the path of the script as given
std::string explanation_json(const std::vector<ExplainedStrategy>& explained, const std::string& script);

}  // namespace trellis
