// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/figures.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/verbs/robot_report.hpp>
#include <dsl/language/words/problem.hpp>
#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/planar/distance.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/pictures/gltf.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/report/report.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis::command {

namespace {

using Json = nlohmann::ordered_json;

struct SceneOptions {
  std::string file;
  std::string robot;    ///< a drawing of its outline, "" if not given
  std::string problem;  ///< the name of one of the file's, "" for the first
  std::string unit;     ///< of a mesh, "" if not given
  std::string svg;
  std::string png;
  std::string gltf;
  std::optional<double> azimuth;  ///< of the view of a scene of space, in degrees
  std::optional<double> elevation;
  bool json = false;
};

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// "3 boxes, 1 disc".
std::string kinds_text(const std::vector<std::pair<std::string, std::size_t>>& kinds) {
  std::vector<std::string> texts;
  for (const auto& [name, count] : kinds) {
    const std::string many = fmt::format("{}{}", name, name.ends_with('x') || name.ends_with('h') ? "es" : "s");
    if (count > 0) texts.push_back(counted(count, name.c_str(), many.c_str()));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// One end of a problem, and how the robot stands there.
struct End {
  Configuration q;
  std::optional<std::string> contact;                     ///< what it touches; none: it is valid
  std::optional<std::pair<std::string, double>> nearest;  ///< the nearest obstacle and its distance in metres
};

/// Returns the obstacle nearest to the robot at q.
std::optional<std::pair<std::string, double>> nearest_obstacle(const PlanarScene& scene, View q) {
  std::vector<Pose2> poses(scene.robot.bodies().size());
  scene.robot.place(q, poses);
  std::optional<std::pair<std::size_t, double>> nearest;
  ConvexShape placed;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const ConvexShape& part : scene.robot.bodies()[i].parts) {
      move_shape(part, poses[i], placed);
      const Box2 box = bounding_box(placed);
      for (const World::Part& other : scene.world.parts()) {
        if (nearest && box_distance(box, bounding_box(other.shape)) >= nearest->second) continue;
        const double away = distance(placed, other.shape);
        if (!nearest || away < nearest->second) nearest = {other.obstacle, away};
      }
    }
  }
  if (!nearest) return std::nullopt;
  return std::pair(scene.world.obstacles()[nearest->first].name, nearest->second);
}

/// Returns the obstacle nearest to the body at q. Examines each obstacle by itself.
std::optional<std::pair<std::string, double>> nearest_obstacle(const SpatialScene& scene, View q, const Space& space,
                                                               double resolution) {
  std::optional<std::pair<std::string, double>> nearest;
  if (!scene.robot.members().empty()) {
    // The clearance of a team is also that of its robots from each other.
    const auto checker = make_checker("fcl_plain", std::make_shared<const SpatialScene>(scene), space, resolution);
    const auto found = checker->nearest_obstacle(q);
    return found ? std::optional(std::pair(scene.obstacle_name(found->obstacle), found->distance)) : std::nullopt;
  }
  for (const Obstacle3& obstacle : scene.world.obstacles()) {
    const World3 alone(scene.world.bounds(), {obstacle}, Contain::none, scene.world.surface());
    const auto checker =
        make_checker("fcl_plain", std::make_shared<const SpatialScene>(alone, scene.robot), space, resolution);
    const double away = checker->clearance(q);
    if (!nearest || away < nearest->second) nearest = std::pair(obstacle.name, away);
  }
  return nearest;
}

/// The findings on one problem.
struct Examined {
  const Problem* problem = nullptr;
  std::optional<End> start;
  std::optional<End> goal;

  [[nodiscard]] bool valid() const { return start && goal && !start->contact && !goal->contact; }
};

/// Examines the problems of a file; those that share a scene share its checker.
class Examiner {
 public:
  Examined at(const Problem& problem, bool closely) {
    Examined look{&problem, {}, {}};
    if (!problem.start.empty()) look.start = end(problem, problem.start, closely);
    if (!problem.goals.empty()) look.goal = end(problem, problem.goal(), closely);
    return look;
  }

