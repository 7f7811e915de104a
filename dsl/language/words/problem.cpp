// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/problem.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <dsl/language/core/script_place.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/core/word.hpp>
#include <dsl/language/words/ends.hpp>
#include <dsl/language/words/manipulator.hpp>
#include <dsl/language/words/motion.hpp>
#include <dsl/language/words/scene_values.hpp>
#include <trellis/base/input_file.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/experiment/input_warnings.hpp>
#include <trellis/instance/end_fault.hpp>
#include <trellis/instance/path_fault.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/motion/team_model.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

/// The member of a problem that says whether start and goals are valid.
constexpr const char* valid_member = "valid";

// The settings that problems of scripts and problems of files share.
struct LoadSettings {
  double weight = 1.0 / std::numbers::pi;
  double resolution = Problem{}.resolution;
  double contact_tolerance = Problem{}.contact_tolerance;
  std::string collision = "auto";
  std::string map_server = "nav2";
  bool motion = true;
  double goal_tolerance = ReadOptions{}.goal_tolerance;
  std::int64_t agents = 0;
  double radius = ReadOptions{}.agent_radius;
};
struct ProblemSettings {
  double weight = LoadSettings{}.weight;
  double resolution = LoadSettings{}.resolution;
  double contact_tolerance = LoadSettings{}.contact_tolerance;
  std::string collision = "auto";
  double goal_tolerance = Problem{}.goal_tolerance;
};

template <class S>
Settings<S> with_scene_options(Settings<S> settings) {
  return settings
      .number("weight", &S::weight, "m/rad", Range::positive(),
              "metres of the metric per radian of turning; if this is not given, of a body in space, or a floating "
              "base, the radius of what turns, and of the joints of a manipulator 1")
      .number("resolution", &S::resolution, "m", Range::positive(),
              "how far the robot's fastest point moves between two checked configurations")
      .number(
          "contact_tolerance", &S::contact_tolerance, "m", Range::non_negative(),
          "how finely the certificate of a path divides its motions: a motion that is undecided at this displacement "
          "of the robot's points counts as contact; 0: a millionth of resolution")
      .choice(
          "collision", &S::collision, {"auto", "planar", "fcl", "fcl_plain", "spheres"},
          "the collision backend: in the plane \"planar\" or \"fcl\"; in space \"fcl\", which decides what it can by "
          "bounds on distances, or \"fcl_plain\" without these; of a manipulator \"spheres\"; \"auto\" is the first "
          "that "
          "the problem has");
}

const Settings<ProblemSettings>& problem_settings() {
  static const auto settings =
      with_scene_options(Settings<ProblemSettings>(Component::Kind::scene, "problem", "a planning problem", ""))
          .number("goal_tolerance", &ProblemSettings::goal_tolerance, "m", Range::non_negative(),
                  "a configuration this near to the goal in the metric is the goal; where the problem has a motion "
                  "model and "
                  "this is not given, 0.25, because controls that are constant over whole steps hit no goal exactly");
  return settings;
}

const Settings<LoadSettings>& load_settings() {
  static const auto settings =
      with_scene_options(Settings<LoadSettings>(Component::Kind::scene, "scenes.load", "reads a scene file", ""))
          .boolean("motion", &LoadSettings::motion,
                   "robots have the motion models that a file of dynobench names; false: they move straight")
          .choice(
              "map_server", &LoadSettings::map_server, {"nav2", "ros1"},
              "the map server whose rules decide which pixels of a map of ROS are free: that of Nav2 takes luma, and "
              "transparent pixels are unknown; that of ROS 1 takes the mean of the channels")
          .integer("agents", &LoadSettings::agents, "robots", {.lo = 0, .hi = Robot::most_members},
                   "of queries of Moving AI: the first so many are one problem of a team; 0: each is a problem of its "
                   "own")
          .number("radius", &LoadSettings::radius, "m", Range::positive(),
                  "of the discs that these agents are, unless `robot` is given")
          .number("goal_tolerance", &LoadSettings::goal_tolerance, "m", Range::positive(),
                  "of problems with a motion model: a state this near to the goal in the metric is the goal");
  return settings;
}

/// The space of a robot whose weight of rotations is given, else its own.
Space space_of(const Scene& scene, double weight, bool given) {
  if (!given && scene.spatial() != nullptr) return scene.spatial()->own_space();
  if (!given && scene.manipulator() != nullptr) return scene.manipulator()->own_space();
  return scene.default_space(weight);
}

