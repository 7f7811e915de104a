// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of teams: each robot where it is, in its colour.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/draw/palette.hpp>
#include <trellis/figures/gltf.hpp>
#include <trellis/figures/html.hpp>
#include <trellis/figures/scene_figures.hpp>
#include <trellis/figures/schedule_figures.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/pictures/traces.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

#include "report_fixture.hpp"
#include "report_folder.hpp"
#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using fixture::Folder;
using fixture::read;
using Json = nlohmann::json;

namespace {

/// Three discs, of which the first and the last change places.
Problem three_discs() {
  return test::make_problem("three", World({{0, 0}, {10, 6}}, {}),
                            Robot::team({Robot::disc(0.4), Robot::disc(0.5), Robot::disc(0.6)}), {1, 1, 5, 5, 9, 1},
                            {9, 1, 5, 3, 1, 1});
}

Experiment prioritised() {
  Experiment experiment;
  experiment.problems = {three_discs()};
  experiment.strategies = {
      {"one by one", GuideSpec::make("prioritise", {}) >> PlannerSpec::make("rrt_connect", {{"bound", 0.0}})}};
  experiment.seeds = {1, 2};
  return experiment;
}

/// An arm of two links at a place of the ground, which turns about the vertical.
SphereModel arm_at(double x) {
  const Solid ball{Sphere{0.1}, {{0.5, 0, 0}, {}}};
  std::vector<Link> links = {{"base", {}}, {"lower", {ball}}, {"upper", {ball}}};
  std::vector<Joint> joints(2);
  joints[0] = {.name = "a", .kind = Joint::Kind::continuous, .parent = 0, .child = 1, .axis = {0, 0, 1}};
  joints[1] = {.name = "b", .kind = Joint::Kind::continuous, .parent = 1, .child = 2, .axis = {0, 0, 1}};
  joints[1].origin = {{1, 0, 0}, {}};
  return SphereModel(Manipulator(KinematicTree("arm", std::move(links), std::move(joints)), {0, 1}))
      .based_at({{x, 0, 0.5}, {}});
}

}  // namespace

TEST_CASE("a team has a trace for each robot, and levels of one robot have that of theirs", "[report][team]") {
  const Experiment experiment = prioritised();
  const auto root = traces_of(experiment.problems[0]);
  REQUIRE(root.size() == 3);
  CHECK(root[2].robot == 2);
  CHECK(root[2].axes == std::vector<std::size_t>{4, 5});
  const ExperimentResult result = run(experiment);
  const std::vector<LevelResult>& levels = result.runs.at(0).levels;
  std::size_t alone = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelRecord& record = levels[i].record;
    if (!record.name.starts_with("robot ")) continue;
    const auto traces = traces_of(levels, i);
    REQUIRE(traces.size() == 1);
    CAPTURE(record.name);
    CHECK(record.name == "robot " + std::to_string(traces[0].robot + 1));
    // Its start is that of the robot in the team.
    const std::size_t axis = 2 * traces[0].robot;
    CHECK(record.start[traces[0].axes[0]] == experiment.problems[0].start[axis]);
    CHECK(record.start[traces[0].axes[1]] == experiment.problems[0].start[axis + 1]);
    CHECK(first_coordinate(levels, i) == traces[0].axes[0]);
    ++alone;
  }
  CHECK(alone >= 3);
}

TEST_CASE("moments of a team are even in the time of the robot with the longest motion", "[report][team]") {
  const Problem problem = three_discs();
  Configurations path(6);
  for (const Configuration& q :
       {Configuration{0, 0, 0, 0, 0, 0}, Configuration{4, 0, 0, 2, 3, 0}, Configuration{4, 0, 0, 2, 3, 8}}) {
    path.push(q);
  }
  const Configurations moments = moments_of(problem.scene.get(), problem.space, path, 4);
  REQUIRE(moments.size() == 4);
  const Configuration second(moments[1].begin(), moments[1].end());
  CHECK(second == Configuration{4, 0, 0, 2, 3, 0});
  CHECK(moments[2][5] == Approx(4));
  CHECK(moments[3][5] == Approx(8));
}

TEST_CASE("a team has pictures of its samples, of its guides and of its motion", "[report][team][slow]") {
  const Experiment experiment = prioritised();
  const ExperimentResult result = run(experiment);
  const Folder folder;
  CHECK(write_scene_figures(experiment, result, folder.path().string()).empty());
  write_motion_figures(experiment, result, folder.path().string());
  write_schedule_figures(experiment, result, folder.path().string());
  for (const char* name : {"samples", "levels", "motion", "schedule"}) {
    CAPTURE(name);
    std::string svg;
    for (const std::string& file : folder.files()) {
      if (file.ends_with(std::string(name) + ".svg")) svg = read(folder.path() / file);
    }
    REQUIRE_FALSE(svg.empty());
    // Each robot's colour is there, and that of a fourth is not.
    const auto colour = [](std::size_t i) {
      const draw::Colour c = draw::palette::robot(i);
      return fmt::format("rgb({:.8g}%,{:.8g}%,{:.8g}%)", 100 * c.r, 100 * c.g, 100 * c.b);
    };
    for (std::size_t i = 0; i < 3; ++i) CHECK(svg.find(colour(i)) != std::string::npos);
    CHECK(svg.find(colour(3)) == std::string::npos);
  }
}

