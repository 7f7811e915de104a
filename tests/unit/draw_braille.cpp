// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures for a terminal.
#include <array>
#include <limits>
#include <string>
#include <trellis/base/error.hpp>
#include <trellis/draw/braille.hpp>

#include "support/catch.hpp"

using namespace trellis;
using draw::Braille;
using draw::Ink256;
using draw::Point;

TEST_CASE("each of a character's eight dots can be set by itself") {
  const std::array<const char*, 8> expected = {"⠁", "⠈", "⠂", "⠐", "⠄", "⠠", "⡀", "⢀"};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    Braille picture(1, 1);
    picture.dot({static_cast<double>(i % 2) + 0.5, static_cast<double>(i / 2) + 0.5}, {});
    CHECK(picture.text(false) == std::string(expected[i]) + "\n");
  }
}

TEST_CASE("a line shows in all characters that it crosses") {
  Braille picture(4, 1);
  picture.line({0, 0.5}, {8, 0.5}, {});
  CHECK(picture.text(false) == "⠉⠉⠉⠉\n");
  Braille steep(1, 2);
  steep.line({0.5, 0}, {0.5, 8}, {});
  CHECK(steep.text(false) == "⡇\n⡇\n");
}

TEST_CASE("what lies outside is left out, however far") {
  Braille picture(2, 1);
  picture.line({-1e6, 0.5}, {1e6, 0.5}, {});

  CHECK(picture.text(false) == "⠉⠉\n");
  Braille empty(2, 1);
  empty.line({-5, -5}, {50, -4}, {});
  empty.line({-1, 100}, {-1, -100}, {});
  empty.line({-1e300, 1e300}, {1e300, 1.1e300}, {});
  empty.dot({1e300, 1}, {});
  empty.dot({-0.5, 1}, {});
  empty.letter({4, 0}, 'x', {});
  const std::array<Point, 3> far = {Point{100, 100}, Point{200, 100}, Point{100, 200}};
  empty.fill(far, {});
  CHECK(empty.text(false) == "  \n");
  CHECK_THROWS_AS(empty.dot({std::numeric_limits<double>::quiet_NaN(), 0}, {}), Fault);
}

TEST_CASE("areas that share an edge neither overlap nor leave a gap") {
  const std::array<Point, 4> left = {Point{0, 0}, Point{3, 0}, Point{3, 4}, Point{0, 4}};
  const std::array<Point, 4> right = {Point{3, 0}, Point{6, 0}, Point{6, 4}, Point{3, 4}};
  Braille one(3, 1);
  one.fill(left, {});
  CHECK(one.text(false) == "⣿⡇ \n");
  one.fill(right, {});
  CHECK(one.text(false) == "⣿⣿⣿\n");
  Braille sparse(1, 1);
  sparse.fill(left, {.pattern = true});
  CHECK(sparse.text(false) == "⢕\n");
}

TEST_CASE("of several inks in a character the highest rank gives the colour, alone if it says so") {
  Braille picture(1, 1);
  picture.dot({0.5, 0.5}, {.colour = 8, .rank = 0});
  picture.dot({1.5, 0.5}, {.colour = 4, .rank = 1});
  CHECK(picture.text(true) == "\x1b[0m\x1b[38;5;4m⠉\x1b[0m\n");
  picture.dot({0.5, 3.5}, {.colour = 2, .rank = 2, .alone = true});
  CHECK(picture.text(true) == "\x1b[0m\x1b[38;5;2m⡀\x1b[0m\n");
  CHECK(picture.text(false) == "⡀\n");
  picture.letter({0.5, 0.5}, 'S', {.colour = 9});
  CHECK(picture.text(true) == "\x1b[0m\x1b[38;5;9mS\x1b[0m\n");
}

TEST_CASE("an area is a background where it fills characters, and dots where it does not") {
  const std::array<Point, 4> area = {Point{0, 0}, Point{5, 0}, Point{5, 4}, Point{0, 4}};
  const Ink256 wall = {.colour = 240, .ground = true};
  Braille picture(4, 1);
  picture.fill(area, wall);
  picture.dot({2.5, 0.5}, {.colour = 3, .rank = 1});
  CHECK(picture.text(true) ==
        "\x1b[0m\x1b[48;5;240m \x1b[0m\x1b[38;5;3m\x1b[48;5;240m⠁\x1b[0m\x1b[38;5;240m⡇\x1b[0m \n");
  CHECK(picture.text(false) == "⣿⣿⡇ \n");
  // Where it does not fill a character it is not drawn, so that it cannot look like another ink.
  picture.dot({5.5, 3.5}, {.colour = 3, .rank = 1});
  CHECK_THAT(picture.text(true), Catch::Matchers::Contains("\x1b[38;5;3m⢀"));
}
