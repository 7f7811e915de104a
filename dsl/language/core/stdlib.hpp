// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trellis::dsl {

/// A module of the standard library, embedded in the program.
struct Module {
  std::string_view name;
  std::string_view text;
};
std::span<const Module> embedded_modules();

/// Returns the names of the standard library's modules: the embedded ones or, if the environment's TRELLIS_STDLIB names
/// a folder, the files NAME.lua in it. \throws Error if it cannot read that folder.
std::vector<std::string> module_names();
/// Returns a module's text, from the same source; none for an unknown module.
std::optional<std::string> module_text(const std::string& name);

/// Returns the path of a module that is not embedded; none for an embedded or unknown one.
std::optional<std::string> module_path(const std::string& name);

/// The default limit of a file's size in bytes.
inline constexpr std::size_t largest_file = std::size_t{64} << 20U;

/// Reads a regular file of at most `largest` bytes. \throws Error that names the path and the reason, before it reads a
/// file that is larger.
std::string read_file(const std::string& path, std::size_t largest = largest_file);

}  // namespace trellis::dsl
