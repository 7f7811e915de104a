// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace trellis {

/// The files of html/, embedded in the program.
struct HtmlParts {
  std::string_view page;  ///< with @PLACES@ for the variable parts
  std::string_view style;
  std::string_view script;
};
const HtmlParts& html_parts();

}  // namespace trellis
