// SPDX-License-Identifier: GPL-3.0-or-later
// What earlier runs are worth to later ones, and where they mislead.
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/memory/library.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/families.hpp"

using namespace trellis;

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t seeds = 30;

/// A folder of this test's own, gone when it ends.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "trellis-memory-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

PlannerSpec planner() { return PlannerSpec::make("rrt", {{"step", 0.5}, {"proposals", std::int64_t{20000}}}); }

/// The ratio of validity checks of two strategies, seed by seed, in order; each run on the problem of its seed. A run
/// without a path has spent all that there is.
std::vector<double> ratios(const StrategySpec& a, const StrategySpec& b,
                           const std::function<Problem(std::uint64_t)>& on) {
  std::vector<double> all;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto spent = [&](const StrategySpec& strategy) {
      const RunRecord run = execute(strategy, on(seed), seed);
      return static_cast<double>(run.validity_checks) * (run.solved ? 1.0 : 10.0);
    };
    const double first = spent(a);
    all.push_back(first / spent(b));
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// The ends of the 95 % interval of the median of 30 values: the 10th and the 21st (sign test).
double lower_end(const std::vector<double>& sorted) { return sorted.at(9); }
double upper_end(const std::vector<double>& sorted) { return sorted.at(20); }

/// A wall with a narrow gap, and whatever else stands in the rooms.
World room(double gap, const test::Rectangles& more = {}) {
  test::Rectangles all = {{4.8, 0, 5.2, gap}, {4.8, gap + 0.5, 5.2, 10}};
  all.insert(all.end(), more.begin(), more.end());
  return test::rectangle_world(all);
}

Problem crossing(const World& world) {
  return test::make_problem("crossing", world, test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
}

}  // namespace

SCENARIO("a library of solved problems saves checks where the world is much the same, and costs some where it is not",
         "[memory][experience]") {
  GIVEN("the paths of three runs through a wall's gap") {
    const Folder folder;
    const std::string file = folder.file("paths.db");
    const Problem before = crossing(room(1.0));
    {
      Library library(file, Library::Mode::write);
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const RunRecord run = execute(PlannerSpec::make("rrt_connect", {}), before, 100 + seed, {200, {}, {}});
        REQUIRE(run.solved);
        static_cast<void>(library.add(stored_path(before, run.path), before.space, 0.0));
      }
      REQUIRE(library.paths().size() == 3);
    }
    const StrategySpec plain = planner();
    const StrategySpec guided = GuideSpec::make("experience", {{"db", file}}) >> planner();
    WHEN("boxes stand in the rooms that were not there") {
      const World changed = room(1.0, {{2.4, 2.4, 3.4, 3.4}, {6.8, 2.4, 7.8, 3.4}});
      const auto found = ratios(guided, plain, [&](std::uint64_t) { return crossing(changed); });
      THEN("it spends fewer validity checks than the planner alone") {
        CAPTURE(lower_end(found), upper_end(found));
        CHECK(upper_end(found) < 1.0);
      }
    }
    WHEN("the gap is elsewhere") {
      const World other = room(8.5);
      const auto found = ratios(guided, plain, [&](std::uint64_t) { return crossing(other); });
      THEN("it spends more") {
        CAPTURE(lower_end(found), upper_end(found));
        CHECK(lower_end(found) > 1.0);
      }
    }
  }
}

SCENARIO("a learnt heuristic saves checks in worlds of its family, and costs some in those of another",
         "[memory][learned]") {
  GIVEN("a model that was trained on walls with gaps in their upper halves") {
    const Folder folder;
    const std::string file = folder.file("gaps.model");
    std::vector<LearningTask> tasks;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const Problem problem = test::upper_gaps(1000 + seed);
      tasks.push_back({problem.name, problem.scene->world, {0.5, 5.0}, {9.5, 5.0}});
    }
    TrainingSettings settings;
    settings.cells = 50;
    settings.samples = 300;
    std::ofstream(file, std::ios::binary) << Model::train(tasks, settings, "upper gaps").bytes();
    const StrategySpec plain = planner();
    const StrategySpec guided = GuideSpec::make("learned", {{"model", file}}) >> planner();
    WHEN("the worlds are others of the same family") {
      const auto found = ratios(guided, plain, test::upper_gaps);
      THEN("it spends fewer validity checks than the planner alone") {
        CAPTURE(lower_end(found), upper_end(found));
        CHECK(upper_end(found) < 0.8);
      }
    }
    WHEN("their gaps are in the lower halves") {
      const auto found = ratios(guided, plain, test::lower_gaps);
      THEN("it spends more") {
        CAPTURE(lower_end(found), upper_end(found));
        CHECK(lower_end(found) > 1.0);
      }
    }
  }
}

SCENARIO("runs of one process see one state of a library", "[memory][experience]") {
  GIVEN("a library that a run has read") {
    const Folder folder;
    const std::string file = folder.file("paths.db");
    const Problem problem = crossing(room(1.0));
    Library library(file, Library::Mode::write);
    const StrategySpec guided = GuideSpec::make("experience", {{"db", file}}) >> planner();
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
