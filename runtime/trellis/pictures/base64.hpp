// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace trellis {

/// Returns bytes in base 64, with padding.
std::string base64(std::string_view bytes);

/// Returns the bytes of a text in base 64. \throws Error for another text
std::string from_base64(std::string_view text);

}  // namespace trellis
