// SPDX-License-Identifier: GPL-3.0-or-later
// Robots of URDF files, and problems of MoveIt, in the language.
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/manipulators.hpp"
#include "support/scenes.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

const std::string arm = "robot.urdf('six.urdf', { srdf = 'six.srdf', group = 'arm' })";
const std::string head = "local arm = " + arm +
                         " local w = world { bounds = {-2, -2, -2, 2, 2, 2}, contain = 'none', "
                         "sphere {0.5, 0.6, 0.7, 0.15, name = 'lamp'} } ";

/// A folder with the robot's files.
class RobotFolder {
 public:
  RobotFolder() {
    static_cast<void>(folder_.write("six.urdf", test::six_joints));
    static_cast<void>(folder_.write("six.srdf", test::six_joints_srdf));
  }
  [[nodiscard]] std::vector<std::string> values(const std::string& script) const {
    return dsl::Session(folder_.path().string()).evaluate(script, "test.lua");
  }
  [[nodiscard]] std::string failure(const std::string& script) const {
    return test::fault_of([&] { static_cast<void>(values(script)); });
  }
  [[nodiscard]] const test::Folder& folder() const { return folder_; }

 private:
  test::Folder folder_;
};

}  // namespace

TEST_CASE("a robot of a URDF file has joints, links, named states and the poses of its links") {
  const RobotFolder files;
  CHECK(files.values("return " + arm).front() == "robot 'six' with 6 coordinates");
  CHECK(files.values("return table.concat((" + arm + ").joints, ' ')").front() == "turn lift elbow roll wrist flange");
  CHECK(files.values("local a = " + arm + " return a.states.ready[3], #a.links, a.name") ==
        std::vector<std::string>{"0.5", "8", "six"});
  CHECK(files.values("local a = " + arm + " return a:pose({0, 0, 0, 0, 0, 0}, 'tool').position[1]").front() == "0.9");
  CHECK(files.values("return robot.urdf('six.urdf', { group = {'elbow', 'roll'}, values = { lift = 0.3 } })").front() ==
        "robot 'six' with 2 coordinates");
  CHECK(files.values("return #robot.urdf('six.urdf').joints, #robot.urdf('six.urdf', { base = 'planar' }).joints") ==
        std::vector<std::string>{"6", "9"});
  CHECK(files.values("local a = robot.urdf('six.urdf', { base = pose {1, 2, 3} }) return a.base.position[3]").front() ==
        "3.0");
  CHECK(files
            .values("local a = (" + arm +
                    "):attach(box {-0.1, -0.1, -0.1, 0.1, 0.1, 0.1, name = 'tray'}, { link = 'hand', touch = {'l5'} "
                    "}) return a.links[#a.links]")
            .front() == "tray");
}

TEST_CASE("a problem of a robot of links takes names for its ends, and weights a radian as a metre") {
  const RobotFolder files;
  dsl::Session session(files.folder().path().string());
  const auto problems = session.problems(
      head + "return problem { world = w, robot = arm, start = 'ready', goal = {'aside', arm.states.ready} }", "t.lua");
  const Problem& p = problems.front();
  CHECK(p.space.name() == "joints of six");
  CHECK(p.space.axes()[0].periodic);
  CHECK(p.space.axes()[2].weight == 1.0);
  CHECK(p.collision == "spheres");
  CHECK(p.start[2] == 0.5);
  REQUIRE(p.goals.size() == 2);
  CHECK(p.goals[0][0] == 2.0);
  const dsl::Program program = session.load(
      head +
          "return workspace { point = 'tool' } >> shrink(0.5) >> rrt_connect {}, problem { world = w, robot = arm, "
          "start = 'ready', goal = 'aside' }",
      "t.lua");
  CHECK(execute(program.experiment.strategies.front().second, program.experiment.problems.front(), 1).solved);
}

TEST_CASE("a guide in Lua sees the robot of links") {
  const RobotFolder files;
  dsl::Session session(files.folder().path().string());
  const dsl::Program program = session.load(
      head +
          "local thin = guiding_space { robot = function(i) return i.robot:attach(sphere {0, 0, 0, 0.05, name = "
          "'ball'}, "
          "{ link = 'tool' }) end } return thin >> rrt_connect {}, problem { world = w, robot = arm, start = "
          "'ready', goal = 'aside' }",
      "t.lua");
  CHECK(execute(program.experiment.strategies.front().second, program.experiment.problems.front(), 1).solved);
}

