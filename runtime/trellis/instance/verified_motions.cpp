// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/verified_motions.hpp>

#include <bit>

namespace trellis {

std::uint64_t configuration_digest(View q) {
  std::uint64_t digest = 0x9E3779B97F4A7C15U;
  for (const double x : q) {
    digest = (digest ^ std::bit_cast<std::uint64_t>(x)) * 0xBF58476D1CE4E5B9U;
    digest ^= digest >> 29U;
  }
  return digest;
}

std::uint64_t motion_digest(View a, View b) {
  const std::uint64_t x = configuration_digest(a);
  const std::uint64_t y = configuration_digest(b);
  // The product distinguishes the motions from a configuration to itself, whose digests' difference is 0.
  return (x ^ y) + x * y;
}

}  // namespace trellis