/// The backend's name for "auto".
std::string backend_of(const Scene& scene, const std::string& collision) {
  const auto known = collision_backends(scene);
  if (collision == "auto") return known.front();
  if (std::find(known.begin(), known.end(), collision) != known.end()) return collision;
  throw Error(fmt::format("problem: collision = \"{}\" is not for {}; there is {}", collision,
                          scene.planar() != nullptr        ? "the plane"
                          : scene.manipulator() != nullptr ? "a manipulator"
                                                           : "space",
                          fmt::join(known, " and ")));
}

/// The motion models that a field lists, or the one that it is; none where it is neither.
std::vector<Motion> motions_in(Value value) {
  std::vector<Motion> all;
  if (const auto* one = value.get<Motion>()) return {*one};
  if (value.type() != lua::Type::table) return all;
  bool fits = true;
  value.each([&](std::size_t, Value element) {
    const auto* one = element.get<Motion>();
    fits = fits && one != nullptr && team_model(**one) == nullptr;
    if (fits) all.push_back(*one);
  });
  return fits ? all : std::vector<Motion>();
}

/// The motion model of a robot; of a team that of all robots, each driven by its own.
/// \param given  at least one; one alone drives each robot of a team
Motion motion_of(std::vector<Motion> given, const Scene& scene) {
  const std::vector<TeamMember> members = scene.members();
  if (members.size() < 2 || scene.manipulator() != nullptr) {
    if (given.size() == 1) return given.front();
    throw Error(fmt::format("problem: field 'motion' lists {} motion models, and '{}' is one robot: give one",
                            given.size(), scene.robot_name()));
  }
  if (given.size() == 1 && team_model(*given.front()) != nullptr) return given.front();
  if (given.size() == 1) given.resize(members.size(), Motion(given.front()));
  if (given.size() != members.size()) {
    throw Error(
        fmt::format("problem: field 'motion' lists {} motion models for {} robots; give one for each, or one "
                    "for all",
                    given.size(), members.size()));
  }
  std::vector<std::vector<std::size_t>> axes;
  axes.reserve(members.size());
  for (const TeamMember& member : members) axes.push_back(member.axes);
  return std::make_shared<const TeamModel>(given, axes);
}

/// Reads the world, the robot and the motion model, which say what the coordinates are.
void read_scene(const Arguments& arguments, Problem& problem, lua::Faults& faults) {
  const auto world = world_in(arguments["world"]);
  const auto robot = robot_in(arguments["robot"]);
  const std::vector<Motion> motion = motions_in(arguments["motion"]);
  for (const auto& [name, missing] : {std::pair{"world", !world}, {"robot", !robot}, {"motion", motion.empty()}}) {
    if (missing && arguments[name].given()) {
      faults.attempt([&, name = name] { arguments.reject(name); });
    }
  }
  ProblemSettings settings;
  faults.attempt([&] { settings = problem_settings().read(arguments.options()); });
  if (!faults.none() && (!world || !robot)) return;
  if (!faults.attempt([&] { problem.scene = make_scene(*world, *robot); })) return;
  problem.space = space_of(*problem.scene, settings.weight, arguments["weight"].given());
  if (!motion.empty()) {
    const bool driven = faults.attempt([&] {
      problem.motion_model = motion_of(motion, *problem.scene);
      problem.space = state_space(problem.space, *problem.motion_model);
    });
    if (!driven) problem.motion_model = nullptr;
  }
  problem.goal_tolerance =
      !motion.empty() && !arguments["goal_tolerance"].given() ? ReadOptions{}.goal_tolerance : settings.goal_tolerance;
  problem.resolution = settings.resolution;
  problem.contact_tolerance = settings.contact_tolerance;
  faults.attempt([&] { problem.collision = backend_of(*problem.scene, settings.collision); });
}

