// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

namespace trellis {

/// How a search ended.
enum class Status : std::uint8_t {
  untried,  ///< no search was started
  solved,
  budget_spent,   ///< proposals, checks or seconds ran out
  no_path,        ///< the search space is finite and contains no path
  invalid_start,  ///< the start is invalid in this space
  invalid_goal,
  interrupted,
  paused,  ///< of a loop that can continue: it waits for other work of the run. No record has it
};
/// Returns the status in words of a message, as "budget spent".
/// \param status  a value of the enumeration
/// \throws Fault for another value
std::string_view to_string(Status status);

}  // namespace trellis
