// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <unordered_set>

#include <trellis/base/configurations.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Motions that were checked and found valid, so that no part of them is checked again: a lazily validated path costs
/// its checks once, whichever search goes along it. They hold for one epoch of an instance (Instance::epoch).
class VerifiedMotions {
 public:
  explicit VerifiedMotions(const Space& space) : space_(space), ends_(space.dimension()) {}

  /// Forgets all motions unless they are of this epoch.
  void hold_at(std::uint64_t epoch) {
    if (epoch == epoch_) return;
    epoch_ = epoch;
    ends_.clear();
    known_.clear();
  }
  [[nodiscard]] std::uint64_t epoch() const { return epoch_; }
  /// \param a, b  the ends of a valid motion, configurations of the space
  void add(View a, View b);
  /// Whether the motion from a to b, or back, was added as it is. Faster than `cover`.
  [[nodiscard]] bool contain(View a, View b) const;
  /// Whether the motion from a to b is part of one that was added, to within rounding.
  [[nodiscard]] bool cover(View a, View b) const;

 private:
  Space space_;
  Configurations ends_;                      ///< two rows a motion
  std::unordered_set<std::uint64_t> known_;  ///< digests of both ends
  std::uint64_t epoch_ = 0;                  ///< of the instance that they are valid in
};

}  // namespace trellis