 private:
  End end(const Problem& problem, const Configuration& q, bool closely) {
    if (scene_ != problem.scene) {
      scene_ = problem.scene;
      checker_ = make_checker(collision_backends(*scene_).front(), scene_, problem.space, problem.resolution);
    }
    End end{q, {}, {}};
    if (!checker_->valid(q)) {
      const auto contact = checker_->contact(q);
      end.contact = contact ? describe(*contact, *scene_) : "coordinates that are no finite numbers";
    }
    // Of very many obstacles in space each would need a tree of its own.
    constexpr std::size_t many = 1000;
    if (!closely || end.contact) return end;
    if (scene_->planar() != nullptr) {
      end.nearest = nearest_obstacle(*scene_->planar(), q);
    } else if (scene_->spatial() != nullptr && scene_->obstacle_count() <= many) {
      end.nearest = nearest_obstacle(spatial(*scene_), q, problem.space, problem.resolution);
    }
    return end;
  }

  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<Checker> checker_;
};

std::vector<std::pair<std::string, std::size_t>> obstacle_kinds(const Scene& scene) {
  std::vector<std::pair<std::string, std::size_t>> kinds;
  const auto add = [&](const std::string& name) {
    const auto at = std::find_if(kinds.begin(), kinds.end(), [&](const auto& kind) { return kind.first == name; });
    if (at != kinds.end()) {
      ++at->second;
    } else {
      kinds.emplace_back(name, 1);
    }
  };
  if (const PlanarScene* planar = scene.planar()) {
    for (const Obstacle& obstacle : planar->world.obstacles()) {
      add(std::holds_alternative<Box2>(obstacle.shape)   ? "box"
          : std::holds_alternative<Disc>(obstacle.shape) ? "disc"
                                                         : "polygon");
    }
    return kinds;
  }
  for (const Obstacle3& obstacle : spatial_world(scene)->obstacles()) {
    constexpr std::array<const char*, 6> names = {"sphere", "box", "cylinder", "capsule", "mesh", "cloud of points"};
    add(names.at(obstacle.solid.shape.index()));
  }
  return kinds;
}

/// What the meshes among some solids are.
struct Meshes {
  std::size_t count = 0;
  std::size_t closed = 0;
  std::size_t triangles = 0;

  void add(const Solid& solid) {
    const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape);
    if (mesh == nullptr) return;
    ++count;
    closed += (*mesh)->closed() ? 1U : 0U;
    triangles += (*mesh)->triangles().size();
  }
  [[nodiscard]] std::string text() const {
    const std::string how = closed == count ? (count == 1 ? "closed" : "all closed")
                            : closed == 0   ? std::string("not closed")
                                            : fmt::format("{} closed", closed);
    return fmt::format("{}, {}", counted(triangles, "triangle", "triangles"), how);
  }
  [[nodiscard]] Json json() const { return {{"meshes", count}, {"closed", closed}, {"triangles", triangles}}; }
};

Meshes obstacle_meshes(const World3& world) {
  Meshes meshes;
  for (const Obstacle3& obstacle : world.obstacles()) meshes.add(obstacle.solid);
  return meshes;
}

Meshes robot_meshes(const SpatialScene& scene) {
  Meshes meshes;
  for (const Solid& solid : scene.robot.solids()) meshes.add(solid);
  return meshes;
}

/// What lies within the bounds of a world of space.
std::string contained(const World3& world) {
  switch (world.contain()) {
    case Contain::robot: return "the robot";
    case Contain::reference: return "the robot's reference point";
    default: return "nothing";
  }
}

std::vector<std::pair<double, double>> bounds_of(const Scene& scene) {
  if (const PlanarScene* planar = scene.planar()) {
    const auto& [lo, hi] = planar->world.bounds();
    return {{lo.x, hi.x}, {lo.y, hi.y}};
  }
  const auto& [lo, hi] = spatial_world(scene)->bounds();
  return {{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}};
}

