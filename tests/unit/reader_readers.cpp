// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "unit/scene_brute.hpp"

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/skeleton.hpp>

using namespace trellis;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// A folder whose files may be in folders of it.
class Folder : public test::Folder {
 public:
  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((path() / name).parent_path());
    return test::Folder::write(name, text);
  }
};

std::string fault_of(const std::string& path, const ReadOptions& options = {}) {
  return test::fault_of([&] { read_problems(path, options); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

const std::string circles = "units: meter\n\tx\ty\tr\n1\t27\t15\t5\n2\t15\t22.5\t4\n";
const std::string queries = "0\tstart:\t12\t13\n0\tgoal:\t30\t25\n7\tstart:\t12\t14\n7\tgoal:\t30\t24\n";

const std::string car_scene =
    "name: small\n"
    "environment:\n"
    "  min: [-1, 0]\n"
    "  max: [6, 5]\n"
    "  obstacles:\n"
    "    - type: box\n"
    "      center: [3, 4]\n"
    "      size: [2, 1]\n"
    "robots:\n"
    "  - type: car1_v0\n"
    "    start: [0.5, 2, 1.5, -4]\n"
    "    goal: [5, 2, 7, 0]\n";
const std::string arm_file =
    "environmentsize(meters): 5.0 4.0\n"
    "discretization(cells): 5 4\n"
    "basex(cells): 2\n"
    "linklengths(meters): 1.5 1.0\n"
    "linkstartangles(degrees): 90.0 0.0\n"
    "endeffectorgoal(cells): 1 0\n"
    "environment:\n"
    "0 0 0 0 1 \n"
    "0 0 0 1 1 \n"
    "0 0 0 0 0 \n"
    "0 0 0 0 0 \n";
const std::string car_model =
    "shape: box\nshape_trailer: box\nsize: [.5, .25]\nsize_trailer: [.3, .25]\nhitch_lengths: [.5]\n"
    "dt: 0.1\nl: 0.25\nmax_vel: 0.5\nmin_vel: -0.1\nmax_steering_abs: 1.0\n";

}  // namespace

TEST_CASE("the circle world and its queries", "[reader]") {
  const std::string folder = test::scene().string();
  if (folder.empty()) return;
  const auto problems = read_problems(folder + "/ompl_tests/circle_obstacles.txt", {});
  REQUIRE(problems.size() == 100);
  CHECK(problems[17].name == "circles/17");
  CHECK(problems[0].start == Configuration{42.3113, 51.0478});
  CHECK(problems[0].goal() == Configuration{59.3943, 35.0738});
  CHECK(problems[0].space.name() == "R^2");
  const World& world = planar(*problems[0].scene).world;
  CHECK(world.obstacles().size() == 70);
  for (const auto& problem : problems) {
    CHECK(problem.scene == problems[0].scene);
    CHECK(problem.scene->is_point());
    for (const auto& q : {problem.start, problem.goal()}) {
      CHECK(problem.space.contains(q));
      CHECK(brute::is_free(world, {q[0], q[1]}));
    }
  }

  // The number of independent cycles equals the number of groups of touching discs off the boundary.
  const Skeleton skeleton = medial_axis(world);
  std::vector<Disc> discs;
  for (const auto& obstacle : world.obstacles()) discs.push_back(std::get<Disc>(obstacle.shape));
  std::vector<std::size_t> group(discs.size() + 1);
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
  const auto join = [&](std::size_t a, std::size_t b) {
    std::replace(group.begin(), group.end(), std::size_t(group[a]), std::size_t(group[b]));
  };
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const Box2 box = bounding_box(discs[i]);
    const auto [lo, hi] = world.bounds();
    if (box.lo.x <= lo.x || box.lo.y <= lo.y || box.hi.x >= hi.x || box.hi.y >= hi.y) join(i, discs.size());
    for (std::size_t j = 0; j < i; ++j) {
      if (norm(discs[i].centre - discs[j].centre) <= discs[i].radius + discs[j].radius) join(i, j);
    }
  }
  std::sort(group.begin(), group.end());
  const auto groups = static_cast<std::size_t>(std::unique(group.begin(), group.end()) - group.begin());
  CHECK(skeleton.edges.size() + 1 - skeleton.vertices.size() == groups - 1);
}

TEST_CASE("every dynobench scene is read, its start and goal inside the boundary and free", "[reader]") {
  const std::string folder = test::scene().string();
  if (folder.empty()) return;
  int count = 0;
  for (const std::string kind : {"unicycle1_v0", "unicycle1_v1", "unicycle2_v0", "car1_v0", "quad2d_v0"}) {
    for (const auto& file : fs::directory_iterator(fs::path(folder) / "dynobench" / kind)) {
      if (file.path().extension() != ".yaml") continue;
      ++count;
      INFO(file.path().string());
      const auto problems = read_problems(file.path().string(), {});
      REQUIRE(problems.size() == 1);
      const auto& problem = problems[0];
      const Robot& robot = planar(*problem.scene).robot;
      CHECK(robot.name() == kind);
      CHECK(problem.space.dimension() == (kind == "car1_v0" ? 4U : kind == "unicycle2_v0" ? 5U : 3U));
      CHECK((problem.motion_model == nullptr) == (kind == "quad2d_v0"));
      const auto plain = read_problems(file.path().string(), {.motion = false});
      CHECK_FALSE(plain[0].motion_model);
      CHECK(plain[0].space.dimension() == robot.dimension());
      for (const auto& q : {problem.start, problem.goal()}) {
        CHECK(problem.space.contains(q));
        std::vector<Pose2> poses(robot.bodies().size());
        robot.place(q, poses);
        for (std::size_t b = 0; b < poses.size(); ++b) {
          // Small bodies against large boxes: points along the outline detect an overlap.
          const auto& v = std::get<Polygon>(robot.bodies()[b].parts[0]).vertices;
          for (std::size_t i = 0; i < v.size(); ++i) {
            for (const double t : {0.0, 0.25, 0.5, 0.75}) {
              CHECK(brute::is_free(planar(*problem.scene).world, poses[b](v[i] + t * (v[(i + 1) % v.size()] - v[i]))));
            }
          }
        }
      }
    }
  }
  CHECK(count == 8);
  const auto kink = read_problems(folder + "/dynobench/car1_v0/kink_0.yaml", {})[0];
  CHECK(kink.name == "car-kink_0");
  CHECK(kink.space.name() == "R^2 x SO(2)^2");
  CHECK(kink.space.axes()[2].weight == 1.0 / std::numbers::pi);
  CHECK(kink.scene->obstacle_count() == 4);
  // A file without a name is called by its stem.
  CHECK(read_problems(folder + "/dynobench/unicycle1_v1/kink_0.yaml", {})[0].name == "kink_0");
}

namespace {

/// The rows of a list of lists in a solution of dynobench: "states" or "actions".
std::vector<std::vector<double>> rows_of(const fs::path& file, const std::string& key) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  bool within = false;
  for (std::string line; std::getline(in, line);) {
    if (line.find("  - [") != 0) {
      within = line == key + ":";
      continue;
    }
    if (!within) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line.substr(line.find('[') + 1));
    rows.emplace_back(std::istream_iterator<double>(numbers), std::istream_iterator<double>());
  }
  return rows;
}

}  // namespace

