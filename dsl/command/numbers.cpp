// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/numbers.hpp>

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <system_error>

#include <trellis/base/error.hpp>

namespace trellis::command {

std::optional<std::uint64_t> integer_option(const std::string& option, const std::string& typed, std::uint64_t least,
                                            std::uint64_t most) {
  if (typed.empty()) return {};
  std::uint64_t value = 0;
  const char* end = typed.data() + typed.size();
  const auto [stop, error] = std::from_chars(typed.data(), end, value);
  const bool padded = typed.size() > 1 && typed.front() == '0';
  if (error != std::errc() || stop != end || padded || value < least || value > most) {
    throw Error(fmt::format("{} must be an integer in [{}, {}], got '{}'", option, least, most, typed));
  }
  return value;
}

std::optional<double> number_option(const std::string& option, const std::string& typed, double least) {
  if (typed.empty()) return {};
  double value = 0.0;
  const char* end = typed.data() + typed.size();
  const auto [stop, error] = std::from_chars(typed.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value) || value < least) {
    throw Error(fmt::format("{} must be a number of at least {:g}, got '{}'", option, least, typed));
  }
  return value;
}

}  // namespace trellis::command
