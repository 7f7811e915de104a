// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <trellis/base/error.hpp>
#include <trellis/base/parallel.hpp>
#include <trellis/draw/canvas.hpp>
#include <trellis/draw/text.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Canvas picture() {
  Canvas canvas(120.0, 80.0);
  canvas.fill(Path::rectangle({0, 0, 120, 80}), palette::paper);
  canvas.fill(Path::circle({40, 40}, 20), palette::sky.faded(0.5));
  canvas.stroke(Path::polygon(std::array{Point{10, 10}, Point{100, 20}, Point{50, 70}}),
                {palette::vermillion, 1.5, {4.0, 2.0}, Cap::round, Join::bevel});
  {
    const auto clip = canvas.clip(Path::circle({60, 40}, 30), FillRule::even_odd);
    const auto turned = canvas.transform(Transform::move({60, 40}) * Transform::rotate(30.0));
    canvas.line({-60, 0}, {60, 0}, {palette::blue, 2.0});
    canvas.text("déjà vu ∇", {0, -3}, {{7.0, true, true}, palette::ink, Align::centre, Stand::bottom, 30.0});
  }
  canvas.text("outside", {119, 79}, {{6.0}, palette::muted, Align::right, Stand::bottom});
  return canvas;
}

}  // namespace

TEST_CASE("a canvas renders in every format, each time the same", "[draw]") {
  const Canvas canvas = picture();
  check_formats(canvas);
  for (const auto format : {Format::svg, Format::png, Format::pdf}) {
    // Another picture in between changes nothing, as a number that Cairo counts up would.
    const std::string first = canvas.render(format);
    CHECK(Canvas(10, 10).render(Format::svg) != first);
    CHECK(canvas.render(format) == first);
    CHECK(picture().render(format) == first);
  }
}

TEST_CASE("pictures drawn by several threads are those of one", "[draw]") {
  // Sizes of their own, so that fonts come and go in all threads; `text_extents` asks for the same ones.
  const auto drawn = [](std::size_t i) {
    const double size = 5.0 + 0.25 * static_cast<double>(i % 24);
    Canvas canvas(60.0, 40.0);
    canvas.text("déjà vu", {5, 20}, {{size, i % 2 == 0, i % 3 == 0}, palette::ink});
    const Format format = std::array{Format::svg, Format::pdf, Format::png}.at(i % 3);
    return fmt::format("{} {}", text_extents("déjà vu", {size}).width, canvas.render(format, 2.0));
  };
  std::vector<std::string> alone;
  for (std::size_t i = 0; i < 48; ++i) alone.push_back(drawn(i));
  std::vector<int> equal(960, 0);
  in_parallel(equal.size(), 8, [&](std::size_t i) { equal[i] = drawn(i % alone.size()) == alone[i % alone.size()]; });
  CHECK(std::count(equal.begin(), equal.end(), 1) == 960);
}

TEST_CASE("a PNG has as many pixels as was asked for", "[draw]") {
  const Canvas canvas = picture();
  for (const double pixels : {0.5, 1.0, 2.0, 300.0 / 72.0}) {
    const auto [width, height] = png_size(canvas.render(Format::png, pixels));
    CHECK(width == static_cast<unsigned>(std::ceil(120.0 * pixels - 1e-6)));
    CHECK(height == static_cast<unsigned>(std::ceil(80.0 * pixels - 1e-6)));
  }
  CHECK_THROWS_AS(canvas.render(Format::png, 1000.0), Error);
  CHECK_THROWS_AS(canvas.render(Format::png, 0.0), Error);
  CHECK_THROWS_AS(canvas.render(Format::png, not_a_number), Error);
}

TEST_CASE("what cannot be drawn is a fault", "[draw]") {
  Canvas canvas(10.0, 10.0);
  for (const double bad : {not_a_number, infinity, -infinity, 1e9}) {
    CHECK_THROWS_AS(canvas.line({0, bad}, {1, 1}, {}), Fault);
    CHECK_THROWS_AS(canvas.fill(Path::circle({0, 0}, bad), palette::ink), Fault);
    CHECK_THROWS_AS(canvas.text("x", {bad, 0}, {}), Fault);
    CHECK_THROWS_AS(canvas.line({0, 0}, {1, 1}, {.width = bad}), Fault);
    CHECK_THROWS_AS(Canvas(bad, 1.0), Fault);
  }
  CHECK_THROWS_AS(canvas.line({0, 0}, {1, 1}, {.dash = {0.0, 0.0}}), Fault);
  CHECK_THROWS_AS(canvas.line({0, 0}, {1, 1}, {.dash = {1.0, -1.0}}), Fault);
  CHECK_THROWS_AS(canvas.fill(Path::circle({0, 0}, 1), {.r = 2.0}), Fault);
  CHECK_THROWS_AS(canvas.text("x", {0, 0}, {.font = {.size = 0.0}}), Fault);
  CHECK_THROWS_AS(Canvas(0.0, 1.0), Fault);
  const auto scope = canvas.clip(Path::circle({5, 5}, 1));
  CHECK_THROWS_AS(canvas.render(Format::svg), Fault);
}

