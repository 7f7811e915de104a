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

const Order& Orders::of(std::uint32_t n) {
  constexpr std::uint32_t longest_kept = 1024;
  if (n > longest_kept) {
    if (long_.indices.size() != n) fill(long_, n);
    return long_;
  }
  if (n >= kept_.size()) kept_.resize(n + 1);
  if (!kept_[n]) {
    kept_[n] = std::make_unique<Order>();
    fill(*kept_[n], n);
  }
  return *kept_[n];
}

}  // namespace trellis
