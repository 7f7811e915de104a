// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

// The registry of words as documents for readers and other programs. scripts/reference writes the committed copies.

namespace trellis::dsl {

/// A page in Markdown: a section for each word and type, with tables of fields and options.
std::string reference_markdown();

/// Stubs in LuaCATS (`---@meta`), from which lua-language-server completes and checks scripts.
std::string reference_stubs();

/// Returns a configuration of luacheck with the globals of scripts and those that scripts do not have.
std::string reference_luacheck();

}  // namespace trellis::dsl
