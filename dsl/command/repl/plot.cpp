// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl/plot.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/printable.hpp>
#include <trellis/draw/braille.hpp>
#include <trellis/draw/camera.hpp>
#include <trellis/pictures/spatial_shapes.hpp>
#include <trellis/pictures/traces.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis::command {

namespace {

using draw::Point;

/// The drawable content of a level, in metres, y up.
struct Sketch {
  Box2 bounds;
  std::vector<std::vector<Point>> obstacles;
  std::vector<std::pair<Point, Point>> wires;  ///< edges of the obstacles of space, as they are seen
  std::vector<std::pair<Point, Point>> ends;   ///< edges of the robot of space at start and goal
  std::vector<std::pair<Point, Point>> box;    ///< edges of the bounds of space
  std::vector<std::pair<Point, char>> letters;
  std::vector<std::vector<Point>> robots;  ///< the robot's parts at start and goal
  std::vector<std::pair<Point, Point>> edges;
  std::vector<Point> nodes;
  std::vector<Point> failed;              ///< proposals without a node
  std::vector<std::vector<Point>> paths;  ///< of each robot
  std::vector<Point> starts;
  std::vector<Point> goals;
  std::string caption;
};

Point point(Vec2 p) { return {p.x, p.y}; }

std::vector<Point> outline(const ConvexShape& shape, const Pose2& pose) {
  std::vector<Point> points;
  if (const auto* polygon = std::get_if<Polygon>(&shape)) {
    points.reserve(polygon->vertices.size());
    for (const Vec2 v : polygon->vertices) points.push_back(point(pose(v)));
    return points;
  }
  constexpr int sides = 36;
  const auto& disc = std::get<Disc>(shape);
  points.reserve(sides);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    points.push_back(point(pose(disc.centre + disc.radius * Vec2{std::cos(angle), std::sin(angle)})));
  }
  return points;
}

void add_robot(const Robot& robot, View q, std::vector<std::vector<Point>>& out) {
  std::vector<Pose2> poses(robot.bodies().size());
  robot.place(q, poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const ConvexShape& part : robot.bodies()[i].parts) out.push_back(outline(part, poses[i]));
  }
}

std::string counted(std::size_t n, const std::string& noun) {
  return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s");
}

/// Adds the world of the plane, and the robot at start and goal.
/// \param first  the coordinate at which those of the robot begin
void add_world(const LevelRecord& record, std::size_t first, Sketch& sketch) {
  sketch.bounds = planar(*record.scene).world.bounds();
  for (const auto& part : planar(*record.scene).world.parts()) sketch.obstacles.push_back(outline(part.shape, {}));
  const Robot& robot = planar(*record.scene).robot;
  if (record.space.dimension() >= robot.dimension() && !robot.is_point()) {
    add_robot(robot, View(record.start).subspan(first), sketch.robots);
    add_robot(robot, View(record.goal).subspan(first), sketch.robots);
  }
}

draw::Camera camera_of(const draw::Point3& lo, const draw::Point3& hi, const PlotView& view) {
  draw::Camera camera = draw::camera_for(lo, hi);
  camera.azimuth = view.azimuth.value_or(camera.azimuth);
  camera.elevation = view.elevation.value_or(camera.elevation);
  return camera;
}

/// Where a camera far away sees points of space: metres to the right and upwards.
class Viewpoint {
 public:
  Viewpoint(const World3& world, const PlotView& view)
      : lo_(drawn(world.bounds().lo)),
        hi_(drawn(world.bounds().hi)),
        camera_(camera_of(lo_, hi_, view)),
        right_(camera_.right()),
        up_(camera_.up()) {}

  [[nodiscard]] Point operator()(const draw::Point3& p) const { return {draw::dot(right_, p), draw::dot(up_, p)}; }

