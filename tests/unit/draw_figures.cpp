// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <random>

#include <trellis/base/error.hpp>
#include <trellis/draw/figures.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

using Kind = WaterfallBar::Kind;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

WaterfallPanel passage() {
  return {.title = "tree",
          .levels = {{"skeleton()", 0.8, 0.6, 1.0}, {"shrink(0.5)", 0.5, 0.2, 0.8}, {"lazy()", -0.1, -0.3, 0.1}},
          .root = {"root", 1.2, 1.0, 1.4}};
}

ProfilePanel thirds() {
  return {.title = "root",
          .edges = {0.0, 0.25, 0.5, 0.75, 1.0},
          .target = {0.25, 0.25, 0.25, 0.25},
          .series = {{"tree", {0.5, 0.5, 0.0, 0.0}, {0.4, 0.4, 0.0, 0.0}, {0.6, 0.6, 0.0, 0.0}},
                     {"expansion", {0.25, 0.0, 0.0, 0.75}, {}, {}}}};
}

}  // namespace

TEST_CASE("a waterfall's bars add up", "[draw]") {
  const auto bars = waterfall_bars(passage());
  REQUIRE(bars.size() == 4);
  CHECK(bars[0].kind == Kind::gain);
  CHECK(bars[0].from == 0.0);
  CHECK(bars[0].to == Approx(0.8));
  CHECK(bars[0].text == "+0.80");
  CHECK(bars[0].lo == Approx(0.6));
  CHECK(bars[0].hi == Approx(1.0));
  CHECK(bars[1].from == Approx(0.8));
  CHECK(bars[1].lo == Approx(1.0));
  CHECK(bars[2].kind == Kind::loss);
  CHECK(bars[2].text == "−0.10");
  CHECK(bars[2].to == Approx(1.2));
  CHECK(bars[3].kind == Kind::total);
  CHECK(bars[3].from == 0.0);
  CHECK(bars[3].to == 1.2);
  CHECK(bars[3].text == "+1.20");
}

TEST_CASE("a waterfall of any numbers is connected", "[draw]") {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 500; ++trial) {
    WaterfallPanel panel;
    double change = 0.0;
    for (std::size_t i = 0; i < random() % 9; ++i) {
      const auto odd = random() % 12;
      const double value = odd == 0 ? not_a_number : odd == 1 ? infinity : odd == 2 ? -infinity : unit(random);
      panel.levels.push_back({"level", value, value - 0.1, value + 0.1});
      if (std::isfinite(value)) change += value;
    }
    panel.root.value = change + (trial % 2 == 0 ? unit(random) : 0.0);
    const auto bars = waterfall_bars(panel);
    REQUIRE(bars.size() >= panel.levels.size() + 1);
    double running = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < bars.size(); ++i) {
      CHECK(bars[i].from == running);
      CHECK((bars[i].kind == Kind::gain) == (bars[i].to > bars[i].from && bars[i].kind != Kind::rest));
      if (!std::isfinite(bars[i].to)) continue;
      if (std::isfinite(bars[i].lo)) {
        CHECK(bars[i].lo <= bars[i].to);
        CHECK(bars[i].hi >= bars[i].to);
      }
      running = bars[i].to;
      sum += bars[i].to - bars[i].from;
    }
    // All that leads to the root is drawn: what the levels leave is a bar of its own.
    CHECK(running == Approx(panel.root.value).margin(0.005));
    CHECK(sum == Approx(panel.root.value).margin(0.006));
    CHECK(bars.back().to == panel.root.value);
    if (trial % 2 == 1) CHECK(bars.size() == panel.levels.size() + 1);
  }
}

TEST_CASE("a waterfall says what has no value", "[draw]") {
  WaterfallPanel panel = passage();
  panel.levels[1].value = not_a_number;
  panel.root.value = infinity;
  const auto bars = waterfall_bars(panel);
  REQUIRE(bars.size() == 4);
  CHECK(bars[1].kind == Kind::missing);
  CHECK(bars[1].text == "n/a");
  CHECK(bars[1].from == bars[1].to);
  CHECK(bars[2].from == bars[0].to);
  CHECK(bars[3].text == "+∞");
  panel.root.value = not_a_number;
  CHECK(waterfall_bars(panel).back().kind == Kind::missing);
  const auto none = waterfall_bars(WaterfallPanel());
  REQUIRE(none.size() == 1);
  CHECK(none[0].text == "n/a");
}