TEST_CASE("mistakes about robots of URDF files are answered with the nearest name") {
  const RobotFolder files;
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { srdf = 'six.srdf', group = 'amr' })"),
             Contains("there is no group 'amr' (did you mean 'arm'?); there are: arm, wrist"));
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { group = 'arm' })"), Contains("groups are defined in a SRDF file"));
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { group = {'elbw'} })"),
             Contains("has no joint 'elbw' (did you mean 'elbow'?)"));
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { values = { elbow = 9 } , group = {'turn'} })"),
             Contains("joint 'elbow': 9 is outside of its limits [-2, 2]"));
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { values = { turn = 0 } , group = {'turn'} })"),
             Contains("joint 'turn' moves: it has no fixed value"));
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { srfd = 'six.srdf' })"),
             Contains("unknown option 'srfd' (did you mean 'srdf'?)"));
  CHECK_THAT(files.failure("robot.urdf('seven.urdf')"), Contains("seven.urdf"));
  CHECK_THAT(files.failure(head + "problem { world = w, robot = arm, start = 'redy', goal = 'aside' }"),
             Contains("robot 'six' has no configuration 'redy' (did you mean 'ready'?); there are: ready, aside"));
  CHECK_THAT(files.failure(head + "problem { world = w, robot = arm, start = {0, 0}, goal = 'aside' }"),
             Contains("must have 6 coordinates (turn, lift, elbow, roll, wrist, flange), got 2"));
  CHECK_THAT(files.failure(head + "problem { world = world { bounds = {0, 0, 1, 1} }, robot = arm, start = 'ready', "
                                  "goal = 'aside' }"),
             Contains("the world is planar and the robot is of space"));
  CHECK_THAT(files.failure(head + "arm:attach(disc {0, 0, 1}, { link = 'hand' })"), Contains("a shape of space"));
  CHECK_THAT(files.failure(head + "arm:attach(sphere {0, 0, 0, 1}, { link = 'had' })"),
             Contains("got \"had\" (did you mean 'hand'?)"));
  // A start in collision names the obstacle and the link.
  const std::string blocked =
      "local a = " + arm +
      " local p = a:pose(a.states.ready, 'hand').position "
      "return rrt_connect {}, problem { world = world { bounds = {-2, -2, -2, 2, 2, 2}, contain = 'none', "
      "sphere {p[1], p[2], p[3], 0.1, name = 'lamp'} }, robot = a, start = 'ready', goal = 'aside' }";
  CHECK_THAT(files.failure(blocked), Contains("lamp") && Contains("start"));
}

TEST_CASE("robot.urdf takes folders of packages, soft limits, and leaves missing meshes out") {
  const test::Folder folder;
  static_cast<void>(folder.write(
      "arm.urdf",
      "<robot name=\"arm\"><link name=\"a\"/><link name=\"b\"><collision><geometry><mesh "
      "filename=\"package://hand/tip.obj\"/></geometry></collision></link><joint name=\"j\" type=\"revolute\"><parent "
      "link=\"a\"/><child link=\"b\"/><limit lower=\"-1\" upper=\"1\"/><safety_controller soft_lower_limit=\"-0.5\" "
      "soft_upper_limit=\"0.5\"/></joint></robot>"));
  static_cast<void>(
      folder.write("other/tip.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"));
  const auto values = [&](const std::string& script) {
    return dsl::Session(folder.path().string()).evaluate(script, "test.lua");
  };
  const auto failure = [&](const std::string& script) {
    return test::fault_of([&] { static_cast<void>(values(script)); });
  };
  CHECK_THAT(failure("robot.urdf('arm.urdf')"), Contains("packages = { hand = \"FOLDER\" }"));
  CHECK(values("return robot.urdf('arm.urdf', { missing_meshes = 'leave_out' }).bounding_radius").front() == "0.0");
  CHECK(values("return robot.urdf('arm.urdf', { packages = { hand = 'other' } }).bounding_radius > 1").front() ==
        "true");
  CHECK_THAT(failure("robot.urdf('arm.urdf', { packages = { hand = 'nowhere' } })"), Contains("no folder 'nowhere'"));
  CHECK_THAT(failure("robot.urdf('arm.urdf', { packages = { hand = '/' } })"),
             Contains("neither in the script's folder"));
  CHECK_THAT(failure("robot.urdf('arm.urdf', { packages = {'other'} })"),
             Contains("field 'packages' must be a table") && Contains("got a list"));
  const std::string problem =
      "return problem { world = world { bounds = {-2, -2, -2, 2, 2, 2}, contain = 'none' }, start = {0}, goal = {0.9}, "
      "robot = robot.urdf('arm.urdf', { missing_meshes = 'leave_out', soft_limits = ";
  CHECK(failure(problem + "false }) }").empty());
  CHECK_THAT(failure(problem + "true }) }"), Contains("0.5"));
}