TEST_CASE("published solutions of dynobench are driven by our motion models as they were", "[reader][motion]") {
  const std::string folder = test::scene().string();
  if (folder.empty()) return;
  int replayed = 0;
  for (const std::string kind : {"unicycle1_v0", "unicycle1_v1", "unicycle2_v0", "car1_v0"}) {
    for (const auto& file : fs::directory_iterator(fs::path(folder) / "dynobench" / kind)) {
      if (!file.is_directory()) continue;
      const auto problem = read_problems(file.path().string() + ".yaml", {})[0];
      REQUIRE(problem.motion_model);
      const auto& model = *problem.motion_model;
      const Space& space = problem.space;
      for (const auto& solution : fs::directory_iterator(file.path())) {
        if (solution.path().filename().string().find("solution") == std::string::npos) continue;
        INFO(solution.path().string());
        ++replayed;
        const auto states = rows_of(solution.path(), "states");
        Trajectory trajectory{Configurations(model.controls().size()), {}, model.dt()};
        for (auto control : rows_of(solution.path(), "actions")) {
          const auto printed = control;
          model.clamp(control);
          // Six digits were printed.
          for (std::size_t j = 0; j < control.size(); ++j) CHECK(std::abs(control[j] - printed[j]) < 1e-5);
          trajectory.controls.push(control);
          trajectory.steps.push_back(1);
        }
        REQUIRE(states.size() > 30);
        REQUIRE(trajectory.steps.size() + 1 == states.size());
        const auto ours = replay(model, space, problem.start, trajectory);
        std::vector<double> difference(space.dimension());
        double worst = 0.0;
        for (std::size_t i = 0; i < states.size(); ++i) {
          space.difference(ours[i], states[i], difference);
          for (const double d : difference) worst = std::max(worst, std::abs(d));
        }
        CHECK(worst < 1e-4);
        CHECK(space.distance(ours.back(), problem.goal()) < 0.01);
        CHECK(space.distance(ours.back(), problem.goal()) < problem.goal_tolerance);
      }
    }
  }
  CHECK(replayed == 12);
}

