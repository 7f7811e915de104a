// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace trellis {

/// Finds the files that a URDF file names: `package://NAME/PATH`, `file://PATH` and PATH.
///
/// The folder of a package NAME is the one that the caller gives; else, in this order: a folder above the file that is
/// called NAME or whose package.xml has that name, a folder NAME in one of the folders above, and where
/// ROS_PACKAGE_PATH (folders that are packages or contain them) and AMENT_PREFIX_PATH (prefixes with share/NAME) have
/// one. A file of one package is never looked for in another one.
class RosPackages {
 public:
  /// \param file   the URDF file
  /// \param given  folders of packages by name
  RosPackages(const std::string& file, std::map<std::string, std::string> given);

  /// Returns the path of a file that exists; none without one.
  [[nodiscard]] std::optional<std::string> find(const std::string& uri) const;
  /// Returns where a file that `find` does not find is looked for, and what to write so that it is found: one sentence
  /// for each package.
  [[nodiscard]] std::string advice(const std::string& uri) const;

 private:
  using Folders = std::vector<std::filesystem::path>;
  /// Returns the folders of a package, the first one first.
  [[nodiscard]] Folders folders_of(const std::string& package) const;

  Folders above_;  ///< that of the file, then those above it
  std::map<std::string, std::string> given_;
  mutable std::map<std::string, Folders> found_;  ///< by package
};

}  // namespace trellis