TEST_CASE("a planning scene of MoveIt is a problem of a robot of links") {
  const std::string folder = test::scene("vamp_mbm").string();
  if (folder.empty()) return;
  dsl::Session session(folder);
  const auto problems = session.problems(
      "local panda = robot.urdf('robots/panda/panda_spherized.urdf', { srdf = 'robots/panda/panda.srdf', group = "
      "'panda_arm' }) return scenes.load('panda_samples/bookshelf_small_scene0001.yaml', { robot = panda, resolution "
      "= 0.02 })",
      "t.lua");
  REQUIRE(problems.size() == 1);
  CHECK(problems.front().space.dimension() == 7);
  CHECK(problems.front().resolution == 0.02);
  CHECK(problems.front().scene->obstacle_count() > 3);
  const auto refused = [&](const std::string& options) {
    try {
      static_cast<void>(session.problems(
          "return scenes.load('panda_samples/bookshelf_small_scene0001.yaml'" + options + ")", "t.lua"));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK_THAT(refused(""), Contains("names its robot and does not contain it: give robot = robot.urdf("));
  CHECK_THAT(refused(", { robot = robot.disc(1) }"), Contains("a robot of a URDF file moves"));
}

TEST_CASE("start and goal of scenes.load name joints and states") {
  const RobotFolder files;
  static_cast<void>(files.folder().write("scene.yaml", "world:\n  collision_objects: []\n"));
  dsl::Session session(files.folder().path().string());
  const auto load = [&](const std::string& start, const std::string& goal) {
    return session.problems(
        "return scenes.load('scene.yaml', { robot = " + arm + ", start = " + start + ", goal = " + goal + " })",
        "t.lua");
  };
  const std::string named = "{ turn = 0, lift = 0.1, elbow = 0.5, roll = 0, wrist = 0.3, flange = 0 }";
  const auto problems = load(named, "'aside'");
  CHECK(problems.front().start == Configuration{0, 0.1, 0.5, 0, 0.3, 0});
  CHECK(
      problems.front().goals ==
      session
          .problems(head + "return problem { world = w, robot = arm, start = " + named + ", goal = 'aside' }", "t.lua")
          .front()
          .goals);
  CHECK(load("{0, 0.1, 0.5, 0, 0.3, 0}", named).front().goal() == problems.front().start);
  const auto refused = [&](const std::string& start) {
    return test::fault_of([&] { static_cast<void>(load(start, "'aside'")); });
  };
  CHECK_THAT(
      refused("{ turn = 0, lift = 0.1, elbw = 0.5, roll = 0, wrist = 0, flange = 0 }"),
      Contains("scenes.load: option 'start': robot 'six' has no joint 'elbw' (did you mean 'elbow'?); there are: "
               "turn, lift"));
  CHECK_THAT(refused("{ turn = 0, lift = 0.1 }"), Contains("option 'start': 'elbow', 'roll', 'wrist', 'flange' are "
                                                           "missing"));
  CHECK_THAT(refused("'redy'"), Contains("has no configuration 'redy' (did you mean 'ready'?)"));
  CHECK_THAT(refused("{0, 0.1}"), Contains("option 'start' must have 6 coordinates (turn, lift"));
}

TEST_CASE("scenes.load leaves out the parts of a scene of MoveIt that `ignore` names") {
  const test::Folder folder;
  folder.write(
      "arm.urdf",
      "<robot name='arm'><link name='base'/><link name='tip'><collision><geometry><sphere radius='0.1'/></geometry>"
      "</collision></link><joint name='turn' type='continuous'><parent link='base'/><child link='tip'/><axis "
      "xyz='0 0 1'/></joint></robot>");
  folder.write("scene.yaml",
               "world:\n  collision_objects: []\n  octomap: {octomap: {id: OcTree, data: [1]}}\nother: 1\n");
  folder.write("again.yaml",
               "world:\n  collision_objects: []\n  octomap: {octomap: {id: OcTree, data: [1]}}\nother: 1\n");
  dsl::Session session(folder.path());
  const auto load = [&](const std::string& file, const std::string& options) {
    return test::fault_of([&] {
      static_cast<void>(session.problems("return scenes.load('" + file +
                                             "', { robot = robot.urdf('arm.urdf'), start = {0}, "
                                             "goal = {1}" +
                                             options + " })",
                                         "t.lua"));
    });
  };
  CHECK_THAT(load("scene.yaml", ""),
             Contains("scene.yaml:3: an octomap is not read") && Contains("ignore = { \"octomap\" }"));
  CHECK_THAT(load("scene.yaml", ", ignore = { 'octomp' }"), Contains("did you mean 'octomap'?"));
  CHECK_THAT(load("scene.yaml", ", ignore = 'octomap'"), Contains("option 'ignore' must be a list of names"));
  CHECK(load("scene.yaml", ", ignore = { 'octomap' }").empty());
  CHECK(load("again.yaml", ", ignore = { 'octomap' }").empty());
  // What both files say is there once.
  const std::vector<std::string> warnings = session.take_warnings();
  REQUIRE(warnings.size() == 2);
  CHECK_THAT(warnings[0], Contains("an octomap is not read") && Contains("(and in 1 more file)"));
  CHECK_THAT(warnings[1], Contains("scene.yaml:4: 'other' is not read (and in 1 more file)"));
}

TEST_CASE("a configuration names its joints, and what it lacks or mixes is an error") {
  const RobotFolder files;
  dsl::Session session(files.folder().path().string());
  const std::string named = "{ turn = 0, lift = 0.1, elbow = 0.5, roll = 0, wrist = 0.3, flange = 0 }";
  const auto problems = session.problems(
      head + "return problem { world = w, robot = arm, start = " + named + ", goal = {'aside', " + named + "} }",
      "t.lua");
  CHECK(problems.front().start == Configuration{0, 0.1, 0.5, 0, 0.3, 0});
  REQUIRE(problems.front().goals.size() == 2);
  CHECK(problems.front().goals[1] == problems.front().start);
  const auto refused = [&](const std::string& start) {
    return files.failure(head + "problem { world = w, robot = arm, start = " + start + ", goal = 'aside' }");
  };
  CHECK_THAT(refused("{ turn = 0, lift = 0.1, elbow = 0.5, roll = 0 }"),
             Contains("field 'start': 'wrist', 'flange' are missing; a configuration by names has all of: turn, lift"));
  CHECK_THAT(refused("{ turn = 0, lift = 0.1, elbw = 0.5, roll = 0, wrist = 0, flange = 0 }"),
             Contains("has no joint 'elbw' (did you mean 'elbow'?)"));
  CHECK_THAT(refused("{ turn = 0, lift = 0.1, elbow = 0.5, roll = 0, wrist = 0, flange = 0, mount = 1 }"),
             Contains("joint 'mount' is fixed"));
  CHECK_THAT(refused("{ 0, 0.1, elbow = 0.5 }"), Contains("this is a mixture: 2 values without a name, and 'elbow'"));
  CHECK_THAT(refused("{ turn = 'x', lift = 0.1, elbow = 0.5, roll = 0, wrist = 0, flange = 0 }"),
             Contains("'turn' must be a finite number"));
  // Joints of the robot that are not of its group.
  CHECK_THAT(files.failure("local r = robot.urdf('six.urdf', { group = {'elbow'} }) problem { world = world { bounds = "
                           "{-2, -2, -2, 2, 2, 2} }, robot = r, start = { elbow = 0, lift = 0.1 }, goal = {1} }"),
             Contains("joint 'lift' does not move") && Contains("values = { lift = 0 }"));
  // The plane has names, too.
  CHECK(dsl::Session("")
            .problems(
                "return problem { world = world { bounds = {0, 0, 9, 9} }, robot = robot.rectangle(1, 0.5), start = "
                "{ theta = 1, y = 3, x = 2 }, goal = {7, 7, 0} }",
                "t.lua")
            .front()
            .start == Configuration{2, 3, 1});
}

TEST_CASE("a start within a millionth of a limit is the limit, and messages distinguish numbers") {
  const RobotFolder files;
  dsl::Session session(files.folder().path().string());
  const auto problems = session.problems(
      head + "return problem { world = w, robot = arm, start = {0, 0.1, 2 + 1e-7, 0, 0.3, 0}, goal = 'aside' }",
      "t.lua");
  CHECK(problems.front().start[2] == 2.0);
  CHECK_THAT(
      files.failure(head + "problem { world = w, robot = arm, start = {0, 0.1, 2 + 2e-6, 0, 0.3, 0}, goal = 'aside' }"),
      Contains("elbow = 2.000002, expected it in [-2, 2]"));
}

TEST_CASE("angles that are probably degrees are hinted at") {
  const RobotFolder files;
  CHECK_THAT(files.failure(head + "problem { world = w, robot = arm, start = {0, 0.1, -34, 0, 0, 0}, goal = 'aside' }"),
             Contains("elbow = -34") && Contains("angles are radians: write math.rad(-34)"));
  // A slide is no angle.
  const std::string slid =
      files.failure(head + "problem { world = w, robot = arm, start = {0, 7, 0, 0, 0, 0}, goal = 'aside' }");
  CHECK_THAT(slid, Contains("lift = 7") && !Contains("radians"));
  CHECK_THAT(
      files.failure(head + "problem { world = w, robot = arm, start = 'ready', goal = reach { link = 'tool', pose "
                           "= pose {5, 0, 0, rpy = {0, 90, 0}} } }"),
      Contains("likely out of reach; the pose has rpy = {0, 90, 0}: angles are radians: write math.rad(90)"));
  dsl::Session session(files.folder().path().string());
  static_cast<void>(
      session.evaluate("return pose {0, 0, 0, rpy = {0, 90, 0}}, pose {0, 0, 0, rpy = {0, 1.5, 0}}", "t.lua"));
  CHECK(session.take_warnings().size() == 1);
}

TEST_CASE("goals and starts may be poses of links, several, and of the robots of a team") {
  const RobotFolder files;
  dsl::Session session(files.folder().path().string());
  const std::string at =
      "local function at(q) return arm:pose(q, 'tool') end local a, r = arm.states.aside, "
      "arm.states.ready ";
  const auto reached = [&](const std::string& text) { return session.problems(head + at + text, "t.lua").front(); };
  const Problem several = reached(
      "return problem { world = w, robot = arm, start = r, goal = { reach { link = 'tool', pose = at(a) }, reach { "
      "link = "
      "'tool', pose = at(r) }, a } }");
  CHECK(several.goals.size() >= 3);
  CHECK(several.goals.back() == several.scene->manipulator()->robot.states()[1].q);
  const auto tool = [](const Problem& p, View q, const std::string& link) {
    const SphereModel& robot = p.scene->manipulator()->robot;
    return robot.base() * robot.robot().pose_of(*robot.robot().tree().find_link(link), q);
  };
  const Configuration aside = several.goals.back();
  const Vec3 wanted = tool(several, aside, "tool").position;
  const Problem started =
      reached("return problem { world = w, robot = arm, start = reach { link = 'tool', pose = at(a) }, goal = r }");
  CHECK(norm(tool(started, started.start, "tool").position - wanted) < 1e-3);

  const std::string team =
      "local two = robots { arm, robot.urdf('six.urdf', { srdf = 'six.srdf', group = 'arm', base = pose {0, 5, 0} }) "
      "} ";
  const auto of_team = [&](const std::string& goal) {
    return reached(team +
                   "return problem { world = world { bounds = {-9, -9, -9, 9, 9, 9} }, robot = two, start = {r, r}, "
                   "goal = " +
                   goal + " }");
  };
  // A list with an element for each robot: its own names.
  const Problem each = of_team("{ reach { link = 'tool', pose = at(a) }, 'ready' }");
  for (const Configuration& goal : each.goals) {
    CHECK(norm(tool(each, goal, "1/tool").position - wanted) < 1e-3);
    CHECK(Configuration(goal.begin() + 6, goal.end()) == Configuration(each.start.begin() + 6, each.start.end()));
  }
  // The names of the team: alternatives.
  const Problem either = of_team("{ reach { link = '1/tool', pose = at(a) }, { r, r } }");
  CHECK(either.goals.back() == either.start);
  CHECK(norm(tool(either, either.goals.front(), "1/tool").position - wanted) < 1e-3);
  CHECK(of_team("reach { link = '1/tool', pose = at(a) }").goals.size() > 1);
  const auto fault = [&](const std::string& goal) { return test::fault_of([&] { static_cast<void>(of_team(goal)); }); };
  CHECK_THAT(fault("reach { link = 'tool', pose = at(a) }"), Contains("name the robot, as link = '1/tool'"));
  CHECK_THAT(fault("{ reach { link = 'tol', pose = at(a) }, r }"),
             Contains("has no link '1/tol' (did you mean '1/tool'?)"));
  CHECK_THAT(fault("{ reach { link = '2/tool', pose = at(a) }, r }"), Contains("a link of another robot"));
}

TEST_CASE("of several goals those that nothing reaches are left out with a warning") {
  const RobotFolder files;
  dsl::Session session(files.folder().path().string());
  const auto problems = session.problems(head +
                                             "return problem { world = w, robot = arm, start = 'ready', goal = { reach "
                                             "{ link = 'tool', pose = pose {9, 0, "
                                             "0} }, 'aside' } }",
                                         "t.lua");
  CHECK(problems.front().goals.size() == 1);
  const auto warnings = session.take_warnings();
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings.front(), Contains("goal 1: 0 of 2000 starts") && Contains("it is left out"));
}

TEST_CASE("a robot says whether a configuration is valid, and why not") {
  const RobotFolder files;
  CHECK(files.values(head + "return arm:valid('ready', w)") == std::vector<std::string>{"true"});
  const auto blocked =
      files.values("local arm = " + arm +
                   " local p = arm:pose(arm.states.ready, 'hand').position return arm:valid(arm.states.ready, "
                   "world { bounds = {-2, -2, -2, 2, 2, 2}, sphere {p[1], p[2], p[3], 0.05, name = 'lamp'} })");
  REQUIRE(blocked.size() == 2);
  CHECK(blocked[0] == "false");
  CHECK_THAT(blocked[1], Contains("is in collision with obstacle 1 (lamp)"));
  const auto beyond = files.values(head + "return arm:valid({0, 0.1, 3, 0, 0, 0})");
  REQUIRE(beyond.size() == 2);
  CHECK(beyond[1] == "elbow = 3, expected it in [-2, 2]");
  CHECK_THAT(files.failure(head + "arm.valid('ready')"), Contains("called with a colon"));
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { base = 'planar' }):valid({0, 0, 0, 0, 0, 0, 0, 0, 0})"),
             Contains("the world is missing"));
  // Robots of the plane and bodies have it, too.
  CHECK(dsl::Session("").evaluate("return robot.disc(1):valid({0.5, 5}, world { bounds = {0, 0, 9, 9} })",
                                  "t.lua")[0] == "false");
  CHECK(dsl::Session("").evaluate("return robot.arm { links = {1, 1} }:valid {0, 1}", "t.lua")[0] == "true");
}