TEST_CASE("options reach the problems", "[reader]") {
  const Folder folder;
  folder.write("my_queries.txt", queries);
  const std::string file = folder.write("my_obstacles.txt", circles);
  const auto problems = read_problems(file, {.weight = 0.3, .resolution = 0.01, .collision = "fcl"});
  REQUIRE(problems.size() == 2);
  CHECK(problems[1].name == "circles/7");
  CHECK(problems[1].resolution == 0.01);
  CHECK(problems[1].collision == "fcl");
  CHECK(planar(*problems[1].scene).world.bounds() == Box2{{11, 10}, {32, 26.5}});

  folder.write("shared/models/car1_v0.yaml", car_model);
  const auto car = read_problems(folder.write("car1_v0/a.yaml", car_scene), {.weight = 0.3})[0];
  CHECK(car.space.axes()[3].weight == 0.3);

  CHECK(car.goal_tolerance == 0.25);
  CHECK(car.motion_model->controls()[1].hi == 1.0);
  CHECK(read_problems(folder.write("car1_v0/b.yaml", car_scene), {.goal_tolerance = 0.1})[0].goal_tolerance == 0.1);

  CHECK_THAT(fault_of(file, {.weight = -1}), Contains("weight"));
  CHECK_THAT(fault_of(file, {.goal_tolerance = 0}), Contains("goal_tolerance"));
  CHECK_THAT(fault_of(file, {.resolution = 0}), Contains("resolution"));
}

TEST_CASE("a car with a trailer is placed as the format means it", "[reader]") {
  const Folder folder;
  folder.write("shared/models/car1_v0.yaml", car_model);
  const auto car = read_problems(folder.write("car1_v0/a.yaml", car_scene), {})[0];
  CHECK(car.name == "small");
  // Angles come into the space.
  CHECK(car.start[3] == Approx(-4 + 2 * std::numbers::pi));
  CHECK(car.goal()[2] == Approx(7 - 2 * std::numbers::pi));
  std::vector<Pose2> poses(2);
  planar(*car.scene).robot.place(Configuration{1, 2, 0.5, 1.2}, poses);
  const auto& trailer = std::get<Polygon>(planar(*car.scene).robot.bodies()[1].parts[0]);
  Vec2 centre;
  for (const Vec2 v : trailer.vertices) centre = centre + 0.25 * poses[1](v);
  CHECK(norm(centre - Vec2{1 - 0.5 * std::cos(1.2), 2 - 0.5 * std::sin(1.2)}) < 1e-12);
}

