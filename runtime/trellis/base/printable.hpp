// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace trellis {

/// Returns a text that a terminal shows and does not obey. Names and messages of scripts and files may have control
/// characters: they could move the cursor, change the window's title or hide text. Each of these is written as its
/// code:
/// - control characters but the line feed and the tab, and bytes that are not UTF-8: `\x1b`;
/// - the control characters U+0080 to U+009F, line and paragraph separators, and the marks that change the direction
///   of text: `\u{202e}`.
std::string printable(std::string_view text);

}  // namespace trellis
