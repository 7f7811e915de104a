// SPDX-License-Identifier: GPL-3.0-or-later
// Guides that use the files of earlier runs.
#include <algorithm>
#include <string>

#include <trellis/memory/library.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// A wall with a narrow gap.
Problem crossing() {
  return test::make_problem("crossing", test::rectangle_world({{4.8, 0, 5.2, 1.0}, {4.8, 1.5, 5.2, 10}}),
                            test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
}

}  // namespace

SCENARIO("runs of one process see one state of a library", "[memory][experience]") {
  GIVEN("a library that a run has read") {
    const test::Folder folder;
    const std::string file = folder.file("paths.db");
    const Problem problem = crossing();
    Library library(file, Library::Mode::write);
    const StrategySpec guided =
        GuideSpec::make("experience", {{"db", file}}) >> PlannerSpec::make("rrt", {{"step", 0.5}});
    const RunRecord first = execute(guided, problem, 1);
    REQUIRE(first.solved);
    WHEN("its path is added") {
      REQUIRE(library.add(stored_path(problem, first.path), problem.space, 0.0));
      THEN("the same run is the same again") {
        const RunRecord again = execute(guided, problem, 1);
        CHECK(again.validity_checks == first.validity_checks);
        CHECK(std::equal(again.path.values().begin(), again.path.values().end(), first.path.values().begin(),
                         first.path.values().end()));
      }
    }
  }
}
