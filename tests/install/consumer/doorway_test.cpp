// SPDX-License-Identifier: GPL-3.0-or-later
// A user's scenario test of a script beside it.
#define CATCH_CONFIG_MAIN
#include <trellis/testing.hpp>

using namespace trellis::testing;

SCENARIO("regions find the doorway") {
  GIVEN("the script of the doorway") {
    const Script script = load(DOORWAY);
    WHEN("both strategies run on 10 seeds") {
      const Trial guided = script.trial("guided", seeds(10));
      const Trial planner = script.trial("planner", seeds(10));
      THEN("the guided one solves it by fewer checks") {
        CHECK_THAT(guided, Solves(at_least(0.9)));
        CHECK_THAT(guided, Spends(below(planner).validity_checks()));
      }
    }
  }
}