std::string bounds_text(const std::vector<std::pair<double, double>>& bounds) {
  constexpr std::string_view axes = "xyz";
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    texts.push_back(fmt::format("{} {:g} to {:g}", axes[i], bounds[i].first, bounds[i].second));
  }
  return fmt::format("{} m", fmt::join(texts, ", "));
}

std::string end_text(const std::optional<End>& end) {
  if (!end) return "none in the file";
  std::string text = fmt::format("({:.4g})", fmt::join(end->q, ", "));
  if (end->contact) return fmt::format("{}: invalid, touches {}", text, *end->contact);
  text += ": valid";
  if (end->nearest) text += fmt::format(", {:.3g} m from {}", end->nearest->second, end->nearest->first);
  return text;
}

Json end_json(const std::optional<End>& end) {
  if (!end) return nullptr;
  Json json = {{"configuration", end->q}, {"valid", !end->contact}};
  if (end->contact) json["contact"] = *end->contact;
  if (end->nearest) json["nearest"] = {{"obstacle", end->nearest->first}, {"distance", end->nearest->second}};
  return json;
}

/// A file's problems with what was seen of them.
class Report {
 public:
  Report(std::string path, const SceneFile& file, const std::string& wanted) : path_(std::move(path)), file_(file) {
    choose(wanted);
    Examiner examiner;
    for (std::size_t i = 0; i < file.problems.size(); ++i) {
      looks_.push_back(examiner.at(file.problems[i], i == chosen_));
      with_ends_ += looks_.back().start && looks_.back().goal ? 1U : 0U;
      valid_ += looks_.back().valid() ? 1U : 0U;
    }
  }

  [[nodiscard]] const Problem& chosen() const { return file_.problems[chosen_]; }

  [[nodiscard]] std::string text() const {
    const Problem& problem = chosen();
    const Scene& scene = *problem.scene;
    const Examined& look = looks_[chosen_];
    std::string text = fmt::format("{}: {}\n\n", path_, file_.format);
    const auto line = [&](const char* name, const std::string& value) {
      text += fmt::format("  {:<9} {}\n", name, value);
    };
    line("units", file_.units);
    line("frame", file_.frame);
    if (file_.problems.size() > 1) {
      line("problems", fmt::format("{}, start and goal valid in {}", file_.problems.size(), valid_));
      line("problem", fmt::format("'{}'{}", problem.name, chosen_ == 0 ? ", the first; --problem shows another" : ""));
    } else {
      line("problem", fmt::format("'{}'", problem.name));
    }
    line("bounds", bounds_text(bounds_of(scene)));
    if (const World3* world = spatial_world(scene)) line("contain", contained(*world));
    line("obstacles", obstacles_text(scene));
    line("robot", file_.robot.empty() ? robot_text(scene, problem.space) : file_.robot);
    if (problem.motion_model) line("motion", problem.motion_model->name());
    line("start", end_text(look.start));
    line("goal", problem.goals.empty() && problem.reach ? region_text(problem) : end_text(look.goal));
    if (!file_.lengths.empty()) line("length", fmt::format("{:.4f} m, by the file", file_.lengths[chosen_]));
    for (const std::string& note : file_.notes) line("note", note);
    for (const std::string& warning : file_.warnings) line("warning", warning);
    return text;
  }

