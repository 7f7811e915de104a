// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// What the definitions of the standard library refer to, and who hears of them.
struct Definitions {
  std::vector<const Construct*> constructs = {};         ///< of the language
  std::function<void(const Construct&)> described = {};  ///< called for every defined function
};

/// The function with which the standard library defines its functions:
///
///     native.define({ NAME, SUMMARY, source = "...", returns = TYPE, usage = "...", options = {...} }, make)
///
/// returns a function that takes one table of values that differ from the defaults, or no argument. It checks the table
/// against the description, and calls `make` with the defaults and the given values. `returns` is a type of the
/// language: "guide", "strategy", "problem", or a LuaCATS type. `options` lists
///     { "shrink", radius = 0, evidence = 100 }     options of a component or construct, with other defaults;
///     { name = "share", default = 0.5, lo = 0, hi = 1, unit = "...", doc = "..." }     a number of its own;
///     { name = "scales", type = "number[]", default = {0.5}, expects = "...", doc = "..." }     anything else;
///     { like = "problem", default = {...} }     all that a construct takes, nothing of it required;
///
/// and lists of these. Of entries with one name, the last applies, in the position of the first.
lua::Callback definer(Definitions definitions);

}  // namespace trellis::dsl
