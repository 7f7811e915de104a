// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>
#include <limits>
#include <regex>
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

TEST_CASE("the axis of ratios covers their intervals, and an arrowhead marks what it does not show", "[draw]") {
  const auto one = [](double lo, double hi) {
    return RatioFigure{.panels = {"checks"},
                       .groups = {{"cup", palette::blue}},
                       .rows = {{"a", {{{0, "cup", 2.0, lo, hi}}}}, {"b", {{{0, "cup", 0.4, 0.4, 0.4}}}}},
                       .lines = {{1.0, "as b", Dash::solid}}};
  };
  const Extent all = ratio_extent(one(0.08, 9.5));
  CHECK(all.lo < 0.08);
  CHECK(all.hi > 9.5);
  // One end is far beyond the dots, which would then have no room: the axis ends at ten times their range.
  const Extent most = ratio_extent(one(1e-6, 9.5));
  CHECK(most.lo < 0.04);
  CHECK(most.lo > 0.02);
  const auto heads = [&](double lo, double hi) {
    const std::string markup = plot(one(lo, hi)).markup("x");
    const std::regex triangle("<path d=\"M[-0-9. ]+L[-0-9. ]+L[-0-9. ]+Z\"");
    return std::distance(std::sregex_iterator(markup.begin(), markup.end(), triangle), std::sregex_iterator());
  };
  CHECK(heads(0.5, 1.9) == 0);
  CHECK(heads(0.08, 19.0) == 0);
  CHECK(heads(0.5, infinity) == 1);
  CHECK(heads(0.0, 1.9) == 1);
  CHECK(heads(0.0, infinity) == 2);
  CHECK(heads(1e-6, 1e6) == 2);
}

TEST_CASE("no label of a figure of ratios is cut or leaves the picture", "[draw]") {
  RatioFigure narrow = figure();
  narrow.width = 240.0;
  narrow.panels.resize(1);
  for (RatioRow& row : narrow.rows) row.panels.resize(1);
  narrow.x_label = "cost / cost of the reference (left of 1: costs less)";
  narrow.lines = {{1.0, "as the strategy with the long name", Dash::solid}};
  narrow.rows[0].panels[0][1].text = "0.02 [0.01, 0.04]";
  const std::string markup = plot(narrow).markup("x");
  CHECK(markup.find(">0.02 [0.01, 0.04]<") != std::string::npos);
  // The label of the axis is broken into lines, and that of the line is shortened.
  CHECK(markup.find(narrow.x_label) == std::string::npos);
  CHECK(markup.find("less)<") != std::string::npos);
  CHECK(markup.find("as the") != std::string::npos);
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
