// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/ticks.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/draw/text.hpp>

namespace trellis::draw {

namespace {

constexpr double least_number = 1e-300;
constexpr std::array<int, 3> nice = {1, 2, 5};

double power(int exponent) { return std::pow(10.0, exponent); }

/// Returns floor(log10 x), exact where x is a power of ten.
int decade(double x) {
  const int guess = static_cast<int>(std::floor(std::log10(x)));
  if (power(guess + 1) <= x) return guess + 1;
  return power(guess) > x ? guess - 1 : guess;
}

void check(const Extent& extent, std::size_t most) {
  if (!(extent.lo < extent.hi) || !std::isfinite(extent.hi - extent.lo)) throw Fault("ticks of no proper extent");
  if (most < 2) throw Fault("fewer than two ticks are no axis");
}

/// Multiples of 10^exponent x mantissa, from the first to the last.
struct Steps {
  int mantissa = 1;
  int exponent = 0;
  double first = 0.0;
  double last = 0.0;
  [[nodiscard]] double count() const { return last - first + 1.0; }
  /// In units of 10^unit.
  [[nodiscard]] double value(double k, int unit) const {
    const int e = exponent - unit;
    return e < 0 ? k * mantissa / power(-e) : k * mantissa * power(e);
  }
};

Steps steps(const Extent& extent, int mantissa, int exponent) {
  const double step = mantissa * power(exponent);
  constexpr double slack = 1e-9;
  return {mantissa, exponent, std::ceil(extent.lo / step - slack), std::floor(extent.hi / step + slack)};
}

/// Writes powers of ten as decimals in this range, else as powers.
bool plain(int exponent) { return exponent >= -3 && exponent <= 4; }

std::string mantissa_text(int mantissa, int exponent, bool written_out) {
  if (written_out) return number_text(mantissa * power(exponent), std::max(0, -exponent));
  return (mantissa == 1 ? "" : std::to_string(mantissa) + "·") + power_text(exponent);
}

}  // namespace

void Extent::add(double value, AxisScale scale) {
  if (!(std::abs(value) <= most_number)) return;
  if (scale == AxisScale::log && value < least_number) return;
  lo = std::min(lo, value);
  hi = std::max(hi, value);
}

void Extent::add(const Extent& other) {
  lo = std::min(lo, other.lo);
  hi = std::max(hi, other.hi);
}

Extent Extent::fitted(AxisScale scale, double margin) const {
  if (scale == AxisScale::log) {
    if (empty()) return {1.0, 10.0};
    double from = std::log10(lo);
    double to = std::log10(hi);
    if (to - from < 1e-6) {
      from -= 0.5;
      to += 0.5;
    }
    const double room = margin * (to - from);
    return {std::pow(10.0, std::max(from - room, -300.5)), std::pow(10.0, std::min(to + room, 300.5))};
  }
  if (empty()) return {0.0, 1.0};
  Extent wide = *this;
  const double size = std::max(std::abs(lo), std::abs(hi));
  if (hi - lo <= std::max(1e-9 * size, least_number)) {
    const double half = size > least_number ? (hi == lo ? 0.5 : 1e-8) * size : 1.0;
    wide = {lo - half, hi + half};
  } else {
    const double room = margin * (hi - lo);
    wide = {lo - room, hi + room};
  }
  if (lo >= 0.0) wide.lo = std::max(wide.lo, 0.0);
  if (hi <= 0.0 && lo < 0.0) wide.hi = std::min(wide.hi, 0.0);
  return wide;
}

Ticks linear_ticks(const Extent& extent, std::size_t most) {
  check(extent, most);
  const auto limit = static_cast<double>(most);
  Steps chosen;
  // One decade below the first guess at the step suffices for any number of ticks that fits on paper.
  for (int exponent = decade((extent.hi - extent.lo) / limit) - 1;; ++exponent) {
    bool found = false;
    for (const int mantissa : nice) {
      chosen = steps(extent, mantissa, exponent);
      found = chosen.count() <= limit;
      if (found) break;
    }
    if (found) break;
  }
  Ticks ticks;
  const double largest = std::max(std::abs(chosen.value(chosen.first, 0)), std::abs(chosen.value(chosen.last, 0)));
  if (largest > 0.0 && (largest >= 1e5 || largest < 1e-3)) ticks.exponent = decade(largest);
  const int decimals = std::clamp(ticks.exponent - chosen.exponent, 0, 15);
  const auto count = static_cast<std::size_t>(chosen.count());
  for (std::size_t i = 0; i < count; ++i) {
    const double k = chosen.first + static_cast<double>(i);
    ticks.at.push_back(chosen.value(k, 0));
    ticks.labels.push_back(number_text(chosen.value(k, ticks.exponent), decimals));
  }
  return ticks;
}

Ticks log_ticks(const Extent& extent, std::size_t most) {
  check(extent, most);
  if (!(extent.lo > 0.0)) throw Fault("a logarithmic axis that is not positive");
  const int first = decade(extent.lo) + (power(decade(extent.lo)) < extent.lo ? 1 : 0);
  const int last = decade(extent.hi);
  Ticks ticks;
  if (last > first) {
    int stride = 1;
    const auto count = [&] {
      int n = 0;
      for (int e = first; e <= last; ++e) n += e % stride == 0 ? 1 : 0;
      return n;
    };
    while (count() > static_cast<int>(most)) ++stride;
    for (int e = first; e <= last; ++e) {
      if (e % stride != 0) continue;
      ticks.at.push_back(power(e));
      ticks.labels.push_back(mantissa_text(1, e, plain(first) && plain(last)));
    }
    for (int e = first - 1; stride == 1 && e <= last; ++e) {
      for (int m = 2; m <= 9; ++m) {
        const double value = m * power(e);
        if (value >= extent.lo && value <= extent.hi) ticks.minor.push_back(value);
      }
    }
    return ticks;
  }
  for (int e = first - 1; e <= last; ++e) {
    for (const int m : nice) {
      const double value = m * power(e);
      if (value < extent.lo || value > extent.hi) continue;
      ticks.at.push_back(value);
      ticks.labels.push_back(mantissa_text(m, e, plain(e)));
    }
  }
  if (ticks.at.size() >= 2 && ticks.at.size() <= most) return ticks;
  return linear_ticks(extent, most);
}

Ticks axis_ticks(const Extent& extent, AxisScale scale, std::size_t most) {
  return scale == AxisScale::log ? log_ticks(extent, most) : linear_ticks(extent, most);
}

}  // namespace trellis::draw
