// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <unordered_set>

#include <trellis/base/configurations.hpp>

namespace trellis {

/// A hash of the configuration.
/// \param q  bits count: 0 and -0 differ
std::uint64_t configuration_digest(View q);
/// A hash of the motion; equal for (a, b) and (b, a), which have the same dimension.
/// \param a, b  the ends, in either order
std::uint64_t motion_digest(View a, View b);

/// Motions that a check found valid, so that no search checks them again. A lazily validated path costs its checks
/// once. A part of a motion is another motion, because a checker would validate it at other configurations. The set
/// belongs to one epoch of an instance (Instance::epoch).
class VerifiedMotions {
 public:
  /// Clears the set unless it belongs to this epoch.
  /// \param epoch  of the instance (Instance::epoch)
  void hold_at(std::uint64_t epoch) {
    if (epoch == epoch_) return;
    epoch_ = epoch;
    known_.clear();
  }
  [[nodiscard]] std::uint64_t epoch() const { return epoch_; }
  /// \param a, b  the ends of a valid motion, configurations of the space
  void add(View a, View b) { known_.insert(motion_digest(a, b)); }
  /// Whether the motion from a to b, or back, was added.
  /// \param a, b  the ends, compared bit by bit
  [[nodiscard]] bool contain(View a, View b) const { return known_.contains(motion_digest(a, b)); }

 private:
  std::unordered_set<std::uint64_t> known_;  ///< digests of the motions
  std::uint64_t epoch_ = 0;                  ///< of the instance in which the motions are valid
};

}  // namespace trellis