TEST_CASE("ink is where something was drawn", "[draw]") {
  Canvas canvas(100.0, 100.0);
  CHECK(canvas.ink().in({0, 0, 100, 100}) == 0.0);
  canvas.fill(Path::rectangle({20, 30, 10, 20}), palette::ink);
  CHECK(canvas.ink().in({0, 0, 100, 100}) == Approx(200.0).epsilon(0.01));
  CHECK(canvas.ink(1.0).in({20, 30, 5, 20}) == Approx(100.0).epsilon(0.01));
  CHECK(canvas.ink().in({40, 0, 60, 100}) == 0.0);
  CHECK(canvas.ink().in({-50, -50, 40, 40}) == 0.0);
  canvas.fill(Path::circle({70, 70}, 10), palette::ink);
  CHECK(canvas.ink(0.5).in({50, 50, 50, 50}) == Approx(100.0 * 3.14159265).epsilon(0.01));
}

TEST_CASE("clips and transforms hold as long as their scope", "[draw]") {
  Canvas canvas(100.0, 100.0);
  {
    const auto clip = canvas.clip(Path::rectangle({0, 0, 50, 100}));
    canvas.fill(Path::rectangle({0, 0, 100, 10}), palette::ink);
  }
  CHECK(canvas.ink(1.0).in({0, 0, 100, 10}) == Approx(500.0).epsilon(0.01));
  {
    // y upwards, ten points to a unit; the pen keeps its width.
    const auto world = canvas.transform(Transform::move({0, 100}) * Transform::scale(10.0, -10.0));
    canvas.line({5, 2}, {10, 2}, {palette::ink, 4.0});
  }
  CHECK(canvas.ink(1.0).in({50, 78, 50, 4}) == Approx(200.0).epsilon(0.01));
  canvas.line({0, 40}, {100, 40}, {palette::ink, 2.0});
  CHECK(canvas.ink(1.0).in({0, 39, 100, 2}) == Approx(200.0).epsilon(0.01));
  // A quarter turn counter-clockwise takes what points right to what points up.
  const Point up = Transform::rotate(90.0)({1.0, 0.0});
  CHECK(up.x == Approx(0.0).margin(1e-12));
  CHECK(up.y == Approx(-1.0));
}

TEST_CASE("a picture stands in a page", "[draw]") {
  Canvas canvas(100.0, 50.0);
  canvas.fill(Path::rectangle({1.0, 2.0, 3.0, 4.0}), palette::blue.faded(0.5));
  {
    const auto clip = canvas.clip(Path::circle({50.0, 25.0}, 10.0));
    canvas.line({0.0, 0.0}, {100.0, 50.0}, {.colour = palette::ink, .width = 2.0, .dash = {3.0, 1.5}});
  }
  canvas.text("a < b & \"c\"", {10.0, 20.0}, {.font = {.size = 8.0, .bold = true}, .angle = 90.0});
  const std::string markup = canvas.markup("one");
  CHECK(markup == canvas.markup("one"));
  CHECK(markup.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 50\""));
  CHECK(markup.ends_with("</svg>"));
  CHECK(markup.find("<path d=\"M1 2L4 2L4 6L1 6Z\" fill=\"#0072b2\" fill-opacity=\"0.5\"/>") != std::string::npos);
  CHECK(markup.find("<clipPath id=\"one-1\">") != std::string::npos);
  CHECK(markup.find("<g clip-path=\"url(#one-1)\"><path d=\"M0 0L100 50\"") != std::string::npos);
  CHECK(markup.find("stroke-dasharray=\"3 1.5\"") != std::string::npos);
  CHECK(markup.find("a &lt; b &amp; \"c\"</text>") != std::string::npos);
  CHECK(markup.find("rotate(-90)") != std::string::npos);
  CHECK(markup.size() < canvas.render(Format::svg).size());
  {
    const auto open = canvas.clip(Path::circle({50.0, 25.0}, 10.0));
    CHECK_THROWS_AS(canvas.markup("two"), Fault);
  }
}

