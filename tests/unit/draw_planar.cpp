// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a planar world: cells, circles, colours, and their data.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <regex>

#include <trellis/base/error.hpp>
#include <trellis/draw/planar.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

constexpr std::array roles = {Role::target, Role::tree, Role::expansion, Role::baseline};

/// A world of 4 x 3 cells of a metre, which hold nothing.
PlanarFigure world() {
  PlanarFigure figure;
  figure.world = {-1.0, 2.0, 4.0, 3.0};
  figure.cell = 1.0;
  return figure;
}

CircleLayer layer(const std::vector<double>& mean, Role role = Role::tree) { return {"a layer", role, mean}; }

struct Seen {
  Point centre;
  double radius = 0.0;
};

/// The circles of all paths of an SVG but its letters, in the order in which they are drawn.
std::vector<Seen> circles(const std::string& picture) {
  const std::string svg = picture.substr(picture.rfind("</defs>"));
  const std::string number = "(-?[0-9.]+) ";
  const std::regex circle("M " + number + number + "C (?:-?[0-9.]+ ){4}" + number + number + "C (?:-?[0-9.]+ ){4}" +
                          number + number);
  std::vector<Seen> seen;
  for (std::sregex_iterator i(svg.begin(), svg.end(), circle), end; i != end; ++i) {
    const double right = std::stod((*i)[1]);
    const double left = std::stod((*i)[5]);
    seen.push_back({{0.5 * (left + right), std::stod((*i)[2])}, 0.5 * (right - left)});
  }
  return seen;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

std::string svg(const PlanarFigure& figure) { return plot(figure).render(Format::svg); }

}  // namespace

TEST_CASE("a world's samples are counted in its cells", "[draw][planar]") {
  using Counts = std::vector<std::pair<std::size_t, double>>;
  const auto counted = [](const Grid& grid, Point p) {
    std::vector<double> counts(grid.size(), 0.0);
    Counts found;
    const bool inside = grid.count(p, 1.0, counts);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] != 0.0) found.emplace_back(i, counts[i]);
    }
    CHECK(inside == !found.empty());
    return found;
  };
  const auto one = [](std::size_t cell) { return Counts{{cell, 1.0}}; };
  const Grid grid({-1.0, 2.0, 4.0, 3.0}, 1.0);
  CHECK(grid.columns() == 4);
  CHECK(grid.rows() == 3);
  CHECK(counted(grid, {-0.5, 2.5}) == one(0));
  CHECK(counted(grid, {0.01, 2.99}) == one(1));
  CHECK(counted(grid, {-0.01, 3.01}) == one(4));
  // The world is closed, and an edge within it belongs to both its sides.
  CHECK(counted(grid, {-1.0, 2.0}) == one(0));
  CHECK(counted(grid, {3.0, 5.0}) == one(11));
  CHECK(counted(grid, {0.0, 2.0}) == Counts{{0, 0.5}, {1, 0.5}});
  CHECK(counted(grid, {2.5, 4.0}) == Counts{{7, 0.5}, {11, 0.5}});
  CHECK(counted(grid, {1.0, 3.0}) == Counts{{1, 0.25}, {2, 0.25}, {5, 0.25}, {6, 0.25}});
  CHECK(counted(grid, {3.01, 4.0}).empty());
  CHECK(counted(grid, {0.0, 1.99}).empty());
  CHECK(counted(grid, {std::nan(""), 3.0}).empty());
  CHECK(grid.centre(0) == Point{-0.5, 2.5});
  CHECK(grid.centre(11) == Point{2.5, 4.5});

  SECTION("the last cells are what is left") {
    const Grid cut({0.0, 0.0, 2.5, 1.0}, 1.0);
    CHECK(cut.columns() == 3);
    CHECK(cut.centre(2) == Point{2.25, 0.5});
    CHECK(counted(cut, {2.5, 1.0}) == one(2));
    // Ten cells of a tenth are ten, however they are rounded.
    CHECK(Grid({0.0, 0.0, 0.7 + 0.1 + 0.1 + 0.1, 1.0}, 0.1).columns() == 10);
  }
  SECTION("each centre lies in its own cell") {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> size(0.1, 20.0);
    for (int trial = 0; trial < 200; ++trial) {
      const Grid any({size(random) - 10.0, -size(random), size(random), size(random)}, 0.1 + 0.1 * size(random));
      for (std::size_t i = 0; i < any.size(); ++i) CHECK(counted(any, any.centre(i)) == one(i));
    }
  }
  SECTION("what is no grid") {
    CHECK_THROWS_AS(Grid({0, 0, 1, 0}, 0.5), Fault);
    CHECK_THROWS_AS(Grid({0, 0, 1, 1}, 0.0), Fault);
    CHECK_THROWS_AS(Grid({0, 0, 1, 1}, std::nan("")), Fault);
    CHECK_THROWS_AS(Grid({std::nan(""), 0, 1, 1}, 0.5), Fault);
    CHECK_THROWS_AS(Grid({0, 0, 1, 1}, 1e-4), Fault);
  }
}

