// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <random>
#include <regex>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/draw/chart.hpp>
#include <trellis/draw/marks.hpp>
#include <trellis/draw/text.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kinds = {Series::Kind::line, Series::Kind::points, Series::Kind::bars, Series::Kind::steps};

/// A series of a kind with these heights at 0, 1, 2 ... and intervals of half their size.
Series series_of(Series::Kind kind, std::vector<double> y, std::string name = "series") {
  Series s{.kind = kind, .name = std::move(name), .y = std::move(y)};
  for (std::size_t i = 0; i < s.y.size() + (kind == Series::Kind::steps ? 1 : 0); ++i) {
    s.x.push_back(static_cast<double>(i));
  }
  for (const double v : s.y) {
    s.lo.push_back(v - 0.5 * std::abs(v));
    s.hi.push_back(v + 0.5 * std::abs(v));
  }
  return s;
}

Figure figure_of(Series series) {
  Panel panel{.title = "panel", .x = {.label = "across"}, .y = {.label = "up"}};
  panel.series = {std::move(series)};
  panel.references = {{1.0, "one"}};
  Figure figure;
  figure.title = "title";
  figure.caption = "caption";
  figure.panels = {panel};
  return figure;
}

/// The ink of a panel's marks alone, in a frame of 100 x 100 points at (50, 50) over [0, 10] x [0, 10].
struct Drawn {
  bool edge = false;
  Ink ink;
};
Drawn drawn(Series series, AxisScale scale = AxisScale::linear) {
  series.colour = palette::ink;
  if (!series.marker) series.marker = Marker::circle;
  Panel panel;
  panel.series = {std::move(series)};
  panel.y.scale = scale;
  const Rect plot{50, 50, 100, 100};
  const Extent y = scale == AxisScale::log ? Extent{0.1, 10.0} : Extent{0.0, 10.0};
  const marks::Frame frame{plot, marks::Scale({0.0, 10.0}, AxisScale::linear, 50.0, 150.0),
                           marks::Scale(y, scale, 150.0, 50.0)};
  Canvas canvas(200.0, 200.0);
  const bool edge = marks::draw(canvas, panel, frame);
  return {edge, canvas.ink(1.0)};
}

}  // namespace

TEST_CASE("every kind of series renders in every format", "[draw][slow]") {
  const std::vector<std::vector<double>> values = {{},
                                                   {1.0},
                                                   {not_a_number},
                                                   {infinity},
                                                   {0.0, 0.0, 0.0},
                                                   {1.0, 2.0, not_a_number, 3.0, not_a_number, 1.0},
                                                   {1.0, infinity, 2.0, -infinity, -1.0},
                                                   {1e300, -1e300, 1e308},
                                                   {1e-300, 3e-300, 5e-324},
                                                   {1e9, 1e9 + 1e-6, 1e9}};
  for (const auto kind : kinds) {
    for (const auto scale : {AxisScale::linear, AxisScale::log}) {
      for (const auto& y : values) {
        CAPTURE(static_cast<int>(kind), static_cast<int>(scale), y);
        Figure figure = figure_of(series_of(kind, y));
        figure.panels[0].y.scale = scale;
        const Canvas canvas = plot(figure);
        CHECK(canvas.width() == figure.width);
        CHECK(canvas.height() > figure.panel_height);
        check_formats(canvas);
        CHECK(plot(figure).render(Format::svg) == canvas.render(Format::svg));
      }
    }
  }
}

TEST_CASE("figures without anything are drawn", "[draw]") {
  check_formats(plot({}));
  check_formats(plot({.panels = std::vector<Panel>(5), .columns = 3, .share_x = true, .share_y = true}));
  // What says "no data" differs from an axis with data.
  Figure empty = figure_of(series_of(Series::Kind::line, {not_a_number, not_a_number}));
  Figure blank = empty;
  blank.panels[0].series.clear();
  empty.legend = blank.legend = Legend::none;
  blank.panels[0].x.lo = 0.0;
  blank.panels[0].x.hi = 1.0;
  CHECK(plot(empty).render(Format::svg) == plot(blank).render(Format::svg));
}