TEST_CASE("the validity of a problem is false for an invalid end, and reading it deals with the fault") {
  const RobotFolder files;
  const std::string sampled =
      head +
      "local function ok(elbow) return problem { world = w, robot = arm, start = {0, 0.1, elbow, 0, 0, 0}, goal = "
      "'aside' }.valid end ";
  CHECK(files.values(sampled + "return ok(0.5), ok(3), ok(0.5), ok(-2.5)") ==
        std::vector<std::string>{"true", "false", "true", "false"});
  CHECK(files
            .values(head +
                    "return problem { world = w, robot = arm, start = 'ready', goal = reach { link = 'tool', pose "
                    "= pose {9, 0, 0} } }.valid")
            .front() == "false");
  // Unread it is a mistake, and so is a problem that is used all the same.
  const std::string invalid =
      "local p = problem { world = w, robot = arm, start = {0, 0.1, 3, 0, 0, 0}, goal = 'aside' } ";
  CHECK_THAT(files.failure(head + invalid), Contains("elbow = 3"));
  CHECK_THAT(files.failure(head + invalid + "local v = p.valid local s = p.start"), Contains("elbow = 3"));
  CHECK_THAT(files.failure(head + invalid +
                           "local v = p.valid return experiment { problems = {p}, strategies = { a = "
                           "rrt_connect {} } }"),
             Contains("elbow = 3"));
  CHECK(files
            .values(head + "return (pcall(problem, { world = w, robot = arm, start = {0, 0.1, 3, 0, 0, 0}, goal = "
                           "'aside' }))")
            .front() == "false");
}

