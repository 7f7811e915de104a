// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dsl/lua/stack.hpp>

namespace trellis::lua {

/// From now on `asked` is polled while a script runs; where it says so the script ends with the error "interrupted",
/// again and again as long as it does, whatever the script catches. Coroutines made before are not watched.
void poll_interrupts(Stack& stack, bool (*asked)());

}  // namespace trellis::lua
