// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/language/core/word.hpp>
#include <dsl/lua/stack.hpp>
#include <trellis/space/space.hpp>

// Conversion of spaces and configurations from and to Lua values.

namespace trellis::dsl {

/// "(1, 2, 0.5)".
std::string coordinates_of(View q);

/// "x, y, theta".
std::string axis_names(const Space& space);

/// A list of numbers.
void push_numbers(lua::Stack& stack, View numbers);

/// Pushes a table that describes a space: trellis.Space.
void push_space(lua::Stack& stack, const Space& space);
ObjectType space_type();

/// Reads such a table, with defaults weight 1 and no periodic axis; or a list of names of axes of `c`. Messages call it
/// `what`. \throws Error.
Space read_space(lua::Value value, const Space& c, const std::string& what);

/// Reads a configuration from a list of as many finite numbers as the space has axes.
Configuration read_configuration(lua::Value value, const Space& space, const std::string& what);

/// Reads the coordinates in `count` values from `first` on: numbers, or one list of them. Messages call them `what`.
/// \throws Error
void read_coordinates(const lua::Stack& stack, int first, int count, const Space& space, MutableView out,
                      const std::string& what);

/// Wraps periodic coordinates into their range. Messages call the configuration `what`. \throws Error for another
/// coordinate out of bounds.
void bring_into(const Space& space, MutableView q, const std::string& what);

}  // namespace trellis::dsl
