// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/measure/statistics.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
}  // namespace

TEST_CASE("Student's interval gives the published figures of the sleep data") {
  // Student 1908, differences between the two drugs; the interval as R's t.test prints it.
  const std::vector<double> hours = {1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4};
  const Interval i = student_interval(hours);
  CHECK(i.value == Approx(1.58));
  CHECK(i.lo == Approx(0.7001142).epsilon(1e-6));
  CHECK(i.hi == Approx(2.4598858).epsilon(1e-6));
  CHECK(i.n == 10);
  CHECK(i.infinite == 0);
  const Interval wide = student_interval(hours, 0.99);
  CHECK(wide.hi - wide.lo > i.hi - i.lo);
}

TEST_CASE("Student's interval leaves NaN out, averages no infinity and needs five values") {
  const Interval with_nan = student_interval(std::vector{1.0, 2.0, not_a_number, 3.0, 4.0, 5.0});
  CHECK(with_nan.value == 3.0);
  CHECK(with_nan.n == 5);
  CHECK(with_nan.hi - 3.0 == Approx(2.776445 * std::sqrt(0.5)).epsilon(1e-6));
  const Interval four = student_interval(std::vector{1.0, 2.0, 3.0, 4.0});
  CHECK(four.value == 2.5);
  CHECK(std::isnan(four.lo));
  CHECK(std::isnan(four.hi));

  const Interval censored = student_interval(std::vector{1.0, infinity, 3.0, not_a_number, 2.0, 5.0});
  CHECK(censored.value == 3.0);
  CHECK(censored.infinite == 1);
  CHECK(censored.n == 4);
  CHECK(std::isnan(censored.lo));
  CHECK(std::isnan(censored.hi));
  CHECK(std::isinf(student_interval(std::vector{1.0, infinity, infinity}).value));
  CHECK(std::isinf(student_interval(std::vector{infinity, infinity}).value));

  const Interval single = student_interval(std::vector{4.0});
  CHECK(single.value == 4.0);
  CHECK(single.n == 1);
  CHECK(std::isnan(single.lo));
  const Interval none = student_interval(std::vector{not_a_number});
  CHECK(std::isnan(none.value));
  CHECK(none.n == 0);
  const Interval equal = student_interval(std::vector{2.0, 2.0, 2.0, 2.0, 2.0});
  CHECK(equal.lo == 2.0);
  CHECK(equal.hi == 2.0);
  CHECK_THROWS_AS(student_interval(std::vector{1.0, 2.0}, 1.0), Error);
}

TEST_CASE("Newcombe's interval gives his published figures and never leaves [-1, 1]") {
  // Newcombe 1998, Statistics in Medicine 17, 873-890, table II, method 10.
  const auto check = [](Share a, Share b, double lo, double hi) {
    const Interval i = newcombe_interval(a, b);
    CHECK(i.lo == Approx(lo).margin(5e-5));
    CHECK(i.hi == Approx(hi).margin(5e-5));
    const Interval turned = newcombe_interval(b, a);
    CHECK(turned.lo == Approx(-i.hi));
    CHECK(turned.value == Approx(-i.value));
  };
  check({56, 70}, {48, 80}, 0.0524, 0.3339);
  check({9, 10}, {3, 10}, 0.1705, 0.8090);
  check({10, 10}, {0, 10}, 0.6075, 1.0);
  check({0, 10}, {0, 20}, -0.1611, 0.2775);
  for (std::size_t a = 0; a <= 6; ++a) {
    for (std::size_t b = 0; b <= 6; ++b) {
      const Interval i = newcombe_interval({a, 6}, {b, 6}, 0.999);
      CHECK(i.lo >= -1.0);
      CHECK(i.hi <= 1.0);
    }
  }
  CHECK(std::isnan(newcombe_interval({1, 2}, {0, 0}).value));
}

