// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/spatial_formats.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/planar/aggregate.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

std::string lower(std::string_view word) {
  std::string text(word);
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

/// The rotation about x by the first angle, then about y, then about z, in radians.
Quaternion euler(double x, double y, double z) {
  return rotation_of({0.0, 0.0, z}) * rotation_of({0.0, y, 0.0}) * rotation_of({x, 0.0, 0.0});
}

struct Placed {
  std::string file;
  Pose3 pose;
  std::size_t line = 0;
};

struct Environment {
  Box3 bounds;
  bool planar = false;  ///< whether the robot moves in the plane
  bool rotates = false;
  Placed robot;
  std::vector<Placed> obstacles;
};

/// Reads an environment: `Boundary`, then `MultiBodies` with their number, then each of them.
class EnvironmentReader {
 public:
  explicit EnvironmentReader(SourceText text) : source_(std::move(text)) {}

  Environment read() {
    boundary();
    next("'MultiBodies'");
    if (const auto word = lower(take()); word != "multibodies") throw expected("'MultiBodies' and their number", word);
    const std::int64_t count = integer("the number of bodies");
    if (count < 0 || static_cast<std::uint64_t>(count) > most_obstacles) {
      throw fault(fmt::format("{} bodies; expected 1 to {}", count, most_obstacles));
    }
    bool active = false;
    for (std::int64_t i = 0; i < count; ++i) {
      next(fmt::format("body {} of {}", i + 1, count));
      const std::string kind = lower(take());
      if (kind == "active") {
        if (active) throw fault("a second active body: problems of several robots are not read");
        active = true;
        robot();
      } else if (kind == "passive") {
        next("the file of a passive body");
        environment_.obstacles.push_back(placed());
      } else {
        throw expected("'Active' or 'Passive'", kind);
      }
    }
    if (!active) throw fault("no active body: there is no robot");
    return std::move(environment_);
  }

 private:
  [[nodiscard]] Error fault(const std::string& what) const {
    return source_.error(std::max<std::size_t>(line_, 1), what);
  }
  [[nodiscard]] Error expected(const std::string& what, std::string_view got) const {
    return fault(fmt::format("expected {}, got {}", what, got.empty() ? "the end of the line" : in_quotes(got)));
  }
  /// Takes the next line with a word, unless this one has words left.
  void next(const std::string& wanted) {
    std::string_view peek = rest_;
    while (take_word(peek).empty()) {
      if (line_ == source_.lines.size()) throw fault(fmt::format("the file ends before {}", wanted));
      rest_ = source_.lines[line_++];
      rest_ = rest_.substr(0, rest_.find('#'));
      peek = rest_;
    }
  }
  std::string_view take() { return take_word(rest_); }
  double number(const std::string& what) {
    const std::string_view word = take();
    const auto value = number_in(word);
    if (!value || !std::isfinite(*value)) throw expected(what, word);
    return *value;
  }
  std::int64_t integer(const std::string& what) {
    next(what);
    const std::string_view word = take();
    const auto value = integer_in(word);
    if (!value) throw expected(what, word);
    return *value;
  }
  /// `Boundary Box -15:15 -15:15 -1:1` or `Boundary Box [-15:15 ; -15:15 ; -1:1]`; two ranges bound the plane.
  void boundary() {
    next("'Boundary'");
    if (const auto word = lower(take()); word != "boundary") throw expected("'Boundary'", word);
    if (const auto shape = lower(take()); shape != "box" && shape != "box2d") {
      throw fault(fmt::format("a boundary of the shape {} is not read; expected 'Box'", in_quotes(shape)));
    }
    std::string numbers(rest_);
    rest_ = {};
    std::replace_if(
        numbers.begin(), numbers.end(), [](char c) { return c == '[' || c == ']' || c == ';' || c == ':'; }, ' ');
    std::vector<double> limits;
    std::string_view left = numbers;
    for (std::string_view word = take_word(left); !word.empty(); word = take_word(left)) {
      const auto value = number_in(word);
      if (!value || !std::isfinite(*value)) throw expected("ranges as -15:15", word);
      limits.push_back(*value);
    }
    if (limits.size() != 4 && limits.size() != 6) {
      throw fault(fmt::format("expected two or three ranges as -15:15, got {} numbers", limits.size()));
    }
    // Without a third range the height has no limit that matters.
    if (limits.size() == 4) limits.insert(limits.end(), {-1.0, 1.0});
    environment_.bounds = {{limits[0], limits[2], limits[4]}, {limits[1], limits[3], limits[5]}};
  }
  /// The name of a mesh, then a colour as -c(0 0 1 1).
  Placed body() {
    Placed body;
    body.line = line_;
    body.file = std::string(take());
    std::string_view ahead = rest_;
    if (take_word(ahead).starts_with("-c(")) {
      const std::size_t end = rest_.find(')');
      if (end == std::string_view::npos) throw fault("the colour -c( has no ')'");
      rest_.remove_prefix(end + 1);
    }
    return body;
  }
  /// A passive body: its pose follows, with angles in degrees.
  Placed placed() {
    Placed result = body();
    const auto next_number = [&] { return number("the position x y z and the angles about x, y and z in degrees"); };
    const double x = next_number(), y = next_number(), z = next_number();
    result.pose.position = {x, y, z};
    constexpr double degree = std::numbers::pi / 180.0;
    const double a = next_number(), b = next_number(), c = next_number();
    result.pose.orientation = euler(degree * a, degree * b, degree * c);
    if (const auto word = take(); !word.empty()) throw expected("the end of the line", word);
    return result;
  }
  /// The active body: the number of its parts, the part with how it moves, and the number of connections.
  void robot() {
    if (const std::int64_t parts = integer("the number of the robot's bodies"); parts != 1) {
      throw fault(fmt::format("a robot of {} bodies; only rigid bodies are read", parts));
    }
    next("the robot's file");
    environment_.robot = body();
    const std::string base = lower(take());
    if (base != "planar" && base != "volumetric") throw expected("'Planar' or 'Volumetric'", base);
    const std::string movement = lower(take());
    if (movement != "rotational" && movement != "translational") {
      throw expected("'Rotational' or 'Translational'", movement);
    }
    environment_.planar = base == "planar";
    environment_.rotates = movement == "rotational";
    next("'Connections'");
    if (const auto word = lower(take()); word != "connections" && word != "connection") {
      throw expected("'Connections' and their number", word);
    }
    if (const std::int64_t joints = integer("the number of connections"); joints != 0) {
      throw fault(fmt::format("{} connections; only rigid bodies are read", joints));
    }
  }

  SourceText source_;
  Environment environment_;
  std::string_view rest_;
  std::size_t line_ = 0;  // counted from 1, of rest_
};

/// Reads the configurations of a query, one in a line; a number of the robot may come first. Angles are fractions of
/// pi.
std::vector<Configuration> read_query(const std::string& path, const Environment& environment) {
  const SourceText source = SourceText::load(path);
  const std::size_t positions = environment.planar ? 2 : 3;
  const std::size_t angles = environment.rotates ? (environment.planar ? 1 : 3) : 0;
  const std::size_t wanted = positions + angles;
  std::vector<Configuration> result;
  for (std::size_t line = 1; line <= source.lines.size(); ++line) {
    std::string_view rest = source.lines[line - 1];
    rest = rest.substr(0, rest.find('#'));
    std::vector<double> numbers;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const auto value = number_in(word);
      if (!value || !std::isfinite(*value))
        throw source.error(line, fmt::format("expected a number, got {}", in_quotes(word)));
      numbers.push_back(*value);
    }
    if (numbers.empty()) continue;
    if (numbers.size() == wanted + 1) {
      if (numbers.front() != 0.0) throw source.error(line, fmt::format("there is no robot {}", numbers.front()));
      numbers.erase(numbers.begin());
    }
    if (numbers.size() != wanted) {
      throw source.error(line, fmt::format("expected {} numbers ({} of position, {} angles as fractions of pi), got {}",
                                           wanted, positions, angles, numbers.size()));
    }
    constexpr double pi = std::numbers::pi;
    if (environment.planar) {
      if (environment.rotates) numbers[2] *= pi;
      result.push_back(std::move(numbers));
      continue;
    }
    if (environment.rotates) {
      const Quaternion q = normalised(euler(pi * numbers[3], pi * numbers[4], pi * numbers[5]));
      numbers.resize(3);
      numbers.insert(numbers.end(), {q.x, q.y, q.z, q.w});
    }
    result.push_back(std::move(numbers));
  }
  if (result.size() < 2) {
    throw source.error(std::max<std::size_t>(source.lines.size(), 1),
                       fmt::format("a query needs a start and a goal, got {} configurations", result.size()));
  }
  return result;
}

