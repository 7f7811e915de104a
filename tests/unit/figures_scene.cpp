// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of the samples in the world, as files.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/draw/planar.hpp>
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

Measure quick_measure() {
  TubeSettings tube;
  tube.points = 256;
  tube.pool = 1024;
  return {.target = tube, .cross = 0};
}

/// The problem of a robot that is two boxes and a disc among a disc and a triangle.
Problem odd_problem() {
  World world({{0, 0}, {6, 4}}, {{"disc", Disc{{3, 1}, 0.5}}, {"triangle", Polygon{{{2.5, 2.5}, {3.5, 2.5}, {3, 4}}}}});
  Robot robot = Robot::rigid({Box2{{-0.2, -0.1}, {0.2, 0.1}}, Box2{{-0.1, -0.2}, {0.1, 0.2}}, Disc{{0.2, 0.0}, 0.1}});
  return test::make_problem("odd", std::move(world), std::move(robot), {0.6, 0.6, 0.3}, {5.6, 3.6, 1.0});
}

Configurations at(const std::vector<Configuration>& rows) {
  Configurations all(3);
  for (const Configuration& q : rows) all.push(q);
  return all;
}

/// A run with these samples, made by hand.
RunResult run_of(const std::string& strategy, std::uint64_t seed, const std::vector<Configuration>& nodes,
                 const std::vector<Configuration>& proposals, const std::vector<Configuration>& path) {
  RunResult run{"odd", strategy, seed, {}, {}, {}};
  run.run.solved = !path.empty();
  run.run.status = run.run.solved ? Status::solved : Status::budget_spent;
  run.run.path = at(path);
  LevelResult root{.record = fixture::level(0, "0", "root", odd_problem().space, "rrt", 0, run.run.solved)};
  root.record.position_axes = {0, 1};
  root.record.search.nodes = at(nodes);
  root.record.search.proposals = at(proposals);
  run.levels.push_back(std::move(root));
  return run;
}

Files formats(const std::vector<std::string>& stems) {
  Files files;
  for (const std::string& stem : stems) {
    for (const char* format : {".svg", ".png", ".pdf"}) files.insert(stem + format);
  }
  return files;
}

}  // namespace

TEST_CASE("every strategy has a picture of its samples, and guides have theirs", "[report][scene-figures][slow]") {
  Experiment experiment;
  experiment.problems = {test::simple_passage_problem()};
  experiment.strategies = {{"rrt", fixture::plain()}, {"nested", fixture::nested()}};
  experiment.seeds = {1, 2};
  experiment.measure = quick_measure();
  const ExperimentResult result = run(experiment);
  const Folder folder;
  CHECK(write_scene_figures(experiment, result, folder.path().string()).empty());
  CHECK(folder.files() ==
        formats({"simple_passage/rrt/samples", "simple_passage/nested/samples", "simple_passage/nested/levels"}));
  check_pictures(folder);

  SECTION("the same bytes the second time") {
    const Folder again;
    write_scene_figures(experiment, result, again.path().string());
    for (const std::string& file : folder.files()) {
      CAPTURE(file);
      const bool same = read(folder.path() / file) == read(again.path() / file);
      CHECK(same);
    }
  }
  SECTION("the colours are the paper's where they are asked for") {
    const Folder paper;
    write_scene_figures(experiment, result, paper.path().string(), {.colours = draw::RoleColours::paper});
    CHECK(paper.files() == folder.files());
    for (const std::string& file : folder.files()) {
      CAPTURE(file);
      const bool same = read(folder.path() / file) == read(paper.path() / file);
      CHECK_FALSE(same);
    }
  }
  SECTION("a scale bar where it is asked for") {
    const Folder scaled;
    FigureStyle style;
    style.scale_bar = true;
    write_scene_figures(experiment, result, scaled.path().string(), {.style = style});
    CHECK(scaled.files() == folder.files());
    const std::string file = "simple_passage/rrt/samples.svg";
    CHECK(read(scaled.path() / file).size() > read(folder.path() / file).size());
    check_pictures(scaled);
  }
  SECTION("the target's points are those that the runs were scored on") {
    for (const RunResult& run : result.runs) {
      REQUIRE(run.run.solved);
      REQUIRE(run.target.size() == 1024);
      const Space& space = experiment.problems[0].space;
      for (std::size_t i = 0; i < run.target.size(); i += 64) {
        const View q = run.target[i];
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t k = 1; k < run.run.path.size(); ++k) {
          for (double t = 0.0; t <= 1.0; t += 1.0 / 64.0) {
            Configuration p(3);
            space.interpolate(run.run.path[k - 1], run.run.path[k], t, p);
            nearest = std::min(nearest, std::hypot(p[0] - q[0], p[1] - q[1]));
          }
        }
        CHECK(nearest < 0.51);
      }
    }
  }
  SECTION("on two threads the pictures are the same") {
    const Folder other;
    write_scene_figures(experiment, result, other.path().string(), {.jobs = 2});
    REQUIRE(other.files() == folder.files());
    for (const std::string& file : folder.files()) {
      if (!file.ends_with(".pdf")) CHECK((read(folder.path() / file) == read(other.path() / file)));
    }
  }
  SECTION("a cell out of range") {
    for (const double cell : {0.0, -1.0, 1e-3, std::nan("")}) {
      CHECK_THROWS_AS(write_scene_figures(experiment, result, folder.path().string(), {.cell = cell}), Error);
    }
    const Folder coarse;
    write_scene_figures(experiment, result, coarse.path().string(), {.cell = 2.0});
    const std::string file = "simple_passage/rrt/samples.svg";
    CHECK(read(coarse.path() / file).size() < read(folder.path() / file).size());
  }
}

