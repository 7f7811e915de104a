// SPDX-License-Identifier: GPL-3.0-or-later
// trellis scene: what is in a scene file.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/scenes.hpp"

using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;
using Json = nlohmann::json;

namespace {

const std::string map = "type octile\nheight 3\nwidth 4\nmap\n..@.\n.G@S\n....\n";
const std::string queries = "version 1\n0 yard.map 4 3 0 0 0 2 2\n0 yard.map 4 3 0 0 3 0 6.41421356\n";

void write(const Place& place, const std::string& name, const std::string& text) {
  std::ofstream(place / name, std::ios::binary) << text;
}

}  // namespace

TEST_CASE("scene prints a file's problems, and of one its ends and the nearest obstacles") {
  const Place place;
  write(place, "yard.map", map);
  write(place, "yard.map.scen", queries);
  const Outcome first = place.run({"scene", "yard.map.scen"});
  CHECK(first.status == 0);
  CHECK(first.err.empty());
  CHECK_THAT(first.out, Contains("problems  2, start and goal valid in 2\n") &&
                            Contains("bounds    x 0 to 4, y 0 to 3 m\n") && Contains("obstacles 1 box\n") &&
                            Contains("goal      (0.5, 0.5): valid, 1.58 m from box 1\n") &&
                            Contains("length    2.0000 m, by the file\n"));
  const Outcome second = place.run({"scene", "yard.map.scen", "--problem", "yard/2"});
  CHECK_THAT(second.out, Contains("problem   'yard/2'\n") && Contains("goal      (3.5, 2.5): valid, 0.5 m from box 1"));
  const Outcome none = place.run({"scene", "yard.map.scen", "--problem", "yard/3"});
  CHECK(none.status == 2);
  CHECK(
      none.err ==
      "trellis: --problem: yard.map.scen has no problem 'yard/3' (did you mean 'yard/1'?); the first is 'yard/1', the "
      "last 'yard/2'\n");
  const Outcome alone = place.run({"scene", "yard.map"});
  CHECK_THAT(alone.out, Contains("start     none in the file\n"));
}

TEST_CASE("scene prints JSON, with what an invalid start touches") {
  const Place place;
  write(place, "obstacles.csv", "world,x,y,radius\n4,0,1,0.5\n");
  write(place, "reference_path.csv", "world,i,x,y\n4,0,0,0.5\n4,1,0,3\n");
  const Outcome text = place.run({"scene", "obstacles.csv"});
  CHECK_THAT(text.out, Contains("start     (0, 0.5): invalid, touches cylinder 1\n") &&
                           Contains("goal      (0, 3): valid, 1.28 m from cylinder 1\n"));
  const Outcome outcome = place.run({"scene", "obstacles.csv", "--json"});
  REQUIRE(outcome.status == 0);
  const Json json = Json::parse(outcome.out);
  CHECK(json["format"] == "BARN cylinder fields");
  CHECK(json["kinds"]["disc"] == 1);
  const Json& problem = json["problems"].at(0);
  CHECK(problem["name"] == "barn/4");
  CHECK(problem["start"]["valid"] == false);
  CHECK(problem["start"]["contact"] == "cylinder 1");
  CHECK(problem["goal"]["nearest"]["obstacle"] == "cylinder 1");
  CHECK(problem["goal"]["nearest"]["distance"].get<double>() == Approx(1.285));
}

TEST_CASE("scene draws a file, with the robot of a drawing") {
  if (!trellis::test::draws_figures()) return;
  const Place place;
  write(place, "lot.svg", "<svg viewBox='0 0 9 4'><path id='wall' d='M4,1h1v3h-1z'/></svg>");
  write(place, "car.svg", "<svg viewBox='0 0 2 1'><path d='M0,0h2v1h-2z'/></svg>");
  const Outcome outcome =
      place.run({"scene", "lot.svg", "--robot", "car.svg", "--svg", "lot-drawn.svg", "--png", "lot.png"});
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.out, Contains("robot     rigid in SE(2), within 1.118 m of its reference point\n"));
  CHECK_THAT(content(place / "lot-drawn.svg"), Contains("<svg"));
  CHECK(content(place / "lot.png").starts_with("\x89PNG\r\n\x1a\n"));
}

