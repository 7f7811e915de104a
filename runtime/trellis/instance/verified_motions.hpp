// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <unordered_set>

#include <trellis/base/configurations.hpp>

namespace trellis {

/// Another number for almost any other configuration.
std::uint64_t configuration_digest(View q);
/// The same number for (a, b) and (b, a), another one for almost any other motion.
std::uint64_t motion_digest(View a, View b);

/// Motions that were checked and found valid, so that they are not checked again: a lazily validated path costs its
/// checks once, whichever search goes along it. A part of a motion is another motion: it would be checked at other
/// configurations. They hold for one epoch of an instance (Instance::epoch).
class VerifiedMotions {
 public:
  /// Forgets all motions unless they are of this epoch.
  void hold_at(std::uint64_t epoch) {
    if (epoch == epoch_) return;
    epoch_ = epoch;
    known_.clear();
  }
  [[nodiscard]] std::uint64_t epoch() const { return epoch_; }
  /// \param a, b  the ends of a valid motion, configurations of the space
  void add(View a, View b) { known_.insert(motion_digest(a, b)); }
  /// Whether the motion from a to b, or back, was added.
  [[nodiscard]] bool contain(View a, View b) const { return known_.contains(motion_digest(a, b)); }

 private:
  std::unordered_set<std::uint64_t> known_;  ///< digests of both ends
  std::uint64_t epoch_ = 0;                  ///< of the instance that they are valid in
};

}  // namespace trellis