TEST_CASE("circles are the mean over the seeds, beside the baseline's", "[report][scene-figures]") {
  Experiment experiment;
  experiment.problems = {odd_problem()};
  experiment.strategies = {{"mine", fixture::plain()}, {"other", fixture::plain()}};
  experiment.seeds = {1, 2};
  experiment.measure.reset();
  experiment.baseline = "other";
  const Configuration start = {0.6, 0.6, 0.3};
  const Configuration goal = {5.6, 3.6, 1.0};
  ExperimentResult result;
  // The same cell whatever the angle; the world's upper right corner; one outside of the world; a corner of four cells.
  result.runs.push_back(
      run_of("mine", 1, {start, {0.6, 0.6, 3.0}, goal}, {{6.0, 4.0, 0.0}, {6.5, 1.0, 0.0}}, {start, goal}));
  result.runs.push_back(run_of("mine", 2, {start}, {{1.0, 1.0, 0.0}}, {}));
  result.runs.push_back(run_of("other", 1, {start, {2.2, 0.2, 0.0}}, {}, {}));
  result.runs.push_back(run_of("other", 2, {start}, {}, {}));
  const Folder folder;
  CHECK(write_scene_figures(experiment, result, folder.path().string()).empty());
  CHECK(folder.files() == formats({"odd/mine/samples", "odd/other/samples"}));
  check_pictures(folder);

  // Text is drawn as outlines, so the picture is compared as a whole with one made from plain numbers.
  draw::PlanarFigure figure;
  figure.title = "mine on odd: where its samples lie";
  figure.caption =
      "Circles: samples in each cell of 0.5 m x 0.5 m of a world of 6 m x 4 m, the mean over 2 seeds; areas are "
      "proportional to it, in each panel to a scale of its own. Samples outside of the world are not drawn.";
  figure.world = {0, 0, 6, 4};
  figure.cell = 0.5;
  figure.obstacles = {draw::WorldDisc{{3, 1}, 0.5}, std::vector<draw::Point>{{2.5, 2.5}, {3.5, 2.5}, {3, 4}}};
  const auto robot = [](const Configuration& q) {
    const double c = std::cos(q[2]);
    const double s = std::sin(q[2]);
    const auto place = [&](double x, double y) { return draw::Point{q[0] + c * x - s * y, q[1] + s * x + c * y}; };
    const auto box = [&](double x, double y) {
      return std::vector<draw::Point>{place(-x, -y), place(x, -y), place(x, y), place(-x, y)};
    };
    return std::vector<draw::WorldShape>{box(0.2, 0.1), box(0.1, 0.2), draw::WorldDisc{place(0.2, 0.0), 0.1}};
  };
  figure.start = robot(start);
  figure.goal = robot(goal);
  const auto cells = [](const std::vector<std::pair<std::size_t, double>>& counts) {
    std::vector<double> mean(12 * 8, 0.0);
    for (const auto& [cell, count] : counts) mean[cell] = count;
    return mean;
  };
  const draw::CircleLayer tree{"tree", draw::Role::tree, cells({{13, 1.5}, {7 * 12 + 11, 0.5}})};
  const draw::CircleLayer expansion{"expansion", draw::Role::expansion,
                                    cells({{7 * 12 + 11, 0.5}, {13, 0.125}, {14, 0.125}, {25, 0.125}, {26, 0.125}})};
  const draw::CircleLayer baseline{"tree of other", draw::Role::baseline, cells({{13, 1.0}, {4, 0.5}})};
  figure.panels = {{.title = "paths of 1 of 2 seeds", .paths = {{{0.6, 0.6}, {5.6, 3.6}}}},
                   {.title = "tree: 2.0 nodes", .layers = {tree}},
                   {.title = "expansion: 1.5 proposals", .layers = {expansion}},
                   {.title = "tree of other: 1.5 nodes", .layers = {baseline}},
                   {.title = "all, to one scale", .layers = {tree, expansion, baseline}}};
  const auto same = [&] {
    return draw::plot(figure).render(draw::Format::svg) == read(folder.path() / "odd/mine/samples.svg");
  };
  CHECK(same());
  figure.panels[1].layers[0].mean[13] = 1.0;
  CHECK_FALSE(same());
}

