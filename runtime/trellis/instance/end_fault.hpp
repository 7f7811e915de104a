// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/scene/scene.hpp>

// Why a start, a goal or any other configuration is not valid.

namespace trellis {

/// A start or a goal that is no valid configuration, or that no valid configuration reaches.
class InvalidEnd : public Error {
 public:
  using Error::Error;
};

/// Returns "lift = 2.5, expected it in [-2, 2]" for the first coordinate that is out of its bounds, with as many digits
/// as distinguish the numbers; "" where there is none.
std::string out_of_bounds(const Space& space, View q);

/// Returns why a configuration is invalid: "link hand is in collision with obstacle 1 (board)"; "" where it is valid.
/// \param checker  of the problem
std::string fault_of(const Problem& problem, View q, const Checker& checker);

}  // namespace trellis