TEST_CASE("text is as wide as its extents say", "[draw]") {
  const Font font{.size = 12.0};
  const TextExtents extents = text_extents("HHHHHHHH", font);
  CHECK(extents.width > 40.0);
  CHECK(extents.cap > 6.0);
  CHECK(extents.cap < extents.ascent);
  CHECK(text_extents("HHHHHHHH", {.size = 24.0}).width == Approx(2.0 * extents.width).epsilon(1e-3));
  CHECK(text_extents("", font).width == 0.0);
  CHECK(text_extents("", font).height() == Approx(extents.height()));
  for (const auto align : {Align::left, Align::centre, Align::right}) {
    for (const double angle : {0.0, 90.0, 180.0, 270.0}) {
      CAPTURE(static_cast<int>(align), angle);
      Canvas canvas(300.0, 300.0);
      canvas.text("HHHHHHHH", {150, 150}, {font, palette::ink, align, Stand::middle, angle});
      const double from = align == Align::left ? 0.0 : align == Align::centre ? -0.5 : -1.0;
      const Transform turn = Transform::move({150, 150}) * Transform::rotate(angle);
      const Point a = turn({from * extents.width, -0.5 * extents.cap});
      const Point b = turn({(from + 1.0) * extents.width, 0.5 * extents.cap});
      const Rect box{std::min(a.x, b.x), std::min(a.y, b.y), std::abs(a.x - b.x), std::abs(a.y - b.y)};
      const Ink ink = canvas.ink(1.0);
      CHECK(ink.in(box.grown(1.0)) > 50.0);
      CHECK(ink.in(box.grown(1.0)) == Approx(ink.in({0, 0, 300, 300})));
    }
  }
}

TEST_CASE("text is made fit to print", "[draw]") {
  CHECK(clean_text("a\tb\nc") == "a b c");
  CHECK(clean_text("ä€𝄞") == "ä€𝄞");
  CHECK(clean_text("\xff") == "\uFFFD");
  CHECK(clean_text("\xc0\xaf") == "\uFFFD\uFFFD");            // overlong
  CHECK(clean_text("\xed\xa0\x80") == "\uFFFD\uFFFD\uFFFD");  // a surrogate
  CHECK(clean_text("x\xe2\x82") == "x\uFFFD\uFFFD");          // cut short
  CHECK(clean_text(std::string("a\0b", 3)) == "a b");
  CHECK(clean_text("\xc2\x85") == " ");
  CHECK(number_text(-0.001, 2) == "0.00");
  CHECK(number_text(-1.5, 1) == "−1.5");
  CHECK(number_text(infinity, 1) == "∞");
  CHECK(number_text(not_a_number, 1) == "n/a");
  CHECK(signed_text(0.25, 2) == "+0.25");
  CHECK(signed_text(-infinity, 2) == "−∞");
  CHECK(signed_text(0.001, 2) == "0.00");
  CHECK(power_text(-12) == "10⁻¹²");
}

TEST_CASE("wrapped and shortened text fits", "[draw]") {
  const Font font{.size = 8.0};
  const std::vector<std::string> texts = {"",
                                          "word",
                                          "several words of text that continue for a while",
                                          "ünïcödé ∞∞ «quoted» text",
                                          "a\nb\n\nc",
                                          std::string(300, 'M'),
                                          "  spaces   between  "};
  for (const auto& text : texts) {
    for (const double width : {12.0, 30.0, 80.0, 1000.0}) {
      CAPTURE(text, width);
      CHECK(text_extents(shorten(text, width, font), font).width <= width);
      const auto lines = wrap_text(text, width, font);
      REQUIRE(!lines.empty());
      std::string joined;
      std::string given;
      for (const auto& line : lines) {
        CHECK(text_extents(line, font).width <= width);
        for (const char c : line) joined += c == ' ' ? "" : std::string(1, c);
      }
      for (const char c : text) given += c == ' ' || c == '\n' ? "" : std::string(1, c);
      CHECK(joined == given);
      const auto two = wrap_text(text, width, font, 2);
      CHECK(two.size() <= 2);
      CHECK(two.size() == std::min<std::size_t>(2, lines.size()));
      for (const auto& line : two) CHECK(text_extents(line, font).width <= width);
    }
  }
  CHECK(wrap_text("one two three", 1000.0, font) == std::vector<std::string>{"one two three"});
  CHECK(wrap_text("one\ntwo", 1000.0, font) == std::vector<std::string>{"one", "two"});
  CHECK(wrap_text("i", 0.1, font) == std::vector<std::string>{"i"});
}

TEST_CASE("the palette's colours are distinguishable", "[draw]") {
  for (std::size_t i = 0; i < palette::series.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Colour a = palette::series[i];
      const Colour b = palette::series[j];
      CHECK(std::hypot(a.r - b.r, a.g - b.g, a.b - b.b) > 0.25);
    }
  }
  CHECK(palette::nth(palette::series.size()) == palette::nth(0));
  CHECK(rgb(0xFF8000) == Colour{1.0, 128.0 / 255.0, 0.0, 1.0});
}
