// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/orders.hpp>

#include <trellis/collision/checker.hpp>

namespace trellis {

namespace {

void fill(Order& order, std::uint32_t n) {
  order.indices = bisection_order(n);
  order.shares.resize((n + kernel::lanes - 1) / kernel::lanes);
  for (std::size_t rank = 0; rank < order.shares.size() * kernel::lanes; ++rank) {
    order.shares[rank / kernel::lanes].v[rank % kernel::lanes] =
        rank < n ? static_cast<double>(order.indices[rank]) / static_cast<double>(n) : 1.0;
  }
}

}  // namespace

const Order& order_of(std::uint32_t n) {
  constexpr std::uint32_t longest_stored = 1024;
  thread_local std::vector<std::unique_ptr<Order>> stored;
  thread_local Order last_long;  // the last order that is too long to store
  if (n > longest_stored) {
    if (last_long.indices.size() != n) fill(last_long, n);
    return last_long;
  }
  if (n >= stored.size()) stored.resize(n + 1);
  if (!stored[n]) {
    stored[n] = std::make_unique<Order>();
    fill(*stored[n], n);
  }
  return *stored[n];
}

}  // namespace trellis
