// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/draw/ratios.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

RatioFigure figure() {
  return {
      .title = "Costs",
      .caption = "A dot is a world.",
      .panels = {"checks", "time"},
      .x_label = "ratio",
      .groups = {{"tuned", palette::blue, true}, {"held out", palette::vermillion, false}},
      .rows = {{"a >> b",
                {{{0, "maze", 0.02, 0.01, 0.04}, {1, "gaps", 3.0, -infinity, infinity}}, {{0, "maze", 0.5, 0.5, 0.5}}}},
               {"a long name of a strategy that has to be broken into several lines of text", {{}, {}}},
               {"never", {{{1, "trap", infinity, 2.0, infinity}, {1, "cup", not_a_number, 0, 0}}, {}}}},
      .lines = {{1.0, "as without", Dash::solid}, {2.2, "2.2 times", Dash::dashed}}};
}

}  // namespace

TEST_CASE("ratios are drawn, infinite and missing ones too", "[draw]") {
  check_formats(plot(figure()));
  check_formats(plot(RatioFigure{.panels = {"empty"}}));
}

TEST_CASE("more rows and groups make a higher picture of the same width", "[draw]") {
  RatioFigure more = figure();
  const double height = plot(more).height();
  more.rows.push_back({"one more", {{}, {}}});
  CHECK(plot(more).height() > height);
  CHECK(plot(more).width() == figure().width);
}

TEST_CASE("a row of ratios has as many panels as its figure", "[draw]") {
  RatioFigure wrong = figure();
  wrong.rows[0].panels.pop_back();
  CHECK_THROWS_AS(plot(wrong), Fault);
}