TEST_CASE("figures stand random numbers and long names", "[draw][slow]") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto number = [&] {
    const double u = unit(random);
    if (u < 0.1) return not_a_number;
    if (u < 0.15) return infinity;
    if (u < 0.2) return -infinity;
    return (unit(random) < 0.5 ? -1.0 : 1.0) * std::pow(10.0, 40.0 * unit(random) - 20.0);
  };
  const std::vector<std::string> names = {
      "",         "a",           "shrink(0.5) >> lazy()", std::string(500, 'w'), "Ünïcödé ∞ 日本",
      "\xff\xfe", "line\nbreak", std::string(3, '\0')};
  const auto name = [&] { return names[random() % names.size()]; };
  for (int trial = 0; trial < 60; ++trial) {
    Figure figure{
        .title = name(), .caption = name(), .columns = 1 + random() % 4, .width = 100.0 + 500.0 * unit(random)};
    figure.share_x = trial % 4 == 0;
    figure.share_y = trial % 3 == 0;
    const std::size_t categories = trial % 4 == 1 ? 1 + random() % 60 : 0;
    for (std::size_t p = 0; p < 1 + random() % 5; ++p) {
      Panel panel{.title = name()};
      panel.x.label = name();
      panel.y.label = name();
      if (trial % 2 == 0) panel.y.scale = AxisScale::log;
      for (std::size_t c = 0; c < categories; ++c) panel.x.categories.push_back(names[c % names.size()]);
      for (std::size_t k = 0; k < random() % 6; ++k) {
        Series s{.kind = kinds[random() % kinds.size()], .name = name()};
        const std::size_t n = random() % 20;
        for (std::size_t i = 0; i < n; ++i) {
          s.x.push_back(unit(random) < 0.5 ? static_cast<double>(i) : number());
          s.y.push_back(number());
          s.lo.push_back(number());
          s.hi.push_back(number());
          s.text.push_back(name());
        }
        if (s.kind == Series::Kind::steps && n > 0) s.x.push_back(number());
        s.dash = static_cast<Dash>(random() % 3);
        panel.series.push_back(std::move(s));
      }
      panel.references = {{number(), name()}, {number(), name()}};
      panel.connectors = {{{number(), number()}, {number(), number()}}};
      panel.shades = {{number(), number(), name()}};
      panel.lanes = {{name(), palette::blue, {{number(), number()}}}};
      figure.panels.push_back(std::move(panel));
    }
    CAPTURE(trial);
    check_formats(plot(figure));
  }
}

TEST_CASE("what is beyond the axis is marked at its edge", "[draw]") {
  const Rect top{50, 48, 100, 12};
  const Rect bottom{50, 140, 100, 12};
  for (const auto kind : kinds) {
    CAPTURE(static_cast<int>(kind));
    Series s{.kind = kind, .x = {4.0}, .y = {5.0}};
    if (kind == Series::Kind::steps) s.x.push_back(6.0);
    const Drawn within = drawn(s);
    CHECK(!within.edge);
    CHECK(within.ink.in(top) == 0.0);
    CHECK(within.ink.in({0, 0, 200, 200}) > 0.0);
    s.y = {infinity};
    const Drawn above = drawn(s);
    CHECK(above.edge);
    CHECK(above.ink.in(top) > 5.0);
    s.y = {-infinity};
    const Drawn below = drawn(s);
    CHECK(below.edge);
    CHECK(below.ink.in(bottom) > 5.0);
    s.y = {not_a_number};
    const Drawn gap = drawn(s);
    CHECK(!gap.edge);
    CHECK(gap.ink.in({0, 0, 200, 200}) == 0.0);
    // A logarithm of zero is as far below as can be.
    s.y = {0.0};
    if (kind != Series::Kind::line) CHECK(drawn(s, AxisScale::log).edge);
  }
  for (const auto kind : kinds) {
    CAPTURE(static_cast<int>(kind));
    Series error{.kind = kind, .x = {5.0}, .y = {5.0}, .lo = {4.0}, .hi = {infinity}};
    if (kind == Series::Kind::steps) error.x.push_back(6.0);
    CHECK(drawn(error).edge);
    CHECK(drawn(error).ink.in(top) > 5.0);
    error.hi = {6.0};
    CHECK(!drawn(error).edge);
  }
  Series sideways{.kind = Series::Kind::points, .x = {infinity}, .y = {5.0}};
  CHECK(drawn(sideways).edge);
  CHECK(drawn(sideways).ink.in({140, 90, 12, 20}) > 5.0);
}

