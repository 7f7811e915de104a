// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <trellis/draw/palette.hpp>

namespace trellis::draw {

/// Lengths are in points, 1/72 inch; x to the right and y down; angles are in degrees, counter-clockwise on the page.
struct Point {
  double x = 0.0;
  double y = 0.0;
  friend bool operator==(const Point&, const Point&) = default;
};

struct Rect {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  [[nodiscard]] double right() const { return x + width; }
  [[nodiscard]] double bottom() const { return y + height; }
  [[nodiscard]] Point centre() const { return {x + 0.5 * width, y + 0.5 * height}; }
  [[nodiscard]] Rect grown(double by) const { return {x - by, y - by, width + 2.0 * by, height + 2.0 * by}; }
};

/// An affine map: (x, y) -> (xx x + xy y + x0, yx x + yy y + y0).
struct Transform {
  double xx = 1.0;
  double yx = 0.0;
  double xy = 0.0;
  double yy = 1.0;
  double x0 = 0.0;
  double y0 = 0.0;

  static Transform move(Point by) { return {.x0 = by.x, .y0 = by.y}; }
  static Transform scale(double x, double y) { return {.xx = x, .yy = y}; }
  static Transform rotate(double degrees);
  [[nodiscard]] Point operator()(Point p) const { return {xx * p.x + xy * p.y + x0, yx * p.x + yy * p.y + y0}; }
  /// Applies b first, then a.
  friend Transform operator*(const Transform& a, const Transform& b);
};

/// Lines and Bezier curves, open or closed, in any number of pieces.
class Path {
 public:
  enum class Verb : std::uint8_t { move, line, curve, close };

  Path& move_to(Point p);
  Path& line_to(Point p);
  Path& curve_to(Point control1, Point control2, Point end);
  Path& close();

  static Path polyline(std::span<const Point> points);
  static Path polygon(std::span<const Point> points);
  static Path rectangle(const Rect& rect);
  static Path circle(Point centre, double radius);

  [[nodiscard]] const std::vector<Verb>& verbs() const { return verbs_; }
  /// One point for each move and line, three for each curve.
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  [[nodiscard]] Path mapped(const Transform& by) const;

 private:
  std::vector<Verb> verbs_;
  std::vector<Point> points_;
};

enum class FillRule : std::uint8_t { nonzero, even_odd };
enum class Cap : std::uint8_t { butt, round, square };
enum class Join : std::uint8_t { miter, round, bevel };

struct Pen {
  Colour colour{};
  double width = 1.0;
  std::vector<double> dash{};  ///< lengths on and off in turn; empty: solid
  Cap cap = Cap::butt;
  Join join = Join::round;
};

/// DejaVu Sans and DejaVu Serif.
enum class Typeface : std::uint8_t { sans, serif };

/// Sets the typeface of all text that this thread measures and draws during the object's lifetime; the default is sans.
class TypefaceScope {
 public:
  explicit TypefaceScope(Typeface typeface);
  ~TypefaceScope();
  TypefaceScope(const TypefaceScope&) = delete;
  TypefaceScope(TypefaceScope&&) = delete;
  TypefaceScope& operator=(const TypefaceScope&) = delete;
  TypefaceScope& operator=(TypefaceScope&&) = delete;

 private:
  Typeface before_;
};

/// Size of the em, and the style; the TypefaceScope sets the typeface.
struct Font {
  double size = 8.0;
  bool bold = false;
  bool italic = false;
};

struct TextExtents {
  double width = 0.0;    ///< the advance
  double ascent = 0.0;   ///< of the font, above the baseline
  double descent = 0.0;  ///< of the font, below it
  double cap = 0.0;      ///< height of a capital letter
  [[nodiscard]] double height() const { return ascent + descent; }
};

/// Returns the extents of one line. Bytes that are not UTF-8 count as the replacement character that is drawn for them.
TextExtents text_extents(std::string_view text, const Font& font);

enum class Align : std::uint8_t { left, centre, right };
/// The part of the line at the given point: `middle` is half a capital's height.
enum class Stand : std::uint8_t { top, middle, baseline, bottom };

struct TextStyle {
  Font font{};
  Colour colour{};
  Align align = Align::left;
  Stand stand = Stand::baseline;
  double angle = 0.0;  ///< about the given point
};

enum class Format : std::uint8_t { svg, png, pdf };

/// The share of ink in each square cell of a picture.
class Ink {
 public:
  /// \param cover  row by row, 0..255
  Ink(double cell, std::size_t columns, std::size_t rows, std::span<const unsigned char> cover);

  /// Returns the inked area within `rect`, in square points.
  [[nodiscard]] double in(const Rect& rect) const;

 private:
  double cell_;
  std::size_t columns_;
  std::size_t rows_;
  std::vector<double> sums_;  ///< of all cells above and left
};

/// A picture that code draws once and writes in any format, with the same bytes each time: SVG and PDF contain no date,
/// and text has the same extents in all formats. Coordinates must be finite, else Fault.
class Canvas {
 public:
  /// A transform or clip that applies to all drawing during its lifetime. Scopes end in reverse order; a canvas must
  /// not move while it has one.
  class [[nodiscard]] Scope {
   public:
    ~Scope();
    Scope(const Scope&) = delete;
    Scope(Scope&&) = delete;
    Scope& operator=(const Scope&) = delete;
    Scope& operator=(Scope&&) = delete;

   private:
    friend class Canvas;
    explicit Scope(Canvas& canvas) : canvas_(canvas) {}
    Canvas& canvas_;
  };

  Canvas(double width, double height);

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }

  void fill(const Path& path, const Colour& colour, FillRule rule = FillRule::nonzero);
  /// The transform does not change the pen's width.
  void stroke(const Path& path, const Pen& pen);
  void line(Point from, Point to, const Pen& pen);
  /// Draws one line of text. Transforms its position, but not its letters.
  void text(std::string_view text, Point at, const TextStyle& style);

  Scope clip(const Path& path, FillRule rule = FillRule::nonzero);
  /// Applies before the active transforms.
  Scope transform(const Transform& transform);

  /// \param pixels  of a PNG, per point; 2 is 144 to the inch
  /// \throws Error where the picture is too large for a PNG.
  [[nodiscard]] std::string render(Format format, double pixels = 2.0) const;

  /// Returns an <svg> element for an HTML page. It has a tenth of a file's size, because its text is text in the page's
  /// sans serif, fitted to the extents of the other formats.
  /// \param id  prefix of its ids, which must differ from those of the page's other pictures
  [[nodiscard]] std::string markup(std::string_view id) const;

  /// Rasterises the ink in cells of `cell` points.
  [[nodiscard]] Ink ink(double cell = 2.0) const;

 private:
  struct Fill {
    Path path;
    Colour colour;
    FillRule rule;
  };
  struct Stroke {
    Path path;
    Pen pen;
  };
  struct Text {
    std::string text;
    Point at;
    Point offset;  ///< of the baseline's left end, before turning
    double angle;
    Font font;
    Typeface typeface;
    Colour colour;
  };
  struct Clip {
    Path path;
    FillRule rule;
  };
  struct Close {};  ///< ends the last clip
  using Command = std::variant<Fill, Stroke, Text, Clip, Close>;
  class Player;
  class Scribe;

  [[nodiscard]] Path placed(const Path& path) const;

  double width_;
  double height_;
  /// One entry for each active scope.
  struct Placing {
    Transform map;
    bool clip = false;
  };
  std::vector<Placing> transforms_{Placing{}};
  std::vector<Command> commands_;
};

}  // namespace trellis::draw
