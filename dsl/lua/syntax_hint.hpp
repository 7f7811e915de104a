// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace trellis::lua {

/// What Lua requires where its parser stopped at the syntax of another language: "; Lua writes 'and'". "" if nothing is
/// known.
/// \param in_session  a text that ends too early gets none, because sessions recognise it by the end of its message
std::string syntax_hint(std::string_view message, std::string_view text, bool in_session);

}  // namespace trellis::lua
