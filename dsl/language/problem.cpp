// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/problem.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include <dsl/language/motion.hpp>
#include <dsl/language/script_place.hpp>
#include <dsl/language/words.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/scene/readers.hpp>
#include <trellis/strategy/executor.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

// The settings that problems of scripts and problems of files share.
struct LoadSettings {
  double weight = 1.0 / std::numbers::pi;
  double resolution = Problem{}.resolution;
  std::string collision = "planar";
  bool motion = true;
  double goal_tolerance = ReadOptions{}.goal_tolerance;
};
struct ProblemSettings {
  double weight = LoadSettings{}.weight;
  double resolution = LoadSettings{}.resolution;
  std::string collision = "planar";
  double goal_tolerance = Problem{}.goal_tolerance;
};

template <class S>
Settings<S> with_scene_options(Settings<S> settings) {
  return settings.number("weight", &S::weight, "m/rad", Range::positive(), "metres of the metric per radian of turning")
      .number("resolution", &S::resolution, "m", Range::positive(),
              "how far the robot's fastest point moves between two checked configurations")
      .choice("collision", &S::collision, {"planar", "fcl"}, "the collision backend");
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
          .number("goal_tolerance", &LoadSettings::goal_tolerance, "m", Range::positive(),
                  "of problems with a motion model: a state this near to the goal in the metric is the goal");
  return settings;
}

std::string axes_of(const Space& space) {
  std::string names;
  for (const auto& axis : space.axes()) names += (names.empty() ? "" : ", ") + axis.name;
  return names;
}

Configuration read_configuration(Value value, const std::string& what, const Space& space) {
  auto q = read_numbers(value, fmt::format("problem: {}", what));
  if (q.size() != space.dimension()) {
    throw Error(fmt::format("problem: {} must have {} coordinates ({}), got {}", what, space.dimension(),
                            axes_of(space), q.size()));
  }
  return q;
}

/// One goal, or a list of them.
void read_goals(Value value, Problem& problem) {
  bool several = false;
  if (value.type() == lua::Type::table) {
    value.each(
        [&](std::size_t i, Value element) { several = several || (i == 1 && element.type() == lua::Type::table); });
  }
  if (!several) {
    problem.goal = read_configuration(value, "field 'goal'", problem.space);
    return;
  }
  problem.further_goals = Configurations(problem.space.dimension());
  value.each([&](std::size_t i, Value element) {
    auto q = read_configuration(element, fmt::format("goal {} of field 'goal'", i), problem.space);
    if (i == 1) {
      problem.goal = std::move(q);
    } else {
      problem.further_goals.push(q);
    }
  });
}

int make_problem(Stack& call) {
  const Arguments arguments(problem_construct(), call);
  const auto* world = arguments["world"].get<World>();
  if (world == nullptr) arguments.reject("world");
  const auto* robot = arguments["robot"].get<Robot>();
  if (robot == nullptr) arguments.reject("robot");
  const auto settings = problem_settings().read(arguments.options());

  Problem problem;
  problem.name = arguments.string("name").value_or("problem");
  if (problem.name.empty()) throw Error("problem: field 'name' must not be empty");
  problem.scene = std::make_shared<const Scene>(Scene{*world, *robot});
  problem.space = default_space(*robot, *world, settings.weight);
  const Value motion = arguments["motion"];
  if (motion.given()) {
    const auto* model = motion.get<Motion>();
    if (model == nullptr) arguments.reject("motion");
    problem.motion_model = *model;
    problem.space = state_space(problem.space, **model);
  }
  problem.start = read_configuration(arguments["start"], "field 'start'", problem.space);
  read_goals(arguments["goal"], problem);
  problem.goal_tolerance =
      motion.given() && !arguments["goal_tolerance"].given() ? ReadOptions{}.goal_tolerance : settings.goal_tolerance;
  problem.resolution = settings.resolution;
  problem.collision = settings.collision;
  check(problem);
  return call.result(std::move(problem));
}

void push_coordinates(Stack& call, View q) {
  const Value list = call.push_table();
  for (const double x : q) {
    call.push(x);
    call.append(list);
  }
}