TEST_CASE("a malformed circle world is an error with file, line and expected content", "[reader]") {
  const Folder folder;
  folder.write("w_queries.txt", queries);
  const auto world = [&](const std::string& content) { return fault_of(folder.write("w_obstacles.txt", content)); };
  CHECK_THAT(world(replaced(circles, "22.5", "here")),
             Contains("w_obstacles.txt:4: ") && Contains("y is 'here', expected a finite number"));
  CHECK_THAT(world(replaced(circles, "\t5\n", "\n")), Contains(":3: ") && Contains("expected 4: index x y r"));
  CHECK_THAT(world(replaced(circles, "\t5\n", "\t0\n")), Contains(":3: ") && Contains("greater than 0"));
  CHECK_THAT(world(replaced(circles, "\t5\n", "\tinf\n")), Contains(":3: ") && Contains("the radius"));
  CHECK_THAT(world(replaced(circles, "1\t27", "one\t27")), Contains(":3: ") && Contains("whole number"));
  CHECK_THAT(world("units: meter\n\tx\ty\tr\n"), Contains("no circles"));

  const auto query = [&](const std::string& content) {
    folder.write("q_queries.txt", content);
    return fault_of(folder.write("q_obstacles.txt", circles));
  };
  CHECK_THAT(query(replaced(queries, "goal:", "end:")),
             Contains("q_queries.txt:2: ") && Contains("'end:'") && Contains("'start:' or 'goal:'"));
  CHECK_THAT(query(replaced(queries, "7\tgoal:\t30\t24\n", "")),
             Contains(":3: ") && Contains("query 7 has no 'goal:'"));
  CHECK_THAT(query(replaced(queries, "7\tgoal:", "0\tgoal:")), Contains(":4: ") && Contains("a second 'goal:'"));
  CHECK_THAT(query(replaced(queries, "\t13", "")), Contains(":1: ") && Contains("expected 4"));
  CHECK_THAT(query(""), Contains("no queries"));

  CHECK_THAT(fault_of(folder.write("circles.txt", circles)), Contains("obstacles") && Contains("queries"));
  CHECK_THAT(fault_of(folder.write("lonely_obstacles.txt", circles)),
             Contains("lonely_queries.txt") && Contains("cannot be opened"));
}