TEST_CASE("a robot solves its inverse kinematics, and lists its joints with their limits") {
  const RobotFolder files;
  const std::string at = head + "local p = arm:pose(arm.states.aside, 'tool') ";
  CHECK(files.values(at +
                     "local found = arm:ik { link = 'tool', pose = p, world = w, count = 3 } local near = true for _, "
                     "q in ipairs(found) do local at = arm:pose(q, 'tool').position near = near and math.abs(at[1] - "
                     "p.position[1]) < 1e-3 and arm:valid(q, w) end return #found > 0 and #found <= 3, near") ==
        std::vector<std::string>{"true", "true"});
  // From a configuration: the nearest to it comes first.
  CHECK(files
            .values(at +
                    "local q = arm:ik { link = 'tool', pose = p, seed = 'aside' }[1] return q[1] == 2.0 and q[2] == "
                    "0.2")
            .front() == "true");
  const auto none =
      files.values(head + "local found, why = arm:ik { link = 'tool', pose = pose {9, 0, 0} } return #found, why");
  CHECK(none[0] == "0");
  CHECK_THAT(none[1], Contains("likely out of reach"));
  CHECK_THAT(files.failure(head + "arm:ik { link = 'tol', pose = pose {} }"), Contains("did you mean 'tool'?"));
  CHECK_THAT(files.failure(head + "arm:ik { link = 'tool' }"), Contains("field 'pose' is missing"));
  CHECK_THAT(files.failure(head + "arm:ik { link = 'tool', pose = pose {}, cuont = 2 }"),
             Contains("unknown option 'cuont' (did you mean 'count'?)"));
  CHECK(files.values("local j = (" + arm +
                     "):joints() return #j, j[1].name, j[1].kind, j[1].lower, j[2].kind, j[3].upper, "
                     "j[3].velocity") ==
        std::vector<std::string>{"6", "turn", "continuous", "nil", "prismatic", "2.0", "nil"});
  CHECK(files.values("return #(" + arm + ").joints, (" + arm + ").joints[2]") == std::vector<std::string>{"6", "lift"});
}

