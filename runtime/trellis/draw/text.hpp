// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/draw/canvas.hpp>

namespace trellis::draw {

/// Returns valid UTF-8 of one line: replaces invalid bytes by U+FFFD and control characters by spaces.
std::string clean_text(std::string_view text);

/// Returns the prefix of the text that fits into `width` points, with an ellipsis where it is not all.
std::string shorten(std::string_view text, double width, const Font& font);

/// Breaks text into lines of at most `width` points, at newlines and spaces, and within a word only where it is wider
/// than a line. Shortens the last of more than `most` lines. Returns at least one line, which may be empty.
std::vector<std::string> wrap_text(std::string_view text, double width, const Font& font,
                                   std::size_t most = std::numeric_limits<std::size_t>::max());

/// Returns the number with a true minus, never "−0"; "∞", and "n/a" for NaN.
std::string number_text(double value, int decimals);
/// The same with a sign, unless it is zero.
std::string signed_text(double value, int decimals);
/// "10⁻³".
std::string power_text(int exponent);

}  // namespace trellis::draw
