// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace trellis {

/// A deterministic stream of random numbers. The generator is counter based (Philox 4x64, Random123) and keyed by
/// (seed, level, purpose). Streams are independent: a new level or purpose changes no other stream, and the number of
/// threads has no influence. Trellis implements all conversions itself, so that every compiler and standard library
/// gives the same values. Only one thread may use a stream at a time; a copy continues independently from the same
/// numbers. Source: Salmon, Moraes, Dror and Shaw, Parallel random numbers: as easy as 1, 2, 3, SC 2011.
class Stream {
 public:
  /// \param seed     the run's seed
  /// \param level    the level's path in the hierarchy, e.g. "0", "0/1"
  /// \param purpose  what the numbers are for: "proposals", "planner", "measure", ...
  Stream(std::uint64_t seed, std::string_view level, std::string_view purpose);

  /// Returns the next 64 random bits.
  std::uint64_t bits() {
    if (next_ == block_.size()) refill();
    return block_[next_++];
  }
  /// Returns a uniform number on [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Returns a uniform number on [lo, hi).
  /// \param lo  finite, included
  /// \param hi  finite, greater than `lo`; rounding may give it for a narrow interval
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Returns a uniform integer of {0, ..., n-1}; n > 0. The bias is below n / 2^64.
  /// \param n  greater than 0, which is not checked; 0 gives 0
  std::size_t below(std::size_t n) {
    __extension__ using Wide = unsigned __int128;
    return static_cast<std::size_t>((static_cast<Wide>(bits()) * n) >> 64U);
  }
  /// Returns a standard normal number (Box-Muller; stores the second value of each pair for the next call).
  double normal();

 private:
  void refill();

  std::array<std::uint64_t, 2> key_;
  std::uint64_t counter_ = 0;
  std::array<std::uint64_t, 16> block_{};
  std::size_t next_ = 16;
  double reserve_ = 0.0;
  bool has_reserve_ = false;
};

/// FNV-1a, 64 bits: a stable hash of bytes, the same on every machine.
/// \param bytes  of any content; zero bytes count
std::uint64_t stable_hash(std::string_view bytes);

}  // namespace trellis
