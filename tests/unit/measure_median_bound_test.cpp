// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/measure/median_bound.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

std::vector<double> first_numbers(std::size_t n) {
  std::vector<double> values(n);
  std::iota(values.begin(), values.end(), 1.0);
  return values;
}

}  // namespace

TEST_CASE("the bound of a median is the value that the sign test puts beyond it") {
  // Of 30 coins at most 19 show heads with a chance of .951, at most 18 with one of .900.
  CHECK(median_upper(first_numbers(30)) == 20.0);
  CHECK(median_lower(first_numbers(30)) == 11.0);
  CHECK(median_upper(first_numbers(30), 0.9) == 20.0);
  CHECK(median_upper(first_numbers(30), 0.89) == 19.0);
  // Of 5 coins at most 4 with .969, of 4 at most 3 with .9375.
  CHECK(median_upper(first_numbers(5)) == 5.0);
  CHECK(std::isinf(median_upper(first_numbers(4))));
  CHECK(std::isinf(median_lower({})));
  CHECK(least_for_median() == 5);
  CHECK(least_for_median(0.99) == 7);
}

TEST_CASE("infinite values take part in the bound of a median, other things do not") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> values = first_numbers(30);
  std::fill(values.begin() + 20, values.end(), infinity);
  CHECK(median_upper(values) == 20.0);
  values[19] = infinity;
  CHECK(median_upper(values) == infinity);
  values[19] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(median_upper(values), Error);
  CHECK_THROWS_AS(median_upper(first_numbers(9), 1.0), Error);
}

TEST_CASE("the bound lies beyond the median as often as it says") {
  constexpr int rounds = 4000;
  constexpr std::size_t n = 21;
  Stream stream(1, "", "median bound");
  int beyond = 0;
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(std::exp(3.0 * stream.normal()));  // the median is 1
    beyond += median_upper(values) >= 1.0 ? 1 : 0;
  }
  // The 15th of 21 bounds it with .961.
  CHECK(static_cast<double>(beyond) / rounds == Approx(0.961).margin(0.012));
}
