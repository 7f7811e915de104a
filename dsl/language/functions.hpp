// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include <dsl/language/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// What the standard library defines its functions with:
///
///     native.define({ NAME, SUMMARY, source = "...", returns = TYPE, usage = "...", options = {...} }, make)
///
/// gives a function that takes one table of what shall differ from the defaults, or nothing. It checks the table as the
/// description says, and calls `make` with the defaults overlaid by what was given. `returns` is a type of the
/// language: "guide", "strategy", "problem", or one as LuaCATS has it. `options` lists
///
///     { "shrink", radius = 0, evidence = 100 }     options of a component or construct, with other defaults;
///     { of = "blend", as = "decay", name = "memory", default = 0.98 }     one of them under another name;
///     { name = "share", default = 0.5, lo = 0, hi = 1, unit = "...", doc = "..." }     a number of its own;
///     { name = "scales", type = "number[]", default = {0.5}, expects = "...", doc = "..." }     anything else;
///     { like = "problem", default = {...} }     all that a construct takes, nothing of it required;
///
/// and lists of these. Of one name the last stands, in the first one's place.
///
/// \param described  is told of every function that is defined
lua::Callback definer(std::function<void(const Construct&)> described);

}  // namespace trellis::dsl
