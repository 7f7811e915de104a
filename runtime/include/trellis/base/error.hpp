// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace trellis {

/// Input from the user is invalid. The message states the fault, the expected value and, where one exists, the nearest
/// valid name. Constructors, loaders and set-up functions throw it; hot loops never do.
class Error : public std::runtime_error {
 public:
  /// \param message  what() of the exception, in words for the user
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

/// A fault of Trellis itself: a broken invariant. The command line exits with status 1.
class Fault : public std::logic_error {
 public:
  /// \param message  what() of the exception, for the developer
  explicit Fault(const std::string& message) : std::logic_error(message) {}
};

/// Returns the entry of `known` with the smallest edit distance to `given`, or "" if no entry is near enough. An entry
/// is too far if its distance exceeds a third of the longer name (at least 2; of three letters 1, or 2 for swapped
/// ones), or equals the length of the shorter name, which then shares no letter.
/// \param given  the name that a user wrote
/// \param known  valid names; of equally near ones the first counts
std::string nearest_name(std::string_view given, std::span<const std::string> known);

/// Returns " (did you mean 'x'?)" or "", to append to a message.
/// \param given  the name that a user wrote
/// \param known  valid names, as for nearest_name
std::string did_you_mean(std::string_view given, std::span<const std::string> known);

}  // namespace trellis
