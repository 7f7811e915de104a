// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/canvas.hpp>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/draw/text.hpp>

#ifdef __SANITIZE_ADDRESS__
// Cairo caches fontconfig's results behind pointers that the leak check cannot follow: five patterns, whatever the
// number of drawings.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }
// The list of what was suppressed would be in the output that tests compare.
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }
#endif

namespace trellis::draw {

namespace {

thread_local Typeface current_typeface = Typeface::sans;
/// Cairo shares fonts between all threads and may end one that another thread uses: only the holder of this lock uses
/// fonts, or what has drawn with them.
std::mutex& fonts() {
  static std::mutex mutex;
  return mutex;
}
/// Cairo's coordinates have 24 bits before the binary point.
constexpr double farthest = 4e6;
constexpr double largest_png = 32767.0;

struct Free {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_scaled_font_t* font) const { cairo_scaled_font_destroy(font); }
  void operator()(cairo_font_face_t* face) const { cairo_font_face_destroy(face); }
  void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

void require(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) throw Fault(fmt::format("drawing: {}", cairo_status_to_string(status)));
}

void require(Point p) {
  if (!(std::abs(p.x) <= farthest && std::abs(p.y) <= farthest)) {
    throw Fault(fmt::format("drawing: a point at ({:g}, {:g})", p.x, p.y));
  }
}

void require(const Colour& colour) {
  for (const double part : {colour.r, colour.g, colour.b, colour.a}) {
    if (!(part >= 0.0 && part <= 1.0)) throw Fault(fmt::format("drawing: {:g} in a colour", part));
  }
}

void require(const Font& font) {
  if (!(font.size > 0.0 && font.size <= 1e4)) throw Fault(fmt::format("drawing: text of size {:g}", font.size));
}

/// No hinting, so that text has the same width in all formats.
Owned<cairo_font_options_t> unhinted() {
  Owned<cairo_font_options_t> options(cairo_font_options_create());
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  return options;
}

Owned<cairo_font_face_t> face(const Font& font, Typeface typeface) {
  const char* name = typeface == Typeface::serif ? "DejaVu Serif" : "DejaVu Sans";
  return Owned<cairo_font_face_t>(
      cairo_toy_font_face_create(name, font.italic ? CAIRO_FONT_SLANT_ITALIC : CAIRO_FONT_SLANT_NORMAL,
                                 font.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL));
}

cairo_status_t append(void* to, const unsigned char* data, unsigned length) {
  try {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
  } catch (const std::exception&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

/// Cairo numbers the surfaces of a process, and an SVG shows the number: renumber from 0 in each document.
std::string renumbered(const std::string& svg) {
  constexpr std::string_view word = "surface";
  std::vector<std::string> seen;
  std::string out;
  std::size_t from = 0;
  for (std::size_t at = svg.find(word); at != std::string::npos; at = svg.find(word, from)) {
    const std::size_t begin = at + word.size();
    const std::size_t end = std::min(svg.find_first_not_of("0123456789", begin), svg.size());
    out.append(svg, from, begin - from);
    if (end > begin) {
      const std::string number = svg.substr(begin, end - begin);
      const auto found = std::find(seen.begin(), seen.end(), number);
      out += std::to_string(found - seen.begin());
      if (found == seen.end()) seen.push_back(number);
    }
    from = end;
  }
  return out.append(svg, from);
}

std::size_t whole(double length, double scale) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(length * scale - 1e-6)));
}

}  // namespace

TypefaceScope::TypefaceScope(Typeface typeface) : before_(std::exchange(current_typeface, typeface)) {}
TypefaceScope::~TypefaceScope() { current_typeface = before_; }

Transform Transform::rotate(double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {.xx = c, .yx = -s, .xy = s, .yy = c};
}

Transform operator*(const Transform& a, const Transform& b) {
  return {.xx = a.xx * b.xx + a.xy * b.yx,
          .yx = a.yx * b.xx + a.yy * b.yx,
          .xy = a.xx * b.xy + a.xy * b.yy,
          .yy = a.yx * b.xy + a.yy * b.yy,
          .x0 = a.xx * b.x0 + a.xy * b.y0 + a.x0,
          .y0 = a.yx * b.x0 + a.yy * b.y0 + a.y0};
}

Path& Path::move_to(Point p) {
  verbs_.push_back(Verb::move);
  points_.push_back(p);
  return *this;
}

Path& Path::line_to(Point p) {
  if (verbs_.empty()) return move_to(p);
  verbs_.push_back(Verb::line);
  points_.push_back(p);
  return *this;
}

