// SPDX-License-Identifier: GPL-3.0-or-later
// Limits of what a script can make large: each is refused before memory is taken, with the limit and the option.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"

using Catch::Matchers::Contains;
using trellis::test::Place;

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr long most_memory = 8L << 20U;  // KiB; the sanitizer's own is most of it
#else
constexpr long most_memory = 1024L << 10U;  // KiB
#endif

const std::string helpers = R"(
local function filled(count, value) local all = {} for i = 1, count do all[i] = value end return all end
local function ring(count)
  local all = {}
  for i = 1, count do
    local a = 2 * math.pi * i / count
    all[i] = {5 + math.cos(a), 5 + math.sin(a)}
  end
  return polygon(all)
end
local function nested(count)
  local strategy = rrt {}
  for i = 1, count do strategy = identity() >> strategy end
  return strategy
end
local function among(obstacles, own, start, resolution)
  obstacles.bounds = {0, 0, 10, 10}
  return problem {
    world = world(obstacles), robot = own or robot.rectangle(0.6, 0.2), start = start or {1, 1, 0},
    goal = start or {9, 9, 0}, resolution = resolution,
  }
end
local plain = among { box {4, 0, 6, 4} }
)";

struct Limited {
  std::string script;
  std::string message;
};

}  // namespace

TEST_CASE("what a script can make large is limited, and the message names the limit and the option", "[limits][slow]") {
  const std::vector<Limited> all = {
      {"return rrt {}, among(filled(1000001, box {4, 0, 6, 4}))", "a world has at most 1000000 obstacles, got 1000001"},
      {"return rrt {}, among { ring(100001) }", "a polygon has at most 100000 vertices, got 100001"},
      {"return rrt {}, among({}, robot.rigid(filled(10001, disc {0, 0, 0.1})))", "at most 10000 shapes, got 10001"},
      {"return rrt {}, among({}, robot.arm { links = filled(201, 0.01), base = {5, 5} }, filled(201, 0.01))",
       "at most 200 links, got 201"},
      {"return rrt { proposals = 1e10 }, plain", "option 'proposals' must be a number in [1, 1e+09]"},
      {"return nested(65), plain", "the hierarchy is deeper than 64 levels"},
      {"return nested(1001), plain", "the composition would have 1001 components; at most 1000 are allowed"},
      {"return blend(filled(2000, goal_bias(0.1))) >> rrt {}, plain", "at most 1000 are allowed"},
      {"return experiment { problems = plain, strategies = { rrt {} }, seeds = 1000001 }",
       "field 'seeds' must be an integer in [1, 1000000]"},
      {"return experiment { problems = plain, strategies = { a = rrt {}, b = prm {} }, seeds = 600000 }",
       "experiment: 1 problems x 2 strategies x 600000 seeds are 1200000 runs; at most 1000000"},
      {"return experiment { problems = plain, strategies = { rrt {} }, measure = tube { pool = 1e8 } }",
       "option 'pool' must be an integer in [64, 1e+07]"},
      {"return skeleton { spacing = 1e-12 } >> rrt {}, plain", "option 'spacing' is 1e-12 m, which makes"},
      {"return workspace { cell = 1e-9 } >> rrt {}, plain",
       "option 'cell' is 1e-09, which makes 1e+10 cells along x; "
       "expected at most 2000"},
      {"return decomposition { size = 1e-9 } >> rrt {}, plain", "triangles of 1e-09 m would be more than 1e+06"},
      {"return rrt {}, among({}, nil, nil, 1e-12)", "would take checks of more than 67108864 configurations"},
      {"return rrt {}, among { box {4, 0, 6, 1e10} }", "coordinates within 1e+09 m of 0"},
      {"return rrt { step = 1e-300 }, plain", "option 'step' must be a number at least 1e-06"},
      {"local t = box {4, 0, 6, 4} for i = 1, 40 do t = {t, t} end return rrt {}, among(t)",
       "world: the lists have over 1500000 values"},
      {"local t = plain for i = 1, 40 do t = {t, t} end "
       "return experiment { problems = t, strategies = { rrt {} } }",
       "experiment: the lists have over 100000 values"},
      {"return skeleton() >> rrt {}, among { disc {5, 5, 1e-15} }",
       "disc 5 5 1e-15: its diameter is 2e-15 m, below the precision of coordinates of up to 5 m; expected at least "
       "2.84e-13 m"},
      {"return rrt {}, among { disc {0, 0, 1e-20} }",
       "obstacle 1 (disc 0 0 1e-20): its diameter is 2e-20 m, below the precision of coordinates of up to 10 m; "
       "expected "
       "at least 5.68e-13 m"},
      {"return rrt {}, among { box {1, 1, 9, 1 + 1e-15} }", "its length along y is 1.11022e-15 m, below the precision"},
      {"return rrt {}, problem { world = world { bounds = {0, 0, 0, 10, 10, 10}, sphere {5, 5, 5, 1e-15} }, "
       "robot = robot.point { dimension = 3 }, start = pose {1, 1, 1}, goal = pose {9, 9, 9} }",
       "sphere 5 5 5 1e-15: its diameter is 2e-15 m, below the precision of coordinates of up to 5 m"},
      {"return rrt {}, among { cylinder { radius = 1, length = 1e-14 } }",
       "cylinder of radius 1 and length 1e-14: its length is 1e-14 m, below the precision of coordinates of up to 1 m"},
  };
  const Place place;
  for (const Limited& one : all) {
    place.script("large.lua", helpers + one.script + "\n");
    const auto outcome = place.run({"run", "large.lua", "--quiet"});
    INFO(one.script << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, Contains(one.message));
    CHECK(outcome.most_memory < most_memory);
  }
}

