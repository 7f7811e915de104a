// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers the named combinators: sequence, blend, schedule, race and split.
void open_combinators(lua::Stack& stack, const ScriptPlace& place);

/// Returns their descriptions, in the order of the reference.
std::vector<const Construct*> combinator_constructs();

/// Returns the number of a guide's components.
std::size_t components_of(const GuideSpec& guide);
/// Composition distributes over combined guides, so a few operators can create more components than memory can store.
/// \throws Error for too many.
void check_size(std::size_t components);

}  // namespace trellis::dsl