TEST_CASE("Holm's correction multiplies the smallest p most and keeps their order") {
  // R: p.adjust(c(.01, .02, .03, .04, .05), "holm").
  const auto adjusted = holm(std::vector{0.05, 0.01, not_a_number, 0.03, 0.04, 0.02});
  CHECK(adjusted[1] == Approx(0.05));
  CHECK(adjusted[5] == Approx(0.08));
  CHECK(adjusted[3] == Approx(0.09));
  CHECK(adjusted[4] == Approx(0.09));
  CHECK(adjusted[0] == Approx(0.09));
  CHECK(std::isnan(adjusted[2]));
  CHECK(holm(std::vector{0.7, 0.9}) == std::vector{1.0, 1.0});
  CHECK(holm({}).empty());
}

TEST_CASE("the sign test is the binomial one") {
  CHECK(sign_test(5, 0) == Approx(2.0 / 32));
  CHECK(sign_test(2, 8) == Approx(0.109375));
  CHECK(sign_test(3, 3) == 1.0);
  CHECK(sign_test(0, 0) == 1.0);
}

TEST_CASE("Wilson's interval gives Newcombe's published figures") {
  // Newcombe 1998, Statistics in Medicine 17, table I, method 3.
  const Interval a = wilson_interval(81, 263);
  CHECK(a.value == Approx(81.0 / 263.0));
  CHECK(a.lo == Approx(0.2553).margin(5e-5));
  CHECK(a.hi == Approx(0.3662).margin(5e-5));
  const Interval b = wilson_interval(15, 148);
  CHECK(b.lo == Approx(0.0624).margin(5e-5));
  CHECK(b.hi == Approx(0.1605).margin(5e-5));
  const Interval c = wilson_interval(0, 20);
  CHECK(c.lo == 0.0);
  CHECK(c.hi == Approx(0.1611).margin(5e-5));
  const Interval d = wilson_interval(1, 29);
  CHECK(d.lo == Approx(0.0061).margin(5e-5));
  CHECK(d.hi == Approx(0.1718).margin(5e-5));
  CHECK(wilson_interval(20, 20).hi == 1.0);
  CHECK(std::isnan(wilson_interval(0, 0).value));
  CHECK_THROWS_AS(wilson_interval(3, 2), Error);
  CHECK_THROWS_AS(wilson_interval(1, 2, 0.0), Error);
}

TEST_CASE("The median leaves NaN out and stands infinities") {
  CHECK(median(std::vector{3.0, 1.0, 2.0}) == 2.0);
  CHECK(median(std::vector{4.0, not_a_number, 1.0, 2.0, 3.0}) == 2.5);
  CHECK(median(std::vector{1.0, infinity}) == infinity);
  CHECK(std::isnan(median(std::vector<double>{})));
  CHECK(std::isnan(median(std::vector{not_a_number})));
}

TEST_CASE("the rank correlation is that of the ranks", "[measure]") {
  const auto rho = [](std::vector<double> a, std::vector<double> b) { return rank_correlation(a, b); };
  CHECK(rho({1, 20, 300}, {-3, -2, 5}) == Approx(1.0));
  CHECK(rho({1, 20, 300, 4000}, {9, 8, 7, -1}) == Approx(-1.0));
  // 1 - 6 sum d^2 / (n (n^2 - 1)), without ties.
  CHECK(rho({86, 97, 99, 100, 101, 103, 106, 110, 112, 113}, {2, 20, 28, 27, 50, 29, 7, 17, 6, 12}) ==
        Approx(-29.0 / 165.0));
  // Ties share their mean rank: the ranks 1.5, 1.5, 3 against 1, 2, 3.
  CHECK(rho({1, 1, 2}, {1, 2, 3}) == Approx(std::sqrt(3.0) / 2.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(rho({1, nan, 2, 3}, {1, 7, 2, 3}) == Approx(1.0));
  CHECK(std::isnan(rho({1, 2}, {1, 2})));
  CHECK(std::isnan(rho({1, 2, nan}, {1, 2, 3})));
  CHECK(std::isnan(rho({1, 1, 1}, {1, 2, 3})));
  CHECK_THROWS_AS(rho({1, 2, 3}, {1, 2}), Error);
}
