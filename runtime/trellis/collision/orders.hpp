// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/collision/kernel.hpp>

namespace trellis {

/// The configurations of a motion in the order in which they are visited.
struct Order {
  std::vector<std::uint32_t> indices;  ///< of 1..n, the bisection order
  /// indices / n, eight to a step; the last step is filled up with the end of the motion.
  std::vector<kernel::Lanes> shares;

  [[nodiscard]] double share(std::size_t rank) const { return shares[rank / kernel::lanes].v[rank % kernel::lanes]; }
};

/// Orders made once for each n and kept: motions are short and alike.
class Orders {
 public:
  const Order& of(std::uint32_t n);

 private:
  std::vector<std::unique_ptr<Order>> kept_;
  Order long_;  ///< the last order that is too long to keep
};

}  // namespace trellis
