// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/draw/canvas.hpp>

namespace trellis::draw {

/// Valid UTF-8 of one line: what is none becomes U+FFFD, control characters become spaces.
std::string clean_text(std::string_view text);

/// As much of the text as `width` points hold, with an ellipsis where it is not all.
std::string shorten(std::string_view text, double width, const Font& font);

/// Lines of at most `width` points, broken at newlines and spaces, and within a word only where it is wider than a
/// line. Of more than `most` lines the last is shortened. At least one line, which may be empty.
std::vector<std::string> wrap_text(std::string_view text, double width, const Font& font,
                                   std::size_t most = std::numeric_limits<std::size_t>::max());

/// With a true minus, never "−0"; "∞", and "n/a" for NaN.
std::string number_text(double value, int decimals);
/// The same with a sign, unless it is zero.
std::string signed_text(double value, int decimals);
/// "10⁻³".
std::string power_text(int exponent);

}  // namespace trellis::draw
