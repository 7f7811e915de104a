// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/worlds.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/draw/page.hpp>

namespace trellis::draw {

namespace {

constexpr double robot_outline = 0.8;
constexpr double marked_below = 4.0;  ///< points; draw a smaller robot as a mark
constexpr double mark_radius = 2.2;

Rect bounds_of(const std::vector<WorldShape>& shapes) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point lo{infinity, infinity};
  Point hi{-infinity, -infinity};
  const auto add = [&](Point p, double radius) {
    lo = {std::min(lo.x, p.x - radius), std::min(lo.y, p.y - radius)};
    hi = {std::max(hi.x, p.x + radius), std::max(hi.y, p.y + radius)};
  };
  for (const auto& shape : shapes) {
    if (const auto* disc = std::get_if<WorldDisc>(&shape)) {
      add(disc->centre, disc->radius);
    } else {
      for (const Point p : std::get<std::vector<Point>>(shape)) add(p, 0.0);
    }
  }
  return {lo.x, lo.y, hi.x - lo.x, hi.y - lo.y};
}

}  // namespace

Path path_of(const WorldShape& shape, const Transform& map) {
  if (const auto* disc = std::get_if<WorldDisc>(&shape)) {
    return Path::circle(map(disc->centre), disc->radius * map.xx);
  }
  return Path::polygon(std::get<std::vector<Point>>(shape)).mapped(map);
}

void append(Path& to, const Path& path) {
  const Point* p = path.points().data();
  for (const auto verb : path.verbs()) {
    switch (verb) {
      case Path::Verb::move: to.move_to(p[0]); break;
      case Path::Verb::line: to.line_to(p[0]); break;
      case Path::Verb::curve: to.curve_to(p[0], p[1], p[2]); break;
      case Path::Verb::close: to.close(); break;
    }
    p += verb == Path::Verb::curve ? 3 : verb == Path::Verb::close ? 0 : 1;
  }
}

std::vector<Path> robot_paths(const std::vector<WorldShape>& parts, const Transform& map) {
  std::vector<Path> paths;
  if (parts.empty()) return paths;
  const Rect box = bounds_of(parts);
  if (std::max(box.width, box.height) * map.xx < marked_below) return {Path::circle(map(box.centre()), mark_radius)};
  paths.reserve(parts.size());
  for (const auto& part : parts) paths.push_back(path_of(part, map));
  return paths;
}

void outline(Canvas& canvas, const std::vector<Path>& paths, const Rect& page, std::size_t at) {
  if (at == paths.size()) {
    for (const Path& path : paths) canvas.stroke(path, {palette::ink, 2.0 * robot_outline});
    return;
  }
  Path outside = Path::rectangle(page);
  append(outside, paths[at]);
  const auto clip = canvas.clip(outside, FillRule::even_odd);
  outline(canvas, paths, page, at + 1);
}

double scale_bar_height() { return page::line_height(page::tick_font) + 1.0; }

void draw_scale_bar(Canvas& canvas, Point at, double most, double scale) {
  const double longest = most / scale;
  const double power = std::pow(10.0, std::floor(std::log10(longest)));
  const double metres = longest >= 5.0 * power ? 5.0 * power : longest >= 2.0 * power ? 2.0 * power : power;
  const double length = metres * scale;
  const double middle = at.y + 0.5 * scale_bar_height();
  canvas.line({at.x, middle}, {at.x + length, middle}, {palette::ink, 1.2, {}, Cap::butt});
  for (const double x : {at.x, at.x + length}) {
    canvas.line({x, middle - 2.0}, {x, middle + 2.0}, {palette::ink, 0.8});
  }
  canvas.text(fmt::format("{:g} m", metres), {at.x + length + 4.0, middle},
              {page::tick_font, palette::ink, Align::left, Stand::middle});
}

void draw_end(Canvas& canvas, Point at, double radius, bool start) {
  canvas.fill(Path::circle(at, radius), start ? start_colour : goal_colour);
  canvas.stroke(Path::circle(at, radius), {palette::ink, 1.0});
}

void draw_obstacles(Canvas& canvas, const std::vector<WorldShape>& obstacles, const Transform& map) {
  for (const auto& obstacle : obstacles) {
    canvas.fill(path_of(obstacle, map), obstacle_colour);
    canvas.stroke(path_of(obstacle, map), {obstacle_edge, 0.4});
  }
}

}  // namespace trellis::draw
