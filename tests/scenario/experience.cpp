// SPDX-License-Identifier: GPL-3.0-or-later
// Where the experience of earlier runs saves checks, and where it misleads: validity checks of 30 runs relative to the
// same planner without it.
#include <cstdint>
#include <string>
#include <vector>

#include <trellis/memory/library.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/families.hpp"
#include "support/folder.hpp"
#include "support/trials.hpp"

using namespace trellis;
using namespace trellis::test;
using namespace trellis::testing;

namespace {

/// A wall with a narrow gap, and further obstacles in the rooms.
Problem crossing(double gap, const Rectangles& more = {}) {
  Rectangles all = {{4.8, 0, 5.2, gap}, {4.8, gap + 0.5, 5.2, 10}};
  all.insert(all.end(), more.begin(), more.end());
  return boxes("crossing", all, {1, 5, 0}, {9, 5, 0});
}

}  // namespace

SCENARIO("experience: a world that is much the same, and one that is not", "[catalogue][experience]") {
  GIVEN("the paths of three runs through a wall's gap") {
    const Folder folder;
    const std::string file = folder.file("paths.db");
    const Problem before = crossing(1.0);
    {
      Library library(file, Library::Mode::write);
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const RunRecord run = execute(PlannerSpec::make("rrt_connect", {}), before, 100 + seed, {200, {}, {}});
        REQUIRE(run.solved);
        static_cast<void>(library.add(stored_path(before, run.path), before.space, 0.0));
      }
      REQUIRE(library.paths().size() == 3);
    }
    const StrategySpec guided = guide("experience", {{"db", file}}) >> tree();
    WHEN("boxes stand in the rooms that were not there") {
      const Problem problem = crossing(1.0, {{2.4, 2.4, 3.4, 3.4}, {6.8, 2.4, 7.8, 3.4}});
      THEN("it saves checks, however its paths are followed: what is valid of them is not checked again") {
        const Trial plain = tried(tree(), problem);
        for (const std::string follow : {"waypoints", "steps"}) {
          const StrategySpec followed = guide("experience", {{"db", file}, {"follow", follow}}) >> trusting(tree());
          CHECK_THAT(tried(followed, problem), Spends(below(plain).validity_checks()));
        }
      }
    }
    WHEN("the gap is elsewhere") {
      const Problem problem = crossing(8.5);
      THEN("it costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(tried(guided, problem), LosesLittle(plain));
      }
    }
  }
}

SCENARIO("learned: worlds of the family that it was learnt of, and those of another", "[catalogue][experience][slow]") {
  GIVEN("a model that was trained on walls with gaps in their upper halves") {
    std::vector<LearningTask> tasks;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const Problem problem = upper_gaps(1000 + seed);
      tasks.push_back({problem.name, planar(*problem.scene).world, {0.5, 5.0}, {9.5, 5.0}});
    }
    TrainingSettings settings;
    settings.cells = 50;
    settings.samples = 300;
    static const std::string model = Model::train(tasks, settings, "upper gaps").bytes();
    const Folder folder;
    const GuideSpec learned = guide("learned", {{"model", folder.write("gaps.model", model)}});
    WHEN("the worlds are others of the same family") {
      THEN("it saves checks") {
        for (const Problem& problem : {upper_gaps(1), upper_gaps(2)}) {
          CHECK_THAT(tried(learned >> trusting(tree()), problem),
                     Spends(below(tried(tree(), problem)).validity_checks()));
        }
      }
    }
    WHEN("their gaps are in the lower halves") {
      THEN("it costs checks") {
        for (const Problem& problem : {lower_gaps(1), lower_gaps(2)}) {
          const Trial plain = tried(tree(), problem);
          CHECK_THAT(tried(learned >> trusting(tree()), problem), Spends(above(plain).validity_checks()));
          CHECK_THAT(tried(learned >> tree(), problem), LosesLittle(plain));
        }
      }
    }
  }
}
