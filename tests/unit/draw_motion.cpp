// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a robot on its path and of its space.
#include <numbers>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/draw/motion.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

constexpr double pi = std::numbers::pi;

std::vector<WorldShape> bar(double x) {
  return {std::vector<Point>{{x, 1}, {x + 1, 1}, {x + 1, 1.2}, {x, 1.2}}, WorldDisc{{x, 1}, 0.2}};
}

MotionFigure example() {
  MotionFigure figure;
  figure.title = "a bar on its path";
  figure.caption = "What it shows.";
  figure.world = {0, 0, 4, 3};
  figure.obstacles = {WorldDisc{{2, 2}, 0.5}};
  figure.x = {"theta", -pi, pi, true};
  figure.y = {"theta2", -pi, pi, true};
  figure.blocked = {3, 2, {0, 1, 1, 0, 0, 1}};
  figure.start = {-1, -1};
  figure.goal = {2, 2};
  MotionRow row;
  row.world_title = "the path";
  row.space_title = "the space";
  row.poses = {bar(0), bar(1), bar(2)};
  row.invalid = {false, true, false};
  row.path = {{{-1, -1}, {-pi, 0}}, {{pi, 0}, {2, 2}}};
  row.density = {2, 2, {0.0, 1.0, 4.0, 2.0}};
  figure.rows = {row, row};
  figure.rows[1].density = {};
  figure.rows[1].nodes = {{0, 0}, {1, 1}};
  return figure;
}

std::string svg(const MotionFigure& figure) { return plot(figure).render(Format::svg); }

}  // namespace

TEST_CASE("a motion is drawn in every format, and the same each time", "[draw][motion]") {
  check_formats(plot(example()));
  MotionFigure bare;
  bare.world = {0, 0, 1, 1};
  check_formats(plot(bare));
}

TEST_CASE("each part of a motion is seen", "[draw][motion]") {
  const std::string whole = svg(example());
  const auto differs = [&](const auto& change) {
    MotionFigure figure = example();
    change(figure);
    return svg(figure) != whole;
  };
  CHECK(differs([](MotionFigure& f) { f.obstacles.clear(); }));
  CHECK(differs([](MotionFigure& f) { f.blocked.values[0] = 1; }));
  CHECK(differs([](MotionFigure& f) { f.start = {0, 0}; }));
  CHECK(differs([](MotionFigure& f) { f.goal = {0, 0}; }));
  CHECK(differs([](MotionFigure& f) { f.rows[0].density.values[0] = 3.0; }));
  CHECK(differs([](MotionFigure& f) { f.rows[0].poses[1] = bar(1.5); }));
  CHECK(differs([](MotionFigure& f) { f.rows[0].invalid[1] = false; }));
  CHECK(differs([](MotionFigure& f) { f.rows[0].path.pop_back(); }));
  CHECK(differs([](MotionFigure& f) { f.rows[1].nodes.pop_back(); }));
  CHECK(differs([](MotionFigure& f) { f.y.name = "phi"; }));
  CHECK(differs([](MotionFigure& f) { f.x = {"x", 0, 3, false}; }));
  CHECK_FALSE(differs([](MotionFigure&) {}));
}

TEST_CASE("the darkest shade is where the density is greatest, whatever its unit", "[draw][motion]") {
  MotionFigure scaled = example();
  for (double& v : scaled.rows[0].density.values) v *= 1e6;
  CHECK(svg(scaled) == svg(example()));
}

TEST_CASE("what cannot be drawn of a motion is a fault", "[draw][motion]") {
  const auto fails = [](const auto& change) {
    MotionFigure figure = example();
    change(figure);
    CHECK_THROWS_AS(plot(figure), Fault);
  };
  fails([](MotionFigure& f) { f.world.width = 0; });
  fails([](MotionFigure& f) { f.x.hi = f.x.lo; });
  fails([](MotionFigure& f) { f.blocked.values.pop_back(); });
  fails([](MotionFigure& f) { f.rows[0].density.rows = 3; });
  fails([](MotionFigure& f) { f.rows[0].invalid.pop_back(); });
}
