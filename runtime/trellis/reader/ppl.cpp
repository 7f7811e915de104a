// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/spatial_formats.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/planar/aggregate.hpp>
#include <trellis/scene/planar/polygon.hpp>
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

/// The point of a mesh that is its body's origin.
enum class Origin : unsigned char { vertex_mean, surface_mean, as_in_file };

struct Placed {
  std::string file;
  Pose3 pose;
  std::size_t line = 0;
  Origin origin = Origin::vertex_mean;
};

struct ActiveBody {
  Placed body;
  bool planar = false;  ///< whether it moves in the plane
  bool rotates = false;
  std::string path;  ///< the file that has it
};

struct Environment {
  Box3 bounds;
  std::vector<ActiveBody> robots;  ///< more than one only in the plane
  std::vector<Placed> obstacles;
};

/// Reads an environment: `Boundary`, resolutions, then `MultiBodies` with their number, then each of them.
class EnvironmentReader {
 public:
  explicit EnvironmentReader(SourceText text) : source_(std::move(text)) {}

  /// Reads NAME.robot: what follows `Active` in an environment.
  void read_robot(Environment& environment) {
    environment_ = std::move(environment);
    robot();
    environment = std::move(environment_);
  }

  Environment read() {
    boundary();
    next("'MultiBodies'");
    std::string word = lower(take());
    // How finely PPL checks motions is no part of a problem.
    while (word == "positionres" || word == "positionresfactor" || word == "orientationres" || word == "orientation" ||
           word == "rdres" || word == "timeres") {
      next("a resolution");
      static_cast<void>(number("a resolution"));
      next("'MultiBodies'");
      word = lower(take());
    }
    if (word != "multibodies") throw expected("'MultiBodies' and their number", word);
    const std::int64_t count = integer("the number of bodies");
    if (count < 0 || static_cast<std::uint64_t>(count) > most_obstacles) {
      throw fault(fmt::format("{} bodies; expected 1 to {}", count, most_obstacles));
    }
    for (std::int64_t i = 0; i < count; ++i) {
      next(fmt::format("body {} of {}", i + 1, count));
      const std::string kind = lower(take());
      if (kind == "active") {
        robot();
      } else if (kind == "passive") {
        next("the file of a passive body");
        environment_.obstacles.push_back(placed());
      } else {
        throw expected("'Active' or 'Passive'", kind);
      }
    }
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
    next("the shape of the boundary");
    if (const auto shape = lower(take()); shape != "box" && shape != "box2d") {
      throw fault(fmt::format("a boundary of the shape {} is not read; expected 'Box'", in_quotes(shape)));
    }
    next("ranges as -15:15");
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
  /// Takes an option as -c(0 0 1 1) or -c (0 0 1 1) after the name of a mesh: returns its letter, and what is in the
  /// parentheses. A letter of 0: there is no option.
  std::pair<char, std::string> option() {
    std::string_view ahead = rest_;
    ahead.remove_prefix(std::min(ahead.size(), ahead.find_first_not_of(" \t")));
    if (ahead.size() < 2 || ahead[0] != '-' || std::isalpha(static_cast<unsigned char>(ahead[1])) == 0) return {};
    const char letter = ahead[1];
    ahead.remove_prefix(2);
    ahead.remove_prefix(std::min(ahead.size(), ahead.find_first_not_of(" \t")));
    if (!ahead.starts_with('(')) throw fault(fmt::format("the option -{} has no '('", letter));
    const std::size_t end = ahead.find(')');
    if (end == std::string_view::npos) throw fault(fmt::format("the option -{}( has no ')'", letter));
    rest_ = ahead.substr(end + 1);
    return {letter, std::string(ahead.substr(1, end - 1))};
  }
  /// The name of a mesh, then a colour -c, a texture -t, and the origin -a(com), -a(surface) or -a(none).
  Placed body() {
    Placed body;
    body.line = line_;
    body.file = std::string(take());
    for (auto [letter, value] = option(); letter != '\0'; std::tie(letter, value) = option()) {
      if (letter == 'c' || letter == 't') continue;
      if (letter != 'a') throw fault(fmt::format("unknown option -{}; expected -c, -t or -a", letter));
      std::string_view words = value;
      const std::string origin = lower(take_word(words));
      if (origin != "com" && origin != "surface" && origin != "none") throw expected("com, surface or none", origin);
      body.origin = origin == "com"       ? Origin::vertex_mean
                    : origin == "surface" ? Origin::surface_mean
                                          : Origin::as_in_file;
    }
    return body;
  }
  /// A passive body: its pose follows, with angles in degrees.
  Placed placed() {
    Placed result = body();
    const auto next_number = [&] {
      const std::string what = "the position x y z and the angles about x, y and z in degrees";
      next(what);
      return number(what);
    };
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
    ActiveBody robot;
    robot.body = body();
    next("'Planar' or 'Volumetric'");
    const std::string base = lower(take());
    if (base != "planar" && base != "volumetric") throw expected("'Planar' or 'Volumetric'", base);
    next("'Rotational' or 'Translational'");
    const std::string movement = lower(take());
    if (movement != "rotational" && movement != "translational") {
      throw expected("'Rotational' or 'Translational'", movement);
    }
    robot.path = source_.path;
    robot.planar = base == "planar";
    robot.rotates = movement == "rotational";
    environment_.robots.push_back(robot);
    if (environment_.robots.size() > 1 && !(robot.planar && environment_.robots.front().planar)) {
      throw fault("a second active body: several robots are read only where all are 'Planar'");
    }
    if (environment_.robots.size() > Robot::most_members) {
      throw fault(fmt::format("more than {} active bodies", Robot::most_members));
    }
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

/// Reads the configurations of a query, one in a line, after the number of its robot, which one robot alone may omit;
/// those of several robots are joined: the first of each robot, then the second of each. Angles are fractions of pi.
std::vector<Configuration> read_query(const std::string& path, const Environment& environment) {
  const SourceText source = SourceText::load(path);
  const std::vector<ActiveBody>& robots = environment.robots;
  std::vector<std::vector<Configuration>> found(robots.size());
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
    std::size_t robot = 0;
    const auto known = [&](double number) {
      return number >= 0.0 && number < static_cast<double>(robots.size()) && number == std::floor(number);
    };
    if (robots.size() > 1 && !known(numbers.front())) {
      throw source.error(
          line, fmt::format("expected the number of a robot, 0 to {}, got {}", robots.size() - 1, numbers.front()));
    }
    if (robots.size() > 1) robot = static_cast<std::size_t>(numbers.front());
    const bool planar = robots[robot].planar;
    const std::size_t positions = planar ? 2 : 3;
    const std::size_t angles = robots[robot].rotates ? (planar ? 1 : 3) : 0;
    const std::size_t wanted = positions + angles;
    if (robots.size() > 1 || numbers.size() == wanted + 1) {
      if (!known(numbers.front())) throw source.error(line, fmt::format("there is no robot {}", numbers.front()));
      numbers.erase(numbers.begin());
    }
    if (numbers.size() != wanted) {
      throw source.error(
          line,
          fmt::format("expected {} numbers{} ({} of position, {} angles as fractions of pi), got {}", wanted,
                      robots.size() > 1 ? fmt::format(" of robot {}", robot) : "", positions, angles, numbers.size()));
    }
    constexpr double pi = std::numbers::pi;
    if (planar) {
      if (angles > 0) numbers[2] *= pi;
    } else if (angles > 0) {
      const Quaternion q = normalised(euler(pi * numbers[3], pi * numbers[4], pi * numbers[5]));
      numbers.resize(3);
      numbers.insert(numbers.end(), {q.x, q.y, q.z, q.w});
    }
    found[robot].push_back(std::move(numbers));
  }
  const std::size_t last = std::max<std::size_t>(source.lines.size(), 1);
  for (std::size_t i = 1; i < found.size(); ++i) {
    if (found[i].size() == found[0].size()) continue;
    throw source.error(last, fmt::format("robot 0 has {} configurations and robot {} has {}; expected as many of each",
                                         found[0].size(), i, found[i].size()));
  }
  if (found[0].size() < 2) {
    throw source.error(last, fmt::format("a query needs a start and a goal, got {} configurations{}", found[0].size(),
                                         robots.size() > 1 ? " of each robot" : ""));
  }
  std::vector<Configuration> result = std::move(found[0]);
  for (std::size_t i = 1; i < found.size(); ++i) {
    for (std::size_t k = 0; k < result.size(); ++k) {
      result[k].insert(result[k].end(), found[i][k].begin(), found[i][k].end());
    }
  }
  return result;
}

/// An upright prism: its outline from above, and its least and greatest height.
struct Prism {
  Polygon outline;
  double lo = 0.0;
  double hi = 0.0;
};

/// Returns the outline of an upright prism as its corners in order: the one loop of its lower edges. Empty where the
/// mesh is no such prism.
std::vector<Vec2> outline_of(const Mesh& mesh, const std::vector<Vec3>& vertices, const Box3& bounds) {
  const double rounding = 1e-9 * norm(bounds.hi - bounds.lo);
  const auto low = [&](const Vec3& v) { return v.z - bounds.lo.z <= rounding; };
  // Each vertex lies at the bottom or at the top, and has another one above or below it.
  for (const Vec3& v : vertices) {
    const bool bottom = low(v);
    if (!bottom && bounds.hi.z - v.z > rounding) return {};
    const double other = bottom ? bounds.hi.z : bounds.lo.z;
    const bool paired = std::any_of(vertices.begin(), vertices.end(), [&](const Vec3& w) {
      return std::abs(w.z - other) <= rounding && std::hypot(w.x - v.x, w.y - v.y) <= rounding;
    });
    if (!paired) return {};
  }
  // The triangles of the bottom cover the outline: sides of one triangle alone bound it.
  std::map<std::uint32_t, std::uint32_t> next;
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
  for (const Triangle& t : mesh.triangles()) {
    if (!std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return low(vertices[v]); })) continue;
    for (std::size_t i = 0; i < 3; ++i) sides.emplace(t.at(i), t.at((i + 1) % 3));
  }
  for (const auto& [from, to] : sides) {
    if (sides.contains({to, from})) continue;
    if (!next.emplace(from, to).second) return {};  // loops that touch
  }
  std::vector<Vec2> outline;
  if (next.empty()) return outline;
  std::uint32_t at = next.begin()->first;
  do {
    outline.push_back({vertices[at].x, vertices[at].y});
    const auto after = next.find(at);
    if (after == next.end()) return {};
    at = after->second;
  } while (at != next.begin()->first && outline.size() <= next.size());
  if (outline.size() != next.size()) return {};  // a hole
  double area = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    area += 0.5 * cross(outline[i] - outline[0], outline[(i + 1) % outline.size()] - outline[0]);
  }
  const double volume = std::abs(area) * (bounds.hi.z - bounds.lo.z);
  constexpr double tolerance = 1e-6;  // of the volume: slanted sides enclose another one
  if (std::abs(volume - std::abs(mesh.volume())) > tolerance * volume) return {};
  return outline;
}