  /// Adds the edges of obstacles and bounds, and the robot at start and goal.
  void add_world(const LevelRecord& record, Sketch& sketch) const {
    constexpr std::size_t most_triangles = 3000;
    add_box(sketch);
    for (const draw::Surface& surface : surfaces_of(*spatial_world(*record.scene), most_triangles).obstacles) {
      if (!draw::closes_view(surface, lo_, hi_, camera_)) add(surface, sketch.wires);
    }
    if (record.scene->is_point() || record.space.dimension() < record.scene->robot_dimension()) return;
    for (const Configuration& q : {record.start, record.goal}) {
      for (const draw::Surface& part : placed(*record.scene, own_coordinates(record, q))) {
        add(part, sketch.ends);
      };
    }
  }

  [[nodiscard]] std::string text() const {
    const draw::Point3 size = hi_ - lo_;
    return fmt::format("; a world of {:g} m x {:g} m x {:g} m from azimuth {:g}, elevation {:g}", size.x, size.y,
                       size.z, camera_.azimuth, camera_.elevation);
  }

 private:
  void add(const draw::Surface& surface, std::vector<std::pair<Point, Point>>& to) const {
    for (const auto& [a, b] : draw::drawn_edges(surface, camera_.direction())) {
      to.emplace_back((*this)(surface.vertices[a]), (*this)(surface.vertices[b]));
    }
  }

  void add_box(Sketch& sketch) const {
    const auto corner = [&](unsigned i) {
      return draw::Point3{(i & 1U) != 0 ? hi_.x : lo_.x, (i & 2U) != 0 ? hi_.y : lo_.y, (i & 4U) != 0 ? hi_.z : lo_.z};
    };
    constexpr double infinity = std::numeric_limits<double>::infinity();
    sketch.bounds = {{infinity, infinity}, {-infinity, -infinity}};
    unsigned nearest = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const Point p = (*this)(corner(i));
      sketch.bounds.lo = {std::min(sketch.bounds.lo.x, p.x), std::min(sketch.bounds.lo.y, p.y)};
      sketch.bounds.hi = {std::max(sketch.bounds.hi.x, p.x), std::max(sketch.bounds.hi.y, p.y)};
      if (draw::dot(corner(i), camera_.direction()) > draw::dot(corner(nearest), camera_.direction())) nearest = i;
    }
    // Those before the scene would only cover it.
    for (unsigned i = 0; i < 8; ++i) {
      for (const unsigned bit : {1U, 2U, 4U}) {
        if ((i & bit) == 0 && i != nearest && (i | bit) != nearest) {
          sketch.box.emplace_back((*this)(corner(i)), (*this)(corner(i | bit)));
        }
      }
    }
    // The axes' names, in the middle of an edge at the rim.
    const draw::Point3 middle = 0.5 * (lo_ + hi_);
    sketch.letters = {{(*this)({middle.x, lo_.y, lo_.z}), 'x'},
                      {(*this)({hi_.x, middle.y, lo_.z}), 'y'},
                      {(*this)({lo_.x, lo_.y, middle.z}), 'z'}};
  }

  draw::Point3 lo_;
  draw::Point3 hi_;
  draw::Camera camera_;
  draw::Point3 right_;
  draw::Point3 up_;
};

