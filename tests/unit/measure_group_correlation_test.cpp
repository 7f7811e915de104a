// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/measure/group_correlation.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Groups whose values differ by much more than those of one group do: b = sign * a within each, and larger b with
/// larger a between them.
std::vector<PairGroup> ordered(double sign, std::size_t count) {
  std::vector<PairGroup> groups;
  for (std::size_t g = 0; g < count; ++g) {
    const double offset = 100.0 * static_cast<double>(g);
    PairGroup& group = groups.emplace_back();
    for (const double a : {1.0, 2.0, 3.0, 4.0}) {
      group.a.push_back(offset + a);
      group.b.push_back(offset + sign * a * a);
    }
  }
  return groups;
}

/// Independent values, or with a common part.
std::vector<PairGroup> drawn(Stream& random, std::size_t count, std::size_t size, double common) {
  std::vector<PairGroup> groups(count);
  for (PairGroup& group : groups) {
    for (std::size_t i = 0; i < size; ++i) {
      const double shared = random.normal();
      group.a.push_back(common * shared + random.normal());
      group.b.push_back(common * shared + random.normal());
    }
  }
  return groups;
}

}  // namespace

TEST_CASE("ranks share their mean where values are equal") {
  CHECK(ranks(std::vector{3.0, 1.0, 3.0, infinity, -infinity}) == std::vector{3.5, 2.0, 3.5, 5.0, 1.0});
  CHECK(ranks(std::vector<double>{}).empty());
}

TEST_CASE("a correlation within groups does not see differences between them") {
  for (const double sign : {1.0, -1.0}) {
    const GroupCorrelation found = group_rank_correlation(ordered(sign, 6));
    CHECK(found.rho.value == Approx(sign));
    CHECK(found.rho.lo == Approx(sign));
    CHECK(found.rho.hi == Approx(sign));
    CHECK(found.rho.n == 6);
  }
  // Of one group it is Spearman's.
  const PairGroup one{{1, 2, 3, 4, 5, 5}, {2, 1, 4, 3, 7, infinity}};
  CHECK(group_rank_correlation(std::vector{one}).rho.value == Approx(rank_correlation(one.a, one.b)));
}

TEST_CASE("infinite values rank as the largest, and pairs with a NaN are left out") {
  const PairGroup with{{1, 2, not_a_number, 3, 4}, {0.0, 1.0, 2.0, infinity, infinity}};
  const PairGroup without{{1, 2, 3, 4}, {0.0, 1.0, 9.0, 9.0}};
  CHECK(group_rank_correlation(std::vector{with}).rho.value ==
        Approx(group_rank_correlation(std::vector{without}).rho.value));
}

TEST_CASE("groups without an order do not count") {
  std::vector<PairGroup> groups = ordered(1.0, 1);
  groups.push_back({{1, 2, 3}, {infinity, infinity, infinity}});  // nothing to order
  groups.push_back({{1, 1, 1}, {1, 2, 3}});
  groups.push_back({{1, 2}, {2, 1}});
  groups.push_back({{1, 2, not_a_number}, {2, 1, 3}});
  const GroupCorrelation found = group_rank_correlation(groups);
  CHECK(found.rho.value == Approx(1.0));
  CHECK(found.rho.n == 1);
  CHECK(found.groups == 5);
  CHECK(std::isnan(found.rho.lo));  // fewer than six groups count
  groups.erase(groups.begin());
  CHECK(std::isnan(group_rank_correlation(groups).rho.value));
  CHECK(std::isnan(group_rank_correlation({}).rho.value));
  CHECK_THROWS_AS(group_rank_correlation(std::vector<PairGroup>{{{1, 2}, {1}}}), Error);
}

TEST_CASE("a difference of correlations is of the same samples of groups") {
  Stream random(7, "", "test");
  const auto groups = drawn(random, 8, 6, 1.0);
  const GroupCorrelation a = group_rank_correlation(groups);
  const Interval none = correlation_difference(a, group_rank_correlation(groups));
  CHECK(none.value == 0.0);
  CHECK(none.lo == 0.0);
  CHECK(none.hi == 0.0);
  const Interval two =
      correlation_difference(group_rank_correlation(ordered(1.0, 8)), group_rank_correlation(ordered(-1.0, 8)));
  CHECK(two.value == Approx(2.0));
  CHECK(two.lo == Approx(2.0));
  CHECK_THROWS_AS(correlation_difference(a, group_rank_correlation(ordered(1.0, 7))), Error);
}

TEST_CASE("the interval holds the correlation as often as it says, over independent groups") {
  // The expected rank correlation of 7 pairs with a normal correlation of one half: 0.428 by simulation.
  for (const auto& [common, truth] : {std::pair{0.0, 0.0}, std::pair{1.0, 0.428}}) {
    for (const std::size_t count : {10U, 20U}) {
      Stream random(11, "", "coverage");
      std::size_t holds = 0;
      constexpr std::size_t repetitions = 200;
      for (std::size_t i = 0; i < repetitions; ++i) {
        const Interval rho = group_rank_correlation(drawn(random, count, 7, common)).rho;
        holds += rho.lo <= truth && truth <= rho.hi ? 1 : 0;
      }
      CAPTURE(common, count, holds);
      CHECK(holds >= 180);  // of 190 expected; a percentile interval that is not expanded holds fewer
      CHECK(holds < repetitions);
    }
  }
}
