// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// published { source, figures, claims }, and the claims in it: claim { text, ... }.
const Construct& published_construct();
const Construct& claim_construct();

void open_publication(lua::Stack& stack);

}  // namespace trellis::dsl
