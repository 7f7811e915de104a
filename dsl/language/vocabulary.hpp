// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis::dsl {

/// All words of the language with a line each, by kind.
std::string vocabulary_text();

/// What is known about a word: its summary, arguments, fields and options; of a module what it holds; of a type of
/// values ("strategy", "trellis.Strategy") what can be done with them. The kind may stand in front: "guide.shrink".
/// Throws Error with the nearest right word.
std::string help_text(const std::string& name);

}  // namespace trellis::dsl
