// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace trellis::dsl {

/// The width of help, in columns, where nothing says how wide its place is.
constexpr std::size_t help_width = 100;

/// Returns all words of the language with a line each, by kind.
/// \param width  in columns; lines are wrapped at words
std::string vocabulary_text(std::size_t width = help_width);

/// Returns the help on a word: its summary, arguments, fields and options; for a module its content; for a type of
/// values ("strategy", "trellis.Strategy") its operators and members. The kind may precede the word: "guide.shrink".
/// For a name that is no word: the options of that name, else the words near it; for an empty one vocabulary_text.
/// \param width  in columns; lines are wrapped at words
/// \throws Error with the nearest valid word, for any other name.
std::string help_text(const std::string& name, std::size_t width = help_width);

/// Returns the help on the options and fields of this name, each meaning once with the words that have it; "" for none.
std::string option_help(const std::string& name, std::size_t width = help_width);

}  // namespace trellis::dsl
