// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/repl_plot.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/draw/braille.hpp>
#include <trellis/draw/canvas.hpp>
#include <trellis/draw/page.hpp>
#include <trellis/draw/worlds.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

using draw::Point;

/// The drawable content of a level, in metres, y up.
struct Sketch {
  Box2 bounds;
  std::vector<std::vector<Point>> obstacles;
  std::vector<std::vector<Point>> robots;  ///< the robot's parts at start and goal
  std::vector<std::pair<Point, Point>> edges;
  std::vector<Point> nodes;
  std::vector<Point> failed;  ///< proposals without a node
  std::vector<Point> path;
  Point start;
  Point goal;
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

Sketch sketch_of(const Run& run, std::size_t level) {
  const LevelRecord& record = run.result.levels.at(level).record;
  const auto& axes = record.position_axes;
  if (axes.size() < 2 || record.scene == nullptr) {
    throw Error(fmt::format("plot: level {}, {}, has no position in the plane", level, record.name));
  }
  const auto at = [&](View q) { return Point{q[axes[0]], q[axes[1]]}; };
  Sketch sketch;
  sketch.bounds = record.scene->world.bounds();
  for (const auto& part : record.scene->world.parts()) sketch.obstacles.push_back(outline(part.shape, {}));
  const Robot& robot = record.scene->robot;
  if (record.space.dimension() >= robot.dimension() && !robot.is_point()) {
    add_robot(robot, record.start, sketch.robots);
    add_robot(robot, record.goal, sketch.robots);
  }
  const Search& search = record.search;
  const std::size_t nodes = search.nodes.size();
  sketch.nodes.reserve(nodes);
  for (std::size_t i = 0; i < nodes; ++i) {
    sketch.nodes.push_back(at(search.nodes[i]));
    const std::uint32_t parent = i < search.parents.size() ? search.parents[i] : no_node;
    if (parent != no_node && parent != i) sketch.edges.emplace_back(at(search.nodes[parent]), sketch.nodes.back());
  }
  for (const auto& [a, b] : search.edges) sketch.edges.emplace_back(at(search.nodes[a]), at(search.nodes[b]));
  for (std::size_t i = 0; i < search.proposals.size(); ++i) {
    if (i < search.fates.size() && search.fates[i] != Fate::rejected) continue;
    sketch.failed.push_back(at(search.proposals[i]));
  }
  const Configurations& path = record.solution.path;
  if (record.solution.solved()) {
    sketch.path.reserve(path.size());
    for (std::size_t i = 0; i < path.size(); ++i) sketch.path.push_back(at(path[i]));
  }
  sketch.start = at(record.start);
  sketch.goal = at(record.goal);
  sketch.caption = fmt::format("level {}, {}: {}, {} of {} led to none{}", level, record.name, counted(nodes, "node"),
                               sketch.failed.size(), counted(search.proposals.size(), "proposal"),
                               sketch.path.empty() ? "" : fmt::format(", a path of {}", counted(path.size(), "point")));
  return sketch;
}

// In characters ------------------------------------------------------------------------------------------------------

constexpr draw::Ink256 wall_ink = {.colour = 240, .ground = true};
constexpr draw::Ink256 failed_ink = {.colour = 172, .rank = 1};
constexpr draw::Ink256 tree_ink = {.colour = 33, .rank = 2};
constexpr draw::Ink256 path_ink = {.colour = 203, .rank = 3, .alone = true};
constexpr draw::Ink256 robot_ink = {.colour = 36, .rank = 4};
constexpr draw::Ink256 end_ink = {.colour = 15, .rank = 5};

// As a picture -------------------------------------------------------------------------------------------------------

draw::Format format_of(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".svg") return draw::Format::svg;
  if (ending == ".png") return draw::Format::png;
  if (ending == ".pdf") return draw::Format::pdf;
  throw Error(fmt::format("plot: a picture's name ends with .svg, .png or .pdf, got '{}'", path));
}

}  // namespace