TEST_CASE("options out of the problem's scale are refused before the run, by name", "[limits]") {
  const std::string driven = R"(
local function driven(model)
  return problem {
    world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 4} }, robot = robot.rectangle(0.6, 0.2), motion = model,
    start = {1, 1, 0}, goal = {9, 9, 0},
  }
end
local function measured(target) return experiment { problems = plain, strategies = { rrt {} }, measure = target } end
local function weighted(weight)
  return problem {
    world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 4} }, robot = robot.rectangle(0.6, 0.2), weight = weight,
    start = {1, 1, 0}, goal = {9, 9, 0},
  }
end
)";
  const std::vector<Limited> all = {
      {"return lazy { sparse = 5e-324 } >> rrt {}, plain",
       "lazy: option 'sparse' is 4.94066e-324 m in the metric, which divides the 14.2 m of problem 'problem' into more "
       "than "
       "1e+06 parts; expected at least 1.42e-05"},
      {"return shrink(0.5) >> lazy { sparse = 1e-9 } >> rrt {}, plain", "lazy: option 'sparse' is 1e-09"},
      {"return rrt { step = 2e-6 }, plain", "rrt: option 'step' is 2e-06"},
      {"return kinodynamic_rrt { controls = math.maxinteger }, driven(motion.unicycle1 {})",
       "kinodynamic_rrt: option 'controls' is 9223372036854775807 controls for each proposal; expected at most 1e+06"},
      {"return measured(near_optimal { epsilon = 1e-9 })", "near_optimal: option 'epsilon' is 1e-09"},
      {"return measured(tube { delta = 5e-324 })", "tube: option 'delta' is 4.94066e-324 m"},
      {"return rrt {}, weighted(1e6)",
       "problem 'problem': option 'weight' is 1e+06 m/rad, so that a turn is 6.28e+06 m long, more than 1e+06 times "
       "the resolution of 0.05 m; expected at most 7.96e+03"},
      {"return rrt {}, weighted(1e300)", "option 'weight' is 1e+300 m/rad"},
      {"return kinodynamic_rrt {}, driven(motion.unicycle1 { max_speed = 1e-310 })",
       "problem 'problem': unicycle1: option 'max_speed' is 1e-310 m/s"},
      {"return kinodynamic_rrt {}, driven(motion.unicycle1 { max_angular_speed = 1e-12 })",
       "unicycle1: option 'max_angular_speed' is 1e-12 rad/s"},
  };
  const Place place;
  for (const Limited& one : all) {
    place.script("scale.lua", helpers + driven + one.script + "\n");
    for (const std::string verb : {"run", "check"}) {
      const auto outcome = place.run({verb, "scale.lua"});
      INFO(one.script << "\n" << outcome.err);
      CHECK(outcome.status == 2);
      CHECK_THAT(outcome.err, Contains(one.message));
      CHECK(outcome.out.empty());
    }
  }
  // What is within the scale runs.
  for (const std::string fine :
       {"return lazy { sparse = 0.01 } >> rrt { step = 0.5 }, plain", "return rrt { step = 0.5 }, weighted(100)",
        "return kinodynamic_rrt { controls = 10, proposals = 10 }, driven(motion.unicycle1 { max_speed = 1 })"}) {
    place.script("scale.lua", helpers + driven + fine + "\n");
    const auto outcome = place.run({"run", "scale.lua", "--quiet"});
    INFO(fine << "\n" << outcome.err);
    CHECK(outcome.status == 0);
  }
}

