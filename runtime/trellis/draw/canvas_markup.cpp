// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures as elements of an HTML page.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/draw/canvas.hpp>

namespace trellis::draw {

namespace {

/// Hundredths of a point are precise enough for any screen.
std::string number(double x) {
  std::string text = fmt::format("{:.2f}", x);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string hex(const Colour& c) {
  const auto part = [](double x) { return static_cast<unsigned>(std::lround(255.0 * x)); };
  return fmt::format("#{:02x}{:02x}{:02x}", part(c.r), part(c.g), part(c.b));
}

/// fill="#123456" fill-opacity="0.5"
std::string paint(std::string_view what, const Colour& colour) {
  std::string out = fmt::format(R"( {}="{}")", what, hex(colour));
  if (colour.a < 1.0) out += fmt::format(R"( {}-opacity="{}")", what, number(colour.a));
  return out;
}

std::string data(const Path& path) {
  std::string out;
  const Point* p = path.points().data();
  const auto add = [&](char verb, std::size_t points) {
    out += verb;
    for (std::size_t i = 0; i < points; ++i, ++p) {
      out += (i == 0 ? "" : " ") + number(p->x) + ' ' + number(p->y);
    }
  };
  for (const auto verb : path.verbs()) {
    switch (verb) {
      case Path::Verb::move: add('M', 1); break;
      case Path::Verb::line: add('L', 1); break;
      case Path::Verb::curve: add('C', 3); break;
      case Path::Verb::close: add('Z', 0); break;
    }
  }
  return out;
}

}  // namespace

/// Writes the commands of a picture as SVG.
class Canvas::Scribe {
 public:
  explicit Scribe(std::string_view id) : id_(id) {}

  void operator()(const Fill& fill) {
    out_ += fmt::format(R"(<path d="{}"{}{}/>)", data(fill.path), paint("fill", fill.colour),
                        fill.rule == FillRule::even_odd ? R"( fill-rule="evenodd")" : "");
  }

  void operator()(const Stroke& stroke) {
    constexpr std::array caps = {"butt", "round", "square"};
    constexpr std::array joins = {"miter", "round", "bevel"};
    const Pen& pen = stroke.pen;
    out_ += fmt::format(R"(<path d="{}" fill="none"{} stroke-width="{}")", data(stroke.path),
                        paint("stroke", pen.colour), number(pen.width));
    if (pen.cap != Cap::butt) {
      out_ += fmt::format(R"( stroke-linecap="{}")", caps.at(static_cast<std::size_t>(pen.cap)));
    }
    if (pen.join != Join::miter) {
      out_ += fmt::format(R"( stroke-linejoin="{}")", joins.at(static_cast<std::size_t>(pen.join)));
    }
    if (!pen.dash.empty()) {
      std::string dash;
      for (const double length : pen.dash) dash += (dash.empty() ? "" : " ") + number(length);
      out_ += fmt::format(R"( stroke-dasharray="{}")", dash);
    }
    out_ += "/>";
  }

  void operator()(const Text& text) {
    if (text.text.empty()) return;
    out_ +=
        fmt::format(R"(<text x="{}" y="{}" font-size="{}"{}{}{} textLength="{}" lengthAdjust="spacingAndGlyphs")",
                    number(text.offset.x), number(text.offset.y), number(text.font.size),
                    text.font.bold ? R"( font-weight="bold")" : "", text.font.italic ? R"( font-style="italic")" : "",
                    paint("fill", text.colour), number(text_extents(text.text, text.font).width));
    out_ += fmt::format(R"( transform="translate({} {}))", number(text.at.x), number(text.at.y));
    if (text.angle != 0.0) out_ += fmt::format(" rotate({})", number(-text.angle));
    out_ += R"(">)" + escaped(text.text) + "</text>";
  }

  void operator()(const Clip& clip) {
    const std::string name = fmt::format("{}-{}", id_, ++clips_);
    out_ += fmt::format(R"-(<clipPath id="{0}"><path d="{1}"{2}/></clipPath><g clip-path="url(#{0})">)-", name,
                        data(clip.path), clip.rule == FillRule::even_odd ? R"( clip-rule="evenodd")" : "");
  }

  void operator()(const Close&) { out_ += "</g>"; }

  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  std::string id_;
  std::string out_;
  int clips_ = 0;
};

std::string Canvas::markup(std::string_view id) const {
  if (transforms_.size() != 1) throw Fault("drawing: a picture rendered inside one of its scopes");
  Scribe scribe(id);
  for (const Command& command : commands_) std::visit(scribe, command);
  // The width in CSS pixels; a point is 4/3 of a pixel.
  return fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{2}" height="{3}" )"
                     R"(font-family="DejaVu Sans, Verdana, sans-serif" role="img">{4}</svg>)",
                     number(width_), number(height_), number(width_ * 4.0 / 3.0), number(height_ * 4.0 / 3.0),
                     scribe.take());
}

}  // namespace trellis::draw