TEST_CASE("a circle's area is in proportion to the mean count", "[draw][planar]") {
  PlanarFigure figure = world();
  const std::vector<double> mean = {1.0, 4.0, 0.0, 9.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 16.0};
  figure.panels = {{.layers = {{"", Role::tree, mean}}}};
  const Grid grid(figure.world, figure.cell);
  const double area = area_per_sample(figure.panels[0].layers, grid.cell());
  const auto seen = circles(svg(figure));
  // Each is a disc and its ring; then those of the legend below, of 10, 2 and half a sample.
  REQUIRE(seen.size() == 2 * 5 + 2 * 3);
  const double scale = (figure.width - 12.0) / 4.0;
  const std::array<std::size_t, 5> cells = {0, 1, 3, 6, 11};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    CHECK(seen[i].radius == Approx(scale * std::sqrt(area * mean[cells[i]] / std::numbers::pi)).margin(6e-3));
    CHECK(seen[i].radius / seen[0].radius == Approx(std::sqrt(mean[cells[i]])).margin(6e-3));
    // From the lower left cell, one to the right is one to the right and one up is one up.
    const Point from{seen[0].centre.x + scale * static_cast<double>(cells[i] % 4),
                     seen[0].centre.y - scale * static_cast<double>(cells[i] / 4)};
    CHECK(seen[i].centre.x == Approx(from.x).margin(6e-3));
    CHECK(seen[i].centre.y == Approx(from.y).margin(6e-3));
    // The ring's outer edge is the circle's.
    CHECK(seen[5 + i].radius == Approx(seen[i].radius - 0.4).margin(6e-3));
  }
  const auto sizes = sizes_explained(figure.panels[0].layers);
  REQUIRE(sizes == std::vector<double>{0.5, 2.0, 10.0});
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    CHECK(seen[10 + 2 * i].radius == Approx(seen[0].radius * std::sqrt(sizes[i])).margin(6e-3));
  }
}

TEST_CASE("nearly all circles fit into their cells", "[draw][planar]") {
  std::mt19937_64 random(7);
  std::exponential_distribution<double> mean(0.5);
  const Grid grid({0, 0, 20, 20}, 0.5);
  for (const double peak : {0.0, 5.0, 500.0}) {
    PlanarPanel panel;
    for (const Role role : {Role::tree, Role::expansion}) {
      std::vector<double> counts(grid.size());
      for (double& n : counts) n = mean(random);
      counts[17] += peak;
      panel.layers.push_back(layer(counts, role));
    }
    const double area = area_per_sample(panel.layers, grid.cell());
    std::size_t beyond = 0;
    for (const auto& l : panel.layers) {
      for (const double n : l.mean) {
        const double diameter = 2.0 * std::sqrt(n * area / std::numbers::pi);
        beyond += diameter > 0.96 * grid.cell() ? 1 : 0;
        CHECK(diameter < 2.21 * grid.cell());
      }
    }
    CHECK(beyond <= grid.size() / 10);
  }
  CHECK(area_per_sample({}, grid.cell()) == 0.0);
  CHECK(area_per_sample({layer(std::vector<double>(grid.size(), 0.0))}, grid.cell()) == 0.0);
}

TEST_CASE("the sizes below a panel are round and at most the largest", "[draw][planar]") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> power(-4.0, 9.0);
  for (int trial = 0; trial < 500; ++trial) {
    const double most = std::pow(10.0, power(random));
    const auto sizes = sizes_explained({layer({0.0, most})});
    REQUIRE(sizes.size() == 3);
    CHECK(std::is_sorted(sizes.begin(), sizes.end()));
    CHECK(sizes.back() <= most * (1.0 + 1e-6));
    CHECK(sizes.back() > 0.39 * most);
    for (const double size : sizes) {
      const double lead = size / std::pow(10.0, std::floor(std::log10(size) + 1e-6));
      const bool is_round = std::abs(lead - 1.0) < 1e-6 || std::abs(lead - 2.0) < 1e-6 || std::abs(lead - 5.0) < 1e-6;
      CHECK(is_round);
    }
  }
  CHECK(sizes_explained({layer({5.0})}) == std::vector<double>{0.2, 1.0, 5.0});
  CHECK(sizes_explained({layer({0.0})}).empty());
}