TEST_CASE("files are measured before they are read", "[limits]") {
  const Place place;
  const auto sparse = [&](const std::string& name) {
    place.script(name, "");
    std::filesystem::resize_file(place / name, std::uintmax_t{3} << 30U);
  };
  sparse("big.stl");
  sparse("big.lua");
  sparse("big.map");
  const std::string spatial =
      "world = world { bounds = {0, 0, 0, 1, 1, 1}, mesh 'big.stl' }, robot = robot.point { dimension = 3 }, "
      "start = pose {0.1, 0.1, 0.1}, goal = pose {0.9, 0.9, 0.9}";
  place.script("mesh.lua", "return rrt {}, problem { " + spatial + " }\n");
  place.script("module.lua", "return require 'big'\n");
  place.script("scene.lua", "return rrt {}, scenes.load('big.map', { start = {1, 1}, goal = {2, 2} })\n");
  for (const std::string script : {"mesh.lua", "module.lua", "scene.lua", "big.lua"}) {
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"run", script, "--quiet"}, {"run", script, "--quiet", "--out", "results"}, {"check", script}}) {
      const auto outcome = place.run(command);
      INFO(script << "\n" << outcome.err);
      CHECK(outcome.status == 2);
      CHECK_THAT(outcome.err, Contains("it has 3221225472 bytes, at most 67108864 are read"));
      CHECK(outcome.most_memory < most_memory / 4);
    }
  }
}

TEST_CASE("pipes and devices are no input files", "[limits]") {
  const Place place;
  place.script("mesh.lua",
               "return rrt {}, problem { world = world { bounds = {0, 0, 0, 1, 1, 1}, mesh 'pipe.stl' }, "
               "robot = robot.point { dimension = 3 }, start = pose {0.1, 0.1, 0.1}, goal = pose {0.9, 0.9, 0.9} }\n");
  place.script("module.lua", "return require 'pipe'\n");
  place.script("scene.lua", "return rrt {}, scenes.load('pipe.map', { start = {1, 1}, goal = {2, 2} })\n");
  place.script("paths.lua", "return experience { db = 'pipe.db' } >> rrt {}, scenes.cup()\n");
  REQUIRE(place.shell("for one in pipe.lua pipe.stl pipe.map pipe.db pipe.json; do mkfifo $one; done").status == 0);
  // No process writes to the pipes: a command that reads one does not end.
  for (const std::string command :
       {"run pipe.lua", "check pipe.lua", "explain pipe.lua", "test pipe.lua", "repl pipe.lua < /dev/null",
        "run mesh.lua", "run module.lua", "run scene.lua", "run paths.lua", "scene pipe.map", "experience pipe.db",
        "verify pipe.json", "report pipe.json --html page.html", "report pipe.json --baseline a --figures tables",
        "run /dev/zero", "verify /dev/zero", "scene /dev/zero", "experience /dev/zero"}) {
    const auto outcome = place.shell("timeout 20 $T " + command);
    INFO(command << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, Contains("expected a regular file"));
  }
}

TEST_CASE("where the system gives no memory, one line says so", "[slow]") {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // the sanitizer reserves more than the limit
  const Place place;
  place.script("long.lua",
               "return experiment { measure = false, seeds = 100000, strategies = { rrt { step = 0.01 } }, problems = "
               "scenes.simple_passage() }\n");
  const auto outcome = place.shell("ulimit -v 300000; $T run long.lua --quiet");
  INFO(outcome.err);
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err, Catch::Matchers::StartsWith("trellis: the system gives no more memory"));
#endif
}
