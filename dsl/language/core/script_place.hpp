// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace trellis::dsl {

/// Receives each file that a script uses while it loads: its name as the script writes it, and its path.
using FileWatch = std::function<void(const std::string& name, const std::string& path)>;

/// A script's folder and permissions.
struct ScriptPlace {
  std::string folder;  ///< the script's; "" the working directory
  bool trust = false;  ///< it may read any file
  FileWatch watch = {};
};

/// Whether a file lies in one of the folders, by the names in its path: does not resolve links, for which the folder's
/// owner is responsible. A relative path lies in every folder, unless it leads out of it.
bool lies_within(const std::string& file, const std::vector<std::string>& folders);

}  // namespace trellis::dsl