  [[nodiscard]] Json json() const {
    const Scene& scene = *chosen().scene;
    Json bounds = Json::array();
    for (const auto& [lo, hi] : bounds_of(scene)) bounds.push_back({lo, hi});
    Json kinds = Json::object();
    for (const auto& [name, count] : obstacle_kinds(scene)) kinds[name] = count;
    Json problems = Json::array();
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      const Problem& problem = file_.problems[i];
      Json one = {{"name", problem.name},
                  {"space", problem.space.name()},
                  {"robot", file_.robot.empty() ? Json(problem.scene->robot_name()) : Json(nullptr)},
                  {"motion", problem.motion_model ? Json(problem.motion_model->name()) : Json(nullptr)},
                  {"start", end_json(looks_[i].start)},
                  {"goal", end_json(looks_[i].goal)}};
      if (!file_.lengths.empty()) one["length"] = file_.lengths[i];
      problems.push_back(std::move(one));
    }
    Json document = {{"file", path_},        {"format", file_.format},
                     {"units", file_.units}, {"frame", file_.frame},
                     {"bounds", bounds},     {"obstacles", scene.obstacle_count()},
                     {"kinds", kinds},       {"problems", problems},
                     {"notes", file_.notes}, {"warnings", file_.warnings}};
    if (const World3* world = spatial_world(scene)) {
      document["contain"] = contained(*world);
      document["surface"] = world->surface();
      document["obstacle_meshes"] = obstacle_meshes(*world).json();
    }
    if (const SpatialScene* spatial = scene.spatial()) document["robot_meshes"] = robot_meshes(*spatial).json();
    return document;
  }

 private:
  void choose(const std::string& wanted) {
    if (wanted.empty()) return;
    std::vector<std::string> known;
    for (const Problem& problem : file_.problems) known.push_back(problem.name);
    const auto at = std::find(known.begin(), known.end(), wanted);
    if (at == known.end()) {
      throw Error(fmt::format("--problem: {} has no problem '{}'{}; the first is '{}', the last '{}'", path_, wanted,
                              did_you_mean(wanted, known), known.front(), known.back()));
    }
    chosen_ = static_cast<std::size_t>(at - known.begin());
  }

  static std::string obstacles_text(const Scene& scene) {
    if (scene.obstacle_count() == 0) return "none";
    std::string text = kinds_text(obstacle_kinds(scene));
    const World3* world = spatial_world(scene);
    if (world == nullptr) return text;
    if (const Meshes meshes = obstacle_meshes(*world); meshes.count > 0) text += fmt::format(", {}", meshes.text());
    return text + (world->surface() ? "; taken as surfaces" : "");
  }

  static std::string robot_text(const Scene& scene, const Space& space) {
    std::string text = fmt::format("{} in {}", scene.robot_name(), space.name());
    if (scene.body_count() > 1) text += fmt::format(", {} bodies", scene.body_count());
    if (scene.spatial() != nullptr) {
      if (const Meshes meshes = robot_meshes(*scene.spatial()); meshes.count > 0) text += ", " + meshes.text();
    }
    if (!scene.is_point()) text += fmt::format(", within {:.4g} m of its reference point", scene.bounding_radius());
    return text;
  }

  static std::string region_text(const Problem& problem) {
    const Reach& reach = *problem.reach;
    return fmt::format("a point of {} in the box ({:g}, {:g}) to ({:g}, {:g})", problem.scene->body_name(reach.body),
                       reach.box.lo.x, reach.box.lo.y, reach.box.hi.x, reach.box.hi.y);
  }

  std::string path_;
  const SceneFile& file_;
  std::size_t chosen_ = 0;
  std::vector<Examined> looks_;
  std::size_t with_ends_ = 0;
  std::size_t valid_ = 0;
};

/// Draws a problem's world, with the robot at start and goal.
void write_pictures(const SceneOptions& options, const Problem& problem) {
  constexpr double zenith = 90.0;
  if (options.elevation.value_or(0.0) > zenith) {
    throw Error(fmt::format("--elevation must be a number of at most {:g}, got {:g}", zenith, *options.elevation));
  }
  Experiment experiment;
  experiment.problems = {problem};
  for (const auto& [file, ending] : {std::pair(options.svg, ".svg"), std::pair(options.png, ".png")}) {
    if (file.empty()) continue;
    write_file(file, picture_of(experiment, {}, 0, ending, {options.azimuth, options.elevation}), Flush::none);
  }
}

bool draws(const SceneOptions& options) { return !options.svg.empty() || !options.png.empty(); }

