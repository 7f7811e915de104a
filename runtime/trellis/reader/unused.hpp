// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/reader/formats.hpp>

namespace trellis {

/// An entry of a file that its reader did not use: an element, an attribute, or a key.
struct Unused {
  std::string name;  ///< as the file writes it: "octomap"
  std::size_t line;
};

/// Returns what a warning at the first of some lines says of the others: " (2 more: lines 40, 61)", "" without others.
/// Lists at most five of them; lines that repeat are listed once.
std::string more_lines(std::vector<std::size_t> lines);

/// Returns one warning for each name, in the order of the first lines: "FILE:12: 'octomap' is not read (2 more: lines
/// 40, 61)".
std::vector<std::string> unused_warnings(const SourceText& text, std::vector<Unused> entries);

}  // namespace trellis