int make_problem(Stack& call, std::vector<std::string>& warnings) {
  lua::Faults faults;
  const Arguments arguments(problem_construct(), call, faults);
  if (!arguments.readable()) faults.raise();
  Problem problem;
  read_scene(arguments, problem, faults);
  faults.attempt([&] {
    problem.name = arguments.string("name").value_or("problem");
    if (problem.name.empty()) throw Error("problem: field 'name' must not be empty");
  });
  const bool motion = arguments["motion"].given();
  // A start or goal that is not valid is no mistake of a script that reads `valid`.
  std::optional<InvalidEnd> invalid;
  const auto read = [&](const auto& body) {
    return faults.attempt([&] {
      try {
        body();
      } catch (const InvalidEnd& error) {
        if (!invalid) invalid = error;
      }
    });
  };
  if (problem.scene && motion == static_cast<bool>(problem.motion_model)) {
    if (const Value start = arguments["start"]; start.given()) {
      read([&] { problem.start = read_start(start, problem); });
    }
    if (const Value goal = arguments["goal"]; goal.given()) {
      read([&] { problem.goals = read_goals(goal, problem, warnings); });
    }
  }
  faults.raise();
  if (invalid) throw lua::DeniedError(valid_member, invalid->what());
  fit_covers_to_ends(problem, warnings);
  try {
    check(problem);
  } catch (const Error& error) {
    std::vector<Configuration> ends = problem.goals;
    ends.insert(ends.begin(), problem.start);
    std::string message = error.what() + degrees_hint(problem, ends);
    // A mesh of another unit often covers start and goal.
    if (const std::string hint = unit_warning(problem); !hint.empty()) message += "; " + hint;
    if (dynamic_cast<const InvalidEnd*>(&error) != nullptr) throw lua::DeniedError(valid_member, message);
    throw Error(message);
  }
  return call.result(std::move(problem));
}

void push_coordinates(Stack& call, View q) {
  const Value list = call.push_table();
  for (const double x : q) {
    call.push(x);
    call.append(list);
  }
}

bool ends_are_valid(const Problem& problem) {
  try {
    check(problem);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// The members of a problem that a script may read, under the names of `problem`'s fields.
const std::map<std::string, void (*)(Stack&, const Problem&)>& readable() {
  static const std::map<std::string, void (*)(Stack&, const Problem&)> fields = {
      {"name", [](Stack& call, const Problem& p) { call.push(p.name); }},
      {"world", [](Stack& call, const Problem& p) { push_world(call, *p.scene); }},
      {"robot", [](Stack& call, const Problem& p) { push_robot(call, *p.scene); }},
      {"motion",
       [](Stack& call, const Problem& p) {
         if (p.motion_model) {
           call.push_object(p.motion_model);
         } else {
           call.push_nil();
         }
       }},
      {"start", [](Stack& call, const Problem& p) { push_coordinates(call, p.start); }},
      {"goal",
       [](Stack& call, const Problem& p) {
         if (p.goals.size() == 1) return push_coordinates(call, p.goal());
         const Value list = call.push_table();
         for (const Configuration& goal : p.goals) {
           push_coordinates(call, goal);
           call.append(list);
         }
       }},
      {"goal_tolerance", [](Stack& call, const Problem& p) { call.push(p.goal_tolerance); }},
      {"contact_tolerance", [](Stack& call, const Problem& p) { call.push(certificate_tolerance(p)); }},
      {"resolution", [](Stack& call, const Problem& p) { call.push(p.resolution); }},
      {"collision", [](Stack& call, const Problem& p) { call.push(p.collision); }},
      {valid_member, [](Stack& call, const Problem& p) { call.push(ends_are_valid(p)); }}};
  return fields;
}

int read_field(Stack& call) {
  const auto* problem = call[1].get<Problem>();
  const auto name = call[2].string();
  const auto field = name ? readable().find(*name) : readable().end();
  if (problem == nullptr || field == readable().end()) {
    std::vector<std::string> known;
    for (const auto& [key, read] : readable()) known.push_back(key);
    throw Error(fmt::format("a problem has no field {}{}", call[2].describe(), name ? did_you_mean(*name, known) : ""));
  }
  field->second(call, *problem);
  return 1;
}

int problem_text(Stack& call) {
  const auto* problem = call[1].get<Problem>();
  if (problem == nullptr) return call.result(call[1].describe());
  return call.result(fmt::format("problem '{}' in {}", problem->name, problem->space.name()));
}

const Field scene_file = {"file", "string", "the name of a file",
                          "looked for in the script's folder, then in the folder of scenes (TRELLIS_SCENES)", true};

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored);
}

