// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace trellis::command {

/// Parses the integer of an option; none for "". Accepts decimal digits only: no sign, fraction, exponent, or leading
/// zero, which other programs read as octal. \throws Error that names the option and its range.
std::optional<std::uint64_t> integer_option(const std::string& option, const std::string& typed, std::uint64_t least,
                                            std::uint64_t most);

/// Parses a number of at least `least` for an option; none for "". \throws Error that names the option and its range.
std::optional<double> number_option(const std::string& option, const std::string& typed, double least);

}  // namespace trellis::command
