// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <dsl/lua/value.hpp>

namespace trellis::lua {

/// A hash of what a value is: of a function its code and the values that it closes over, of a table its content. The
/// same in every interpreter. Globals are no part of it.
/// \param text  what objects are told by
std::uint64_t digest(Value value, const std::function<std::string(Value)>& text);

}  // namespace trellis::lua
