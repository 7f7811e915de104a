// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis::dsl {

/// A script's folder and permissions.
struct ScriptPlace {
  std::string folder;  ///< the script's; "" the working directory
  bool trust = false;  ///< it may read any file
};

/// Whether a file lies in one of the folders, by the names in its path: does not resolve links, for which the folder's
/// owner is responsible. A relative path lies in every folder, unless it leads out of it.
bool lies_within(const std::string& file, const std::vector<std::string>& folders);

}  // namespace trellis::dsl
