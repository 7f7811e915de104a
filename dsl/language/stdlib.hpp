// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trellis::dsl {

/// A module of the standard library as it was compiled in.
struct Module {
  std::string_view name;
  std::string_view text;
};
std::span<const Module> embedded_modules();

/// The names of the standard library's modules: those compiled in or, where the environment's TRELLIS_STDLIB names a
/// folder, the files NAME.lua in it. Throws Error where that folder cannot be read.
std::vector<std::string> module_names();
/// A module's text, from the same place; none where there is no such module.
std::optional<std::string> module_text(const std::string& name);

/// The size in bytes up to which a file is read, unless more is expected: a device may never end.
inline constexpr std::size_t largest_file = std::size_t{64} << 20U;

/// A whole file of at most `largest` bytes. Throws Error naming the path and the reason.
std::string read_file(const std::string& path, std::size_t largest = largest_file);

}  // namespace trellis::dsl
