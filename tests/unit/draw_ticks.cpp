// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <trellis/base/error.hpp>
#include <trellis/draw/ticks.hpp>

#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Whether x is 1, 2 or 5 times a power of ten.
bool nice(double x) {
  const double mantissa = x / std::pow(10.0, std::floor(std::log10(x) + 1e-9));
  return std::abs(mantissa - 1.0) < 1e-6 || std::abs(mantissa - 2.0) < 1e-6 || std::abs(mantissa - 5.0) < 1e-6;
}

void check_common(const Ticks& ticks, const Extent& extent, std::size_t most) {
  REQUIRE(!ticks.at.empty());
  CHECK(ticks.at.size() <= most);
  CHECK(ticks.labels.size() == ticks.at.size());
  CHECK(std::set<std::string>(ticks.labels.begin(), ticks.labels.end()).size() == ticks.labels.size());
  const double slack = 1e-8 * (extent.hi - extent.lo);
  for (const double at : ticks.at) {
    CHECK(at >= extent.lo - slack);
    CHECK(at <= extent.hi + slack);
  }
  CHECK(std::is_sorted(ticks.at.begin(), ticks.at.end()));
}

}  // namespace

TEST_CASE("linear ticks are few nice numbers that cover the extent", "[draw]") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 4000; ++trial) {
    const double middle =
        (trial % 3 == 0 ? 0.0 : std::pow(10.0, 30.0 * unit(random) - 15.0)) * (trial % 2 == 0 ? 1 : -1);
    const double width = (middle == 0.0 ? std::pow(10.0, 600.0 * unit(random) - 300.0)
                                        : std::abs(middle) * std::pow(10.0, 10.0 * unit(random) - 8.0));
    const Extent extent{middle - width * unit(random), middle + width * (0.01 + unit(random))};
    const auto most = 2 + static_cast<std::size_t>(trial % 12);
    CAPTURE(extent.lo, extent.hi, most);
    const Ticks ticks = linear_ticks(extent, most);
    check_common(ticks, extent, most);
    if (most >= 5) REQUIRE(ticks.at.size() >= 2);
    if (ticks.at.size() < 2) continue;
    const double step = (ticks.at.back() - ticks.at.front()) / static_cast<double>(ticks.at.size() - 1);
    if (std::abs(middle) < 1e5 * width) CHECK(nice(step));
    CHECK(ticks.at.front() - extent.lo < 1.0001 * step);
    CHECK(extent.hi - ticks.at.back() < 1.0001 * step);
    for (std::size_t i = 1; i < ticks.at.size(); ++i) {
      CHECK(ticks.at[i] - ticks.at[i - 1] == Approx(step).epsilon(1e-4).margin(0.0));
    }
  }
}

TEST_CASE("logarithmic ticks are few and within the extent", "[draw]") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 4000; ++trial) {
    const double lo = std::pow(10.0, 500.0 * unit(random) - 280.0);
    const double decades = trial % 3 == 0 ? 0.01 + unit(random) : 75.0 * unit(random) * unit(random) + 0.01;
    const Extent extent{lo, lo * std::pow(10.0, decades)};
    const auto most = 2 + static_cast<std::size_t>(trial % 12);
    CAPTURE(extent.lo, extent.hi, most);
    const Ticks ticks = log_ticks(extent, most);
    check_common(ticks, extent, most);
    for (const double minor : ticks.minor) {
      CHECK(minor >= extent.lo);
      CHECK(minor <= extent.hi);
    }
    if (decades > 2.5) {
      for (const double at : ticks.at) CHECK(std::log10(at) == Approx(std::round(std::log10(at))).margin(1e-9));
    }
  }
}

TEST_CASE("ticks look as in print", "[draw]") {
  using Labels = std::vector<std::string>;
  CHECK(linear_ticks({-1.0, 1.0}, 5).labels == Labels{"−1.0", "−0.5", "0.0", "0.5", "1.0"});
  CHECK(linear_ticks({0.0, 31.0}, 5).labels == Labels{"0", "10", "20", "30"});
  const Ticks large = linear_ticks({0.0, 3.2e6}, 5);
  CHECK(large.exponent == 6);
  CHECK(large.labels == Labels{"0", "1", "2", "3"});
  CHECK(linear_ticks({0.0, 4e-5}, 5).exponent == -5);
  CHECK(log_ticks({1.0, 1000.0}, 5).labels == Labels{"1", "10", "100", "1000"});
  CHECK(log_ticks({0.5, 2e6}, 9).labels.back() == "10⁶");
  CHECK(log_ticks({1.0, 8.0}, 5).labels == Labels{"1", "2", "5"});
  CHECK(log_ticks({1.0, 1e8}, 5).labels == Labels{"10⁰", "10²", "10⁴", "10⁶", "10⁸"});
}

TEST_CASE("ticks of no extent are a fault", "[draw]") {
  CHECK_THROWS_AS(linear_ticks({1.0, 1.0}, 5), Fault);
  CHECK_THROWS_AS(linear_ticks({0.0, infinity}, 5), Fault);
  CHECK_THROWS_AS(linear_ticks({0.0, 1.0}, 1), Fault);
  CHECK_THROWS_AS(log_ticks({0.0, 1.0}, 5), Fault);
  CHECK_THROWS_AS(linear_ticks({}, 5), Fault);
}

TEST_CASE("an extent fitted to any numbers can be ticked and holds them", "[draw]") {
  const std::vector<double> numbers = {0.0,    -0.0,         1.0,      -1.0,      1e9,         1e9 + 1e-7,
                                       5e-324, 1e-300,       -1e-310,  1e300,     -1e300,      1e308,
                                       1e-5,   not_a_number, infinity, -infinity, 1e9 + 100.0, 3.0};
  for (const auto scale : {AxisScale::linear, AxisScale::log}) {
    for (const double a : numbers) {
      for (const double b : numbers) {
        CAPTURE(a, b);
        Extent extent;
        extent.add(a, scale);
        extent.add(b, scale);
        const Extent fitted = extent.fitted(scale, 0.05);
        REQUIRE(fitted.lo < fitted.hi);
        if (!extent.empty() && scale == AxisScale::linear) {
          CHECK(fitted.lo <= extent.lo);
          CHECK(fitted.hi >= extent.hi);
        }
        check_common(axis_ticks(fitted, scale, 7), fitted, 7);
      }
    }
  }
  CHECK(Extent{2.0, 8.0}.fitted(AxisScale::linear, 0.5).lo == 0.0);
  CHECK(Extent{-8.0, -2.0}.fitted(AxisScale::linear, 0.5).hi == 0.0);
  CHECK(Extent{-1.0, 1.0}.fitted(AxisScale::linear, 0.5).lo == -2.0);
}