TEST_CASE("scene prints a mesh") {
  const Place place;
  write(place, "tetra.obj", "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nv 0 0 1000\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const Outcome outcome = place.run({"scene", "tetra.obj", "--unit", "mm"});
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.out, Contains("units     1 unit = 0.001 m\n") &&
                              Contains("bounds    x 0 to 1, y 0 to 1, z 0 to 1 m\n") &&
                              Contains("triangles 4, of 4 polygons; 4 vertices\n") &&
                              Contains("closed    yes, convex, volume 0.1667 m3\n"));
  const Json json = Json::parse(place.run({"scene", "tetra.obj", "--unit", "mm", "--json"}).out);
  CHECK(json["triangles"] == 4);
  CHECK(json["closed"] == true);
  CHECK(place.run({"scene", "tetra.obj", "--svg", "x.svg", "--elevation", "91"}).err ==
        "trellis: --elevation must be a number of at most 90, got 91\n");
  CHECK(place.run({"scene", "tetra.obj", "--problem", "x"}).status == 2);
  if (!trellis::test::draws_figures()) return;
  CHECK(place.run({"scene", "tetra.obj", "--png", "x.png", "--azimuth", "20", "--elevation", "70"}).status == 0);
  CHECK(content(place / "x.png").starts_with("\x89PNG\r\n\x1a\n"));
}

TEST_CASE("scene says what a file of COLLADA states of its unit and axes") {
  const Place place;
  const auto printed = [&](const std::string& asset) {
    write(place, "a.dae",
          R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
              asset + R"(</asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 2 3</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)");
    return place.run({"scene", "a.dae"});
  };
  const Outcome inch = printed(R"(<unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis>)");
  if (inch.err.find("trellis-mesh, which is not installed") != std::string::npos) {
    WARN("SKIPPED: trellis-mesh was not built");
    return;
  }
  CHECK_THAT(inch.out, Contains("1 unit = 0.0254 m (inch), as the file says") && Contains("z is up") &&
                           Contains("x 0 to 0.0254, y 0 to 0.0508, z 0 to 0.0762 m") && !Contains("warning"));
  CHECK_THAT(printed("<up_axis>Y_UP</up_axis>").out,
             Contains("1 unit = 1 m, as COLLADA has it without a <unit>") && Contains("y is up (Y_UP)"));
}

TEST_CASE("scene says by which rule it read a map, and check and run what they found in it") {
  const Place place;
  write(place, "map.pgm", "P2 4 2 255 254 254 254 254 254 0 205 254\n");
  write(place, "map.yaml",
        "{image: map.pgm, resolution: 1, origin: [0, 0, 0.5], negate: 0, occupied_thresh: 0.65, free_thresh: 0.196, "
        "map_type: occupancy}\n");
  const Outcome printed = place.run({"scene", "map.yaml"});
  CHECK(printed.status == 0);
  CHECK_THAT(printed.out, Contains("frame     the lower left corner is (0, 0), turned by 0.5 rad, y up\n") &&
                              Contains("note      pixels are read as by the map server of Nav2: their luma") &&
                              Contains("map.yaml:1: 'map_type' is not read") &&
                              Contains("warning   1 of 8 pixels are neither free nor occupied; they are obstacles\n"));
  const Json json = Json::parse(place.run({"scene", "map.yaml", "--json"}).out);
  CHECK(json["notes"].size() == 1);
  CHECK(json["warnings"].size() == 2);
  CHECK(json["kinds"]["polygon"] == 5);  // a run of two pixels, and four triangles around the image
  place.script(
      "go.lua",
      "return rrt_connect { step = 1 }, scenes.load('map.yaml', { start = {0, 1}, goal = {2, 2.5}, name = 'yard' "
      "})\n");
  for (const char* verb : {"check", "run"}) {
    const Outcome outcome = place.run({verb, "go.lua"});
    CAPTURE(verb, outcome.err);
    CHECK(outcome.status == 0);
    CHECK_THAT(outcome.err,
               Contains("map.yaml:1: 'map_type' is not read") &&
                   Contains("trellis: warning: scenes.load: map.yaml: 1 of 8 pixels are neither free nor occupied"));
  }
}

