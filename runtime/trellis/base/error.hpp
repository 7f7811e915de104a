// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace trellis {

/// Something the user gave cannot be used. The message says what is wrong, what was expected and, where there is
/// one, the nearest right name. Thrown at borders (construction, loading, set-up), never in a hot loop.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

/// A fault of Trellis itself: a broken invariant. The command line answers with exit status 1.
class Fault : public std::logic_error {
 public:
  explicit Fault(const std::string& message) : std::logic_error(message) {}
};

/// The entry of `known` with the smallest edit distance to `given`, or "" when none is near enough to be meant
/// (distance over a third of the longer name, at least 2; or as long as the shorter name, which then shares nothing).
std::string nearest_name(std::string_view given, std::span<const std::string> known);

/// " (did you mean 'x'?)" or "" for use at the end of a message.
std::string did_you_mean(std::string_view given, std::span<const std::string> known);

}  // namespace trellis