/// The folders that a script may read: its own, and that of scenes if TRELLIS_SCENES names one.
std::vector<std::string> scene_folders(const std::string& script_folder) {
  const char* scenes = std::getenv("TRELLIS_SCENES");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  std::vector<std::string> folders = {script_folder};
  if (scenes != nullptr && *scenes != '\0') folders.emplace_back(scenes);
  return folders;
}

std::vector<std::filesystem::path> scene_paths(const std::string& file, const std::string& script_folder) {
  if (std::filesystem::path(file).is_absolute()) return {std::filesystem::path(file).lexically_normal()};
  std::vector<std::filesystem::path> paths;
  for (const auto& folder : scene_folders(script_folder)) {
    paths.push_back((std::filesystem::path(folder) / file).lexically_normal());
  }
  return paths;
}

/// \throws Error for a file outside of the folders of scenes.
void require_within(const char* function, const std::string& file, const std::string& script_folder) {
  if (lies_within(file, scene_folders(script_folder))) return;
  throw Error(
      fmt::format("{}: '{}' lies neither in the script's folder nor in the folder of scenes; --trust lets a script "
                  "that you trust read it",
                  function, file));
}

std::string file_argument(Stack& call, const char* function) {
  const auto file = call[1].string();
  if (!file || file->empty()) {
    throw Error(fmt::format("{}: the file must be a string, as in {} \"ompl_tests/circle_obstacles.txt\", got {}",
                            function, function, describe(call[1])));
  }
  return *file;
}

}  // namespace

const Construct& problem_construct() {
  static const Construct construct = {
      .name = "problem",
      .usage = "problem { world = w, robot = r, start = {1, 8.5, 0}, goal = {9, 1.5, 0} }",
      .summary = "a planning problem: what the robot is, where it is, and where it is to go",
      .list = "",
      .element = "",
      .fields =
          {{"name", "string", "a string", "how the report calls it", false, "\"problem\""},
           {"world", "trellis.World", "a world", "as world { ... } makes it", true},
           {"robot", "trellis.Robot|trellis.Manipulator", "a robot", "as robot.rectangle(0.6, 0.2) makes it", true},
           {"start", "number[]|table<string, number>|trellis.Pose|string|trellis.Reach",
            "a list of numbers, a table as { lift = 0.1, elbow = 1 }, a pose, a name, or reach { ... }",
            "the start configuration, in metres and radians: a list, or each coordinate by its name; with a motion "
            "model its velocities follow; of a body in space its pose, or x, y, z and a quaternion x, y, z, w; of a "
            "manipulator also the name of a state, or the pose of a link. A coordinate within 1e-6 of a bound is moved "
            "to it",
            true},
           {"goal",
            "number[]|number[][]|table<string, number>|trellis.Pose|trellis.Pose[]|string|string[]|trellis.Reach|"
            "trellis.Reach[]",
            "a list of numbers, a table as { lift = 0.1, elbow = 1 }, a pose, a name, or reach { ... }; or a list of "
            "these",
            "the goal configuration, in metres and radians, or several of which any will do", true},
           {"motion", "trellis.Motion|trellis.Motion[]",
            "a motion model, as motion.unicycle1 {}, or of a team a list with one for each robot",
            "how the robot is driven; without one it moves straight to any configuration. It drives each robot of a "
            "team, or a list has one for each"}},
      .options = problem_settings().component(),
      .returns = "trellis.Problem"};
  return construct;
}

ObjectType problem_type() {
  ObjectType type{"trellis.Problem", "a planning problem", "", {}, {}};
  const Construct& construct = problem_construct();
  for (Field field : construct.fields) {
    if (readable().contains(field.name)) type.members.push_back(std::move(field));
  }
  type.members.push_back(
      {valid_member, "boolean", "",
       "whether start and goals are within their bounds and touch nothing. A problem whose ends are not valid is an "
       "error only where the script does not read this, or uses the problem all the same"});
  for (const Option& option : construct.options.options) {
    if (!readable().contains(option.name)) continue;
    type.members.push_back({option.name, option.type == Option::Type::choice ? "string" : "number", "", option.doc});
  }
  return type;
}

