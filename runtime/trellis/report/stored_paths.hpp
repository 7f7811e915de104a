// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/motion/motion_model.hpp>

namespace trellis {

/// The path of one solved run, from a document of `trellis run --json`.
struct StoredRunPath {
  std::string problem;
  std::string strategy;
  std::uint64_t seed = 0;
  Configurations path;
  Trajectory trajectory;  ///< dt is 0 where the robot has no motion model
};

/// The paths of a document, in its order.
struct StoredPaths {
  std::string script;  ///< as given on the command line
  std::vector<StoredRunPath> paths;
  std::size_t unsolved = 0;  ///< runs without a path
};

/// \param document  JSON of trellis run
/// \param file      for messages
/// \throws Error that names the file, for another kind of document.
StoredPaths read_stored_paths(const std::string& document, const std::string& file);

}  // namespace trellis
