// SPDX-License-Identifier: GPL-3.0-or-later
// Planar scenes of other projects: grid maps of Moving AI, BARN, drawings, maps of ROS.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/image.hpp"
#include "support/scenes.hpp"
#include "unit/scene_brute.hpp"

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::string written(const test::Folder& folder, const std::string& name, const std::string& content) {
  return folder.write(name, content);
}

std::string fault_of(const std::string& path, const ReadOptions& options = {}) {
  return test::fault_of([&] { read_problems(path, options); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

const World& world_of(const SceneFile& file) { return planar(*file.problems.front().scene).world; }

const std::string map =
    "type octile\nheight 3\nwidth 4\nmap\n"
    "..@.\n"
    ".G@S\n"
    "TTW.\n";
const std::string queries =
    "version 1\n"
    "0\tsmall.map\t4\t3\t0\t0\t1\t1\t1.41421356\n"
    "0\tmaps/../small.map\t4\t3\t3\t0\t3\t2\t2\n";

}  // namespace

TEST_CASE("a grid map's blocked cells are obstacles, row 0 at the top", "[reader][moving_ai]") {
  const test::Folder folder;
  const SceneFile file = read_scene(written(folder, "small.map", map), {});
  REQUIRE(file.problems.size() == 1);
  CHECK(file.problems[0].start.empty());
  CHECK(world_of(file).bounds() == Box2{{0, 0}, {4, 3}});
  const std::string cells = "..@..G@STTW.";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const char cell = cells[static_cast<std::size_t>(4 * row + column)];
      CAPTURE(row, column, cell);
      CHECK(brute::is_free(world_of(file), {column + 0.5, 2.5 - row}) == (cell == '.' || cell == 'G' || cell == 'S'));
    }
  }
  REQUIRE(file.warnings.size() == 1);
  CHECK(file.warnings[0] == "1 cells of water (W) are obstacles");
  CHECK(file.notes.empty());
  CHECK_THAT(fault_of(folder.file("small.map")), Contains("has no start and no goal: give start = {...}"));
  const auto placed = read_problems(folder.file("small.map"), {.start = {0.5, 2.5}, .goal = {1.5, 1.5}});
  CHECK(placed.at(0).goal() == Configuration{1.5, 1.5});
  CHECK_THAT(fault_of(folder.file("small.map"), {.start = {1}, .goal = {1, 1}}),
             Contains("the start has 1 coordinates, expected 2"));
  CHECK_THAT(
      fault_of(folder.file("small.map"), {.start = {0.5, 2.5}, .goal_pose = Pose3{{1.5, 1.5, 0}, {}}}),
      Contains("small.map: the goal is a pose, which places a body in space, and the file's world is the plane") &&
          Contains("a list of 2 numbers (R^2)"));
}

TEST_CASE("queries of a grid map go from cell to cell", "[reader][moving_ai]") {
  const test::Folder folder;
  written(folder, "small.map", map);
  const std::string same = replaced(queries, "maps/../small.map", "small.map");
  const SceneFile file = read_scene(written(folder, "small.map.scen", same), {});
  REQUIRE(file.problems.size() == 2);
  CHECK(file.problems[0].name == "small/1");
  CHECK(file.problems[0].start == Configuration{0.5, 2.5});
  CHECK(file.problems[0].goal() == Configuration{1.5, 1.5});
  CHECK(file.problems[1].goal() == Configuration{3.5, 0.5});
  CHECK(file.lengths == std::vector<double>{1.41421356, 2.0});
  CHECK(file.problems[0].scene == file.problems[1].scene);
  const auto turning =
      read_problems(folder.file("small.map.scen"), {.robot = Robot::rigid({Box2{{-0.1, -0.1}, {0.1, 0.1}}})});
  CHECK(turning[0].start == Configuration{0.5, 2.5, 0.0});
}

TEST_CASE("a malformed grid map or query is an error with file, line and reason", "[reader][moving_ai]") {
  const test::Folder folder;
  const auto fault = [&](const std::string& from, const std::string& to) {
    return fault_of(written(folder, "bad.map", replaced(map, from, to)));
  };
  CHECK_THAT(fault("octile", "tile"), Contains("bad.map:1: the type is 'tile', expected 'octile'"));
  CHECK_THAT(fault("height 3", "height 0"), Contains("bad.map:2: the height is 0, expected 1 to 4096"));
  CHECK_THAT(fault("height 3", "height 999999999"), Contains("bad.map:2: ") && Contains("1 to 4096"));
  CHECK_THAT(fault("height 3", "height nan"), Contains("bad.map:2: height is 'nan'"));
  CHECK_THAT(fault("width 4", "widht 4"), Contains("bad.map:3: 'widht' in the header"));
  CHECK_THAT(fault("width 4\n", ""), Contains("bad.map:3: 'width' is missing above 'map'"));
  CHECK_THAT(fault("width 4\n", "height 3\n"), Contains("bad.map:3: 'height' for the second time"));
  CHECK_THAT(fault("map\n", ""), Contains("bad.map:4: '..@.' in the header"));
  CHECK_THAT(fault("..@.\n", "..@\n"), Contains("bad.map:5: a row of 3 cells, expected 4"));
  CHECK_THAT(fault("TTW.\n", ""), Contains("bad.map:6: the grid has 2 rows, expected 3"));
  CHECK_THAT(fault("TTW.", "TT?."), Contains("bad.map:7: column 3 is '?'"));
  CHECK_THAT(fault("TTW.", std::string("TT\x01.")), Contains("column 3 is byte 1"));
  CHECK_THAT(fault_of(written(folder, "bad.map", "type octile\n")), Contains("bad.map:1: no 'map'"));

  const std::string good = replaced(queries, "maps/../small.map", "small.map");
  const auto query_fault = [&](const std::string& from, const std::string& to) {
    return fault_of(written(folder, "bad.scen", replaced(good, from, to)));
  };
  CHECK_THAT(query_fault("version 1", "version 2"), Contains("bad.scen:1: version 2, expected 1"));
  CHECK_THAT(query_fault("0\tsmall.map", "0\tgone.map"),
             Contains("bad.scen:2: its map: ") && Contains("gone.map: the file cannot be opened"));
  written(folder, "small.map", map);
  CHECK(query_fault("version 1", "version 1.0").empty());
  CHECK_THAT(fault_of(written(folder, "bad.scen", queries)), Contains("bad.scen:3: the map is 'maps/../small.map'"));
  CHECK_THAT(query_fault("\t4\t3\t0", "\t8\t6\t0"), Contains("bad.scen:2: the map's size is 8 x 6"));
  CHECK_THAT(query_fault("\t0\t0\t1", "\t2\t0\t1"),
             Contains("bad.scen:2: the start cell (2, 0) is '@' in the map, expected a passable one"));
  CHECK_THAT(query_fault("\t1\t1\t1.4", "\t4\t1\t1.4"), Contains("bad.scen:2: goal-x is 4, expected less than 4"));
  CHECK_THAT(query_fault("1.41421356", "inf"), Contains("bad.scen:2: the length is 'inf'"));
  CHECK_THAT(query_fault("\t2\n", "\n"), Contains("bad.scen:3: a row of 8 words, expected 9"));
  CHECK_THAT(fault_of(written(folder, "bad.scen", "version 1\n")), Contains("bad.scen:1: no queries"));
  CHECK_THAT(fault_of(written(folder, "bad.scen", good), {.start = {0.5, 0.5}}),
             Contains("the file has 2 problems with a start each"));
}