TEST_CASE("a waterfall in which nothing adds anything is flat", "[draw]") {
  WaterfallPanel flat = passage();
  for (auto& level : flat.levels) level = {"level", -1e-15, -1e-15, 1e-15};
  flat.root = {"root", -3e-15, -3e-15, 1e-15};
  Waterfall source{.title = "title"};
  source.panels = {flat};
  const Figure figure = waterfall(source);
  REQUIRE(figure.panels.front().y.lo.has_value());
  CHECK(*figure.panels.front().y.lo <= -0.1);
  CHECK(*figure.panels.front().y.hi >= 0.1);
  // One bar that can be seen, in any panel, decides the axis of all.
  source.panels.push_back(passage());
  for (const Panel& panel : waterfall(source).panels) CHECK_FALSE(panel.y.lo.has_value());
}

TEST_CASE("waterfalls are drawn", "[draw]") {
  WaterfallPanel odd = passage();
  odd.levels = {{"inf", infinity, not_a_number, not_a_number},
                {"-inf", -infinity, -infinity, infinity},
                {"nan", not_a_number, 0.0, 1.0},
                {"wide", 0.1, -1e6, 1e6},
                {std::string(400, 'x'), 0.1, 0.0, 0.2}};
  WaterfallPanel deep = passage();
  deep.levels.resize(40, deep.levels[0]);
  const WaterfallPanel plain = passage();
  const WaterfallPanel blank;
  const auto check = [](const std::vector<WaterfallPanel>& panels) {
    Waterfall source{.title = "title", .caption = "caption"};
    source.panels = panels;
    const Figure figure = waterfall(source);
    CHECK(figure.panels.size() == panels.size());
    const Canvas canvas = plot(figure);
    CHECK(canvas.width() == Approx(504.0));
    check_formats(canvas);
    CHECK(plot(waterfall(source)).render(Format::png) == canvas.render(Format::png));
  };
  check({});
  check({plain});
  check({plain, odd});
  check({deep, odd});
  check({blank, plain});
  // Few bars stand beside each other, many below each other.
  CHECK(waterfall({"", "", {plain, plain}}).columns == 2);
  CHECK(waterfall({"", "", {deep, deep}}).columns == 1);
}

TEST_CASE("a profile marks where samples are missing", "[draw]") {
  const Figure figure = profile({.panels = {thirds()}});
  REQUIRE(figure.panels.size() == 1);
  const Panel& panel = figure.panels[0];
  REQUIRE(panel.series.size() == 3);
  CHECK(panel.series[0].y == std::vector<double>{50.0, 50.0, 0.0, 0.0});
  CHECK(panel.series[2].name == "target");
  using Stretches = std::vector<std::pair<double, double>>;
  REQUIRE(panel.lanes.size() == 2);
  CHECK(panel.lanes[0].stretches == Stretches{{0.5, 1.0}});
  CHECK(panel.lanes[1].stretches == Stretches{{0.25, 0.75}});
  REQUIRE(panel.shades.size() == 1);
  CHECK(panel.shades[0].from == 0.5);
  CHECK(panel.shades[0].to == 0.75);

  ProfilePanel full = thirds();
  full.series = {{"tree", {0.25, 0.25, 0.25, 0.25}, {}, {}}};
  CHECK(profile({.panels = {full}}).panels[0].lanes.empty());
  // Nothing is missing where the target has nothing, nor known where a share is not.
  full.target[0] = 0.0;
  full.series[0].share = {0.0, 0.5, not_a_number, 0.5};
  CHECK(profile({.panels = {full}}).panels[0].shades.empty());
}

TEST_CASE("profiles are drawn", "[draw]") {
  ProfilePanel odd = thirds();
  odd.series[0].share = {not_a_number, infinity, 0.0, 1.0};
  odd.series[1].hi = {infinity, 0.0, 0.0, not_a_number};
  ProfilePanel metres = thirds();
  for (double& edge : metres.edges) edge *= 13.7;
  ProfilePanel nobody = thirds();
  nobody.series.clear();
  const std::vector<std::vector<ProfilePanel>> cases = {
      {}, {thirds()}, {thirds(), odd, metres}, {ProfilePanel(), nobody}};
  for (const auto& panels : cases) {
    const Canvas canvas = plot(profile({.title = "title", .caption = "caption", .panels = panels}));
    CHECK(canvas.width() == Approx(504.0));
    check_formats(canvas);
  }
  CHECK(profile({.panels = {thirds(), thirds()}}).share_x);
  CHECK(!profile({.panels = {thirds(), metres}}).share_x);
  ProfilePanel broken = thirds();
  broken.edges.pop_back();
  CHECK_THROWS_AS(profile({.panels = {broken}}), Fault);
  broken = thirds();
  broken.series[0].share.pop_back();
  CHECK_THROWS_AS(profile({.panels = {broken}}), Fault);
}
