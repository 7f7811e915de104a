// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <memory>
#include <thread>

#include <trellis/scene/set_up_cache.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

struct SmallWorld {
  std::shared_ptr<const int> shared = std::make_shared<const int>(0);
  [[nodiscard]] std::shared_ptr<const void> identity() const { return shared; }
};

constexpr auto spend_time = std::chrono::milliseconds(2);
constexpr double paused = 0.002;

}  // namespace

TEST_CASE("each run reports what the shared set-ups took that it uses, and the first spends it", "[scene]") {
  SetUpCache<int> inner;
  SetUpCache<int> outer;
  const SmallWorld world;
  int computed = 0;
  const auto inner_of = [&] {
    return *inner.get(world, [&](const SmallWorld&) {
      std::this_thread::sleep_for(spend_time);
      return ++computed;
    });
  };
  const auto outer_of = [&] {
    return *outer.get(world, [&](const SmallWorld&) {
      std::this_thread::sleep_for(spend_time);
      return 10 + inner_of();
    });
  };
  const auto run = [&](SharedSetUps& of, int uses) {
    const SharedSetUpsScope recorded(&of);
    for (int i = 0; i < uses; ++i) CHECK(outer_of() == 11);
  };
  SharedSetUps first;
  SharedSetUps second;
  SharedSetUps none;
  run(first, 1);
  run(second, 3);
  run(none, 0);
  CHECK(computed == 1);
  // The sum of both, each counted once, however often they are used.
  CHECK(first.seconds() >= 2.0 * paused);
  CHECK(second.seconds() == first.seconds());
  CHECK(first.spent() >= first.seconds());
  CHECK(none.seconds() == 0.0);
  CHECK(none.spent() == 0.0);

  // A run that uses the inner one alone does not report the other.
  SharedSetUps third;
  {
    const SharedSetUpsScope recorded(&third);
    CHECK(inner_of() == 1);
  }
  CHECK(third.seconds() >= paused);
  CHECK(third.seconds() <= first.seconds() - paused);
}

TEST_CASE("a run that computes its own set-ups shares none", "[scene]") {
  SetUpCache<int> cache;
  const SmallWorld world;
  OwnSetUps own;
  SharedSetUps shared;
  const OwnSetUpsScope unshared(&own);
  const SharedSetUpsScope recorded(&shared);
  CHECK(*cache.get(world, [](const SmallWorld&) { return 5; }) == 5);
  CHECK(*cache.get(world, [](const SmallWorld&) { return 6; }) == 5);
  CHECK(shared.seconds() == 0.0);
  CHECK(shared.spent() == 0.0);
}