TEST_CASE("a field of BARN: cylinders, and the ends of its reference path", "[reader][barn]") {
  const test::Folder folder;
  const std::string obstacles = "world,x,y,radius\n7,0,1,0.5\n7,1,1,0.25\n9,0,2,0.5\n";
  const std::string path = "world,i,x,y\n7,0,-1,0\n7,1,0,0\n7,2,2,3\n8,0,0,0\n";
  written(folder, "reference_path.csv", path);
  const SceneFile file = read_scene(written(folder, "obstacles.csv", obstacles), {});
  REQUIRE(file.problems.size() == 2);
  const Problem& problem = file.problems[0];
  CHECK(problem.name == "barn/7");
  CHECK(problem.start == Configuration{-1, 0});
  CHECK(problem.goal() == Configuration{2, 3});
  const auto& scene = planar(*problem.scene);
  CHECK(scene.world.bounds() == Box2{{-2, -1}, {3, 4}});
  CHECK(scene.world.obstacles().size() == 2);
  CHECK(scene.robot.bounding_radius() == Approx(0.215));
  REQUIRE(file.warnings.size() == 1);
  CHECK(file.warnings[0] == "world 9 has no reference path");
  CHECK_THAT(fault_of(folder.file("obstacles.csv")), Contains("problem 'barn/9' has no start and no goal"));

  const auto fault = [&](const std::string& from, const std::string& to) {
    return fault_of(written(folder, "obstacles.csv", replaced(obstacles, from, to)));
  };
  CHECK_THAT(fault("7,0,1,0.5", "7,0,1"), Contains("obstacles.csv:2: a row of 3 cells, expected 4"));
  CHECK_THAT(fault("7,0,1,0.5", "7,nan,1,0.5"), Contains("obstacles.csv:2: x is 'nan', expected a finite number"));
  CHECK_THAT(fault("7,0,1,0.5", "7,0,1,0"), Contains("obstacles.csv:2: the radius is 0"));
  CHECK_THAT(fault("7,0,1,0.5", "7,1e12,1,1"), Contains("obstacles.csv:2: a cylinder farther than"));
  CHECK_THAT(fault("7,0,1,0.5", "-7,0,1,1"), Contains("obstacles.csv:2: the world is '-7'"));
  written(folder, "reference_path.csv", "world,x,y\n");
  CHECK_THAT(fault("7,0", "7,0"), Contains("reference_path.csv:1: expected 'world,i,x,y'"));
  std::filesystem::remove(folder.file("reference_path.csv"));
  CHECK_THAT(fault("7,0", "7,0"), Contains("reference_path.csv: the file cannot be opened"));
}

namespace {

const std::string drawing =
    "<?xml version=\"1.0\"?>\n"
    "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20mm\" height=\"10mm\" viewBox=\"0 0 20 10\">\n"
    "  <defs><path d=\"m 0,0 5,5 5,0 z\"/></defs>\n"
    "  <g transform=\"translate(-100,-50)\">\n"
    "    <path id=\"car\" d=\"m 102,52 h 4 v 2 l -2,-1 -2,1 z\"/>\n"
    "    <rect x=\"110\" y=\"55\" width=\"2\" height=\"1\"/>\n"
    "    <circle cx=\"115\" cy=\"57\" r=\"1\"/>\n"
    "  </g>\n"
    "  <text>lot</text>\n"
    "</svg>\n";

}  // namespace

