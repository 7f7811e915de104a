// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/braille.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <trellis/base/error.hpp>

namespace trellis::draw {

namespace {

/// The bit of each dot in Unicode's patterns, by row and column.
constexpr std::array<std::array<std::uint8_t, 2>, 4> bits = {{{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}}};

std::string pattern(std::uint8_t mask) {
  constexpr unsigned first = 0x2800;
  const unsigned code = first + mask;
  return {static_cast<char>(0xE0U | (code >> 12U)), static_cast<char>(0x80U | ((code >> 6U) & 0x3FU)),
          static_cast<char>(0x80U | (code & 0x3FU))};
}

void require_finite(std::span<const Point> points) {
  for (const Point& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) throw Fault("a point that is not finite cannot be drawn");
  }
}

}  // namespace

Braille::Braille(std::size_t columns, std::size_t rows) : columns_(columns), rows_(rows), cells_(columns * rows) {}

void Braille::set(std::ptrdiff_t x, std::ptrdiff_t y, const Ink256& ink) {
  if (x < 0 || y < 0) return;
  const auto column = static_cast<std::size_t>(x);
  const auto row = static_cast<std::size_t>(y);
  if (column >= width() || row >= height()) return;
  if (ink.pattern && (column + row) % 2 != 0) return;
  auto& dots = cells_[(row / 4) * columns_ + column / 2].dots;
  auto it = std::find_if(dots.begin(), dots.end(), [&](const Dots& d) { return d.ink.rank == ink.rank; });
  if (it == dots.end()) it = dots.insert(it, {ink, 0});
  it->mask |= bits[row % 4][column % 2];
}

void Braille::dot(Point p, const Ink256& ink) {
  require_finite({&p, 1});
  // A double far outside does not fit into an integer.
  if (p.x < 0.0 || p.y < 0.0 || p.x >= static_cast<double>(width()) || p.y >= static_cast<double>(height())) return;
  set(static_cast<std::ptrdiff_t>(p.x), static_cast<std::ptrdiff_t>(p.y), ink);
}

void Braille::line(Point from, Point to, const Ink256& ink) {
  require_finite(std::array{from, to});
  // Clip first (Liang and Barsky), so that the number of steps is bounded.
  double begin = 0.0;
  double end = 1.0;
  const auto cut = [&](double at, double difference, double limit) {
    // Restricts [begin, end] to the parameters on the inner side of the limit.
    if (difference == 0.0) return at <= limit;
    const double t = (limit - at) / difference;
    if (difference > 0.0) {
      end = std::min(end, t);
    } else {
      begin = std::max(begin, t);
    }
    return true;
  };
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const bool in = cut(from.x, dx, static_cast<double>(width())) && cut(-from.x, -dx, 0.0) &&
                  cut(from.y, dy, static_cast<double>(height())) && cut(-from.y, -dy, 0.0);
  if (!in || begin > end) return;
  const auto within = [&](double t) {
    return Point{std::clamp(from.x + t * dx, 0.0, static_cast<double>(width())),
                 std::clamp(from.y + t * dy, 0.0, static_cast<double>(height()))};
  };
  const Point first = within(begin);
  const Point last = within(end);
  const double steps = std::max(1.0, std::ceil(std::max(std::abs(last.x - first.x), std::abs(last.y - first.y))));
  const auto count = static_cast<std::size_t>(steps);
  for (std::size_t i = 0; i <= count; ++i) {
    const double t = static_cast<double>(i) / steps;
    dot({first.x + t * (last.x - first.x), first.y + t * (last.y - first.y)}, ink);
  }
}

void Braille::fill(std::span<const Point> polygon, const Ink256& ink) {
  require_finite(polygon);
  if (polygon.size() < 3) return;
  std::vector<double> crossings;
  for (std::size_t row = 0; row < height(); ++row) {
    const double y = static_cast<double>(row) + 0.5;
    crossings.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point& a = polygon[i];
      const Point& b = polygon[(i + 1) % polygon.size()];
      if ((a.y <= y) == (b.y <= y)) continue;
      crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const double first = std::max(0.0, std::ceil(crossings[i] - 0.5));
      const double last = std::min(static_cast<double>(width()) - 1.0, std::ceil(crossings[i + 1] - 0.5) - 1.0);
      if (first > last) continue;
      const auto end = static_cast<std::ptrdiff_t>(last);
      for (auto x = static_cast<std::ptrdiff_t>(first); x <= end; ++x) set(x, static_cast<std::ptrdiff_t>(row), ink);
    }
  }
}

void Braille::letter(Point p, char c, const Ink256& ink) {
  require_finite({&p, 1});
  if (p.x < 0.0 || p.y < 0.0 || p.x >= static_cast<double>(width()) || p.y >= static_cast<double>(height())) return;
  Cell& cell = cells_[static_cast<std::size_t>(p.y) / 4 * columns_ + static_cast<std::size_t>(p.x) / 2];
  cell.letter = c;
  cell.letter_ink = ink;
}

std::string Braille::text(bool colour) const {
  constexpr std::uint8_t full = 0xFF;
  std::string out;
  for (std::size_t row = 0; row < rows_; ++row) {
    int front = -1;
    int back = -1;
    const auto use = [&](int next_front, int next_back) {
      if (!colour || (next_front == front && next_back == back)) return;
      out += "\x1b[0m";
      if (next_front >= 0) out += fmt::format("\x1b[38;5;{}m", next_front);
      if (next_back >= 0) out += fmt::format("\x1b[48;5;{}m", next_back);
      front = next_front;
      back = next_back;
    };
    for (std::size_t column = 0; column < columns_; ++column) {
      const Cell& cell = cells_[row * columns_ + column];
      const auto ground = std::find_if(cell.dots.begin(), cell.dots.end(),
                                       [](const Dots& d) { return d.ink.ground && d.mask == full; });
      const int behind = colour && ground != cell.dots.end() ? ground->ink.colour : -1;
      if (cell.letter != '\0') {
        use(cell.letter_ink.colour, behind);
        out += cell.letter;
        continue;
      }
      const Dots* top = nullptr;
      for (const Dots& dots : cell.dots) {
        if (behind >= 0 && &dots == &*ground) continue;
        if (top == nullptr || dots.ink.rank > top->ink.rank) top = &dots;
      }
      if (top == nullptr) {
        use(-1, behind);
        out += ' ';
        continue;
      }
      std::uint8_t mask = 0;
      for (const Dots& dots : cell.dots) {
        // With colour, the ground is the background; without, other inks replace it.
        const bool other = colour && dots.ink.ground && !top->ink.ground;
        if (!other && (!top->ink.alone || dots.ink.rank == top->ink.rank)) mask |= dots.mask;
      }
      use(top->ink.colour, behind);
      out += pattern(mask);
    }
    use(-1, -1);
    out += '\n';
  }
  return out;
}

}  // namespace trellis::draw
