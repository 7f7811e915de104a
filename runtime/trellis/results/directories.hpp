// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <set>
#include <string>

namespace trellis {

/// Assigns each name its own directory: letters, digits and other characters that are safe in shells and file systems;
/// everything else becomes '-'. A number distinguishes two names that differ in unsafe characters only.
class Directories {
 public:
  const std::string& operator()(const std::string& name);

 private:
  std::map<std::string, std::string> names_;
  std::set<std::string> taken_;
};

/// Creates a directory and its parents. \throws Error where it cannot create one.
void make_directory(const std::string& path);

}  // namespace trellis