Path& Path::curve_to(Point control1, Point control2, Point end) {
  if (verbs_.empty()) move_to(control1);
  verbs_.push_back(Verb::curve);
  points_.insert(points_.end(), {control1, control2, end});
  return *this;
}

Path& Path::close() {
  verbs_.push_back(Verb::close);
  return *this;
}

Path Path::polyline(std::span<const Point> points) {
  Path path;
  for (const Point p : points) path.line_to(p);
  return path;
}

Path Path::polygon(std::span<const Point> points) {
  Path path = polyline(points);
  path.close();
  return path;
}

Path Path::rectangle(const Rect& rect) {
  const std::array<Point, 4> corners = {Point{rect.x, rect.y}, Point{rect.right(), rect.y},
                                        Point{rect.right(), rect.bottom()}, Point{rect.x, rect.bottom()}};
  return polygon(corners);
}

Path Path::circle(Point centre, double radius) {
  // Four curves approximate a circle to within 0.03 % of the radius.
  const double k = radius * 4.0 / 3.0 * (std::numbers::sqrt2 - 1.0);
  const auto at = [&](double x, double y) { return Point{centre.x + x, centre.y + y}; };
  const double r = radius;
  Path path;
  path.move_to(at(r, 0))
      .curve_to(at(r, k), at(k, r), at(0, r))
      .curve_to(at(-k, r), at(-r, k), at(-r, 0))
      .curve_to(at(-r, -k), at(-k, -r), at(0, -r))
      .curve_to(at(k, -r), at(r, -k), at(r, 0))
      .close();
  return path;
}

Path Path::mapped(const Transform& by) const {
  Path path = *this;
  for (Point& p : path.points_) p = by(p);
  return path;
}

TextExtents text_extents(std::string_view text, const Font& font) {
  require(font);
  const std::scoped_lock lock(fonts());
  const auto options = unhinted();
  const auto used = face(font, current_typeface);
  cairo_matrix_t size;
  cairo_matrix_t identity;
  cairo_matrix_init_scale(&size, font.size, font.size);
  cairo_matrix_init_identity(&identity);
  const Owned<cairo_scaled_font_t> scaled(cairo_scaled_font_create(used.get(), &size, &identity, options.get()));
  require(cairo_scaled_font_status(scaled.get()));
  cairo_font_extents_t line;
  cairo_text_extents_t run;
  cairo_text_extents_t capital;
  cairo_scaled_font_extents(scaled.get(), &line);
  cairo_scaled_font_text_extents(scaled.get(), clean_text(text).c_str(), &run);
  cairo_scaled_font_text_extents(scaled.get(), "H", &capital);
  require(cairo_scaled_font_status(scaled.get()));
  return {run.x_advance, line.ascent, line.descent, capital.height};
}

Ink::Ink(double cell, std::size_t columns, std::size_t rows, std::span<const unsigned char> cover)
    : cell_(cell), columns_(columns), rows_(rows), sums_((columns + 1) * (rows + 1), 0.0) {
  for (std::size_t r = 0; r < rows; ++r) {
    double row = 0.0;
    for (std::size_t c = 0; c < columns; ++c) {
      row += cover[r * columns + c] / 255.0 * cell * cell;
      sums_[(r + 1) * (columns + 1) + c + 1] = sums_[r * (columns + 1) + c + 1] + row;
    }
  }
}

double Ink::in(const Rect& rect) const {
  // All cells that the rectangle touches.
  const auto index = [this](double at, std::size_t most, bool up) {
    const double cells = at / cell_;
    return static_cast<std::size_t>(std::clamp(up ? std::ceil(cells) : std::floor(cells), 0.0, double(most)));
  };
  const std::size_t left = index(rect.x, columns_, false);
  const std::size_t right = index(rect.right(), columns_, true);
  const std::size_t top = index(rect.y, rows_, false);
  const std::size_t bottom = index(rect.bottom(), rows_, true);
  if (left >= right || top >= bottom) return 0.0;
  const auto sum = [this](std::size_t r, std::size_t c) { return sums_[r * (columns_ + 1) + c]; };
  return std::max(0.0, sum(bottom, right) - sum(top, right) - sum(bottom, left) + sum(top, left));
}

Canvas::Canvas(double width, double height) : width_(width), height_(height) {
  if (!(width > 0.0 && height > 0.0 && width <= farthest && height <= farthest)) {
    throw Fault(fmt::format("drawing: a canvas of {:g} x {:g} points", width, height));
  }
}