namespace {

std::vector<Field> load_fields() {
  return {
      {"name", "string", "a string",
       "how the report calls the problem, in place of the file's name for it; of n problems name/1 to name/n"},
      {"robot", "trellis.Robot|trellis.Manipulator", "a robot",
       "moves in the world of a file that has no robot; without it a point, or in BARN a disc of 0.215 m; a scene of "
       "MoveIt needs a robot of a URDF file"},
      {"start", "number[]|table<string, number>|trellis.Pose|string",
       "a list of numbers; of a body in space a pose; of a robot of a URDF file a table as { lift = 0.1, elbow = 1 }, "
       "or the name of a state",
       "the start, in place of the file's or where it has none"},
      {"goal", "number[]|table<string, number>|trellis.Pose|string",
       "a list of numbers; of a body in space a pose; of a robot of a URDF file a table as { lift = 0.1, elbow = 1 }, "
       "or the name of a state",
       "the goal, in place of the file's or where it has none"},
      {"ignore", "string[]", "a list of parts of a scene of MoveIt, as { \"octomap\" }",
       "parts that are left out, which are errors otherwise, because other configurations are valid without them: "
       "octomap, path_constraints, trajectory_constraints, allowed_collision_matrix (its entries of a link and an "
       "object)"}};
}

}  // namespace

const Construct& load_construct() {
  static const Construct construct = {.name = "scenes.load",
                                      .usage = "scenes.load(\"ompl_tests/circle_obstacles.txt\", { resolution = 0.1 })",
                                      .summary = "the problems in a scene file made by others",
                                      .list = "",
                                      .element = "",
                                      .fields = load_fields(),
                                      .options = load_settings().component(),
                                      .returns = "trellis.Problem[]",
                                      .arguments = {scene_file}};
  return construct;
}

const Construct& robot_file_construct() {
  static const Construct construct = {.name = "scenes.robot",
                                      .usage = "scenes.robot \"bench_mr/shared/car.svg\"",
                                      .summary = "a robot with the outline that a drawing (SVG) of one shape has",
                                      .list = "",
                                      .element = "",
                                      .fields = {},
                                      .options = {},
                                      .returns = "trellis.Robot",
                                      .arguments = {scene_file}};
  return construct;
}

const Construct& exists_construct() {
  static const Construct construct = {.name = "scenes.exists",
                                      .usage = "scenes.exists \"ompl_tests/circle_obstacles.txt\"",
                                      .summary = "whether there is a scene file that scenes.load would find",
                                      .list = "",
                                      .element = "",
                                      .fields = {},
                                      .options = {},
                                      .returns = "boolean",
                                      .arguments = {scene_file}};
  return construct;
}

std::string find_scene(const std::string& file, const std::string& script_folder) {
  for (const auto& path : scene_paths(file, script_folder)) {
    if (is_file(path)) return path.string();
  }
  return "";
}

std::string missing_scene(const std::string& file, const std::string& script_folder) {
  std::string tried;
  const auto paths = scene_paths(file, script_folder);
  for (const auto& one : paths) tried += (tried.empty() ? "" : ", ") + one.string();
  const bool no_scenes = paths.size() == 1 && !std::filesystem::path(file).is_absolute();
  return fmt::format("no file '{}' (looked for {}{})", file, tried,
                     no_scenes ? "; the environment's TRELLIS_SCENES names no folder of scenes" : "");
}

std::string scene_path(const char* function, const std::string& file, const ScriptPlace& place) {
  if (!place.trust) require_within(function, file, place.folder);
  std::string path = find_scene(file, place.folder);
  if (path.empty()) throw Error(fmt::format("{}: {}", function, missing_scene(file, place.folder)));
  // The reader refuses any other file, and says why.
  if (place.watch && input_fault(path, largest_file).empty()) place.watch(file, path);
  return path;
}

std::string scene_folder(const char* function, const std::string& folder, const ScriptPlace& place) {
  if (!place.trust) require_within(function, folder, place.folder);
  std::string tried;
  for (const auto& path : scene_paths(folder, place.folder)) {
    std::error_code fault;
    if (std::filesystem::is_directory(path, fault)) return path.string();
    tried += (tried.empty() ? "" : ", ") + path.string();
  }
  throw Error(fmt::format("{}: no folder '{}' (looked for {})", function, folder, tried));
}

