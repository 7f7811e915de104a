// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <set>
#include <string>

namespace trellis {

/// Gives each name a directory of its own: letters, digits and what no shell or file system minds; everything else
/// becomes '-'. Two names that only differ in unsafe characters are told apart by a number.
class Directories {
 public:
  const std::string& operator()(const std::string& name);

 private:
  std::map<std::string, std::string> names_;
  std::set<std::string> taken_;
};

/// Makes a directory and those above it. Throws Error where it cannot be made.
void make_directory(const std::string& path);

}  // namespace trellis