TEST_CASE("a malformed dynobench scene is an error with file, line and expected content", "[reader]") {
  const Folder folder;
  const std::string model = folder.write("shared/models/car1_v0.yaml", car_model);
  const auto fault = [&](const std::string& from, const std::string& to) {
    return fault_of(folder.write("car1_v0/bad.yaml", replaced(car_scene, from, to)));
  };
  CHECK(fault("small", "large").empty());
  CHECK_THAT(fault("car1_v0", "car1_v1"), Contains("bad.yaml:10: ") && Contains("'car1_v1'") &&
                                              Contains("did you mean 'car1_v0'?") && Contains("unicycle2_v0"));
  CHECK_THAT(fault("type: box", "type: sphere"), Contains(":6: ") && Contains("'sphere', expected 'box'"));
  CHECK_THAT(fault("center: [3, 4]", "center: [3, 4, 5]"),
             Contains(":7: ") && Contains("a list of 3, expected 2 numbers: x, y"));
  CHECK_THAT(fault("center: [3, 4]", "centre: [3, 4]"), Contains(":6: ") && Contains("'center' is missing"));
  CHECK_THAT(fault("[3, 4]", "[3, up]"), Contains(":7: ") && Contains("'up', expected a finite number"));
  CHECK_THAT(fault("[3, 4]", "[3, .nan]"), Contains(":7: ") && Contains("finite"));
  CHECK_THAT(fault("size: [2, 1]", "size: [2, 0]"), Contains(":8: ") && Contains("greater than 0"));
  CHECK_THAT(fault("max: [6, 5]", "max: [6, -5]"), Contains(":4: ") && Contains("'max'"));
  CHECK_THAT(fault("  min: [-1, 0]\n", ""), Contains("'min' is missing"));
  CHECK_THAT(fault("start: [0.5, 2, 1.5, -4]", "start: [0.5, 2, 1.5]"),
             Contains(":11: ") && Contains("expected 4 numbers: x, y, theta, theta of the trailer"));
  CHECK_THAT(fault("    goal: [5, 2, 7, 0]\n", ""), Contains("'goal' is missing"));
  CHECK_THAT(fault("[5, 2, 7, 0]", "[5, 2, 7, 0"), Contains("bad.yaml:") && Contains("as a YAML map"));
  CHECK_THAT(fault("robots:\n", "vehicles:\n"), Contains("'robots' is missing"));
  CHECK_THAT(fault_of(folder.write("car1_v0/bad.yaml",
                                   "environment: {min: [0, 0], max: [1, 1], obstacles: []}\nrobots: []\n")),
             Contains(":2: ") && Contains("at least one robot"));
  CHECK_THAT(fault_of(folder.write("car1_v0/bad.yaml", "just a word\n")),
             Contains("expected another known format, or dynobench as a YAML map"));
  CHECK_THAT(fault_of(folder.write("car1_v0/bad.yaml", "")), Contains("bad.yaml:1"));
  CHECK_THAT(fault_of(folder.write("car1_v0/bad.yaml", "").substr(0, 5) + "/no/such/file"),
             Contains("cannot be opened"));

  const auto model_fault = [&](const std::string& from, const std::string& to) {
    folder.write("shared/models/car1_v0.yaml", replaced(car_model, from, to));
    return fault_of(folder.write("car1_v0/good.yaml", car_scene));
  };
  CHECK_THAT(model_fault("shape: box", "shape: sphere"), Contains("car1_v0.yaml:1: ") && Contains("expected 'box'"));
  CHECK_THAT(model_fault("[.5, .25]", "[.5]"), Contains("car1_v0.yaml:3: ") && Contains("expected 2 numbers"));
  CHECK_THAT(model_fault("[.5]", "[.5, .5]"), Contains("car1_v0.yaml:5: ") && Contains("expected 1 numbers"));
  fs::remove(model);
  CHECK_THAT(fault_of(folder.write("car1_v0/good.yaml", car_scene)),
             Contains("models/car1_v0.yaml") && Contains("cannot be opened"));
}

TEST_CASE("an arm of SBPL's: its base, angles, goal cell and cells", "[reader]") {
  const Folder folder;
  const auto problems = read_problems(folder.write("two.cfg", arm_file), {.weight = 0.5});
  REQUIRE(problems.size() == 1);
  const Problem& p = problems[0];
  CHECK(p.name == "robarm/two");
  CHECK(p.space.name() == "SO(2)^2");
  CHECK(p.space.axes()[1].weight == 0.5);
  CHECK(planar(*p.scene).world.bounds() == Box2{{0, 0}, {5, 4}});
  CHECK(planar(*p.scene).robot.base() == Vec2{2.5, 0.5});
  REQUIRE(p.start.size() == 2);
  CHECK(p.start[0] == Approx(std::numbers::pi / 2));
  CHECK(p.start[1] == Approx(-std::numbers::pi / 2));
  CHECK(p.goals.empty());
  REQUIRE(p.reach);
  CHECK(p.reach->box == Box2{{1, 3}, {2, 4}});
  std::vector<Pose2> poses(2);
  planar(*p.scene).robot.place(p.start, poses);
  CHECK(norm(poses[p.reach->body](p.reach->point) - Vec2{3.5, 2.0}) < 1e-12);
  // The occupied cells, for any decomposition into rectangles.
  for (int column = 0; column < 5; ++column) {
    for (int row = 0; row < 4; ++row) {
      const bool taken = (row == 0 && column == 4) || (row == 1 && column >= 3);
      CHECK(brute::is_free(planar(*p.scene).world, {column + 0.5, 3.5 - row}) == !taken);
    }
  }
}

