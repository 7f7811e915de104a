// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/draw/chart.hpp>
#include <trellis/draw/palette.hpp>
#include <trellis/draw/strips.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

StripFigure figure() {
  return {.title = "Along the path",
          .caption = "Means over 5 runs.",
          .x_label = "place",
          .strips = {{"root: tree", {0.0, 0.5, 1.0}, {0.9, 0.1}, {0.5, 0.5}},
                     {"a long name of a level that has no room beside its strip: tree",
                      {0.0, 0.25, 0.5, 1.0},
                      {0.0, 1.0, 0.0},
                      {0.2, 0.8, 0.0}},
                     {"nothing", {}, {}, {}}}};
}

}  // namespace

TEST_CASE("a bin's colour says whether samples are missing", "[draw]") {
  CHECK(strip_colour(0.3, 0.3) == palette::paper);
  CHECK(strip_colour(0.0, 0.3) == palette::loss);
  CHECK(strip_colour(0.01, 0.3) == palette::loss);  // a quarter of the target's share and less look alike
  const Colour fewer = strip_colour(0.2, 0.3);
  CHECK(fewer.b > palette::loss.b);
  CHECK(fewer.b < 1.0);
  const Colour more = strip_colour(0.6, 0.3);
  CHECK(more.r == Approx(more.g));
  CHECK(more.r < 1.0);
  CHECK(strip_colour(3.0, 0.3) == strip_colour(1.2, 0.3));
  CHECK(strip_colour(0.5, 0.0) == palette::paper);  // no target
}

TEST_CASE("strips are drawn, each as high as the others", "[draw]") {
  check_formats(plot(figure()));
  check_formats(plot(StripFigure{}));
  StripFigure more = figure();
  more.strips.push_back(more.strips.front());
  StripFigure most = more;
  most.strips.push_back(most.strips.front());
  CHECK(plot(more).height() - plot(figure()).height() == Approx(plot(most).height() - plot(more).height()));
  CHECK(plot(more).height() > plot(figure()).height());
  StripFigure narrow = figure();
  narrow.width = 240.0;
  CHECK(plot(narrow).width() == 240.0);
  // A bin without samples is crossed out.
  StripFigure full = figure();
  full.strips[1].share = {0.001, 0.999, 0.0};
  CHECK(plot(full).render(Format::svg).size() < plot(figure()).render(Format::svg).size());
}

TEST_CASE("a strip's shares fit its bins", "[draw]") {
  StripFigure wrong = figure();
  wrong.strips[0].target.pop_back();
  CHECK_THROWS_AS(plot(wrong), Fault);
}

TEST_CASE("points have intervals of both axes, and arrows lead between them", "[draw]") {
  Panel panel;
  panel.series = {{.kind = Series::Kind::points, .name = "a", .x = {1.0}, .y = {2.0}, .marker = Marker::ring},
                  {.kind = Series::Kind::points, .name = "b", .x = {2.0}, .y = {3.0}}};
  Figure plain{.panels = {panel}};
  const std::string before = plot(plain).render(Format::svg);
  Figure crossed = plain;
  crossed.panels[0].series[0].x_lo = {0.5};
  crossed.panels[0].series[0].x_hi = {1.5};
  check_formats(plot(crossed));
  CHECK((plot(crossed).render(Format::svg) != before));
  Figure arrows = plain;
  arrows.panels[0].connectors = {{{1.0, 2.0}, {2.0, 3.0}, true}};
  check_formats(plot(arrows));
  CHECK((plot(arrows).render(Format::svg) != before));
  // An arrow from a point to itself is none.
  arrows.panels[0].connectors = {{{1.0, 2.0}, {1.0, 2.0}, true}};
  CHECK((plot(arrows).render(Format::svg) == before));
  crossed.panels[0].series[0].x_hi.clear();
  crossed.panels[0].series[0].x_lo = {0.5, 0.6};
  CHECK_THROWS_AS(plot(crossed), Fault);
}

TEST_CASE("a typeface holds while its scope does", "[draw]") {
  const Font font{.size = 10.0};
  const double sans = text_extents("guiding spaces", font).width;
  double serif = 0.0;
  Canvas canvas(100.0, 20.0);
  {
    const TypefaceScope scope(Typeface::serif);
    serif = text_extents("guiding spaces", font).width;
    canvas.text("guiding spaces", {0.0, 10.0}, {.font = font});
  }
  CHECK(serif != sans);
  CHECK(text_extents("guiding spaces", font).width == sans);
  // What was drawn keeps its typeface whatever holds when it is written.
  Canvas other(100.0, 20.0);
  other.text("guiding spaces", {0.0, 10.0}, {.font = font});
  const bool same = canvas.render(Format::svg) == other.render(Format::svg);
  CHECK_FALSE(same);
  check_formats(canvas);
}