TEST_CASE("a coordination diagram shows where two robots touch on their paths", "[report][team]") {
  // Discs of radius 0.5 on crossing lines of 8 m: they touch where both are within 1 m of the crossing.
  const Problem problem = test::make_problem("crossing", test::rectangle_world({}),
                                             Robot::team({Robot::disc(0.5), Robot::disc(0.5), Robot::disc(0.5)}),
                                             {1, 5, 5, 1, 1, 9}, {9, 5, 5, 9, 3, 9});
  Configurations path(6);
  // The first crosses, then the second does; the third moves 2 m meanwhile.
  for (const Configuration& q :
       {Configuration{1, 5, 5, 1, 1, 9}, Configuration{9, 5, 5, 1, 3, 9}, Configuration{9, 5, 5, 9, 3, 9}}) {
    path.push(q);
  }
  const TeamProgress progress = progress_of(problem, path);
  CHECK(progress.numbers == std::vector<std::size_t>{1, 2, 3});
  CHECK(progress.at == std::vector<double>{0, 8, 16});
  CHECK(progress.distance[0] == std::vector<double>{0, 8, 8});
  CHECK(progress.distance[1] == std::vector<double>{0, 0, 8});
  CHECK(progress.distance[2] == std::vector<double>{0, 2, 2});
  constexpr std::size_t cells = 80;
  const ContactRegion region = contact_region(problem, path, 0, 1, cells);
  std::size_t expected = 0;
  for (std::size_t row = 0; row < cells; ++row) {
    for (std::size_t column = 0; column < cells; ++column) {
      const double x = (static_cast<double>(column) + 0.5) / 10.0 - 4.0,
                   y = (static_cast<double>(row) + 0.5) / 10.0 - 4.0;
      const bool touch = std::hypot(x, y) <= 1.0;
      expected += touch ? 1 : 0;
      CHECK((region.touch[row * cells + column] != 0) == touch);
    }
  }
  CHECK(region.size() == expected);
  CHECK(contact_region(problem, path, 0, 2, cells).size() == 0);
  const auto figure = schedule_figure(problem, path);
  REQUIRE(figure);
  // The progress of all, and the only pair that can touch.
  REQUIRE(figure->panels.size() == 2);
  CHECK(figure->panels[0].series.size() == 3);
  CHECK(figure->panels[1].title == "robots 1 and 2");
  // Its shades cover a disc of radius 1 in the middle.
  const auto shaded = [&](double x, double y) {
    return std::any_of(figure->panels[1].shades.begin(), figure->panels[1].shades.end(), [&](const draw::Shade& shade) {
      return x > shade.from && x < shade.to && y > shade.y->first && y < shade.y->second;
    });
  };
  for (int i = 0; i < 36; ++i) {
    const double x = std::cos(i * std::numbers::pi / 18.0), y = std::sin(i * std::numbers::pi / 18.0);
    CHECK(shaded(4.0 + 0.9 * x, 4.0 + 0.9 * y));
    CHECK_FALSE(shaded(4.0 + 1.15 * x, 4.0 + 1.15 * y));
  }
  CHECK_FALSE(schedule_figure(test::cup_problem(), Configurations(3)));
}

