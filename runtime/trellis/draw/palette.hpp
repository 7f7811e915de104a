// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace trellis::draw {

/// sRGB and opacity, each in [0, 1].
struct Colour {
  double r = 0.0;
  double g = 0.0;
  double b = 0.0;
  double a = 1.0;

  [[nodiscard]] constexpr Colour faded(double alpha) const { return {r, g, b, alpha}; }
  friend constexpr bool operator==(const Colour&, const Colour&) = default;
};

/// 0xRRGGBB.
constexpr Colour rgb(unsigned hex) {
  const auto part = [hex](unsigned shift) { return static_cast<double>((hex >> shift) & 0xFFU) / 255.0; };
  return {part(16U), part(8U), part(0U), 1.0};
}

/// The colours of Okabe and Ito (2008), which readers with any colour vision distinguish, and greys; then the meaning
/// of each.
namespace palette {

inline constexpr Colour black = rgb(0x000000);
inline constexpr Colour orange = rgb(0xE69F00);
inline constexpr Colour sky = rgb(0x56B4E9);
inline constexpr Colour green = rgb(0x009E73);
inline constexpr Colour yellow = rgb(0xF0E442);
inline constexpr Colour blue = rgb(0x0072B2);
inline constexpr Colour vermillion = rgb(0xD55E00);
inline constexpr Colour purple = rgb(0xCC79A7);

inline constexpr Colour paper = rgb(0xFFFFFF);
inline constexpr Colour ink = rgb(0x222222);    ///< text, whiskers
inline constexpr Colour muted = rgb(0x666666);  ///< of captions, references, ticks
inline constexpr Colour frame = rgb(0x444444);
inline constexpr Colour grid = rgb(0xE4E4E4);
inline constexpr Colour shade = rgb(0xEBEBEB);  ///< a marked interval of an axis

// One quantity has one colour in every figure.
inline constexpr Colour total = rgb(0x9A9A9A);
inline constexpr Colour gain = green;
inline constexpr Colour loss = vermillion;
inline constexpr Colour rest = rgb(0xCFCFCF);
inline constexpr Colour target = orange;
inline constexpr Colour tree = blue;
inline constexpr Colour expansion = purple;
inline constexpr Colour baseline = sky;

/// The colours of the levels of a hierarchy, the root's first: those of the page (report.css, --level-0 to --level-3).
inline constexpr std::array<Colour, 4> levels = {rgb(0x0072B2), rgb(0xB8588D), rgb(0x857500), rgb(0x4A4F55)};
constexpr Colour level(std::size_t i) { return levels[i % levels.size()]; }

/// For series without a colour of their own, in this order; omits the faint yellow.
inline constexpr std::array<Colour, 7> series = {blue, vermillion, green, orange, purple, sky, black};
constexpr Colour nth(std::size_t i) { return series[i % series.size()]; }

/// The robots of a team: eight hues, then the same ones darker, then lighter.
inline constexpr std::array<Colour, 8> robots = {blue,   vermillion, green,         purple,
                                                 orange, sky,        rgb(0x8C564B), rgb(0x6A51A3)};
constexpr Colour robot(std::size_t i) {
  const Colour hue = robots[i % robots.size()];
  const auto mixed = [&](double share, double with) {
    return Colour{hue.r + share * (with - hue.r), hue.g + share * (with - hue.g), hue.b + share * (with - hue.b), 1.0};
  };
  constexpr double darker = 0.4;
  constexpr double lighter = 0.5;
  switch (i / robots.size() % 3) {
    case 1: return mixed(darker, 0.0);
    case 2: return mixed(lighter, 1.0);
    default: return hue;
  }
}

}  // namespace palette

}  // namespace trellis::draw