void draw_scene(const SceneOptions& options, const Problem& problem) {
  const bool flat = problem.scene->planar() != nullptr;
  if (!options.gltf.empty()) {
    if (flat) throw Error(fmt::format("--gltf: {} is planar", options.file));
    write_file(options.gltf, gltf(problem, gltf_form(options.gltf)), Flush::none);
  }
  if ((options.azimuth || options.elevation) && (flat || !draws(options))) {
    throw Error(fmt::format(
        "{}: {}", options.azimuth ? "--azimuth" : "--elevation",
        flat ? options.file + " is planar: it is drawn from above" : "nothing is drawn without --svg or --png"));
  }
  if (draws(options)) write_pictures(options, problem);
}

/// Draws a mesh in the box that it fills; a flat one in a box of a hundredth of its extent.
void draw_mesh(const SceneOptions& options, const MeshFile& file, const std::string& name) {
  auto [lo, hi] = file.mesh->bounds();
  const double least = 0.01 * norm(hi - lo);
  if (hi.x - lo.x < least) hi.x = lo.x + least;
  if (hi.y - lo.y < least) hi.y = lo.y + least;
  if (hi.z - lo.z < least) hi.z = lo.z + least;
  Problem problem;
  problem.name = name;
  problem.scene =
      std::make_shared<const SpatialScene>(World3({lo, hi}, {{name, {file.mesh, {}}}}, Contain::none), Robot3::point());
  if (draws(options)) write_pictures(options, problem);
  if (!options.gltf.empty()) write_file(options.gltf, gltf(problem, gltf_form(options.gltf)), Flush::none);
}

std::string units_text(const MeshFile& file, const SceneOptions& options) {
  const std::string unit = fmt::format("1 unit = {:g} m", file.metres_in_unit);
  if (file.up != '\0') {
    // The format's default, which most files do not state.
    if (file.metres_in_unit == 1.0 && file.unit_name.empty()) return unit + ", as COLLADA has it without a <unit>";
    return fmt::format("{}{}, as the file says", unit,
                       file.unit_name.empty() ? "" : fmt::format(" ({})", file.unit_name));
  }
  return options.unit.empty() ? "metres, as no --unit says otherwise" : unit;
}

int print_mesh(const std::string& path, const SceneOptions& options) {
  if (!options.robot.empty() || !options.problem.empty()) {
    throw Error(fmt::format("{}: a mesh has no robot or problem: leave out {}", options.file,
                            !options.robot.empty() ? "--robot" : "--problem"));
  }
  MeshFile file = read_mesh(path, {options.unit.empty() ? "m" : options.unit});
  if (!file.up_warning.empty()) file.warnings.push_back(file.up_warning);
  const Mesh& mesh = *file.mesh;
  const auto& [lo, hi] = mesh.bounds();
  if (draws(options) || !options.gltf.empty())
    draw_mesh(options, file, std::filesystem::path(path).filename().string());
  if (options.json) {
    const Json json = {{"file", path},
                       {"format", file.format},
                       {"metres_in_unit", file.metres_in_unit},
                       {"up", file.up != '\0' ? Json(std::string(1, file.up)) : Json(nullptr)},
                       {"bounds", {{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}}},
                       {"polygons", file.polygons},
                       {"triangles", mesh.triangles().size()},
                       {"vertices", mesh.vertices().size()},
                       {"without_area", file.without_area},
                       {"closed", mesh.closed()},
                       {"convex", mesh.convex()},
                       {"volume", mesh.volume()},
                       {"warnings", file.warnings}};
    print_all(json.dump(2) + "\n");
    return success;
  }
  std::string text = fmt::format("{}: {}\n\n", path, file.format);
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<9} {}\n", name, value);
  };
  line("units", units_text(file, options));
  line("frame", file.up == '\0' ? std::string("as in the file") : fmt::format("as in the file: {} is up", file.up));
  line("bounds", bounds_text({{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}}));
  line("triangles", fmt::format("{}, of {}; {}", mesh.triangles().size(), counted(file.polygons, "polygon", "polygons"),
                                counted(mesh.vertices().size(), "vertex", "vertices")));
  line("closed", mesh.closed() ? fmt::format("yes{}, volume {:.4g} m3", mesh.convex() ? ", convex" : "", mesh.volume())
                               : std::string("no: a surface without an inside"));
  for (const std::string& warning : file.warnings) line("warning", warning);
  print_all(text);
  return success;
}