/// An upright convex prism: its outline from above, and its least and greatest height.
struct Prism {
  Polygon outline;
  double lo = 0.0;
  double hi = 0.0;
};

Prism prism_of(const Solid& solid, const std::string& where) {
  const auto& mesh = *std::get<std::shared_ptr<const Mesh>>(solid.shape);
  const Box3 bounds = bounding_box(solid);
  const Vec3 size = bounds.hi - bounds.lo;
  const double rounding = 1e-9 * norm(size);
  std::vector<Vec3> vertices;
  for (const Vec3& v : mesh.vertices()) vertices.push_back(solid.pose(v));
  // Each vertex lies at the bottom or at the top, and has another one above or below it.
  const bool upright = mesh.convex() && std::all_of(vertices.begin(), vertices.end(), [&](const Vec3& v) {
                         const bool bottom = v.z - bounds.lo.z <= rounding;
                         if (!bottom && bounds.hi.z - v.z > rounding) return false;
                         const double other = bottom ? bounds.hi.z : bounds.lo.z;
                         return std::any_of(vertices.begin(), vertices.end(), [&](const Vec3& w) {
                           return std::abs(w.z - other) <= rounding && std::hypot(w.x - v.x, w.y - v.y) <= rounding;
                         });
                       });
  constexpr std::size_t most = 1000;
  if (mesh.vertices().size() > most || !upright) {
    throw Error(
        fmt::format("{}: the robot moves in the plane, so each body must be an upright convex prism of at most {} "
                    "vertices",
                    where, most));
  }
  std::vector<Vec2> below;
  for (const Vec3& v : vertices) {
    if (v.z - bounds.lo.z <= rounding) below.push_back({v.x, v.y});
  }
  return {convex_hull(std::move(below)), bounds.lo.z, bounds.hi.z};
}

