// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <dsl/lua/value.hpp>

namespace trellis::lua {

/// Hashes the content of a value: of a function its code and upvalues, of a table its entries. The result is the same
/// in every interpreter. Globals are not part of it.
/// \param text  returns the text that identifies an object
std::uint64_t digest(Value value, const std::function<std::string(Value)>& text);

}  // namespace trellis::lua
