// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <trellis/draw/canvas.hpp>

namespace trellis::draw {

/// What dots are drawn with. A character has one ink: that of the highest rank among its dots.
struct Ink256 {
  std::uint8_t colour = 7;  ///< of the 256 that terminals have
  int rank = 0;
  bool alone = false;    ///< its characters show no dots of other inks, so that a thin line stays one
  bool pattern = false;  ///< every other dot of an area, to tell it from a crowd of lines
  bool ground = false;   ///< where it has all dots of a character, its colour is the background; in colour only
};

/// A picture in characters, each of which shows 2 x 4 dots: Unicode's braille patterns. Points are in dots, x points
/// right and y down; what lies outside is left out.
class Braille {
 public:
  /// In characters.
  Braille(std::size_t columns, std::size_t rows);

  [[nodiscard]] std::size_t width() const { return 2 * columns_; }
  [[nodiscard]] std::size_t height() const { return 4 * rows_; }

  void dot(Point p, const Ink256& ink);
  void line(Point from, Point to, const Ink256& ink);
  /// The dots whose middles lie in a polygon.
  void fill(std::span<const Point> polygon, const Ink256& ink);
  /// One ASCII character in place of the dots there.
  void letter(Point p, char c, const Ink256& ink);

  /// Lines of text, each ended by a newline. \param colour  with the escape sequences of 256 colours
  [[nodiscard]] std::string text(bool colour) const;

 private:
  struct Dots {
    Ink256 ink;
    std::uint8_t mask = 0;
  };
  struct Cell {
    std::vector<Dots> dots;  ///< one for each ink that met the character, few
    char letter = '\0';
    Ink256 letter_ink;
  };

  void set(std::ptrdiff_t x, std::ptrdiff_t y, const Ink256& ink);

  std::size_t columns_;
  std::size_t rows_;
  std::vector<Cell> cells_;
};

}  // namespace trellis::draw