TEST_CASE("the bounds of a world contain nothing of an arm with a fixed base, unless a script says so") {
  const RobotFolder files;
  const auto valid = [&](const std::string& options, const std::string& robot) {
    return files
        .values("local r = " + robot +
                " return r:valid(r.states and r.states.ready or {0.5, 0.5, 0, 0, 0.1, 0.5, "
                "0, 0.3, 0}, world { bounds = {0, 0, 0, 1, 1, 1}" +
                options + " })")
        .front();
  };
  CHECK(valid("", arm) == "true");
  CHECK(valid(", contain = 'robot'", arm) == "false");
  CHECK(valid("", "robot.urdf('six.urdf', { base = 'planar' })") == "false");
}

TEST_CASE("a robot with a floating base plans as others do") {
  const RobotFolder files;
  CHECK(files.values("return #robot.urdf('six.urdf', { base = 'floating' }).joints").front() == "13");
  CHECK_THAT(files.failure("robot.urdf('six.urdf', { base = 'flying' })"),
             Contains("must be a pose, \"planar\" or \"floating\""));
  dsl::Session session(files.folder().path().string());
  const std::string room =
      "local hand = robot.urdf('six.urdf', { srdf = 'six.srdf', group = {'wrist'}, base = 'floating' }) "
      "local w = world { bounds = {-3, -3, -3, 3, 3, 3}, box {-0.1, -3, -3, 0.1, 3, 0.5, name = 'wall'} } ";
  const std::string ends =
      "problem { world = w, robot = hand, start = {1.5, 0, 0, 0, 0, 0, 1, 0}, "
      "goal = {-1.5, 0, 0, 0, 0, 1, 0, 0.5} }";
  for (const char* strategy :
       {"rrt_connect {}", "skeleton() >> rrt_connect {}", "shrink(0.5) >> lazy() >> rrt_connect {}",
        "joints { 1, 2, 3, 4, 5, 6, 7 } >> rrt_connect {}", "workspace { point = 'tool' } >> prm {}",
        "skeleton { explore = 0.1 } >> rrt_connect {}"}) {
    INFO(strategy);
    const dsl::Program program = session.load(room + "return " + strategy + ", " + ends, "t.lua");
    const Problem& problem = program.experiment.problems.front();
    CHECK(problem.space.dimension() == 8);
    CHECK(problem.space.degrees() == 7);
    CHECK(execute(program.experiment.strategies.front().second, problem, 1).solved);
  }
  // A quaternion has norm 1, a coordinate a name, a goal a pose of a link.
  CHECK_THAT(
      files.failure(room + "return problem { world = w, robot = hand, start = {1.5, 0, 0, 1, 1, 0, 1, 0}, goal = "
                           "{-1.5, 0, 0, 0, 0, 1, 0, 0.5} }"),
      Contains("its coordinates 4 to 7 are the quaternion x, y, z, w of an orientation, of norm 1"));
  const Problem reached =
      session
          .problems(room +
                        "return problem { world = w, robot = hand, start = {1.5, 0, 0, 0, 0, 0, 1, 0}, goal = reach { "
                        "link = 'tool', pose = pose {-1.5, 1, 1, rpy = {1, 2, 3}} } }",
                    "t.lua")
          .front();
  const SphereModel& robot = reached.scene->manipulator()->robot;
  const Vec3 tool = robot.robot().pose_of(*robot.robot().tree().find_link("tool"), reached.goals.front()).position;
  CHECK(norm(tool - Vec3{-1.5, 1, 1}) < 1e-3);
  CHECK_THAT(files.failure(room + "return problem { world = w, robot = hand, start = {0, 0, 0, 0, 0, 0, 1, 0}, goal = "
                                  "{-1.5, 0, 0, 0, 0, 1, 0, 0.5} }"),
             Contains("(wall"));
}

