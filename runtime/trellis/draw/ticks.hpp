// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace trellis::draw {

enum class AxisScale : std::uint8_t { linear, log };

/// An axis treats larger numbers as infinite, so that no width of a range overflows.
inline constexpr double most_number = 1e300;

/// The ends of an axis. Starts empty and grows with each number that the axis can show.
struct Extent {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();

  [[nodiscard]] bool empty() const { return !(lo <= hi); }
  /// Ignores NaN and values that an axis of this scale cannot show.
  void add(double value, AxisScale scale = AxisScale::linear);
  void add(const Extent& other);
  /// Returns the extent with a margin at both ends, as a share of the width, wide enough for its printed ends to
  /// differ. An empty one becomes [0, 1] or [1, 10]. A margin does not cross zero.
  [[nodiscard]] Extent fitted(AxisScale scale, double margin) const;
};

struct Ticks {
  std::vector<double> at;           ///< ascending
  std::vector<std::string> labels;  ///< one for each
  std::vector<double> minor;        ///< without a label
  int exponent = 0;                 ///< the labels are in units of 10^exponent
};

/// Returns multiples of 1, 2 or 5 times a power of ten within the extent, at most `most` (at least 2) and as many as
/// possible: at least one, and two where `most` is 5 or more.
Ticks linear_ticks(const Extent& extent, std::size_t most);

/// Returns powers of ten, or of a power of ten where they are too many. With fewer than two: 1, 2 and 5 times a power
/// of ten, and then linear ticks. The extent is positive.
Ticks log_ticks(const Extent& extent, std::size_t most);

Ticks axis_ticks(const Extent& extent, AxisScale scale, std::size_t most);

}  // namespace trellis::draw