TEST_CASE("a drawing's shapes are obstacles, y up", "[reader][svg]") {
  const test::Folder folder;
  const SceneFile file = read_scene(written(folder, "lot.svg", drawing), {});
  const auto& obstacles = world_of(file).obstacles();
  REQUIRE(obstacles.size() == 3);
  CHECK(world_of(file).bounds() == Box2{{0, -10}, {20, 0}});
  CHECK(obstacles[0].name == "car");
  // The notch at (4, 3) of the page belongs to the hull.
  CHECK(std::get<Polygon>(obstacles[0].shape).vertices.size() == 4);
  CHECK(!brute::is_free(world_of(file), {4, -3.9}));
  CHECK(brute::is_free(world_of(file), {4, -4.1}));
  CHECK(obstacles[1].name == "rect on line 6");
  CHECK(std::get<Disc>(obstacles[2].shape) == Disc{{15, -7}, 1.0});
  REQUIRE(file.warnings.size() == 1);
  CHECK(file.warnings[0] == "1 element 'text' ignored");
  CHECK(file.units == "1 mm of the drawing = 1 m");
  // Centimetres of which the page has two for a unit of the drawing.
  const SceneFile scaled = read_scene(
      written(folder, "cm.svg", replaced(drawing, "width=\"20mm\" height=\"10mm\"", "width=\"4cm\" height=\"2cm\"")),
      {});
  CHECK(world_of(scaled).bounds() == Box2{{0, -20}, {40, 0}});
}

TEST_CASE("curves, arcs and transforms of a drawing", "[reader][svg]") {
  const test::Folder folder;
  const auto box_of = [&](const std::string& element) {
    const auto path = written(folder, "one.svg", "<svg viewBox=\"0 0 1 1\">" + element + "</svg>");
    const SceneFile file = read_scene(path, {});
    return bounding_box(std::get<Polygon>(world_of(file).obstacles().at(0).shape));
  };
  const auto check = [&](const std::string& element, double left, double top, double right, double bottom) {
    CAPTURE(element);
    const Box2 box = box_of(element);
    CHECK(box.lo.x == Approx(left).margin(2e-3));
    CHECK(-box.hi.y == Approx(top).margin(2e-3));
    CHECK(box.hi.x == Approx(right).margin(2e-3));
    CHECK(-box.lo.y == Approx(bottom).margin(2e-3));
  };
  check("<path d='M1,1L3,1 3,2z'/>", 1, 1, 3, 2);
  check("<path d='m1 1 2 0 0 1zm0 4 1 0 0 1'/>", 1, 1, 3, 6);
  check("<path d='M1-1H-2V.5.75z'/>", -2, -1, 1, 0.75);
  check("<path d='M0,0C0,4 4,4 4,0'/>", 0, 0, 4, 3);
  check("<path d='M0,0c0,4 4,4 4,0s4-4 4,0'/>", 0, -3, 8, 3);
  check("<path d='M0,0Q2,4 4,0T8,0'/>", 0, -2, 8, 2);
  check("<path d='M0,0A2,2 0 0 1 4,0z'/>", 0, -2, 4, 0);
  check("<path d='M0,0a2 2 0 014,0z'/>", 0, -2, 4, 0);
  check("<path d='M0,0A1,1 0 0 0 4,0z'/>", 0, 0, 4, 2);
  check("<polygon points='0,0 2,0 2,1' transform='translate(1) rotate(90) scale(2)'/>", -1, 0, 1, 4);
  check("<polygon points='0,0 2,0 2,1' transform='rotate(90, 2, 0)'/>", 1, -2, 2, 0);
  check("<polygon points='0,0 2,0 2,1' transform='matrix(1 0 1 1 0 0)'/>", 0, 0, 3, 1);
  check("<ellipse cx='1' cy='1' rx='2' ry='1'/>", -1, 0, 3, 2);
}

TEST_CASE("a malformed drawing is an error with file, line and reason", "[reader][svg]") {
  const test::Folder folder;
  const auto fault = [&](const std::string& from, const std::string& to) {
    return fault_of(written(folder, "bad.svg", replaced(drawing, from, to)));
  };
  CHECK_THAT(fault("</g>", "</h>"), Contains("bad.svg:4: no SVG that can be read: mismatched element"));
  CHECK_THAT(fault("h 4", "k 4"), Contains("bad.svg:5: 'd': 'k' is no command of path data"));
  CHECK_THAT(fault("h 4", "h 4e99"), Contains("bad.svg:5: 'd': '4e99") && Contains("a number of at most 1e+09"));
  CHECK_THAT(fault("h 4", "h nan"), Contains("bad.svg:5: 'd'"));
  CHECK_THAT(fault("m 102,52", "102,52"), Contains("bad.svg:5: 'd': path data begin with M or m"));
  CHECK_THAT(fault("translate", "moveto"), Contains("bad.svg:4: 'transform': 'moveto' is no transform"));
  CHECK_THAT(fault("(-100,-50)", "(-100,-50,3)"), Contains("has 3 numbers, expected 1 or 2"));
  CHECK_THAT(fault("(-100,-50)", "(-100,-50"), Contains("bad.svg:4: ") && Contains("no ')'"));
  CHECK_THAT(fault("0 0 20 10", "0 0 0 10"), Contains("bad.svg:2: 'viewBox' must be"));
  CHECK_THAT(fault("r=\"1\"", "r=\"-1\""), Contains("bad.svg:7: a radius is less than 0"));
  CHECK_THAT(fault_of(written(folder, "bad.svg", "<svg></svg>")), Contains("bad.svg:1: nothing is drawn"));
  CHECK_THAT(fault_of(written(folder, "bad.svg", "<?xml version='1.0'?>\n<html/>")),
             Contains("the outermost element is no 'svg': it is a page of the web"));
  CHECK_THAT(fault_of(written(folder, "lot.svg", drawing)), Contains("has no start and no goal"));
  // Every beginning of the file is an error, never a crash; a drawing whose end is missing is no SVG.
  for (std::size_t length = 0; length + 8 < drawing.size(); length += 3) {
    CAPTURE(length);
    CHECK(!fault_of(written(folder, "cut.svg", drawing.substr(0, length))).empty());
  }
}