namespace {

/// \throws Error unless the second argument of scenes.load is a table of fields and options
void check_load_table(Stack& call) {
  const Component& component = load_settings().component();
  if (call.count() > 2 || call[2].type() != lua::Type::table) {
    throw Error(fmt::format("scenes.load: after the file a table belongs, as {{ resolution = 0.1 }}, got {}",
                            call.count() > 2 ? fmt::format("{} arguments", call.count()) : describe(call[2])));
  }
  std::vector<std::string> known;
  for (const Field& field : load_construct().fields) known.push_back(field.name);
  for (const Option& option : component.options) known.push_back(option.name);
  const lua::Keys keys = call[2].keys();
  if (keys.length > 0 || !keys.odd.empty()) throw Error("scenes.load: options have names, as in { resolution = 0.1 }");
  lua::Faults faults;
  for (const auto& name : keys.names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    faults.add(fmt::format("scenes.load: unknown option '{}'{}; its options are: {}", name, did_you_mean(name, known),
                           fmt::join(known, ", ")));
  }
  faults.raise();
}

/// Returns the problem of a robot of a URDF file whose world is not read yet: what the coordinates are.
Problem without_world(const SphereModel& robot) {
  constexpr double wide = 1e6;  // m: no coordinate of a base that moves is near these bounds
  const World3 world({{-wide, -wide, -wide}, {wide, wide, wide}}, {}, Contain::none);
  Problem problem;
  problem.scene = std::make_shared<const ManipulatorScene>(world, robot);
  problem.space = problem.scene->default_space(1.0);
  return problem;
}

/// Reads the table of scenes.load: the name, the robot, start and goal, and the options into `given`.
ReadOptions read_load_fields(Stack& call, std::vector<Options::Entry>& given, std::optional<std::string>& name) {
  ReadOptions options;
  if (call.count() < 2) return options;
  check_load_table(call);
  lua::Faults faults;
  for (const Option& option : load_settings().component().options) {
    const Value value = call[2].field(option.name);
    if (value.given()) {
      faults.attempt([&] { read_option(load_settings().component(), option.name, value, given); });
    }
  }
  if (const Value value = call[2].field("name"); value.given()) {
    faults.attempt([&] {
      name = value.string();
      if (!name || name->empty()) {
        throw Error(
            fmt::format("scenes.load: option 'name' must be a string that is not empty, got {}", describe(value)));
      }
    });
  }
  if (const Value value = call[2].field("robot"); value.given()) {
    faults.attempt([&] {
      const auto robot = robot_in(value);
      if (!robot) {
        throw Error(fmt::format("scenes.load: option 'robot' must be a robot, as scenes.robot \"car.svg\", got {}",
                                describe(value)));
      }
      if (const auto* planar = std::get_if<Robot>(&*robot)) options.robot = *planar;
      if (const auto* manipulator = std::get_if<SphereModel>(&*robot))
        options.manipulator = std::make_shared<const SphereModel>(*manipulator);
      if (!options.robot && !options.manipulator) {
        throw Error("scenes.load: option 'robot' must be a robot of the plane, or one of a URDF file");
      }
    });
  }
  const auto read_end = [&](const char* option, Configuration& end, std::optional<Pose3>& as_pose) {
    const Value value = call[2].field(option);
    if (!value.given()) return;
    const std::string what = fmt::format("scenes.load: option '{}'", option);
    faults.attempt([&] {
      if (options.manipulator) {
        end = read_place(value, what, without_world(*options.manipulator));
      } else if (const auto* pose = value.get<Pose3>()) {
        as_pose = *pose;
      } else {
        end = read_numbers(value, what);
      }
    });
  };
  if (const Value value = call[2].field("ignore"); value.given()) {
    faults.attempt([&] {
      if (value.type() != lua::Type::table) {
        throw Error(fmt::format("scenes.load: option 'ignore' must be a list of names, as {{ \"octomap\" }}, got {}",
                                describe(value)));
      }
      value.each([&](std::size_t i, Value entry) {
        const auto part = entry.string();
        if (!part) {
          throw Error(
              fmt::format("scenes.load: entry {} of option 'ignore' must be a name, got {}", i, describe(entry)));
        }
        options.ignore.push_back(*part);
      });
    });
  }
  read_end("start", options.start, options.start_pose);
  read_end("goal", options.goal, options.goal_pose);
  faults.raise();
  return options;
}

}  // namespace

namespace {

/// Warnings about files. Those that several files share, as in a benchmark, are there once, with the number of files.
class FileWarnings {
 public:
  explicit FileWarnings(std::shared_ptr<std::vector<std::string>> list) : list_(std::move(list)) {}