TEST_CASE("the legend covers no data", "[draw]") {
  const auto height = [](Figure figure, Legend legend) {
    figure.legend = legend;
    return plot(figure).height();
  };
  // A rising line leaves a corner free; points everywhere leave none.
  Figure free = figure_of(series_of(Series::Kind::line, {1.0, 2.0, 3.0, 4.0}));
  free.panels[0].references.clear();
  CHECK(height(free, Legend::automatic) == height(free, Legend::none));
  CHECK(height(free, Legend::above) > height(free, Legend::none));
  Series all{.kind = Series::Kind::points, .name = "all over"};
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 20; ++j) {
      all.x.push_back(i);
      all.y.push_back(j);
    }
  }
  const Figure full = figure_of(all);
  CHECK(height(full, Legend::automatic) == height(full, Legend::above));
  Figure two = free;
  two.panels.push_back(two.panels[0]);
  CHECK(height(two, Legend::automatic) == height(two, Legend::above));
}

TEST_CASE("a figure is larger only where its panels need it", "[draw]") {
  Figure figure = figure_of(series_of(Series::Kind::line, {1.0, 2.0}));
  for (const double width : {252.0, 504.0, 1000.0}) {
    figure.width = width;
    CHECK(plot(figure).width() == Approx(width));
  }
  figure.panels.resize(8, figure.panels[0]);
  figure.columns = 8;
  figure.width = 100.0;
  CHECK(plot(figure).width() > 8.0 * 40.0);
  check_formats(plot(figure));
}

TEST_CASE("a name has one colour in all panels", "[draw]") {
  Figure figure = figure_of(series_of(Series::Kind::line, {1.0, 2.0}, "a"));
  figure.panels.push_back(figure.panels[0]);
  figure.panels[1].series.insert(figure.panels[1].series.begin(), series_of(Series::Kind::line, {2.0, 1.0}, "b"));
  Figure explicitly = figure;
  explicitly.panels[0].series[0].colour = palette::nth(0);
  explicitly.panels[1].series[0].colour = palette::nth(1);
  explicitly.panels[1].series[1].colour = palette::nth(0);
  CHECK(plot(figure).render(Format::svg) == plot(explicitly).render(Format::svg));
}

TEST_CASE("a chart that contradicts itself is a fault", "[draw]") {
  Figure figure = figure_of(series_of(Series::Kind::line, {1.0, 2.0}));
  const auto broken = [&](auto&& change) {
    Figure bad = figure;
    change(bad);
    CHECK_THROWS_AS(plot(bad), Fault);
  };
  broken([](Figure& f) { f.panels[0].series[0].x.push_back(1.0); });
  broken([](Figure& f) { f.panels[0].series[0].lo.pop_back(); });
  broken([](Figure& f) { f.panels[0].series[0].text = {"one"}; });
  broken([](Figure& f) { f.panels[0].series[0].kind = Series::Kind::steps; });
  broken([](Figure& f) { f.panels[0].y.lo = infinity; });
  broken([](Figure& f) { f.panels[0].y.lo = f.panels[0].y.hi = 1.0; });
  broken([](Figure& f) {
    f.panels[0].y.scale = AxisScale::log;
    f.panels[0].y.lo = 0.0;
  });
  broken([](Figure& f) { f.columns = 0; });
  broken([](Figure& f) { f.width = not_a_number; });
  broken([](Figure& f) {
    f.panels.push_back(f.panels[0]);
    f.panels[1].y.scale = AxisScale::log;
    f.share_y = true;
  });
  // An end on its own, with all data on the other side of it, still makes an axis.
  figure.panels[0].y.lo = 100.0;
  check_formats(plot(figure));
}