TEST_CASE("roles are distinguishable with any colour vision", "[draw][planar]") {
  // Machado, Oliveira and Fernandes 2009: the colours without one kind of cone, in linear RGB.
  using Matrix = std::array<std::array<double, 3>, 3>;
  const Matrix all = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const Matrix protan = {
      {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
  const Matrix deutan = {
      {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};
  const auto seen = [](const Colour& c, const Matrix& m) {
    const std::array linear = {std::pow(c.r, 2.2), std::pow(c.g, 2.2), std::pow(c.b, 2.2)};
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = m[i][0] * linear[0] + m[i][1] * linear[1] + m[i][2] * linear[2];
      out[i] = std::pow(std::clamp(v, 0.0, 1.0), 1.0 / 2.2);
    }
    return out;
  };
  const auto nearest = [&](RoleColours colours, const Matrix& m) {
    double least = 10.0;
    for (const Role a : roles) {
      for (const Role b : roles) {
        if (a == b) continue;
        const auto x = seen(colour_of(a, colours), m);
        const auto y = seen(colour_of(b, colours), m);
        least = std::min(least, std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]));
      }
    }
    return least;
  };
  for (const Matrix& m : {all, protan, deutan}) CHECK(nearest(RoleColours::safe, m) > 0.15);
  // The paper's: red, blue, purple, green.
  const auto paper = [](Role role) { return colour_of(role, RoleColours::paper); };
  CHECK(paper(Role::target).r > 2.0 * std::max(paper(Role::target).g, paper(Role::target).b));
  CHECK(paper(Role::tree).b > 2.0 * std::max(paper(Role::tree).r, paper(Role::tree).g));
  CHECK(std::min(paper(Role::expansion).r, paper(Role::expansion).b) > 2.0 * paper(Role::expansion).g);
  CHECK(paper(Role::baseline).g > 2.0 * std::max(paper(Role::baseline).r, paper(Role::baseline).b));
}

TEST_CASE("a picture of a world has all its parts in every format", "[draw][planar]") {
  PlanarFigure figure = world();
  figure.title = "a strategy on a problem";
  figure.caption = "What the circles are.";
  figure.obstacles = {std::vector<Point>{{0, 2}, {1, 2}, {0.5, 3}}, WorldDisc{{2.0, 3.0}, 0.5}};
  // A robot of two parts that overlap, and one that is a point.
  figure.start = {std::vector<Point>{{-0.9, 2.4}, {-0.3, 2.4}, {-0.3, 2.6}, {-0.9, 2.6}}, WorldDisc{{-0.4, 2.5}, 0.2}};
  figure.goal = {WorldDisc{{2.5, 4.5}, 0.0}};
  std::vector<double> mean(12, 0.0);
  mean[11] = 3.0;
  for (const Role role : roles) {
    figure.panels.push_back({.title = "one", .layers = {{std::to_string(int(role)), role, mean}}});
  }
  figure.panels.push_back({.title = "paths", .paths = {{{-0.6, 2.5}, {1.5, 4.5}, {2.5, 4.5}}, {}, {{0.0, 4.0}}}});
  PlanarPanel all{.title = "all"};
  for (std::size_t i = 0; i < 4; ++i) all.layers.push_back(figure.panels[i].layers[0]);
  figure.panels.push_back(all);
  check_formats(plot(figure));

  const std::string picture = svg(figure);
  SECTION("what lies outside of the world is cut off, panel by panel") { CHECK(count(picture, "<clipPath") >= 6); }
  SECTION("the palette changes the colours and nothing else") {
    PlanarFigure other = figure;
    other.colours = RoleColours::paper;
    const std::string painted = svg(other);
    CHECK(painted != picture);
    const std::regex colour("rgb\\([^)]*\\)");
    const bool same = std::regex_replace(painted, colour, "") == std::regex_replace(picture, colour, "");
    CHECK(same);
  }
  SECTION("each of its parts shows") {
    const auto differs = [&](const auto& change) {
      PlanarFigure other = figure;
      change(other);
      return svg(other) != picture;
    };
    CHECK(differs([](PlanarFigure& f) { f.obstacles.pop_back(); }));
    CHECK(differs([](PlanarFigure& f) { f.start.pop_back(); }));
    CHECK(differs([](PlanarFigure& f) { f.goal = {WorldDisc{{2.5, 4.4}, 0.0}}; }));
    CHECK(differs([](PlanarFigure& f) { f.panels[4].paths[0].pop_back(); }));
    CHECK(differs([](PlanarFigure& f) { f.caption = ""; }));
    CHECK(differs([](PlanarFigure& f) { f.title = ""; }));
  }
}

