// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace trellis {

/// The files of html/, embedded in the program.
struct HtmlParts {
  std::string_view page;  ///< with @PLACES@ for the variable parts
  std::string_view style;
  std::string_view script;
  std::string_view charts;  ///< of costs, before the script
  std::string_view space;   ///< the viewer of problems in space, before the script where there are some
  std::string_view teams;   ///< the schedules of teams, before the script where there are some
};
const HtmlParts& html_parts();

}  // namespace trellis
