// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/collision/kernel.hpp>

namespace trellis {

/// The configurations of a motion in the order in which a checker visits them.
struct Order {
  std::vector<std::uint32_t> indices;  ///< of 1..n, the bisection order
  /// indices / n, eight to a step; the end of the motion pads the last step.
  std::vector<kernel::Lanes> shares;

  [[nodiscard]] double share(std::size_t rank) const { return shares[rank / kernel::lanes].v[rank % kernel::lanes]; }
};

/// Stores the order for each n: motions are short, so few values of n occur.
class Orders {
 public:
  const Order& of(std::uint32_t n);

 private:
  std::vector<std::unique_ptr<Order>> kept_;
  Order long_;  ///< the last order that is too long to store
};

}  // namespace trellis
