// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::dsl {

/// Where a script lies, and what that gives it.
struct ScriptPlace {
  std::string folder;  ///< the script's; "" the working directory
  bool trust = false;  ///< it may read files from anywhere
};

/// Whether a file lies in one of the folders, going by the words of its path: links in a folder are its owner's affair.
/// A relative path is one within any folder, unless it leads out of it.
bool lies_within(const std::string& file, const std::vector<std::string>& folders);

}  // namespace trellis::dsl