TEST_CASE("check and run warn of a mesh 1000 times as large as its world") {
  const Place place;
  write(place, "part.obj", "v 2000 0 0\nv 6000 0 0\nv 2000 3000 0\nv 2000 0 900\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const auto script = [&](const std::string& unit) {
    place.script("go.lua",
                 "return rrt_connect { step = 1 }, problem { world = world { bounds = {0, 0, 0, 4, 4, 4}, "
                 "mesh { 'part.obj'" +
                     unit +
                     ", name = 'part' } }, robot = robot.point { dimension = 3 }, "
                     "start = {1, 3.5, 3.5}, goal = {3, 3.5, 3.5} }\n");
  };
  for (const char* verb : {"check", "run"}) {
    CAPTURE(verb);
    script("");
    CHECK_THAT(
        place.run({verb, "go.lua"}).err,
        Contains("trellis: warning: problem 'problem': ") && Contains("part") &&
            Contains("extends 4000 m in a world of 4 m; if the numbers of its mesh are millimetres, give mesh unit "
                     "= \"mm\""));
    script(", unit = 'mm'");
    CHECK_THAT(place.run({verb, "go.lua"}).err, !Contains("extends"));
  }
}

TEST_CASE("scene says in a line what is wrong with a file") {
  const Place place;
  const auto fault = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = place.run(arguments);
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    return outcome.err;
  };
  CHECK_THAT(fault({"scene", "gone.map"}), Contains("trellis: no file 'gone.map' (looked for gone.map"));
  write(place, "bad.map", "type octile\nheight 3\nwidth 4\nmap\n..@.\n.G?S\n....\n");
  CHECK(fault({"scene", "bad.map"}) ==
        "trellis: bad.map:6: column 3 is '?', expected one of . G S E (passable) or @ O T W (not)\n");
  write(place, "words.txt", "no scene\n");
  CHECK_THAT(fault({"scene", "words.txt"}), Contains("trellis: words.txt:1: no scene that can be read"));
  write(place, "yard.map", map);
  CHECK_THAT(fault({"scene", "yard.map", "--unit", "mm"}), Contains("--unit: yard.map is no mesh"));
  CHECK_THAT(fault({"scene", "yard.map", "--robot", "gone.svg"}), Contains("--robot: no file 'gone.svg'"));
  CHECK(fault({"scene", "yard.map", "--gltf", "x.glb"}) == "trellis: --gltf: yard.map is planar\n");
  CHECK_THAT(fault({"scene", "yard.map", "--svg", "no/such/folder/x.svg"}), Contains("no/such/folder"));
}