TEST_CASE("an arm, a disc and a body are one team, which every division plans for") {
  const RobotFolder files;
  dsl::Session session(files.folder().path().string());
  const std::string gate =
      "local w = world { bounds = {-3, -3, -0.5, 3, 3, 2}, contain = 'none', box {-0.1, 1, -0.5, 0.1, 3, 1.2} } "
      "local all = robots { robot.arm { links = {0.8, 0.8}, width = 0.12, base = {-1.2, 0} }, robot.disc(0.25), "
      "robot.rigid { box {-0.25, -0.25, -0.06, 0.25, 0.25, 0.06} }, " +
      arm +
      ", height = 0.5 } "
      "local p = problem { world = w, robot = all, "
      "start = { {1.5, -0.1}, {-2, -2}, pose {2, -2, 1}, {0, 0.1, 0.5, 0, 0.3, 0} }, "
      "goal = { {2.5, -0.4}, {2, 2}, pose {-2, 2, 1, axis = {0, 0, 1}, angle = 1.5}, "
      "{2, 0.2, 0.4, 0.2, 0.3, 0} } } ";
  for (const char* strategy : {"rrt_connect {}", "prioritise() >> rrt_connect {}", "couple() >> rrt_connect {}",
                               "decouple() >> rrt_connect {}", "team { 2, 3 } >> rrt_connect {}",
                               "prioritise() >> lazy() >> rrt_connect {}", "shrink(0.5) >> rrt_connect {}"}) {
    INFO(strategy);
    const dsl::Program program = session.load(gate + "return " + strategy + ", p", "t.lua");
    const Problem& problem = program.experiment.problems.front();
    CHECK(problem.space.dimension() == 2 + 2 + 7 + 6);
    CHECK(problem.scene->members().size() == 4);
    const RunRecord run = execute(program.experiment.strategies.front().second, problem, 1);
    CHECK(run.solved);
  }
  CHECK_THAT(files.failure("return robots { " + arm + ", robot.disc(0.3) }"),
             Contains("element 2 is of the plane, and element 1 of space: give the height"));
  CHECK_THAT(files.failure("return robots { robot.disc(0.3), robot.rigid { sphere {0, 0, 0, 0.1} } }"),
             Contains("element 2 is of space, and element 1 of the plane: give the height"));
  CHECK_THAT(files.failure("return robots { " + arm + ", robot.disc(0.3), height = -1 }"), Contains("'height'"));
  CHECK_THAT(files.failure("return robots { " + arm + ", robot.point(), height = 1 }"),
             Contains("a point has no height"));
}
