// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include <trellis/base/configurations.hpp>

namespace trellis {

/// Memory for a state or its rate: of few coordinates, without an allocation.
class SmallState {
 public:
  /// Returns n numbers, which are those of the call before if it asked for as many.
  MutableView of(std::size_t n) {
    if (n <= few_.size()) return {few_.data(), n};
    many_.resize(n);
    return many_;
  }

 private:
  std::array<double, 8> few_{};
  Configuration many_;
};

}  // namespace trellis