TEST_CASE("without a path there is no target, and the rest is drawn", "[report][scene-figures]") {
  Experiment experiment;
  experiment.problems = {odd_problem()};
  experiment.strategies = {{"rrt", fixture::plain()}};
  experiment.seeds = {1};
  experiment.measure = quick_measure();
  ExperimentResult result;
  SECTION("one run that failed") { result.runs.push_back(run_of("rrt", 1, {{0.5, 0.5, 0.3}}, {}, {})); }
  SECTION("a run that has no samples at all") { result.runs.push_back(run_of("rrt", 1, {}, {}, {})); }
  SECTION("a run without levels") { result.runs.push_back({"odd", "rrt", 1, {}, {}}); }
  const Folder folder;
  CHECK(write_scene_figures(experiment, result, folder.path().string()).empty());
  CHECK(folder.files() == formats({"odd/rrt/samples"}));
  check_pictures(folder);
}

TEST_CASE("targets of every kind are drawn or left out", "[report][scene-figures]") {
  Experiment experiment;
  experiment.problems = {odd_problem()};
  experiment.strategies = {{"rrt", fixture::plain()}};
  experiment.seeds = {1, 2};
  SECTION("near the optimum") {
    NearOptimalSettings near;
    near.points = near.pool = 256;
    near.nodes = 1000;
    experiment.measure = Measure{.target = near, .cross = 0};
  }
  SECTION("progress, which is not in the world") {
    experiment.measure = Measure{.target = ProgressSettings{}, .cross = 0};
  }
  SECTION("the user's") {
    UserTarget target;
    target.points = target.pool = 256;
    target.make = [](const UserTarget::Context& context) {
      Target::Distribution distribution{Configurations(3), [](View) { return 0.0; }};
      Stream stream(context.seed, "", "");
      Configuration q(3);
      for (std::int64_t i = 0; i < context.draws; ++i) {
        context.problem.space.sample_uniform(stream, q);
        distribution.samples.push(q);
      }
      return distribution;
    };
    experiment.measure = Measure{.target = target, .cross = 0};
  }
  const ExperimentResult result = run(experiment);
  const Folder folder;
  CHECK(write_scene_figures(experiment, result, folder.path().string()).empty());
  CHECK(folder.files() == formats({"odd/rrt/samples"}));
  check_pictures(folder);
}

TEST_CASE("problems without a place in the plane are left out, with a word", "[report][scene-figures]") {
  Experiment experiment;
  Body link;
  link.parts = {Polygon{{{0, -0.05}, {1, -0.05}, {1, 0.05}, {0, 0.05}}}};
  link.angle_axis = 0;
  Body second = link;
  second.parent = 0;
  second.joint = {1, 0};
  second.angle_axis = 1;
  experiment.problems = {test::make_problem("arm", World({{0, 0}, {10, 10}}, {}),
                                            Robot("arm", {link, second}, false, {5, 5}), {0, 0}, {1, 1}),
                         test::simple_passage_problem(), fixture::problem("no world")};
  experiment.strategies = {{"rrt", fixture::plain()}};
  experiment.seeds = {1};
  experiment.measure = quick_measure();
  Experiment possible = experiment;
  possible.problems.pop_back();
  const ExperimentResult result = run(possible);
  const Folder folder;
  const auto notes = write_scene_figures(experiment, result, folder.path().string());
  REQUIRE(notes.size() == 2);
  CHECK(notes[0] == "arm: no picture of its samples, its robot has no position in the plane");
  CHECK(notes[1].starts_with("no world: "));
  CHECK(folder.files() == formats({"simple_passage/rrt/samples"}));
}

TEST_CASE("worlds of any size have a sensible number of cells", "[report][scene-figures]") {
  for (const double side : {0.01, 1.0, 37.0, 1e4}) {
    CAPTURE(side);
    World world({{0, 0}, {side, 0.4 * side}}, {});
    Experiment experiment;
    experiment.problems = {test::make_problem("p", std::move(world), Robot::disc(0.01 * side), {0.1 * side, 0.1 * side},
                                              {0.9 * side, 0.3 * side})};
    experiment.strategies = {{"rrt", {PlannerSpec::make("rrt", {{"step", 0.1 * side}})}}};
    experiment.seeds = {1};
    experiment.measure.reset();
    const Folder folder;
    write_scene_figures(experiment, run(experiment), folder.path().string());
    CHECK(folder.files() == formats({"p/rrt/samples"}));
    CHECK(read(folder.path() / "p/rrt/samples.svg").size() < 2'000'000);
    check_pictures(folder);
  }
}