TEST_CASE("a robot's outline is read from a drawing", "[reader][svg]") {
  const test::Folder folder;
  const std::string outline = "<svg viewBox='0 0 4 2'><path d='m 10,10 h 4 v 2 h -4 z'/></svg>";
  const Robot robot = read_robot(written(folder, "robot.svg", outline));
  CHECK(robot.dimension() == 3);
  CHECK(robot.bounding_radius() == Approx(std::hypot(2.0, 1.0)));
  CHECK(robot.inscribed_radius() == Approx(1.0));
  CHECK_THROWS_WITH(read_robot(written(folder, "lot.svg", drawing)), Contains("3 shapes, expected one"));
  CHECK_THROWS_WITH(read_robot(written(folder, "no.svg", "hull")), Contains("no SVG"));
}

namespace {

const std::string ros_map =
    "image: map.pgm\nresolution: 0.5\norigin: [-1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

}  // namespace

TEST_CASE("a map of ROS: its image, thresholds and origin", "[reader][ros]") {
  const test::Folder folder;
  // Free, occupied, unknown (205 of map_server); free, free, occupied.
  written(folder, "map.pgm", "P2\n# made by hand\n3 2 255\n254 0 205\n254 230 10\n");
  const SceneFile file = read_scene(written(folder, "map.yaml", ros_map), {});
  CHECK(world_of(file).bounds() == Box2{{-1, 2}, {0.5, 3}});
  const std::string cells = ".#?..#";
  for (int i = 0; i < 6; ++i) {
    CAPTURE(i);
    const Vec2 middle{-0.75 + 0.5 * (i % 3), 2.75 - 0.5 * (i / 3)};
    CHECK(brute::is_free(world_of(file), middle) == (cells[static_cast<std::size_t>(i)] == '.'));
  }
  REQUIRE(file.warnings.size() == 1);
  CHECK(file.warnings[0] == "1 of 6 pixels are neither free nor occupied; they are obstacles");
  // Negated, the other pixels are obstacles; binary, and a PNG, the same.
  const SceneFile negated = read_scene(written(folder, "map.yaml", replaced(ros_map, "negate: 0", "negate: 1")), {});
  CHECK(brute::is_free(world_of(negated), {-0.25, 2.75}));
  CHECK(!brute::is_free(world_of(negated), {-0.75, 2.75}));
  written(folder, "map.pgm", std::string("P5 3 2 255\n\xFE\x00\xCD\xFE\xE6\x0A", 17));
  const SceneFile binary = read_scene(written(folder, "map.yaml", ros_map), {});
  CHECK(world_of(binary).obstacles().size() == world_of(file).obstacles().size());
  test::write_image(folder.file("map.pgm"), 3, 2,
                    [](std::size_t column, std::size_t row) { return row == 0 && column == 1; });
  const SceneFile png = read_scene(written(folder, "map.yaml", ros_map), {});
  CHECK(world_of(png).obstacles().size() == 1);
}

TEST_CASE("a map of ROS is found and read however its YAML is written", "[reader][ros]") {
  const test::Folder folder;
  written(folder, "map.pgm", "P2\n3 2 255\n254 0 205\n254 230 10\n");
  const Box2 bounds{{-1, 2}, {0.5, 3}};
  for (const std::string& text : {
           ros_map,
           std::string("\xEF\xBB\xBF") + ros_map,
           std::string("{image: map.pgm, resolution: 0.5, origin: [-1, 2, 0], negate: 0, occupied_thresh: 0.65, "
                       "free_thresh: 0.196}\n"),
           std::string("{\"image\": \"map.pgm\", \"resolution\": 0.5, \"origin\": [-1, 2, 0], \"negate\": 0, "
                       "\"occupied_thresh\": 0.65, \"free_thresh\": 0.196}"),
           std::string(
               "# by a tool\n---\n'image' : map.pgm\n\"resolution\": 0.5\n'origin':\n  - -1\n  - 2\n  - 0\nnegate: "
               "False\noccupied_thresh: .65\nfree_thresh: .196\nmode: Trinary\n...\n"),
           replaced(ros_map, "\nresolution", "\r\nresolution"),
       }) {
    CAPTURE(text);
    const SceneFile file = read_scene(written(folder, "map.yaml", text), {});
    CHECK(file.format == "map of ROS");
    CHECK(world_of(file).bounds() == bounds);
    CHECK(file.warnings.size() == 1);  // the unknown pixel
  }
}

TEST_CASE("further keys of a map of ROS are a warning each", "[reader][ros]") {
  const test::Folder folder;
  written(folder, "map.pgm", "P2\n3 2 255\n254 0 254\n254 230 10\n");
  const SceneFile file =
      read_scene(written(folder, "map.yaml", ros_map + "map_type: occupancy\nunknown_thresh: 0.2\n"), {});
  REQUIRE(file.warnings.size() == 2);
  CHECK_THAT(file.warnings[0], Contains("map.yaml:7: 'map_type' is not read"));
  CHECK_THAT(file.warnings[1], Contains("map.yaml:8: 'unknown_thresh' is not read"));
  // A word alone, as some tools write the mode, is no key of YAML.
  CHECK(read_scene(written(folder, "map.yaml", ros_map + "trinary: true\n"), {}).warnings.size() == 1);
}

