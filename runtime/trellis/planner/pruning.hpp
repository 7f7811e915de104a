// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include <trellis/base/configurations.hpp>

namespace trellis {

/// Removes configurations of a path between which the straight motion is valid: from each one that remains it tries
/// motions to later ones, twice as many configurations ahead each time, up to the first motion that is not valid. A
/// path of many robots has a configuration wherever one of them turns. The result is never longer.
class PathPruning {
 public:
  /// \param path   of valid motions, at least one configuration
  /// \param valid  whether the straight motion between two of its configurations is valid
  PathPruning(const Configurations& path, std::function<bool(View, View)> valid);

  [[nodiscard]] bool done() const { return at_ + 1 >= path_.size(); }
  /// Tries one motion. Requires that it is not done.
  void step();
  /// The path so far; all of it once done.
  [[nodiscard]] const Configurations& path() const { return pruned_; }

 private:
  Configurations path_;
  std::function<bool(View, View)> valid_;
  Configurations pruned_;
  std::size_t at_ = 0;     ///< the last one that remains
  std::size_t best_ = 1;   ///< the farthest one known to be reached from there by a valid motion
  std::size_t reach_ = 2;  ///< how far the next motion goes
};

}  // namespace trellis