namespace {

/// A printed text, unturned: its box on paper, from the baseline to the height of a capital.
struct Printed {
  std::string text;
  Rect box;
};

std::vector<Printed> printed(const Canvas& canvas, const std::string& size) {
  const std::string markup = canvas.markup("x");
  const std::regex pattern("<text x=\"(-?[0-9.]+)\" y=\"(-?[0-9.]+)\" font-size=\"" + size +
                           "\"[^>]*textLength=\"([0-9.]+)\"[^>]*translate\\((-?[0-9.]+) (-?[0-9.]+)\\)\">([^<]*)<");
  std::vector<Printed> found;
  for (std::sregex_iterator i(markup.begin(), markup.end(), pattern), end; i != end; ++i) {
    const auto number = [&](std::size_t n) { return std::stod((*i)[n]); };
    const double cap = text_extents("0", {.size = std::stod(size)}).cap;
    found.push_back({(*i)[6], {number(1) + number(4), number(2) + number(5) - cap, number(3), cap}});
  }
  return found;
}

bool apart(const Rect& a, const Rect& b) {
  return a.right() <= b.x || b.right() <= a.x || a.bottom() <= b.y || b.bottom() <= a.y;
}

}  // namespace

TEST_CASE("texts of bars cover neither each other nor bars", "[draw]") {
  // A small bar between tall ones, one that ends at zero from below, and values whose texts are wider than bars.
  const std::vector<double> base = {0.0, 1.04, 2.06, -2.3, 0.0, 0.0};
  const std::vector<double> top = {1.04, 2.06, 2.1, -0.05, 0.02, -1.48};
  Panel panel;
  for (std::size_t i = 0; i < top.size(); ++i) panel.x.categories.push_back("c");
  panel.y.lo = -2.35;
  panel.y.hi = 3.0;
  Series bars{.kind = Series::Kind::bars, .name = "bars", .y = top, .lo = top, .hi = top, .base = base};
  for (std::size_t i = 0; i < top.size(); ++i) {
    bars.x.push_back(static_cast<double>(i));
    bars.hi[i] += 0.1;
    bars.text.push_back(number_text(top[i] - base[i], 2));
  }
  panel.series.push_back(bars);
  const Canvas canvas = plot(Figure{.panels = {panel}, .width = 260.0, .panel_height = 120.0, .legend = Legend::none});
  const std::vector<Printed> texts = printed(canvas, "6.5");
  REQUIRE(texts.size() == top.size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      CAPTURE(texts[i].text, texts[j].text);
      CHECK(apart(texts[i].box, texts[j].box));
    }
  }
  // Without the texts there is no ink where they stand, but for the faint grid.
  for (Series& series : panel.series) series.text.clear();
  const Canvas plain = plot(Figure{.panels = {panel}, .width = 260.0, .panel_height = 120.0, .legend = Legend::none});
  REQUIRE(plain.height() == canvas.height());
  const std::string markup = plain.markup("x");
  const std::regex bar("<path d=\"M([0-9.]+) ([0-9.]+)L([0-9.]+) [0-9.]+L[0-9.]+ ([0-9.]+)L[^\"]*\" fill=\"#0072b2\"");
  std::size_t seen = 0;
  for (std::sregex_iterator i(markup.begin(), markup.end(), bar), end; i != end; ++i, ++seen) {
    const auto number = [&](std::size_t n) { return std::stod((*i)[n]); };
    const Rect box{number(1), number(2), number(3) - number(1), number(4) - number(2)};
    for (const Printed& text : texts) {
      CAPTURE(text.text, text.box.x, text.box.y, box.x, box.y, box.width, box.height);
      CHECK(apart(text.box, box));
    }
  }
  CHECK(seen == top.size());
}

TEST_CASE("the last line of a panel's title is never left out", "[draw]") {
  const std::string name = "a strategy with a name that is far too long for the title of a panel of this width";
  Panel tree{.title = name + "\ntree"};
  Panel expansion{.title = name + "\nexpansion"};
  const std::string markup = plot(Figure{.panels = {tree, expansion}, .columns = 2, .width = 300.0}).markup("x");
  CHECK(markup.find(">tree<") != std::string::npos);
  CHECK(markup.find(">expansion<") != std::string::npos);
}
