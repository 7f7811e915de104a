// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/language/words.hpp>
#include <dsl/lua/stack.hpp>
#include <trellis/space/space.hpp>

// Spaces and configurations as scripts hold them.

namespace trellis::dsl {

/// "(1, 2, 0.5)".
std::string coordinates_of(View q);

/// A list of numbers.
void push_numbers(lua::Stack& stack, View numbers);

/// A table that tells of a space: trellis.Space.
void push_space(lua::Stack& stack, const Space& space);
ObjectType space_type();

/// Reads such a table, in which weights are 1 and no axis wraps around unless it says so; or a list of names of axes of
/// `c`. `what` names it in messages. Throws Error.
Space read_space(lua::Value value, const Space& c, const std::string& what);

/// A configuration that a script gives as a list: as many finite numbers as the space has axes.
Configuration read_configuration(lua::Value value, const Space& space, const std::string& what);

/// Brings periodic coordinates into their range; throws Error where another is outside of the space. `what` names the
/// configuration in messages.
void bring_into(const Space& space, MutableView q, const std::string& what);

}  // namespace trellis::dsl