Canvas::Scope::~Scope() {
  // Leaving a transform only pops the stack; leaving a clip records a command, for which the constructor reserved
  // memory.
  if (canvas_.transforms_.back().clip) {
    canvas_.commands_.emplace_back(Close{});
  }
  canvas_.transforms_.pop_back();
}

Path Canvas::placed(const Path& path) const {
  Path mapped = path.mapped(transforms_.back().map);
  for (const Point p : mapped.points()) require(p);
  return mapped;
}

void Canvas::fill(const Path& path, const Colour& colour, FillRule rule) {
  require(colour);
  commands_.emplace_back(Fill{placed(path), colour, rule});
}

void Canvas::stroke(const Path& path, const Pen& pen) {
  require(pen.colour);
  const bool negative = std::any_of(pen.dash.begin(), pen.dash.end(), [](double d) { return !(d >= 0.0 && d < 1e6); });
  const bool nothing = std::all_of(pen.dash.begin(), pen.dash.end(), [](double d) { return d == 0.0; });
  if (!(pen.width >= 0.0 && pen.width < 1e6) || negative || (nothing && !pen.dash.empty())) {
    throw Fault(fmt::format("drawing: a pen of width {:g} with {} dashes", pen.width, pen.dash.size()));
  }
  commands_.emplace_back(Stroke{placed(path), pen});
}

void Canvas::line(Point from, Point to, const Pen& pen) { stroke(Path().move_to(from).line_to(to), pen); }

void Canvas::text(std::string_view text, Point at, const TextStyle& style) {
  require(style.colour);
  const Point placed = transforms_.back().map(at);
  require(placed);
  require(Point{style.angle, 0.0});
  const TextExtents extents = text_extents(text, style.font);
  Point offset;
  switch (style.align) {
    case Align::left: break;
    case Align::centre: offset.x = -0.5 * extents.width; break;
    case Align::right: offset.x = -extents.width; break;
  }
  switch (style.stand) {
    case Stand::top: offset.y = extents.ascent; break;
    case Stand::middle: offset.y = 0.5 * extents.cap; break;
    case Stand::baseline: break;
    case Stand::bottom: offset.y = -extents.descent; break;
  }
  commands_.emplace_back(
      Text{clean_text(text), placed, offset, style.angle, style.font, current_typeface, style.colour});
}

Canvas::Scope Canvas::clip(const Path& path, FillRule rule) {
  commands_.emplace_back(Clip{placed(path), rule});
  transforms_.push_back({transforms_.back().map, true});
  return Scope(*this);
}

Canvas::Scope Canvas::transform(const Transform& transform) {
  transforms_.push_back({transforms_.back().map * transform, false});
  return Scope(*this);
}

/// Draws the commands of a canvas with Cairo.
class Canvas::Player {
 public:
  /// \param outlines  draw text as outlines: otherwise Cairo's images place letters at whole pixels
  Player(cairo_surface_t* surface, double scale, bool outlines) : to_(cairo_create(surface)), outlines_(outlines) {
    require(cairo_status(to_.get()));
    cairo_scale(to_.get(), scale, scale);
    const auto options = unhinted();
    cairo_set_font_options(to_.get(), options.get());
  }

  void play(const std::vector<Command>& commands) {
    for (const auto& command : commands) std::visit(*this, command);
    require(cairo_status(to_.get()));
  }

  void operator()(const Fill& fill) {
    trace(fill.path);
    paint(fill.colour);
    cairo_set_fill_rule(to_.get(), rule(fill.rule));
    cairo_fill(to_.get());
  }

  void operator()(const Stroke& stroke) {
    constexpr std::array caps = {CAIRO_LINE_CAP_BUTT, CAIRO_LINE_CAP_ROUND, CAIRO_LINE_CAP_SQUARE};
    constexpr std::array joins = {CAIRO_LINE_JOIN_MITER, CAIRO_LINE_JOIN_ROUND, CAIRO_LINE_JOIN_BEVEL};
    const Pen& pen = stroke.pen;
    trace(stroke.path);
    paint(pen.colour);
    cairo_set_line_width(to_.get(), pen.width);
    cairo_set_line_cap(to_.get(), caps.at(static_cast<std::size_t>(pen.cap)));
    cairo_set_line_join(to_.get(), joins.at(static_cast<std::size_t>(pen.join)));
    cairo_set_dash(to_.get(), pen.dash.data(), static_cast<int>(pen.dash.size()), 0.0);
    cairo_stroke(to_.get());
  }