Prism prism_of(const Solid& solid, const std::string& where) {
  const auto& mesh = *std::get<std::shared_ptr<const Mesh>>(solid.shape);
  const Box3 bounds = bounding_box(solid);
  std::vector<Vec3> vertices;
  for (const Vec3& v : mesh.vertices()) vertices.push_back(solid.pose(v));
  constexpr std::size_t most = 1000;
  std::vector<Vec2> outline;
  if (mesh.closed() && vertices.size() <= most) outline = outline_of(mesh, vertices, bounds);
  if (outline.empty()) {
    throw Error(
        fmt::format("{}: the robot moves in the plane, so each body must be an upright prism without holes of at most "
                    "{} vertices",
                    where, most));
  }
  if (mesh.convex()) outline = convex_hull(std::move(outline)).vertices;
  return {validated_polygon({std::move(outline)}, where), bounds.lo.z, bounds.hi.z};
}

/// Whether one is above the other.
bool apart(const Prism& a, const Prism& b) { return a.hi <= b.lo || b.hi <= a.lo; }

/// The mean of a mesh's surface.
Vec3 surface_mean(const Mesh& mesh) {
  Vec3 sum;
  double area = 0.0;
  for (const Triangle& t : mesh.triangles()) {
    const Vec3 &a = mesh.vertices()[t[0]], &b = mesh.vertices()[t[1]], &c = mesh.vertices()[t[2]];
    const double twice = norm(cross(b - a, c - a));
    sum = sum + twice / 3.0 * (a + b + c);
    area += twice;
  }
  return 1.0 / area * sum;
}

