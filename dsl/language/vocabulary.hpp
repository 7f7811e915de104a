// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis::dsl {

/// Returns all words of the language with a line each, by kind.
std::string vocabulary_text();

/// Returns the help on a word: its summary, arguments, fields and options; for a module its content; for a type of
/// values ("strategy", "trellis.Strategy") its operators and members. The kind may precede the word: "guide.shrink".
/// \throws Error with the nearest valid word.
std::string help_text(const std::string& name);

}  // namespace trellis::dsl