TEST_CASE("colours of a map: luma as Nav2, the mean of the channels as ROS 1", "[reader][ros]") {
  const test::Folder folder;
  struct Case {
    std::string name;
    std::string rgba;
    bool nav2;  // whether it is free
    bool ros1;
  };
  // The threshold is 0.196: a brightness of at least 205.02 is free.
  const std::vector<Case> cases = {{"white", "\xFF\xFF\xFF\xFF", true, true},
                                   {"green", std::string("\0\xFF\0\xFF", 4), false, false},
                                   {"yellow", std::string("\xFF\xFF\0\xFF", 4), true, false},      // luma 226, mean 191
                                   {"lavender", std::string("\xD0\xB0\xFF\xFF", 4), false, true},  // luma 195, mean 223
                                   {"white, half clear", "\xFF\xFF\xFF\x80", false, true},         // 223 with alpha
                                   {"white, clear", std::string("\xFF\xFF\xFF\0", 4), false, false}};
  const auto sample = [&](std::size_t column, std::size_t) { return cases[column].rgba; };
  written(folder, "map.png", test::image_of(cases.size(), 1, test::Channels::rgba, sample));
  const std::string text = replaced(replaced(ros_map, "map.pgm", "map.png"), "-1, 2, 0", "0, 0, 0");
  for (const MapServer server : {MapServer::nav2, MapServer::ros1}) {
    const SceneFile file = read_scene(written(folder, "map.yaml", text), {.map_server = server});
    REQUIRE(file.notes.size() == 1);
    CHECK_THAT(file.notes[0], Contains(server == MapServer::nav2 ? "Nav2" : "ROS 1"));
    for (std::size_t i = 0; i < cases.size(); ++i) {
      CAPTURE(cases[i].name, server == MapServer::nav2);
      CHECK(brute::is_free(world_of(file), {0.5 * static_cast<double>(i) + 0.25, 0.25}) ==
            (server == MapServer::nav2 ? cases[i].nav2 : cases[i].ros1));
    }
  }
  CHECK_THAT(read_scene(folder.file("map.yaml"), {}).warnings.at(0),
             Contains("of 6 pixels are neither free nor occupied (2 transparent); they are obstacles"));
  // Alpha is no channel to ROS 1 in the mode scale: clear white is free.
  const SceneFile scale =
      read_scene(written(folder, "map.yaml", text + "mode: scale\n"), {.map_server = MapServer::ros1});
  CHECK(brute::is_free(world_of(scale), {2.75, 0.25}));
}

TEST_CASE("a pixel at a threshold: free or occupied to Nav2, unknown to ROS 1", "[reader][ros]") {
  const test::Folder folder;
  // 51 of 255 is 0.2, 204 of 255 is 0.8.
  written(folder, "map.pgm", "P2\n3 1 255\n204 51 205\n");
  const std::string text = replaced(replaced(ros_map, "0.65", "0.8"), "0.196", "0.2");
  const SceneFile nav2 = read_scene(written(folder, "map.yaml", text), {});
  CHECK(nav2.warnings.empty());
  CHECK(brute::is_free(world_of(nav2), {-0.75, 2.25}));
  const SceneFile ros1 = read_scene(folder.file("map.yaml"), {.map_server = MapServer::ros1});
  CHECK_THAT(ros1.warnings.at(0), Contains("2 of 3 pixels are neither"));
  CHECK_FALSE(brute::is_free(world_of(ros1), {-0.75, 2.25}));
}

TEST_CASE("the yaw of a map's origin turns it about its lower left corner", "[reader][ros]") {
  const test::Folder folder;
  // 6 x 4 pixels of 0.5 m, some of them dark.
  const std::string cells = "..#...#.#...###..#...#.#";
  const auto dark = [&](std::size_t column, std::size_t row) { return cells[6 * row + column] == '#'; };
  test::write_image(folder.file("map.pgm"), 6, 4, dark);
  for (const double yaw : {0.0, 1e-10, -1e-10, 0.3, 1.2, -2.0, std::acos(-1.0) / 2, std::acos(-1.0), 4.0}) {
    CAPTURE(yaw);
    const std::string origin = "-1, 2, " + std::to_string(yaw);
    const std::string exact =
        std::abs(yaw) < 1e-5 && yaw != 0.0 ? (yaw > 0.0 ? "-1, 2, 1e-10" : "-1, 2, -1e-10") : origin;
    const SceneFile file = read_scene(written(folder, "map.yaml", replaced(ros_map, "-1, 2, 0", exact)), {});
    const World& world = world_of(file);
    const double turned = exact == origin ? std::stod(std::to_string(yaw)) : 0.0;
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = 0; column < 6; ++column) {
        // The centre, and a point near each side, which a turn in the other direction or about another point would
        // miss.
        for (const Vec2 within : {Vec2{0.5, 0.5}, {0.05, 0.5}, {0.95, 0.5}, {0.5, 0.05}, {0.5, 0.95}}) {
          const Vec2 p{0.5 * (static_cast<double>(column) + within.x),
                       0.5 * (3.0 - static_cast<double>(row) + within.y)};
          const Vec2 q{-1.0 + std::cos(turned) * p.x - std::sin(turned) * p.y,
                       2.0 + std::sin(turned) * p.x + std::cos(turned) * p.y};
          REQUIRE(brute::is_free(world, q) == !dark(column, row));
        }
      }
    }
    // Outside of the image nothing is free.
    const auto [lo, hi] = world.bounds();
    for (int i = 1; i < 40; ++i) {
      for (int j = 1; j < 40; ++j) {
        const Vec2 q{lo.x + (hi.x - lo.x) * i / 40.0, lo.y + (hi.y - lo.y) * j / 40.0};
        const double x = std::cos(turned) * (q.x + 1.0) + std::sin(turned) * (q.y - 2.0);
        const double y = -std::sin(turned) * (q.x + 1.0) + std::cos(turned) * (q.y - 2.0);
        if (x < -1e-9 || x > 3.0 + 1e-9 || y < -1e-9 || y > 2.0 + 1e-9) REQUIRE_FALSE(brute::is_free(world, q));
      }
    }
    const bool quarter = std::abs(std::sin(2.0 * turned)) < 1e-5;
    // Runs become one part each, and with a turn there are four triangles around the image.
    const std::size_t straight = world_of(read_scene(written(folder, "straight.yaml", ros_map), {})).obstacles().size();
    CHECK(world.obstacles().size() <= straight + 4);
    if (exact != origin) CHECK(world.bounds() == Box2{{-1, 2}, {2, 4}});
    if (exact != origin || yaw == 0.0) CHECK(std::holds_alternative<Box2>(world.obstacles()[0].shape));
    if (!quarter) {
      CHECK(world.obstacles().size() == straight + 4);
      CHECK(world.obstacles().back().name == "outside of the map 4");
      CHECK_THAT(file.frame, Contains("turned by "));
    }
  }
  const SceneFile degrees = read_scene(written(folder, "map.yaml", replaced(ros_map, "-1, 2, 0", "-1, 2, 90")), {});
  CHECK_THAT(degrees.warnings.at(0),
             Contains("line 3: the yaw of the origin is 90, more than a full turn; it is in rad"));
}