/// The solid of a body: its mesh about its origin, at its pose.
Solid solid_of(const Placed& body, const MeshFolder& meshes) {
  const MeshFile& file = meshes.at(body.file);
  const Vec3 origin = body.origin == Origin::vertex_mean    ? file.vertex_mean
                      : body.origin == Origin::surface_mean ? surface_mean(*file.mesh)
                                                            : Vec3{};
  return {file.mesh, body.pose * Pose3{-1.0 * origin, {}}};
}

/// Returns the file with the robot of an environment that has none: NAME.robot, or the only one of its folder, which
/// is a warning.
std::string robot_file(const std::string& environment, std::vector<std::string>& warnings) {
  std::string own = fs::path(environment).replace_extension(".robot").string();
  std::error_code ignored;
  if (fs::exists(own, ignored)) return own;
  std::vector<std::string> others;
  const fs::path folder = fs::path(environment).parent_path();
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    if (lower(entry.path().extension().string()) == ".robot") others.push_back(entry.path().string());
  }
  if (others.size() != 1) {
    throw Error(fmt::format("{}: no active body: the robot must be beside the environment, as {}{}", environment, own,
                            others.empty() ? "" : fmt::format("; the folder has {} other robots", others.size())));
  }
  warnings.push_back(fmt::format("{}: the robot is that of {}, the only one beside it", environment, others.front()));
  return others.front();
}

