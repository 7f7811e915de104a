// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <dsl/language/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Makes the combinators known that are written by name: sequence, blend, schedule, race and split.
void open_combinators(lua::Stack& stack, const ScriptPlace& place);

/// They as they are described, in the order of the reference.
std::vector<const Construct*> combinator_constructs();

/// How many components a guide is made of.
std::size_t components_of(const GuideSpec& guide);
/// Composition distributes over what is combined, so a few operators can ask for more components than any memory holds:
/// throws Error for too many.
void check_size(std::size_t components);

}  // namespace trellis::dsl