TEST_CASE("a quarter turn of a map is exact, and its boxes stay boxes", "[reader][ros]") {
  const test::Folder folder;
  written(folder, "map.pgm", "P2\n3 1 255\n254 254 0\n");
  const SceneFile file =
      read_scene(written(folder, "map.yaml", replaced(ros_map, "-1, 2, 0", "-1, 2, 1.5707963267948966")), {});
  CHECK(world_of(file).bounds() == Box2{{-1.5, 2}, {-1, 3.5}});
  REQUIRE(world_of(file).obstacles().size() == 1);
  CHECK(std::get<Box2>(world_of(file).obstacles()[0].shape) == Box2{{-1.5, 3}, {-1, 3.5}});
}

TEST_CASE("diagonal pixels of a turned map leave no gap", "[reader][ros]") {
  const test::Folder folder;
  test::write_image(folder.file("map.pgm"), 64, 64, [](std::size_t column, std::size_t row) { return column == row; });
  const SceneFile file = read_scene(written(folder, "map.yaml", replaced(ros_map, "-1, 2, 0", "-1, 2, 0.7")), {});
  // Each corner that two pixels share lies in both.
  for (int i = 1; i < 64; ++i) {
    const Vec2 p{0.5 * i, 0.5 * (64 - i)};
    const Vec2 q{-1.0 + std::cos(0.7) * p.x - std::sin(0.7) * p.y, 2.0 + std::sin(0.7) * p.x + std::cos(0.7) * p.y};
    CAPTURE(i);
    CHECK_FALSE(brute::is_free(world_of(file), q));
  }
}

TEST_CASE("a malformed map of ROS is an error with file, line and reason", "[reader][ros]") {
  const test::Folder folder;
  const std::string image = "P2\n3 2 255\n254 0 205\n254 230 10\n";
  written(folder, "map.pgm", image);
  const auto fault = [&](const std::string& from, const std::string& to) {
    return fault_of(written(folder, "map.yaml", replaced(ros_map, from, to)));
  };
  CHECK_THAT(fault("-1, 2, 0", "-1, 2"), Contains("map.yaml:3: ") && Contains("expected 3 numbers: x, y, yaw"));
  CHECK_THAT(fault("-1, 2, 0", "-1, .nan, 0"), Contains("map.yaml:3: ") && Contains("finite"));
  CHECK_THAT(fault("resolution: 0.5", "resolution: 0"), Contains("map.yaml:2: 'resolution' is 0"));
  CHECK_THAT(fault("negate: 0", "negate: 2"), Contains("map.yaml:4: 'negate' is '2'"));
  CHECK_THAT(fault("free_thresh: 0.196", "free_thresh: 0.75"), Contains("map.yaml:6: 'free_thresh' is 0.75"));
  CHECK_THAT(fault("free_thresh: 0.196", "free_tresh: 0.196"),
             Contains("'free_thresh' is missing (did you mean 'free_tresh'?)"));
  CHECK_THAT(fault("free_thresh: 0.196\n", ""), Contains("'free_thresh' is missing"));
  CHECK_THAT(fault("negate: 0", "negate: 0\nmode: raw"), Contains("map.yaml:5: the mode is 'raw'"));
  CHECK_THAT(fault("map.pgm", "gone.pgm"), Contains("map.yaml:1: its image: ") && Contains("cannot be opened"));
  CHECK_THAT(fault("map.pgm", "/etc/map.pgm"), Contains("map.yaml:1: the image is '/etc/map.pgm'"));
  CHECK_THAT(fault("map.pgm", "a/../../map.pgm"), Contains("expected a file beside the map or in a folder below"));
  const auto image_fault = [&](const std::string& content) {
    written(folder, "map.pgm", content);
    return fault_of(written(folder, "map.yaml", ros_map), {.start = {0, 2.1}, .goal = {0, 2.2}});
  };
  CHECK(image_fault(image).empty());
  CHECK_THAT(image_fault("P5 99999999 99999999 255\n"), Contains("at most 4096 x 4096"));
  CHECK_THAT(image_fault("P5 4000 4000 255\nabc"), Contains("it ends after 3 of 16000000 pixels"));
  CHECK_THAT(image_fault("P5 0 4 255\n"), Contains("it has no pixels"));
  CHECK_THAT(image_fault("P5 3 2 65535\n      "), Contains("its largest grey value is 65535"));
  CHECK_THAT(image_fault("P6 3 2 255"), Contains("expected a PNG or a PGM: it is a PPM image; convert it to PNG"));
  CHECK_THAT(image_fault("\xFF\xD8\xFF"), Contains("expected a PNG or a PGM: it is a JPEG image; convert it to PNG"));
  CHECK_THAT(image_fault("P2 3 2 255 1 2 3 4 5"), Contains("a grey value is missing"));
  CHECK_THAT(image_fault("P2 3 2 255 1 2 3 4 5 256"), Contains("a grey value is 256"));
}