  void operator()(const Text& text) {
    // Surfaces of files keep fonts, and their drawing holds the lock throughout.
    std::unique_lock lock(fonts(), std::defer_lock);
    if (outlines_) lock.lock();
    cairo_save(to_.get());
    const auto used = face(text.font, text.typeface);
    cairo_set_font_face(to_.get(), used.get());
    cairo_set_font_size(to_.get(), text.font.size);
    cairo_translate(to_.get(), text.at.x, text.at.y);
    cairo_rotate(to_.get(), -text.angle * std::numbers::pi / 180.0);
    cairo_move_to(to_.get(), text.offset.x, text.offset.y);
    paint(text.colour);
    if (outlines_) {
      cairo_text_path(to_.get(), text.text.c_str());
      cairo_set_fill_rule(to_.get(), CAIRO_FILL_RULE_WINDING);
      cairo_fill(to_.get());
    } else {
      cairo_show_text(to_.get(), text.text.c_str());
    }
    cairo_restore(to_.get());
    cairo_new_path(to_.get());
  }

  void operator()(const Clip& clip) {
    cairo_save(to_.get());
    trace(clip.path);
    cairo_set_fill_rule(to_.get(), rule(clip.rule));
    cairo_clip(to_.get());
  }

  void operator()(const Close&) { cairo_restore(to_.get()); }

 private:
  static cairo_fill_rule_t rule(FillRule rule) {
    return rule == FillRule::nonzero ? CAIRO_FILL_RULE_WINDING : CAIRO_FILL_RULE_EVEN_ODD;
  }

  void paint(const Colour& c) { cairo_set_source_rgba(to_.get(), c.r, c.g, c.b, c.a); }

  void trace(const Path& path) {
    cairo_new_path(to_.get());
    const Point* p = path.points().data();
    for (const auto verb : path.verbs()) {
      switch (verb) {
        case Path::Verb::move: cairo_move_to(to_.get(), p[0].x, p[0].y); break;
        case Path::Verb::line: cairo_line_to(to_.get(), p[0].x, p[0].y); break;
        case Path::Verb::curve: cairo_curve_to(to_.get(), p[0].x, p[0].y, p[1].x, p[1].y, p[2].x, p[2].y); break;
        case Path::Verb::close: cairo_close_path(to_.get()); break;
      }
      p += verb == Path::Verb::curve ? 3 : verb == Path::Verb::close ? 0 : 1;
    }
  }

  Owned<cairo_t> to_;
  bool outlines_;
};

std::string Canvas::render(Format format, double pixels) const {
  if (transforms_.size() != 1) throw Fault("drawing: a picture rendered inside one of its scopes");
  const bool png = format == Format::png;
  std::string out;
  std::unique_lock lock(fonts(), std::defer_lock);
  if (!png) lock.lock();
  Owned<cairo_surface_t> surface;
  if (png) {
    if (!(pixels > 0.0 && std::max(width_, height_) * pixels <= largest_png)) {
      throw Error(
          fmt::format("a picture of {:g} x {:g} points is no PNG at {:g} pixels a point: the limit is {:g} pixels",
                      width_, height_, pixels, largest_png));
    }
    surface.reset(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(whole(width_, pixels)),
                                             static_cast<int>(whole(height_, pixels))));
  } else if (format == Format::svg) {
    surface.reset(cairo_svg_surface_create_for_stream(append, &out, width_, height_));
  } else {
    surface.reset(cairo_pdf_surface_create_for_stream(append, &out, width_, height_));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  }
  require(cairo_surface_status(surface.get()));
  Player(surface.get(), png ? pixels : 1.0, png).play(commands_);
  if (png) require(cairo_surface_write_to_png_stream(surface.get(), append, &out));
  cairo_surface_finish(surface.get());
  require(cairo_surface_status(surface.get()));
  return format == Format::svg ? renumbered(out) : out;
}

Ink Canvas::ink(double cell) const {
  if (transforms_.size() != 1) throw Fault("drawing: a picture is read inside one of its scopes");
  const std::size_t columns = whole(width_, 1.0 / cell);
  const std::size_t rows = whole(height_, 1.0 / cell);
  const Owned<cairo_surface_t> surface(
      cairo_image_surface_create(CAIRO_FORMAT_A8, static_cast<int>(columns), static_cast<int>(rows)));
  require(cairo_surface_status(surface.get()));
  Player(surface.get(), 1.0 / cell, true).play(commands_);
  cairo_surface_flush(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  std::vector<unsigned char> cover;
  cover.reserve(rows * columns);
  for (std::size_t r = 0; r < rows; ++r) cover.insert(cover.end(), data + r * stride, data + r * stride + columns);
  return {cell, columns, rows, cover};
}

}  // namespace trellis::draw
