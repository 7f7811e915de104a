// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/language/core/word.hpp>

// The registry of words as documents for readers and other programs. scripts/reference writes the committed copies.

namespace trellis::dsl {

/// A page in Markdown: a section for each word and type, with tables of fields and options.
std::string reference_markdown();

/// Stubs in LuaCATS (`---@meta`), from which lua-language-server completes and checks scripts.
std::string reference_stubs();

/// Stubs of the words that the Python package takes from the registry: python/trellis/_words.pyi.
std::string reference_python();
/// The parameters and the result of a word as a function in Python: "(scale: float = 0.5, *, planner: Strategy = ...)
/// -> Guide".
std::string python_signature(const Word& word);

/// Returns a configuration of luacheck with the globals of scripts and those that scripts do not have.
std::string reference_luacheck();

}  // namespace trellis::dsl