std::string name_of(std::size_t obstacle, const Placed& body) {
  return fmt::format("obstacle {} ({})", obstacle + 1, body.file);
}

/// The scene of a robot that moves in the plane: bodies at other heights than the robot's are left out.
Problem planar_problem(const std::string& path, const Environment& environment, const MeshFolder& meshes,
                       const ReadOptions& options, std::vector<std::string>& warnings) {
  const auto where = [&](const Placed& body) { return fmt::format("{}:{}: {}", path, body.line, body.file); };
  std::vector<Prism> prisms;
  std::vector<Robot> robots;
  for (const ActiveBody& robot : environment.robots) {
    const std::string place = fmt::format("{}:{}: {}", robot.path, robot.body.line, robot.body.file);
    prisms.push_back(prism_of(solid_of(robot.body, meshes), place));
    if (apart(prisms.front(), prisms.back())) {
      throw Error(
          fmt::format("{}: it is above or below the first robot; robots of the plane must be at one height", place));
    }
    robots.push_back(Robot::rigid({prisms.back().outline}, robot.rotates));
  }
  std::vector<Obstacle> obstacles;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    const Placed& body = environment.obstacles[i];
    const Prism prism = prism_of(solid_of(body, meshes), where(body));
    const auto passed =
        std::count_if(prisms.begin(), prisms.end(), [&](const Prism& robot) { return apart(prism, robot); });
    if (passed == static_cast<std::ptrdiff_t>(prisms.size())) {
      warnings.push_back(
          fmt::format("{}: it is above or below the robot, which moves in the plane, and was left out", where(body)));
      continue;
    }
    if (passed > 0) {
      warnings.push_back(
          fmt::format("{}: it is above or below some of the robots, and is an obstacle of all", where(body)));
    }
    obstacles.push_back({name_of(i, body), prism.outline});
  }
  const auto& [lo, hi] = environment.bounds;
  return problem_in(fs::path(path).stem().string(),
                    std::make_shared<PlanarScene>(World({{lo.x, lo.y}, {hi.x, hi.y}}, std::move(obstacles)),
                                                  robots.size() == 1 ? robots.front() : Robot::team(robots)),
                    options);
}

Problem problem_of(const std::string& path, const Environment& environment, const MeshFolder& meshes,
                   const ReadOptions& options) {
  std::vector<Obstacle3> obstacles;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    obstacles.push_back({name_of(i, environment.obstacles[i]), solid_of(environment.obstacles[i], meshes)});
  }
  World3 world(environment.bounds, std::move(obstacles));
  const ActiveBody& active = environment.robots.front();
  Robot3 robot(active.body.file, {solid_of(active.body, meshes)}, active.rotates);
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
  SceneFile file;
  Environment environment = EnvironmentReader(place == path ? text : SourceText::load(place)).read();
  if (environment.robots.empty()) {
    EnvironmentReader(SourceText::load(robot_file(place, file.warnings))).read_robot(environment);
  }
  file.format = "environment of PPL";
  file.units = "1 unit = 1 m; angles in degrees, in queries as fractions of pi";
  file.frame = "each mesh is about the mean of its vertices, or about what its option -a names";
  MeshFolder meshes(place);
  for (const ActiveBody& robot : environment.robots) {
    if (robot.path != place && !fs::exists(beside(place, robot.body.file), ignored)) {
      throw Error(fmt::format("{}:{}: its mesh is not there: {}, named from the environment's folder", robot.path,
                              robot.body.line, robot.body.file));
    }
    meshes.need(robot.body.file, robot.body.line);
  }
  for (const Placed& body : environment.obstacles) meshes.need(body.file, body.line);
  meshes.load({}, file.warnings);
  const Problem problem = environment.robots.front().planar
                              ? planar_problem(place, environment, meshes, options, file.warnings)
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