Sketch sketch_of(const Run& run, std::size_t level, const PlotView& from) {
  const LevelRecord& record = run.result().levels.at(level).record;
  const std::vector<Trace> traces = traces_of(run.result().levels, level);
  const bool in_space = has_positions(record);
  if (!in_space && (traces.empty() || record.scene == nullptr || record.scene->planar() == nullptr)) {
    throw Error(fmt::format("plot: level {}, {}, has no position in the plane or in space", level, record.name));
  }
  if (!in_space && (from.azimuth || from.elevation)) {
    throw Error(fmt::format("plot: level {}, {}, is in the plane, which is drawn from above", level, record.name));
  }
  std::optional<Viewpoint> view;
  if (in_space) view.emplace(*spatial_world(*record.scene), from);
  const std::size_t robots = in_space ? positions_in(record, record.start).size() : traces.size();
  const auto at = [&](View q, std::size_t robot) {
    if (view) return (*view)(positions_in(record, q)[robot]);
    return Point{q[traces[robot].axes[0]], q[traces[robot].axes[1]]};
  };
  Sketch sketch;
  if (view) {
    view->add_world(record, sketch);
  } else {
    add_world(record, first_coordinate(run.result().levels, level), sketch);
  }
  const Search& search = record.search;
  const std::size_t nodes = search.nodes.size();
  std::size_t failed = 0;
  for (std::size_t robot = 0; robot < robots; ++robot) {
    for (std::size_t i = 0; i < nodes; ++i) {
      sketch.nodes.push_back(at(search.nodes[i], robot));
      const std::uint32_t parent = i < search.parents.size() ? search.parents[i] : no_node;
      if (parent != no_node && parent != i) {
        sketch.edges.emplace_back(at(search.nodes[parent], robot), sketch.nodes.back());
      }
    }
    for (const auto& [a, b] : search.edges) {
      sketch.edges.emplace_back(at(search.nodes[a], robot), at(search.nodes[b], robot));
    }
    failed = 0;
    for (std::size_t i = 0; i < search.proposals.size(); ++i) {
      if (i < search.fates.size() && search.fates[i] != Fate::rejected) continue;
      sketch.failed.push_back(at(search.proposals[i], robot));
      ++failed;
    }
    if (record.solution.solved()) {
      std::vector<Point>& path = sketch.paths.emplace_back();
      for (std::size_t i = 0; i < record.solution.path.size(); ++i) {
        path.push_back(at(record.solution.path[i], robot));
      }
    }
    sketch.starts.push_back(at(record.start, robot));
    sketch.goals.push_back(at(record.goal, robot));
  }
  sketch.caption = fmt::format(
      "level {}, {}: {}, {} of {} led to none{}", level, record.name, counted(nodes, "node"), failed,
      counted(search.proposals.size(), "proposal"),
      sketch.paths.empty() ? "" : fmt::format(", a path of {}", counted(record.solution.path.size(), "point")));
  if (view) sketch.caption += view->text();
  return sketch;
}

// In characters ------------------------------------------------------------------------------------------------------

constexpr draw::Ink256 wall_ink = {.colour = 240, .ground = true};
constexpr draw::Ink256 box_ink = {.colour = 238, .rank = -2};
constexpr draw::Ink256 wire_ink = {.colour = 246, .rank = -1};
constexpr draw::Ink256 failed_ink = {.colour = 172, .rank = 1};
constexpr draw::Ink256 tree_ink = {.colour = 33, .rank = 2};
constexpr draw::Ink256 path_ink = {.colour = 203, .rank = 3, .alone = true};
/// Paths of the robots of a team that are beside each other differ.
constexpr draw::Ink256 path_ink_of(std::size_t robot) {
  constexpr std::array<std::uint8_t, 6> colours = {203, 114, 221, 141, 80, 208};
  draw::Ink256 ink = path_ink;
  ink.colour = colours[robot % colours.size()];
  return ink;
}
constexpr draw::Ink256 robot_ink = {.colour = 36, .rank = 4};
constexpr draw::Ink256 end_ink = {.colour = 15, .rank = 5};

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".svg" || ending == ".png" || ending == ".pdf") return ending;
  throw Error(fmt::format("plot: a picture's name ends with .svg, .png or .pdf, got '{}'", path));
}

}  // namespace