TEST_CASE("SBPL's own arms start where they are free", "[reader]") {
  const std::string folder = test::scene().string();
  if (folder.empty()) return;
  for (const auto& [name, links] : {std::pair("env1_6d", 6), std::pair("env3_6d", 6), std::pair("env1_20d", 20)}) {
    CAPTURE(name);
    const auto problems = read_problems(folder + "/sbpl/robarm/" + name + ".cfg", {});
    REQUIRE(problems.size() == 1);
    const Problem& p = problems[0];
    REQUIRE(p.space.dimension() == static_cast<std::size_t>(links));
    CHECK(planar(*p.scene).robot.base() == Vec2{25.5, 0.5});
    CHECK(p.scene->obstacle_count() < 20);
    std::vector<Pose2> poses(p.scene->body_count());
    planar(*p.scene).robot.place(p.start, poses);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const auto& link = std::get<Polygon>(planar(*p.scene).robot.bodies()[i].parts[0]).vertices;
      const double length = link[1].x;
      for (int k = 0; k <= 100; ++k) {
        const Vec2 at = poses[i]({length * k / 100.0, 0.0});
        CHECK(brute::is_free(planar(*p.scene).world, at));
      }
    }
    const Vec2 goal = 0.5 * (p.reach->box.lo + p.reach->box.hi);
    CHECK(brute::is_free(planar(*p.scene).world, goal));
  }
}

TEST_CASE("a malformed arm of SBPL's is an error with file, line and expected content", "[reader]") {
  const Folder folder;
  const auto fault = [&](const std::string& from, const std::string& to) {
    return fault_of(folder.write("bad.cfg", replaced(arm_file, from, to)));
  };
  CHECK_THAT(fault("5.0 4.0", "5.0"), Contains("bad.cfg:1: ") && Contains("1 number, expected 2"));
  CHECK_THAT(fault("5.0 4.0", "5.0 -4.0"), Contains(":1: ") && Contains("greater than 0"));
  CHECK_THAT(fault("(cells): 5 4", "(cells): 5 4.5"), Contains(":2: ") && Contains("whole number"));
  CHECK_THAT(fault("basex(cells): 2", "basex(cells): 5"), Contains(":3: ") && Contains("below 5"));
  CHECK_THAT(fault("1.5 1.0", "1.5 0.0"), Contains(":4: ") && Contains("greater than 0"));
  CHECK_THAT(fault("90.0 0.0", "90.0 0.0 1.0"), Contains(":5: ") && Contains("expected 2"));
  CHECK_THAT(fault("90.0", "up"), Contains(":5: ") && Contains("'up', expected a finite number"));
  CHECK_THAT(fault("goal(cells): 1 0", "goal(cells): 1 4"), Contains(":6: ") && Contains("below 4"));
  CHECK_THAT(fault("basex", "base"), Contains(":3: ") && Contains("'base(cells):', expected one of"));
  CHECK_THAT(fault("basex(cells): 2\n", ""), Contains("'basex(cells):' is missing"));
  CHECK_THAT(fault("basex(cells): 2\n", "basex(cells): 2\nbasex(cells): 2\n"), Contains(":4: ") && Contains("second"));
  CHECK_THAT(fault("environment:\n", ""), Contains(":7: "));
  CHECK_THAT(fault("0 0 0 1 1 \n", "0 0 0 1 \n"), Contains(":9: ") && Contains("a row of 4 cells, expected 5"));
  CHECK_THAT(fault("0 0 0 1 1 \n", ""), Contains("3 rows, expected 4"));
  CHECK_THAT(fault("0 0 0 1 1", "0 0 2 1 1"), Contains(":9: ") && Contains("'2', expected 0 or 1"));
}

TEST_CASE("the goal cells of SBPL's arms are reached", "[reader][goal]") {
  const std::string folder = test::scene("sbpl/robarm").string();
  if (folder.empty()) return;
  for (const auto* name : {"env1_6d", "env3_6d", "env1_20d"}) {
    CAPTURE(name);
    auto problems = read_problems(folder + "/" + name + ".cfg", {});
    REQUIRE(problems.size() == 1);
    Problem& problem = problems[0];
    resolve_goal(problem);
    REQUIRE(problem.space.contains(problem.goal()));
    CHECK(reaches(planar(*problem.scene).robot, *problem.reach, problem.goal()));
    CHECK(make_checker("planar", problem.scene, problem.space, 0.05)->valid(problem.goal()));
  }
}