/// The members of a problem that a script may read, under the names of `problem`'s fields.
const std::map<std::string, void (*)(Stack&, const Problem&)>& readable() {
  static const std::map<std::string, void (*)(Stack&, const Problem&)> fields = {
      {"name", [](Stack& call, const Problem& p) { call.push(p.name); }},
      {"world", [](Stack& call, const Problem& p) { call.push_object(p.scene->world); }},
      {"robot", [](Stack& call, const Problem& p) { call.push_object(p.scene->robot); }},
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
         if (p.further_goals.empty()) return push_coordinates(call, p.goal);
         const Value list = call.push_table();
         push_coordinates(call, p.goal);
         call.append(list);
         for (std::size_t i = 0; i < p.further_goals.size(); ++i) {
           push_coordinates(call, p.further_goals[i]);
           call.append(list);
         }
       }},
      {"goal_tolerance", [](Stack& call, const Problem& p) { call.push(p.goal_tolerance); }},
      {"resolution", [](Stack& call, const Problem& p) { call.push(p.resolution); }},
      {"collision", [](Stack& call, const Problem& p) { call.push(p.collision); }}};
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
      .fields = {{"name", "string", "a string", "how the report calls it", false, "\"problem\""},
                 {"world", "trellis.World", "a world", "as world { ... } makes it", true},
                 {"robot", "trellis.Robot", "a robot", "as robot.rectangle(0.6, 0.2) makes it", true},
                 {"start", "number[]", "a list of numbers",
                  "the start configuration, in metres and radians; with a motion model its velocities follow", true},
                 {"goal", "number[]|number[][]", "a list of numbers, or a list of such lists",
                  "the goal configuration, in metres and radians, or several of which any will do", true},
                 {"motion", "trellis.Motion", "a motion model, as motion.unicycle1 {}",
                  "how the robot is driven; without one it moves straight to any configuration"}},
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
  for (const Option& option : construct.options.options) {
    if (!readable().contains(option.name)) continue;
    type.members.push_back({option.name, option.type == Option::Type::choice ? "string" : "number", "", option.doc});
  }
  return type;
}

const Construct& load_construct() {
  static const Construct construct = {.name = "scenes.load",
                                      .usage = "scenes.load(\"ompl_tests/circle_obstacles.txt\", { resolution = 0.1 })",
                                      .summary = "the problems in a scene file made by others",
                                      .list = "",
                                      .element = "",
                                      .fields = {},
                                      .options = load_settings().component(),
                                      .returns = "trellis.Problem[]",
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

lua::Callback scene_loader(ScriptPlace place) {
  return [place = std::move(place)](Stack& call) {
    const std::string file = file_argument(call, "scenes.load");
    if (!place.trust) require_within("scenes.load", file, place.folder);
    const std::string path = find_scene(file, place.folder);
    if (path.empty()) throw Error("scenes.load: " + missing_scene(file, place.folder));
    if (place.watch) place.watch(file, path);
    const Given given = read_options(load_settings().component(), call, 2, false);
    const auto settings = load_settings().read(Options::validate(load_settings().component(), given.options));
    auto problems = read_problems(
        path, {settings.weight, settings.resolution, settings.collision, settings.motion, settings.goal_tolerance});
    const Value list = call.push_table();
    for (auto& problem : problems) {
      resolve_goal(problem);
      call.push_object(std::move(problem));
      call.append(list);
    }
    return 1;
  };
}

lua::Callback scene_finder(std::string script_folder, bool trust) {
  return [folder = std::move(script_folder), trust](Stack& call) {
    const std::string file = file_argument(call, "scenes.exists");
    if (!trust) require_within("scenes.exists", file, folder);
    return call.result(!find_scene(file, folder).empty());
  };
}

void open_problem(Stack& stack) {
  stack.declare<Problem>({{"__tostring", problem_text}, {"__index", read_field}});
  stack.push_function(make_problem);
  stack.set_global(problem_construct().name);
}

}  // namespace trellis::dsl
