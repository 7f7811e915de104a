// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace trellis::draw {

/// A point of a picture; x to the right and y down.
struct Point {
  double x = 0.0;
  double y = 0.0;
  friend bool operator==(const Point&, const Point&) = default;
};

/// The ink of dots. A character has one ink: that of the highest rank among its dots.
struct Ink256 {
  std::uint8_t colour = 7;  ///< index into a terminal's 256 colours
  int rank = 0;
  bool alone = false;    ///< its characters show no dots of other inks, so that a thin line stays thin
  bool pattern = false;  ///< every other dot of an area, to distinguish it from a crowd of lines
  bool ground = false;   ///< where it fills a character, its colour is the background; in colour only
};

/// A picture in characters, each of which shows 2 x 4 dots: Unicode's braille patterns. Coordinates are in dots, x to
/// the right and y down; the picture clips dots outside of it.
class Braille {
 public:
  /// In characters.
  Braille(std::size_t columns, std::size_t rows);

  [[nodiscard]] std::size_t width() const { return 2 * columns_; }
  [[nodiscard]] std::size_t height() const { return 4 * rows_; }

  void dot(Point p, const Ink256& ink);
  void line(Point from, Point to, const Ink256& ink);
  /// Sets the dots whose centres lie in a polygon.
  void fill(std::span<const Point> polygon, const Ink256& ink);
  /// Sets one ASCII character in place of the dots there.
  void letter(Point p, char c, const Ink256& ink);

  /// Returns lines of text, each ended by a newline. \param colour  with the escape sequences of 256 colours
  [[nodiscard]] std::string text(bool colour) const;

 private:
  struct Dots {
    Ink256 ink;
    std::uint8_t mask = 0;
  };
  struct Cell {
    std::vector<Dots> dots;  ///< one per ink in the character
    char letter = '\0';
    Ink256 letter_ink;
  };

  void set(std::ptrdiff_t x, std::ptrdiff_t y, const Ink256& ink);

  std::size_t columns_;
  std::size_t rows_;
  std::vector<Cell> cells_;
};

}  // namespace trellis::draw