TEST_CASE("scene prints a scene of space: what the bounds contain, triangles, and whether meshes are closed") {
  const Place place;
  write(place, "body.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  write(place, "floor.obj", "v -9 -9 -2\nv 9 -9 -2\nv 9 9 -2\nv -9 9 -2\nf 1 2 3\nf 1 3 4\n");
  write(place, "hall.cfg",
        "[problem]\nrobot = body.obj\nworld = floor.obj\nstart.x = 0\nstart.y = 0\nstart.z = 3\nstart.theta = 0\n"
        "start.axis.x = 1\nstart.axis.y = 0\nstart.axis.z = 0\ngoal.x = 4\ngoal.y = 0\ngoal.z = 3\ngoal.theta = 0\n"
        "goal.axis.x = 1\ngoal.axis.y = 0\ngoal.axis.z = 0\n"
        "volume.min.x = -9\nvolume.min.y = -9\nvolume.min.z = -3\n"
        "volume.max.x = 9\nvolume.max.y = 9\nvolume.max.z = 9\n");
  const Outcome outcome = place.run({"scene", "hall.cfg"});
  CHECK(outcome.err.empty());
  CHECK_THAT(outcome.out, Contains("obstacles 1 mesh, 2 triangles, not closed") && Contains("4 triangles, closed") &&
                              Contains("in SE(3)") && Contains(": valid, ") && Contains("contain   "));
  const Json json = Json::parse(place.run({"scene", "hall.cfg", "--json"}).out);
  CHECK(json["obstacle_meshes"]["triangles"] == 2);
  CHECK(json["obstacle_meshes"]["closed"] == 0);
  CHECK(json["robot_meshes"]["closed"] == 1);
  CHECK(json["bounds"].size() == 3);
  const Outcome drawn = place.run({"scene", "hall.cfg", "--svg", "hall.svg", "--png", "hall.png"});
  CHECK(drawn.status == 0);
  CHECK_THAT(content(place / "hall.svg"), Contains("<svg"));
  CHECK(content(place / "hall.png").starts_with("\x89PNG\r\n\x1a\n"));
  REQUIRE(place.run({"scene", "hall.cfg", "--svg", "again.svg"}).status == 0);
  CHECK(content(place / "again.svg") == content(place / "hall.svg"));
  REQUIRE(place.run({"scene", "hall.cfg", "--svg", "turned.svg", "--azimuth", "30"}).status == 0);
  CHECK(content(place / "turned.svg") != content(place / "hall.svg"));
  CHECK_THAT(place.run({"scene", "hall.cfg", "--azimuth", "30"}).err, Contains("nothing is drawn without --svg"));

  REQUIRE(place.run({"scene", "hall.cfg", "--gltf", "hall.gltf"}).status == 0);
  const Json gltf = Json::parse(content(place / "hall.gltf"));
  CHECK(gltf["asset"]["version"] == "2.0");
  CHECK(gltf["meshes"].size() == 4);  // the floor, the bounds, the body at start and goal
  REQUIRE(place.run({"scene", "body.obj", "--gltf", "body.glb"}).status == 0);
  CHECK(content(place / "body.glb").starts_with("glTF"));
  CHECK(place.run({"scene", "hall.cfg", "--gltf", "hall.obj"}).err ==
        "trellis: glTF: a name ends with .gltf or .glb, got 'hall.obj'\n");
}

TEST_CASE("scene draws scenes of space by others, in files of bounded size") {
  if (!trellis::test::draws_figures()) return;
  const Place place;
  for (const char* name : {"open_ppl/hook/hook.env", "rl/rlplan/box-6d-300505_maze_rrtConCon.mdl.sixDof.xml",
                           "fcl/env.obj", "fcl/rob.obj"}) {
    const std::filesystem::path path = trellis::test::scene(name);
    if (path.empty()) continue;
    CAPTURE(name);
    const Outcome outcome =
        place.run({"scene", path.string(), "--svg", "scene.svg", "--png", "scene.png", "--gltf", "scene.glb"});
    INFO(outcome.err);
    CHECK(outcome.status == 0);
    CHECK(content(place / "scene.svg").size() < 1'000'000);
    CHECK_THAT(content(place / "scene.svg"), !Contains(" nan") && !Contains("\"nan"));
    CHECK(content(place / "scene.glb").starts_with("glTF"));
  }
}

TEST_CASE("run writes the motions in space as glTF, and says that a planar problem has none") {
  const Place place;
  place.script(
      "script.lua",
      "local hall = problem { name = 'hall', world = world { bounds = {0, 0, 0, 10, 10, 4} }, "
      "robot = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} }, start = pose {1, 1, 1}, goal = pose {9, 9, 3} }\n"
      "return experiment { problems = { hall, scenes.cup() }, strategies = { free = rrt_connect { step = 1 } }, "
      "seeds = 1, measure = false }\n");
  const Outcome outcome = place.run({"run", "script.lua", "--gltf", "motions"});
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.err, Contains("trellis: cup: no glTF, its world is planar\n"));
  CHECK(content(place / "motions/hall/free.glb").starts_with("glTF"));
  CHECK_FALSE(std::filesystem::exists(place / "motions/cup"));
}

