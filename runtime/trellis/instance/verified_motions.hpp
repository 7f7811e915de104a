// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <unordered_set>

#include <trellis/base/configurations.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Motions that were checked and found valid, so that no part of them is checked again: a lazily validated path costs
/// its checks once, whoever drives along it.
class VerifiedMotions {
 public:
  explicit VerifiedMotions(const Space& space) : space_(space), ends_(space.dimension()) {}

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
};

}  // namespace trellis