std::string plot_text(const Run& run, std::size_t level, const Screen& screen, const PlotView& view) {
  const Sketch sketch = sketch_of(run, level, view);
  const double wide = sketch.bounds.hi.x - sketch.bounds.lo.x;
  const double high = sketch.bounds.hi.y - sketch.bounds.lo.y;
  // A frame of one character, and space for the caption and the prompt; a dot is as high as wide.
  constexpr std::size_t least = 8;
  constexpr std::size_t frame = 2;
  constexpr std::size_t below = 5;
  const auto columns = static_cast<double>(std::max(least, screen.columns - std::min(screen.columns, frame)));
  const auto rows = static_cast<double>(std::max(least, screen.rows - std::min(screen.rows, below)));
  const double scale = std::min(2.0 * columns / wide, 4.0 * rows / high);
  const auto across = static_cast<std::size_t>(std::max(1.0, std::ceil(scale * wide / 2.0 - 1e-9)));
  const auto down = static_cast<std::size_t>(std::max(1.0, std::ceil(scale * high / 4.0 - 1e-9)));
  draw::Braille picture(across, down);
  const double bottom = scale * high;
  const auto at = [&](Point p) {
    return Point{scale * (p.x - sketch.bounds.lo.x), bottom - scale * (p.y - sketch.bounds.lo.y)};
  };
  const auto all_at = [&](std::vector<Point> points) {
    std::transform(points.begin(), points.end(), points.begin(), at);
    return points;
  };
  const auto closed = [&](const std::vector<Point>& points, const draw::Ink256& ink) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      picture.line(at(points[i]), at(points[(i + 1) % points.size()]), ink);
    }
  };
  for (const auto& obstacle : sketch.obstacles) {
    draw::Ink256 ink = wall_ink;
    ink.pattern = !screen.colour;
    picture.fill(all_at(obstacle), ink);
  }
  for (const auto& [a, b] : sketch.box) picture.line(at(a), at(b), box_ink);
  for (const auto& [a, b] : sketch.wires) picture.line(at(a), at(b), wire_ink);
  for (const Point p : sketch.failed) picture.dot(at(p), failed_ink);
  for (const auto& [a, b] : sketch.edges) picture.line(at(a), at(b), tree_ink);
  for (const Point p : sketch.nodes) picture.dot(at(p), tree_ink);
  for (const auto& part : sketch.robots) closed(part, robot_ink);
  for (const auto& [a, b] : sketch.ends) picture.line(at(a), at(b), robot_ink);
  for (std::size_t robot = 0; robot < sketch.paths.size(); ++robot) {
    const std::vector<Point>& path = sketch.paths[robot];
    for (std::size_t i = 0; i + 1 < path.size(); ++i) picture.line(at(path[i]), at(path[i + 1]), path_ink_of(robot));
  }
  for (const auto& [p, letter] : sketch.letters) {
    const Point dot = at(p);
    picture.letter({std::clamp(dot.x, 0.0, static_cast<double>(picture.width()) - 1.0),
                    std::clamp(dot.y, 0.0, static_cast<double>(picture.height()) - 1.0)},
                   letter, box_ink);
  }
  for (const Point p : sketch.starts) picture.letter(at(p), 'S', end_ink);
  for (const Point p : sketch.goals) picture.letter(at(p), 'G', end_ink);

  std::string edge;
  for (std::size_t i = 0; i < across; ++i) edge += "─";
  std::string out = "┌" + edge + "┐\n";
  const std::string inside = picture.text(screen.colour);
  for (std::size_t begin = 0; begin < inside.size();) {
    const std::size_t end = inside.find('\n', begin);
    out += "│" + inside.substr(begin, end - begin) + "│\n";
    begin = end + 1;
  }
  out += "└" + edge + "┘\n" + printable(sketch.caption) + '\n';
  if (!screen.colour) return out;
  const auto key = [](const draw::Ink256& ink, const char* sign, const char* name) {
    return fmt::format("\x1b[38;5;{}m{}\x1b[0m {}", ink.colour, sign, name);
  };
  out += fmt::format("{}  {}  {}  {}\n", key(tree_ink, "━", "tree"), key(failed_ink, "∙", "proposals without a node"),
                     key(path_ink, "━", "path"),
                     sketch.wires.empty() ? key(wall_ink, "█", "obstacles") : key(wire_ink, "━", "obstacles"));
  return out;
}

std::string plot_picture(const Run& run, std::size_t level, const std::string& path, const PlotView& view) {
  const std::string ending = ending_of(path);
  // What cannot be drawn is refused as in characters.
  static_cast<void>(sketch_of(run, level, view));
  Experiment experiment;
  experiment.problems = {run.problem};
  experiment.strategies = {{run.strategy_name, run.strategy}};
  experiment.seeds = {run.seed};
  ExperimentResult result;
  result.runs = {run.result()};
  return picture_of(experiment, result, level, ending, view);
}

}  // namespace trellis::command