TEST_CASE("scene prints what is in the files of a robot, and how a script reads it") {
  const Place place;
  write(place, "two.urdf",
        "<robot name=\"two\">\n<link name=\"a\"/>\n<link name=\"b\"><collision><geometry><sphere radius=\"0.1\"/>"
        "</geometry></collision></link>\n<link name=\"c\"><collision><geometry><mesh filename=\"c.obj\"/></geometry>"
        "</collision></link>\n"
        "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><limit lower=\"-1\" upper=\"2\"/>"
        "</joint>\n<joint name=\"k\" type=\"prismatic\"><parent link=\"b\"/><child link=\"c\"/><limit/></joint>\n"
        "<plug/>\n</robot>\n");
  const Outcome urdf = place.run({"scene", "two.urdf"});
  CHECK(urdf.status == 0);
  CHECK_THAT(urdf.out, Contains("two.urdf: URDF, a robot of links and joints\n") &&
                           Contains("links     3, 1 with collision geometry; the base is 'a'\n") &&
                           Contains("joints    2, 1 can plan, 0 fixed\n") &&
                           Contains("joint     j  revolute    -1 to 2 rad\n") &&
                           Contains("joint     k  prismatic   0 to 0 m: it cannot move\n") &&
                           Contains("meshes    0 files found, 1 not found\n") &&
                           Contains("two.urdf:4: the mesh c.obj of link 'c' is not found") &&
                           Contains("two.urdf:7: 'plug' is not read\n") &&
                           Contains(R"(use       robot.urdf("two.urdf", { missing_meshes = "leave_out" }))"));
  write(place, "two.srdf",
        "<robot name=\"two\">\n<group name=\"arm\"><joint name=\"j\"/></group>\n"
        "<group_state name=\"home\" group=\"arm\"><joint name=\"j\" value=\"0.5\"/></group_state>\n"
        "<disable_collisions link1=\"a\" link2=\"c\"/>\n</robot>\n");
  const std::string use =
      R"(use       robot.urdf("two.urdf", { srdf = "two.srdf", group = "arm", missing_meshes = "leave_out" }))";
  CHECK_THAT(place.run({"scene", "two.urdf"}).out, Contains(use));
  const Outcome srdf = place.run({"scene", "two.srdf"});
  CHECK_THAT(srdf.out, Contains("two.srdf: SRDF, groups and states of a robot\n") &&
                           Contains("group     arm: joint j (1 joint: j)\n") &&
                           Contains("state     home of arm: j 0.5\n") &&
                           Contains("pairs     1 of links that may touch\n") && Contains(use));
  const Json json = Json::parse(place.run({"scene", "two.srdf", "--json"}).out);
  CHECK(json["groups"][0]["joints"] == Json::array({"j"}));
  CHECK(json["joints"][0]["limits"] == Json({-1.0, 2.0}));
  CHECK(json["meshes"][0]["path"].is_null());
  // A SRDF file by itself, and with a robot elsewhere.
  std::filesystem::create_directories(place / "moveit");
  write(place, "moveit/two.srdf",
        "<robot name=\"two\"><group name=\"arm\"><chain base_link=\"a\" tip_link=\"b\"/></group></robot>");
  CHECK_THAT(place.run({"scene", "moveit/two.srdf"}).out,
             Contains("group     arm: chain a to b\n") &&
                 Contains(R"(robot.urdf("FILE.urdf", { srdf = "two.srdf", group = "arm" }))"));
  CHECK_THAT(place.run({"scene", "moveit/two.srdf", "--robot", "two.urdf"}).out, Contains("(1 joint: j)"));
  CHECK_THAT(place.run({"scene", "two.urdf", "--svg", "two.svg"}).err, Contains("is a robot without a world"));
  write(place, "arm.urdf.xacro", "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">\n<xacro:arm/></robot>");
  CHECK_THAT(place.run({"scene", "arm.urdf.xacro"}).err,
             Contains("arm.urdf.xacro:2: a xacro file: expand it first: xacro arm.urdf.xacro > arm.urdf"));
}
