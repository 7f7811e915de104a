// SPDX-License-Identifier: GPL-3.0-or-later
// What a run records beside its samples: why levels were solved again, and its paths.
#pragma once

#include <cstdint>

namespace trellis {

/// How often a level's instance was solved again, by reason. The first solve and these are all its solves.
struct Resolves {
  std::uint64_t invalid_path = 0;    ///< validation in C found points or edges of its path invalid
  std::uint64_t rejections = 0;      ///< C rejected guided proposals along its path, or they made no progress
  std::uint64_t lost_place = 0;      ///< a level above, or another part of the guide, refuted a place on its path
  std::uint64_t presumed_valid = 0;  ///< a configuration that its path presumed valid is invalid
  std::uint64_t changed_world = 0;   ///< the instance that it is projected from has other obstacles
  std::uint64_t new_turn = 0;        ///< its guide's turn came, and f was applied to the samples since
  std::uint64_t further_path = 0;    ///< its guide requested another path
  std::uint64_t refuted_path = 0;    ///< for the root: the path could not be certified
  /// Whether a search for a path to replace a refuted one found none. The instance is then not solved again.
  bool exhausted = false;
  /// Whether its path was refuted after the maximum number of solves that its guide allows.
  bool limit_reached = false;
};

/// A path of a run that is shorter than all earlier ones.
struct Improvement {
  std::uint64_t validity_checks = 0;  ///< of all levels so far
  double cpu_seconds = 0.0;
  double length = 0.0;  ///< in metres in the metric
};

}  // namespace trellis
