// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/collision/planar/kernel.hpp>

namespace trellis {

/// The configurations of a motion in the order in which a checker visits them.
struct Order {
  std::vector<std::uint32_t> indices;  ///< of 1..n, the bisection order
  /// indices / n, eight to a step; the end of the motion pads the last step.
  std::vector<kernel::Lanes> shares;

  [[nodiscard]] double share(std::size_t rank) const { return shares[rank / kernel::lanes].v[rank % kernel::lanes]; }
};

/// The order for n configurations. All checkers of a thread share the orders: motions are short, so few values of n
/// occur. Valid until the thread's next call.
const Order& order_of(std::uint32_t n);

}  // namespace trellis
