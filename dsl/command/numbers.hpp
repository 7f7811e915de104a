// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace trellis::command {

/// The integer that was typed for an option; none for "". Decimal digits only: no sign, fraction, exponent, or leading
/// zero that another program would read as octal. Throws Error that names the option and what it takes.
std::optional<std::uint64_t> integer_option(const std::string& option, const std::string& typed, std::uint64_t least,
                                            std::uint64_t most);

/// The number of at least `least` that was typed for an option; none for "". Throws Error that names the option and
/// what it takes.
std::optional<double> number_option(const std::string& option, const std::string& typed, double least);

}  // namespace trellis::command