/// The solid of a body: its mesh about the mean of its vertices, at its pose.
Solid solid_of(const Placed& body, const MeshFolder& meshes) {
  const MeshFile& file = meshes.at(body.file);
  return {file.mesh, body.pose * Pose3{-1.0 * file.vertex_mean, {}}};
}

std::string name_of(std::size_t obstacle, const Placed& body) {
  return fmt::format("obstacle {} ({})", obstacle + 1, body.file);
}

/// The scene of a robot that moves in the plane: bodies at other heights than the robot's are left out.
Problem planar_problem(const std::string& path, const Environment& environment, const MeshFolder& meshes,
                       const ReadOptions& options, std::vector<std::string>& warnings) {
  const auto where = [&](const Placed& body) { return fmt::format("{}:{}: {}", path, body.line, body.file); };
  const Prism robot = prism_of(solid_of(environment.robot, meshes), where(environment.robot));
  std::vector<Obstacle> obstacles;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    const Placed& body = environment.obstacles[i];
    const Prism prism = prism_of(solid_of(body, meshes), where(body));
    if (prism.hi <= robot.lo || robot.hi <= prism.lo) {
      warnings.push_back(
          fmt::format("{}: it is above or below the robot, which moves in the plane, and was left out", where(body)));
      continue;
    }
    obstacles.push_back({name_of(i, body), prism.outline});
  }
  const auto& [lo, hi] = environment.bounds;
  return problem_in(fs::path(path).stem().string(),
                    std::make_shared<PlanarScene>(World({{lo.x, lo.y}, {hi.x, hi.y}}, std::move(obstacles)),
                                                  Robot::rigid({robot.outline}, environment.rotates)),
                    options);
}

Problem problem_of(const std::string& path, const Environment& environment, const MeshFolder& meshes,
                   const ReadOptions& options) {
  std::vector<Obstacle3> obstacles;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    obstacles.push_back({name_of(i, environment.obstacles[i]), solid_of(environment.obstacles[i], meshes)});
  }
  World3 world(environment.bounds, std::move(obstacles));
  Robot3 robot(environment.robot.file, {solid_of(environment.robot, meshes)}, environment.rotates);
  return spatial_problem(fs::path(path).stem().string(), std::move(world), std::move(robot), options);
}

}  // namespace

bool is_ppl(const SourceText& text) {
  const std::string ending = lower(fs::path(text.path).extension().string());
  return ending == ".env" || ending == ".query";
}

SceneFile read_ppl(const SourceText& text, const ReadOptions& options) {
  const std::string& path = text.path;
  const std::string place = fs::path(path).replace_extension(".env").string();
  const std::string query = fs::path(path).replace_extension(".query").string();
  std::error_code ignored;
  if (!fs::exists(place, ignored)) {
    throw Error(fmt::format("{}: the environment of this query must be beside it, as {}", path, place));
  }
  Environment environment = EnvironmentReader(place == path ? text : SourceText::load(place)).read();
  SceneFile file;
  file.format = "environment of PPL";
  file.units = "1 unit = 1 m; angles in degrees, in queries as fractions of pi";
  file.frame = "each mesh is about the mean of its vertices";
  MeshFolder meshes(place);
  meshes.need(environment.robot.file, environment.robot.line);
  for (const Placed& body : environment.obstacles) meshes.need(body.file, body.line);
  meshes.load({}, file.warnings);
  const Problem problem = environment.planar ? planar_problem(place, environment, meshes, options, file.warnings)
                                             : problem_of(place, environment, meshes, options);
  if (!fs::exists(query, ignored)) {
    file.problems.push_back(problem);
    return file;
  }
  // From each configuration to the next one.
  const std::vector<Configuration> configurations = read_query(query, environment);
  for (std::size_t i = 0; i + 1 < configurations.size(); ++i) {
    Problem& one = file.problems.emplace_back(problem);
    one.start = configurations[i];
    one.goals = {configurations[i + 1]};
    if (configurations.size() > 2) one.name += fmt::format(" {}", i + 1);
  }
  return file;
}

}  // namespace trellis
