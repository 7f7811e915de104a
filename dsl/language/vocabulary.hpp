// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <dsl/language/construct.hpp>

namespace trellis::dsl {

/// The constructs of the language that are no planner, guide, target or estimator by themselves.
std::vector<const Construct*> constructs();

/// All words of the language with a line each, by kind.
std::string vocabulary_text();

/// What is known about a word: a component's or construct's summary, fields and options, or the head of a module of
/// the standard library. Throws Error with the nearest right word.
std::string help_text(const std::string& word);

}  // namespace trellis::dsl