/// Whether the file describes a robot of links and joints; then it is reported.
bool print_robot(const std::string& path, const SceneOptions& options) {
  std::string robot;
  if (!options.robot.empty()) {
    robot = dsl::find_scene(options.robot, "");
    if (robot.empty()) throw Error("--robot: " + dsl::missing_scene(options.robot, ""));
  }
  const auto report = robot_report(path, options.file, robot, options.json);
  if (!report) return false;
  if (draws(options) || !options.gltf.empty() || !options.problem.empty()) {
    const char* given = !options.problem.empty() ? "--problem" : !options.gltf.empty() ? "--gltf" : "--svg or --png";
    throw Error(fmt::format("{}: {} is a robot without a world; a script with problem {{ ... }} draws it", given,
                            options.file));
  }
  print_all(*report);
  return true;
}

int scene(const SceneOptions& options) {
  const std::string path = dsl::find_scene(options.file, "");
  if (path.empty()) throw Error(dsl::missing_scene(options.file, ""));
  if (!options.svg.empty()) require_writable_file(options.svg);
  if (!options.png.empty()) require_writable_file(options.png);
  if (!options.gltf.empty()) {
    static_cast<void>(gltf_form(options.gltf));
    require_writable_file(options.gltf);
  }
  if (has_mesh_ending(path)) return print_mesh(path, options);
  if (!options.unit.empty()) throw Error(fmt::format("--unit: {} is no mesh", options.file));
  if (print_robot(path, options)) return success;
  ReadOptions read;
  read.describe = true;
  if (!options.robot.empty()) {
    const std::string robot = dsl::find_scene(options.robot, "");
    if (robot.empty()) throw Error("--robot: " + dsl::missing_scene(options.robot, ""));
    read.robot = read_robot(robot);
  }
  SceneFile file = read_scene(path, read);
  const Report report(options.file, file, options.problem);
  draw_scene(options, report.chosen());
  print_all(options.json ? report.json().dump(2) + "\n" : report.text());
  return success;
}

}  // namespace

void add_scene(CommandLine& line) {
  const auto options = std::make_shared<SceneOptions>();
  Subcommand verb = line.add("scene", "print what is in a scene file of another project, and draw it",
                             [options] { return scene(*options); });
  verb.argument(
      "SCENE", "FILE", options->file,
      "a scene, a mesh alone (.stl .obj .ply .off .g .dae) or a robot (.urdf .srdf); also looked for in the folder "
      "TRELLIS_SCENES");
  verb.text("--problem", "NAME", options->problem, "show this one of the file's problems, not the first");
  verb.text("--robot", "FILE", options->robot,
            "a drawing (SVG) of the outline of the robot, if the scene has none; the URDF file of a .srdf");
  verb.text("--unit", "UNIT", options->unit, "of a mesh: m, mm, cm, inch, or the number of metres");
  verb.text("--svg", "FILE", options->svg,
            "draw the scene, with the robot at start and goal (needs matplotlib of Python)");
  verb.text("--png", "FILE", options->png, "the same as a PNG");
  verb.text("--gltf", "FILE", options->gltf, "write a scene of space as glTF 2.0 (.gltf, or .glb in binary)");
  verb.number("--azimuth", "DEGREES", -360.0, options->azimuth,
              "of the direction from which a scene of space is seen, from the x axis (default -60)");
  verb.number("--elevation", "DEGREES", -90.0, options->elevation,
              "of this direction above the horizon, to 90 (default 30; more for flat worlds)");
  verb.flag("--json", options->json, "print JSON");
}

}  // namespace trellis::command