  /// \param place  "FILE" or "FILE:LINE"
  void add(const std::string& place, const std::string& text) {
    if (list_->empty()) shared_.clear();  // they were taken
    const auto [found, first] = shared_.try_emplace(text);
    Shared& shared = found->second;
    if (!shared.places.insert(place).second) return;
    if (first) {
      shared.number = list_->size();
      list_->push_back(fmt::format("scenes.load: {}: {}", place, text));
      shared.alone = list_->back();
      return;
    }
    const std::size_t more = shared.places.size() - 1;
    list_->at(shared.number) = fmt::format("{} (and in {} more file{})", shared.alone, more, more == 1 ? "" : "s");
  }

 private:
  struct Shared {
    std::size_t number = 0;  ///< in the list
    std::string alone;       ///< the warning about the first file
    std::set<std::string> places;
  };
  std::shared_ptr<std::vector<std::string>> list_;
  std::map<std::string, Shared> shared_;
};

}  // namespace

lua::Callback scene_loader(ScriptPlace place, std::shared_ptr<std::vector<std::string>> warnings) {
  return [place = std::move(place), warnings = std::make_shared<FileWarnings>(std::move(warnings))](Stack& call) {
    const std::string file = file_argument(call, "scenes.load");
    const std::string path = scene_path("scenes.load", file, place);
    std::vector<Options::Entry> given;
    std::optional<std::string> name;
    ReadOptions options = read_load_fields(call, given, name);
    const auto settings = load_settings().read(validated(load_settings().component(), given));
    const bool weighted =
        std::any_of(given.begin(), given.end(), [](const auto& option) { return option.first == "weight"; });
    options.weight = weighted ? settings.weight : 0.0;
    options.resolution = settings.resolution;
    options.motion = settings.motion;
    options.goal_tolerance = settings.goal_tolerance;
    options.agents = static_cast<std::size_t>(settings.agents);
    options.agent_radius = settings.radius;
    options.map_server = settings.map_server == "ros1" ? MapServer::ros1 : MapServer::nav2;
    std::vector<std::string> found;
    auto problems = read_problems(path, options, &found);
    for (const std::string& warning : found) {
      // Those of the files that a scene names begin with their paths, and may have lines.
      std::size_t colon = warning.find(':');
      const bool placed = colon != std::string::npos && is_file(warning.substr(0, colon));
      const std::size_t digits = placed ? warning.find_first_not_of("0123456789", colon + 1) : 0;
      if (placed && digits != std::string::npos && digits > colon + 1 && warning[digits] == ':') colon = digits;
      const std::size_t text = placed ? warning.find_first_not_of(' ', colon + 1) : 0;
      warnings->add(placed ? warning.substr(0, colon) : file, text == std::string::npos ? "" : warning.substr(text));
    }
    const Value list = call.push_table();
    std::size_t count = 0;
    for (auto& problem : problems) {
      ++count;
      if (name) problem.name = problems.size() == 1 ? *name : fmt::format("{}/{}", *name, count);
      problem.collision = backend_of(*problem.scene, settings.collision);
      problem.contact_tolerance = settings.contact_tolerance;
      resolve_goal(problem);
      std::vector<std::string> fitted;
      fit_covers_to_ends(problem, fitted);
      for (const std::string& warning : fitted) warnings->add(file, warning);
      call.push_object(std::move(problem));
      call.append(list);
    }
    return 1;
  };
}

lua::Callback robot_loader(ScriptPlace place) {
  return [place = std::move(place)](Stack& call) {
    return call.result(read_robot(scene_path("scenes.robot", file_argument(call, "scenes.robot"), place)));
  };
}

lua::Callback scene_finder(std::string script_folder, bool trust) {
  return [folder = std::move(script_folder), trust](Stack& call) {
    const std::string file = file_argument(call, "scenes.exists");
    if (!trust) require_within("scenes.exists", file, folder);
    return call.result(!find_scene(file, folder).empty());
  };
}

void open_problem(Stack& stack, const std::shared_ptr<std::vector<std::string>>& warnings) {
  stack.declare<Problem>({{"__tostring", problem_text}, {"__index", read_field}});
  stack.push_function([warnings](Stack& call) { return make_problem(call, *warnings); });
  stack.set_global(problem_construct().name);
}

}  // namespace trellis::dsl