std::string plot_text(const Run& run, std::size_t level, const Screen& screen) {
  const Sketch sketch = sketch_of(run, level);
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
  for (const Point p : sketch.failed) picture.dot(at(p), failed_ink);
  for (const auto& [a, b] : sketch.edges) picture.line(at(a), at(b), tree_ink);
  for (const Point p : sketch.nodes) picture.dot(at(p), tree_ink);
  for (const auto& part : sketch.robots) closed(part, robot_ink);
  for (std::size_t i = 0; i + 1 < sketch.path.size(); ++i) {
    picture.line(at(sketch.path[i]), at(sketch.path[i + 1]), path_ink);
  }
  picture.letter(at(sketch.start), 'S', end_ink);
  picture.letter(at(sketch.goal), 'G', end_ink);

  std::string edge;
  for (std::size_t i = 0; i < across; ++i) edge += "─";
  std::string out = "┌" + edge + "┐\n";
  const std::string inside = picture.text(screen.colour);
  for (std::size_t begin = 0; begin < inside.size();) {
    const std::size_t end = inside.find('\n', begin);
    out += "│" + inside.substr(begin, end - begin) + "│\n";
    begin = end + 1;
  }
  out += "└" + edge + "┘\n" + sketch.caption + '\n';
  if (!screen.colour) return out;
  const auto key = [](const draw::Ink256& ink, const char* sign, const char* name) {
    return fmt::format("\x1b[38;5;{}m{}\x1b[0m {}", ink.colour, sign, name);
  };
  out += fmt::format("{}  {}  {}  {}\n", key(tree_ink, "━", "tree"), key(failed_ink, "∙", "proposals without a node"),
                     key(path_ink, "━", "path"), key(wall_ink, "█", "obstacles"));
  return out;
}

void plot_file(const Run& run, std::size_t level, const std::string& path) {
  const draw::Format format = format_of(path);
  const Sketch sketch = sketch_of(run, level);
  namespace page = draw::page;
  namespace palette = draw::palette;
  const double wide = sketch.bounds.hi.x - sketch.bounds.lo.x;
  const double high = sketch.bounds.hi.y - sketch.bounds.lo.y;
  constexpr double longer_side = 420.0;  // points
  constexpr std::size_t most_lines = 4;
  const double scale = longer_side / std::max(wide, high);
  const double width = std::max(0.5 * longer_side, scale * wide);
  const auto title = page::wrapped(outcome_text(run), width, page::label_font, most_lines);
  const auto caption = page::wrapped(sketch.caption, width, page::caption_font, most_lines);
  const double top = page::border + page::block_height(title, page::label_font) + page::border;
  const double bottom = top + scale * high;
  draw::Canvas canvas(width + 2.0 * page::border,
                      bottom + 2.0 * page::border + page::block_height(caption, page::caption_font));
  canvas.fill(draw::Path::rectangle({0.0, 0.0, canvas.width(), canvas.height()}), palette::paper);
  page::block(canvas, title, {page::border, page::border}, {.font = page::label_font, .colour = palette::ink});
  page::block(canvas, caption, {page::border, bottom + page::border},
              {.font = page::caption_font, .colour = palette::muted});
  const draw::Rect world{page::border, top, scale * wide, scale * high};
  const auto at = [&](Point p) {
    return Point{world.x + scale * (p.x - sketch.bounds.lo.x), world.bottom() - scale * (p.y - sketch.bounds.lo.y)};
  };
  const auto all_at = [&](std::vector<Point> points) {
    std::transform(points.begin(), points.end(), points.begin(), at);
    return points;
  };
  {
    const auto clip = canvas.clip(draw::Path::rectangle(world));
    for (const auto& obstacle : sketch.obstacles) canvas.fill(draw::Path::polygon(all_at(obstacle)), palette::rest);
    for (const Point p : sketch.failed) canvas.fill(draw::Path::circle(at(p), 0.9), palette::orange.faded(0.6));
    for (const auto& [a, b] : sketch.edges)
      canvas.line(at(a), at(b), {.colour = palette::blue.faded(0.6), .width = 0.5});
    for (const Point p : sketch.nodes) canvas.fill(draw::Path::circle(at(p), 0.8), palette::blue);
    for (const auto& part : sketch.robots) {
      canvas.stroke(draw::Path::polygon(all_at(part)), {.colour = palette::ink, .width = 0.9});
    }
    if (sketch.path.size() > 1) {
      canvas.stroke(draw::Path::polyline(all_at(sketch.path)), {.colour = palette::vermillion, .width = 1.6});
    }
    constexpr double end_radius = 2.4;
    draw::draw_end(canvas, at(sketch.start), end_radius, true);
    draw::draw_end(canvas, at(sketch.goal), end_radius, false);
  }
  canvas.stroke(draw::Path::rectangle(world), {.colour = palette::frame, .width = 0.7});
  write_file(path, canvas.render(format));
}

}  // namespace trellis::command
