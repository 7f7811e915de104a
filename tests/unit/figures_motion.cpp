// SPDX-License-Identifier: GPL-3.0-or-later
// Motions in spaces of two dimensions, as files.
#include <string>

#include <trellis/figures/scene_figures.hpp>
#include <trellis/report/report.hpp>

#include "report_fixture.hpp"
#include "report_folder.hpp"
#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using fixture::check_pictures;
using fixture::Files;
using fixture::Folder;
using fixture::read;

namespace {

Problem arm_problem() {
  const Arm arm{.links = {2.4, 2}, .widths = {0.25, 0.25}, .base = {5, 5}};
  return test::make_problem("arm", test::rectangle_world({{6.2, 7, 8.2, 8.2}, {6.8, 2.2, 8, 3.6}}), Robot::arm(arm),
                            {1.9, 0.4}, {-0.9, -0.5});
}

Files formats(const std::string& stem) { return {stem + ".svg", stem + ".png", stem + ".pdf"}; }

Experiment experiment_on(std::vector<Problem> problems) {
  Experiment experiment;
  experiment.problems = std::move(problems);
  experiment.strategies = {{"lazy", GuideSpec::make("lazy", {}) >> PlannerSpec::make("rrt", {{"step", 0.2}})}};
  experiment.seeds = {1};
  experiment.measure.reset();
  return experiment;
}

}  // namespace

TEST_CASE("robots whose space is a plane or a torus have pictures of it", "[report][motion-figures]") {
  const Problem disc = test::make_problem("disc", test::rectangle_world(test::cup()), Robot::disc(0.3), {1, 5}, {9, 5});
  const Experiment experiment = experiment_on({arm_problem(), disc, test::point_problem(3), test::cup_problem()});
  const ExperimentResult result = run(experiment);
  const Folder folder;
  write_motion_figures(experiment, result, folder.path().string());
  // A point's space is the workspace, and an SE(2) has three dimensions.
  Files expected = formats("arm/lazy/motion");
  expected.merge(formats("disc/lazy/motion"));
  CHECK(folder.files() == expected);
  check_pictures(folder);

  SECTION("the same bytes on two threads") {
    const Folder again;
    write_motion_figures(experiment, result, again.path().string(), 2);
    CHECK((read(folder.path() / "arm/lazy/motion.svg") == read(again.path() / "arm/lazy/motion.svg")));
  }
  SECTION("what guides has a row of its own") {
    Experiment plain = experiment;
    plain.strategies = {{"lazy", {PlannerSpec::make("rrt", {{"step", 0.2}})}}};
    const Folder other;
    write_motion_figures(plain, run(plain), other.path().string());
    CHECK(read(other.path() / "arm/lazy/motion.svg").size() < read(folder.path() / "arm/lazy/motion.svg").size());
  }
}

TEST_CASE("a run without levels or a path has no picture of a motion, or the path to the nearest node",
          "[report][motion-figures][slow]") {
  Experiment experiment = experiment_on({arm_problem()});
  ExperimentResult result;
  result.runs.push_back({"arm", "lazy", 1, {}, {}});
  const Folder none;
  write_motion_figures(experiment, result, none.path().string());
  CHECK(none.files().empty());

  experiment.strategies = {{"lazy", {PlannerSpec::make("rrt", {{"step", 0.2}, {"proposals", 5.0}})}}};
  const Folder some;
  write_motion_figures(experiment, run(experiment), some.path().string());
  CHECK(some.files() == formats("arm/lazy/motion"));
  check_pictures(some);
}