TEST_CASE("a map with cells E follows the rule of the MAPF Start-Kit: only @ and T block", "[reader][moving_ai]") {
  const test::Folder folder;
  const std::string text = "type octile\nheight 3\nwidth 4\nmap\nES@.  \nE.TS\nWO.E\t\n";
  const SceneFile file = read_scene(written(folder, "depot.map", text), {});
  const std::string cells = "ES@.E.TSWO.E";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const char cell = cells[static_cast<std::size_t>(4 * row + column)];
      CAPTURE(row, column, cell);
      CHECK(brute::is_free(world_of(file), {column + 0.5, 2.5 - row}) == (cell != '@' && cell != 'T'));
    }
  }
  REQUIRE(file.warnings.size() == 1);
  CHECK(file.warnings[0] == "2 cells O and W are passable: with cells E the map follows the MAPF Start-Kit");
  REQUIRE(file.notes.size() == 1);
  CHECK(file.notes[0] == "by the rule of the MAPF Start-Kit: only cells @ and T are obstacles");
  // A byte order mark changes nothing.
  CHECK(world_of(read_scene(written(folder, "depot.map", "\xEF\xBB\xBF" + text), {})).obstacles().size() ==
        world_of(file).obstacles().size());
  CHECK_THAT(fault_of(written(folder, "depot.map", replaced(text, "ES@", "Ex@"))),
             Contains("depot.map:5: column 2 is 'x', expected one of . G S E (passable) or @ O T W (not)"));
}

TEST_CASE("a file of a format that is known and not read is named", "[reader][unread]") {
  const test::Folder folder;
  const auto fault = [&](const std::string& name, const std::string& text) {
    return fault_of(written(folder, name, text));
  };
  struct Case {
    std::string name;
    std::string text;
    std::string what;
    std::string instead;
  };
  for (const auto& [name, text, what, instead] : std::vector<Case>{
           {"arm.urdf",
            "<?xml version=\"1.0\"?>\n<!-- arm -->\n<robot name=\"arm\">\n <link name=\"base\"/>\n</robot>\n",
            "it is a URDF, which describes the links and joints of a robot", "robot.urdf(\"FILE.urdf\") reads it"},
           {"arm.xml", "<robot name=\"arm\"><link name=\"base\"/></robot>\n", "it is a URDF",
            "trellis scene FILE.urdf"},
           {"arm.urdf.xacro", "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\" name=\"a\"/>\n", "it is a xacro file",
            "expand it first: xacro FILE > robot.urdf"},
           {"arm.srdf", "<robot name=\"arm\">\n<group name=\"all\"/>\n</robot>\n", "it is an SRDF",
            "srdf = \"FILE.srdf\""},
           {"room.world", "<?xml version='1.0'?>\n<sdf version='1.6'><world name='a'/></sdf>", "it is an SDF file",
            "world { ... }"},
           {"room.sdf", "<sdf version='1.6'/>", "it is an SDF file, a world or a model of Gazebo", "world { ... }"},
           {"stage.world", "define block model\n(\n size [1 1 1]\n)\n", "it is a world of Gazebo or Stage",
            "world { ... }"},
           {"room.wbt", "#VRML_SIM R2023a utf8\nWorldInfo {\n}\n", "it is a world of Webots", "world { ... }"},
           {"arm.xml", "<mujoco model=\"a\"/>", "it is a model of MuJoCo", "world { ... }"},
           {"table.yaml", "robot_model_name: a\nother: 1\n", "it is a planning scene of MoveIt", "collision_objects"},
           {"query.yaml", "start_state:\n  joint_state:\n    position: [0]\n", "it is a request to MoveIt",
            "scenes.load("},
           {"room.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": []}", "it is a glTF file", "assimp export"},
           {"room.glb", std::string("glTF\2\0\0\0", 8), "it is a binary glTF file",
            ".stl, .obj, .ply, .off, .g and .dae"},
           {"room.wrl", "#VRML V2.0 utf8\nGroup { }\n", "it is a VRML file", "assimp export"},
           {"part.step", "ISO-10303-21;\nHEADER;\n", "it is a STEP file", "assimp export"},
           {"map.jpg", "\xFF\xD8\xFF\xE0", "it is a JPEG image", "PNG or PGM"},
           {"map.bmp", std::string("BM\0\0\0\0", 6), "it is a BMP image", "PNG or PGM"},
           {"maze.ppm", "P6\n2 2\n255\n", "it is a PPM image", "PNG or PGM"},
           {"worlds.npz", "PK\3\4", "it is a ZIP archive", "unpack it"},
           {"maze.ppm.gz", "\x1F\x8B\x08", "it is a file that gzip compressed", "gunzip"},
           {"benchmark.db", "SQLite format 3", "it is an SQLite database", "not results"},
           {"large.map", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "it is a pointer of Git LFS",
            "git lfs pull"},
           {"page.map", "<!DOCTYPE html>\n<html></html>\n", "it is a page of the web", "download"},
           {"env1.cfg", "discretization(cells): 15 15\nobsthresh: 1\n", "it is a navigation grid of SBPL",
            "planar arms"},
           {"run.json", "{\"settings\": {\"benchmark\": {}}}\n", "it is a configuration of bench-mr", ".svg"},
           {"problem.json", "{\"mapFile\": \"a.map\", \"agentFile\": \"a.agents\"}",
            "it is a problem of the MAPF Start-Kit", ".map"},
           {"a.robot", "1\nrod.obj Volumetric Rotational\nConnections\n0\n", "it is a robot of PPL", "NAME.env"},
           {"run.lua", "return rrt {}\n", "it is a Lua script", "trellis run"},
           {"part.stl", "solid a\nendsolid\n", "it is a mesh", "mesh \"FILE\""},
           {"scene.xml", "<rlsg><scene/></rlsg>", "it is a scene of the Robotics Library", "<rlplan>"},
           {"other.xml", "<thing/>", "it is an XML file with the root <thing>", "<rlplan>"},
           {"empty.map", "\n \n", "it is empty", ""}}) {
    CAPTURE(name, text);
    const std::string found = fault(name, text);
    CHECK_THAT(found, Contains(name + ":1: no scene that can be read: " + what) && Contains(instead));
    CHECK(std::count(found.begin(), found.end(), '\n') == 0);
  }
  // Others are what they were.
  CHECK_THAT(fault("words.txt", "no scene\n"), Contains("words.txt:1: no scene that can be read: expected "));
  CHECK_THAT(
      fault("other.yaml", "sensors:\n  - a\n"),
      Contains("other.yaml:1: no scene that can be read: it is YAML of no known format; of YAML Trellis reads maps"));
  CHECK_THAT(fault("Palace.txt", "P6ace\n"), Contains("expected ") && !Contains("PPM"));
}