TEST_CASE("each body of a team in space has a trace, moves on the page, in glTF and in pictures", "[report][team]") {
  Problem problem;
  problem.name = "two";
  const Robot3 bar("bar", {{Cuboid{{1.0, 0.3, 0.3}}, {}}});
  problem.scene = std::make_shared<const SpatialScene>(
      World3({{0, 0, 0}, {4, 4, 4}}, {{"post", {Cylinder{0.2, 4.0}, {{2, 2, 2}, {}}}}}),
      Robot3::team({bar, bar, Robot3("ball", {{Sphere{0.3}, {}}}, false)}));
  problem.space = spatial(*problem.scene).own_space();
  problem.start = {1, 1, 1, 0, 0, 0, 1, 3, 3, 3, 0, 0, 0, 1, 1, 3, 1};
  problem.goals = {{3, 3, 1, 0, 0, 0, 1, 1, 1, 3, 0, 0, 0, 1, 3, 1, 1}};
  problem.collision = "fcl";
  Experiment experiment;
  experiment.problems = {problem};
  experiment.strategies = {
      {"one by one", GuideSpec::make("prioritise", {}) >> PlannerSpec::make("rrt_connect", {{"bound", 0.0}})},
      {"windows", GuideSpec::make("couple", {}) >> PlannerSpec::make("rrt_connect", {{"bound", 0.0}})}};
  experiment.seeds = {1};
  experiment.measure.reset();
  const ExperimentResult result = run(experiment);
  REQUIRE(result.runs.size() == 2);
  const auto traces = traces_of(problem);
  REQUIRE(traces.size() == 3);
  CHECK(traces[2].axes == std::vector<std::size_t>{14, 15, 16});
  for (const RunResult& one : result.runs) {
    REQUIRE(one.run.solved);
    for (std::size_t level = 1; level < one.levels.size(); ++level) {
      const LevelRecord& record = one.levels[level].record;
      const auto own = traces_of(one.levels, level);
      REQUIRE(has_positions(record) == !own.empty());
      if (own.empty()) continue;
      // Pictures and the viewer's record have the same positions, whatever coordinates come before those of the robots.
      const View q = record.search.nodes[0];
      const auto positions = positions_in(record, q);
      REQUIRE(positions.size() == own.size());
      for (std::size_t i = 0; i < own.size(); ++i) CHECK(positions[i].x == q[own[i].axes[0]]);
    }
    const std::string text = gltf(problem, one, GltfForm::text);
    for (const char* name : {"robot 1", "robot 2", "robot 3"}) CHECK(text.find(name) != std::string::npos);
  }
  const std::string page = fixture::report_html(experiment, result, "", {});
  CHECK(page.find("\"columns\":[[0,true],[7,true],[14,false]]") != std::string::npos);
  const Folder folder;
  CHECK(write_scene_figures(experiment, result, folder.path().string()).empty());
  write_motion_figures(experiment, result, folder.path().string());
  int pictures = 0;
  for (const std::string& file : folder.files()) pictures += file.ends_with("motion.svg") ? 1 : 0;
  CHECK(pictures == 2);
}

TEST_CASE("64 robots have 24 colours, and neighbours differ", "[report][team]") {
  for (std::size_t i = 0; i + 1 < 64; ++i) CHECK_FALSE(draw::palette::robot(i) == draw::palette::robot(i + 1));
  for (std::size_t i = 0; i < 24; ++i) {
    for (std::size_t k = 0; k < i; ++k) CHECK_FALSE(draw::palette::robot(i) == draw::palette::robot(k));
  }
}

TEST_CASE("the page says where each body of a team is", "[report][team]") {
  Experiment experiment = prioritised();
  experiment.seeds = {1};
  const ExperimentResult result = run(experiment);
  const std::string page = fixture::report_html(experiment, result, "", {});
  const auto script = [&](const std::string& id) {
    const std::size_t at = page.find("id=\"" + id + "\"");
    REQUIRE(at != std::string::npos);
    const std::size_t begin = page.find('>', at) + 1;
    return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  };
  const Json data = script("data");
  const Json& problem = data["problems"][0];
  REQUIRE(problem["team"].size() == 3);
  CHECK(problem["team"][1]["colour"] == "#d55e00");
  CHECK(problem["traces"][2]["position"] == Json({4, 5}));
  const Json& robot = data["robots"][problem["robot"].get<std::size_t>()];
  REQUIRE(robot["bodies"].size() == 3);
  CHECK(robot["bodies"][2]["position"] == 4);
  CHECK(robot["bodies"][2]["robot"] == 2);
  const Json record = script("run-0");
  for (const Json& level : record["levels"]) {
    if (level["name"].get<std::string>().starts_with("robot ")) CHECK(level["traces"].size() == 1);
  }
}

TEST_CASE("of two arms both tips have traces, in the viewer's record and in glTF", "[report][team]") {
  const SphereModel team = SphereModel::team({arm_at(-3), arm_at(3)});
  const auto tips = team.tips();
  REQUIRE(tips.size() == 2);
  const Configuration q = {0, 0, 0, 0};
  CHECK(norm(team.position(tips[0], q) - Vec3{-1.5, 0, 0.5}) < 1e-12);
  CHECK(norm(team.position(tips[1], q) - Vec3{4.5, 0, 0.5}) < 1e-12);
  CHECK(arm_at(0).tips().size() == 1);

  Experiment experiment;
  Problem problem;
  problem.name = "arms";
  auto scene = std::make_shared<ManipulatorScene>(World3({{-6, -6, 0}, {6, 6, 2}}, {}), team);
  problem.space = scene->default_space(1.0);
  problem.scene = scene;
  problem.collision = "spheres";
  problem.start = {0, 0, 0, 0};
  problem.goals = {{1, 0.5, 1, 0.5}};
  const auto traces = traces_of(problem);
  REQUIRE(traces.size() == 2);
  CHECK(traces[1].tip.body == tips[1].body);
  experiment.problems = {problem};
  experiment.strategies = {{"rrt_connect", PlannerSpec::make("rrt_connect", {})}};
  experiment.seeds = {1};
  const ExperimentResult result = run(experiment);
  REQUIRE(result.runs.at(0).run.solved);
  const std::string text = gltf(problem, result.runs[0], GltfForm::text);
  CHECK(text.find("path of robot 1") != std::string::npos);
  CHECK(text.find("path of robot 2") != std::string::npos);
}