TEST_CASE("a picture of a world is drawn of whatever there is", "[draw][planar]") {
  PlanarFigure figure = world();
  SECTION("no panel") { check_formats(plot(figure)); }
  SECTION("a panel without layers, and a note") {
    figure.panels = {{.title = "target", .note = "no path, no target"}};
    CHECK(circles(svg(figure)).empty());
    check_formats(plot(figure));
  }
  SECTION("layers that count nothing") {
    figure.panels = {{.layers = {{"tree", Role::tree, std::vector<double>(12, 0.0)}}}};
    // The legend's circle alone: there are no sizes to explain.
    CHECK(circles(svg(figure)).size() == 2);
    check_formats(plot(figure));
  }
  SECTION("a narrow world, a wide one, a huge one, a tiny one") {
    for (const Rect& rect :
         {Rect{0, 0, 0.1, 10}, Rect{0, 0, 30, 0.2}, Rect{-1e6, 1e6, 1e5, 1e5}, Rect{0, 0, 1e-6, 1e-6}}) {
      PlanarFigure other{.world = rect, .cell = std::max(rect.width, rect.height) / 20.0};
      const Grid grid(other.world, other.cell);
      other.panels.assign(4, {.title = "a", .layers = {layer(std::vector<double>(grid.size(), 2.0))}});
      other.start = {WorldDisc{{rect.x, rect.y}, 0.0}};
      const Canvas canvas = plot(other);
      CHECK(canvas.height() < 1600.0);
      check_formats(canvas);
    }
  }
  SECTION("counts of any size, names of any length") {
    for (const double most : {1e-9, 1e12}) {
      std::vector<double> mean(12, 0.0);
      mean[5] = most;
      figure.panels = {
          {.title = std::string(300, 'x') + " <&>", .layers = {{std::string(400, 'y'), Role::target, mean}}}};
      check_formats(plot(figure));
    }
  }
  SECTION("what cannot be drawn is a fault") {
    for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
      std::vector<double> mean(12, 1.0);
      mean[3] = bad;
      figure.panels = {{.layers = {layer(mean)}}};
      CHECK_THROWS_AS(plot(figure), Fault);
    }
    figure.panels = {{.layers = {layer({1.0, 2.0})}}};
    CHECK_THROWS_AS(plot(figure), Fault);
    figure.panels.clear();
    figure.columns = 0;
    CHECK_THROWS_AS(plot(figure), Fault);
  }
}

TEST_CASE("a scale bar stands below the first panel and covers nothing of the world", "[draw][planar]") {
  for (const bool circles : {false, true}) {
    PlanarFigure figure = world();
    figure.obstacles.push_back(std::vector<Point>{{-1.0, 2.0}, {3.0, 2.0}, {3.0, 5.0}, {-1.0, 5.0}});
    figure.panels.resize(2);
    if (circles) figure.panels[0].layers = {layer(std::vector<double>(12, 3.0))};
    const Canvas plain = plot(figure);
    figure.scale_bar = true;
    const Canvas scaled = plot(figure);
    CHECK(scaled.height() > plain.height());
    const auto text = [](const Canvas& canvas) { return canvas.markup("x"); };
    CHECK(text(plain).find(">1 m<") == std::string::npos);
    CHECK(text(scaled).find(">1 m<") != std::string::npos);
    // The panel has the same ink as without the bar: the world is 4 m wide and fills a column.
    const double width = 0.5 * (figure.width - 12.0 - 12.0);
    const Ink before = plain.ink();
    const Ink after = scaled.ink();
    for (double y = 0.0; y < plain.height() - 40.0; y += 10.0) {
      CAPTURE(y, circles);
      const Rect strip{0.0, y, width, 10.0};
      if (strip.bottom() < 0.75 * width) CHECK(after.in(strip) == Approx(before.in(strip)));
    }
  }
}