TEST_CASE("files that are no scenes are refused at once", "[reader]") {
  const test::Folder folder;
  CHECK_THAT(fault_of(folder.file("gone.map")), Contains("gone.map: the file cannot be opened"));
  CHECK_THAT(fault_of(folder.path()), Contains("the file cannot be read"));
  CHECK_THAT(fault_of("/dev/zero"), Contains("the file cannot be read: it is a device; expected a regular file"));
  std::ofstream(folder.file("large.map")) << "type octile\n";
  std::filesystem::resize_file(folder.file("large.map"), (std::size_t{64} << 20U) + 1);
  CHECK_THAT(fault_of(folder.file("large.map")),
             Contains("large.map: the file cannot be read: it has 67108865 bytes, at most 67108864 are read"));
  written(folder, "lines.map", std::string(2'000'001, '\n'));
  CHECK_THAT(fault_of(folder.file("lines.map")), Contains("lines.map:2000000: more than 2000000 lines"));
  CHECK_THAT(fault_of(written(folder, "long.yaml", "a: " + std::string(3 << 20U, 'x'))), Contains("read as YAML"));
  // A board of chess has a box for each dark field.
  std::string board = "P5 2000 2000 255\n";
  for (int i = 0; i < 2000 * 2000; ++i) board += (i + i / 2000) % 2 == 0 ? '\xFF' : '\0';
  CHECK_THAT(fault_of(written(folder, "board.pgm", board)),
             Contains("board.pgm: the grid has more than 1000000 boxes"));
  std::string deep = "<svg>";
  for (int i = 0; i < 100'000; ++i) deep += "<g>";
  CHECK_THAT(fault_of(written(folder, "deep.svg", deep)),
             Contains("deep.svg:1: no SVG that can be read: element depth"));
  // A table of mistakes stops at the fiftieth.
  std::string rows = "world,x,y,radius\n";
  for (int i = 0; i < 200'000; ++i) rows += "1,x,0,1\n";
  CHECK_THAT(fault_of(written(folder, "rows.csv", rows)), Contains("rows.csv:51:") && !Contains("rows.csv:52:"));
  CHECK_THAT(
      fault_of(written(folder, "arm.cfg", "environmentsize(meters): 1 1\nlinklengths(meters): 1\nenvironment:\n"),
               {.robot = Robot::point()}),
      Contains("the file has a robot of its own"));
}

TEST_CASE("the scenes of bench-mr and BARN have the sizes that their files state", "[reader][scenes]") {
  const std::string folder = test::scene().string();
  if (folder.empty()) return;
  const SceneFile lot = read_scene(folder + "/bench_mr/polygon/parking1.svg", {});
  CHECK(world_of(lot).obstacles().size() == 13);
  CHECK(world_of(lot).bounds().hi.x == Approx(18.658882).margin(0.02));
  CHECK(world_of(lot).bounds().lo.y == Approx(-14.412246).margin(0.02));
  CHECK(lot.warnings.empty());
  CHECK(world_of(read_scene(folder + "/bench_mr/polygon/parking3.svg", {})).obstacles().size() == 18);
  CHECK(world_of(read_scene(folder + "/bench_mr/polygon/warehouse.svg", {})).obstacles().size() == 88);
  // A car of 4.2534 m x 2.4339 m.
  const Robot car = read_robot(folder + "/bench_mr/shared/car.svg");
  const auto& outline = std::get<Polygon>(car.bodies().at(0).parts.at(0));
  CHECK(bounding_box(outline).hi.x == Approx(4.2533908 / 2).margin(1e-3));
  CHECK(bounding_box(outline).hi.y == Approx(2.433861 / 2).margin(1e-3));

  const SceneFile barn = read_scene(folder + "/barn/obstacles.csv", {});
  REQUIRE(barn.problems.size() == 25);
  REQUIRE(barn.lengths.size() == 25);
  for (std::size_t i = 0; i < barn.problems.size(); ++i) {
    const Problem& problem = barn.problems[i];
    CAPTURE(problem.name);
    CHECK(barn.lengths[i] > 10.0);
    const auto checker = make_checker("planar", problem.scene, problem.space, problem.resolution);
    CHECK(checker->valid(problem.start));
    CHECK(checker->valid(problem.goal()));
  }
}
