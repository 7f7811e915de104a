// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

// The registry of words, written out for other programs and for readers. What is committed of it is made by
// scripts/reference.

namespace trellis::dsl {

/// A page in Markdown: a section for each word and type, with tables of fields and options.
std::string reference_markdown();

/// Stubs in LuaCATS (`---@meta`), from which lua-language-server completes and checks scripts.
std::string reference_stubs();

/// A configuration of luacheck that knows the globals that scripts find and those that they do not.
std::string reference_luacheck();

}  // namespace trellis::dsl
