// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/circles.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <trellis/draw/page.hpp>
#include <trellis/draw/text.hpp>
#include <trellis/draw/worlds.hpp>

namespace trellis::draw {

namespace {

constexpr double ring = 0.8;  ///< points
constexpr double least_shown = 0.5;

}  // namespace

CircleLook circle_look(Role role, RoleColours colours, bool alone) {
  const Colour colour = colour_of(role, colours);
  if (alone) return {colour, 0.55};
  switch (role) {
    case Role::target: return {colour, 0.65, false};
    case Role::baseline: return {colour, 0.3, false};
    case Role::tree:
    case Role::expansion: break;
  }
  return {colour};
}

std::vector<CircleLayer> below_each_other(const std::vector<CircleLayer>& layers) {
  constexpr std::array order = {2, 4, 3, 1};  // target, tree, expansion, baseline
  std::vector<CircleLayer> sorted = layers;
  std::stable_sort(sorted.begin(), sorted.end(), [&](const CircleLayer& a, const CircleLayer& b) {
    return order.at(static_cast<std::size_t>(a.role)) < order.at(static_cast<std::size_t>(b.role));
  });
  return sorted;
}

double circle_radius(double area) { return std::sqrt(area / std::numbers::pi); }

Point step(Point p) {
  constexpr double steps = 20.0;
  return {std::round(steps * p.x) / steps, std::round(steps * p.y) / steps};
}

Path stepped(const Path& path) {
  Path out;
  const Point* p = path.points().data();
  for (const auto verb : path.verbs()) {
    switch (verb) {
      case Path::Verb::move: out.move_to(step(*p++)); break;
      case Path::Verb::line: out.line_to(step(*p++)); break;
      case Path::Verb::curve:
        out.curve_to(step(p[0]), step(p[1]), step(p[2]));
        p += 3;
        break;
      case Path::Verb::close: out.close(); break;
    }
  }
  return out;
}

void Circles::add(Point at, double radius) {
  if (!(radius > 0.0)) return;
  const auto circle = [&](double r) { return stepped_ ? stepped(Path::circle(at, r)) : Path::circle(at, r); };
  if (radius <= ring) {
    append(dots_, circle(radius));
  } else {
    append(discs_, circle(radius));
    append(rings_, circle(radius - 0.5 * ring));
  }
}

void Circles::draw(Canvas& canvas, const CircleLook& look) const {
  if (look.filling > 0.0 && !discs_.verbs().empty()) canvas.fill(discs_, look.colour.faded(look.filling));
  if (look.ringed && !rings_.verbs().empty()) canvas.stroke(rings_, {look.colour, ring});
  if (!dots_.verbs().empty()) canvas.fill(dots_, look.ringed ? look.colour : look.colour.faded(look.filling));
}

double circle_sizes_height(const std::vector<double>& sizes, double area) {
  return std::max(page::line_height(page::tick_font), 2.0 * circle_radius(sizes.back() * area));
}

void draw_circle_sizes(Canvas& canvas, const std::vector<double>& sizes, double area, const CircleLook& look,
                       const Rect& plot) {
  const double middle = plot.bottom() + 3.0 + 0.5 * circle_sizes_height(sizes, area);
  const TextStyle style{page::tick_font, palette::ink, Align::left, Stand::middle};
  double x = plot.x + 1.0;
  for (const double size : sizes) {
    const double radius = circle_radius(size * area);
    Circles circle;
    circle.add({x + radius, middle}, radius);
    circle.draw(canvas, look);
    const std::string text = fmt::format("{:g}", size);
    canvas.text(text, {x + 2.0 * radius + 2.0, middle}, style);
    x += 2.0 * radius + 2.0 + text_extents(text, page::tick_font).width + 7.0;
  }
  canvas.text(shorten("per cell", plot.right() - x + 4.0, page::tick_font), {x - 4.0, middle},
              {page::tick_font, palette::muted, Align::left, Stand::middle});
}

std::vector<double> visible_sizes(std::vector<double> sizes, double area) {
  std::erase_if(sizes, [&](double size) { return circle_radius(size * area) < least_shown; });
  return sizes;
}

void draw_note(Canvas& canvas, const std::string& text, const Rect& plot) {
  const Font font{.size = 9.0, .italic = true};
  const std::string note = shorten(text, plot.width - 6.0, font);
  const TextExtents extents = text_extents(note, font);
  const Point at = plot.centre();
  canvas.fill(Path::rectangle({at.x - 0.5 * extents.width - 3.0, at.y - 0.5 * extents.height() - 1.0,
                               extents.width + 6.0, extents.height() + 2.0}),
              palette::paper.faded(0.85));
  canvas.text(note, at, {font, palette::muted, Align::centre, Stand::middle});
}

}  // namespace trellis::draw
