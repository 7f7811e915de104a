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

/// The colours of Okabe and Ito (2008), which readers with any colour vision distinguish, and what has which.
namespace palette {

inline constexpr Colour black = rgb(0x000000);
inline constexpr Colour orange = rgb(0xE69F00);
inline constexpr Colour sky = rgb(0x56B4E9);
inline constexpr Colour green = rgb(0x009E73);
inline constexpr Colour blue = rgb(0x0072B2);
inline constexpr Colour vermillion = rgb(0xD55E00);
inline constexpr Colour purple = rgb(0xCC79A7);

/// The colours of the levels of a hierarchy, the root's first: those of the page (report.css, --level-0 to --level-3).
inline constexpr std::array<Colour, 4> levels = {rgb(0x0072B2), rgb(0xB8588D), rgb(0x857500), rgb(0x4A4F55)};
constexpr Colour level(std::size_t i) { return levels[i % levels.size()]; }

/// The strategies of an experiment beside its baseline, in the order of the script, as in the figures of Python
/// (python/trellis/figures/_style.py).
inline constexpr std::array<Colour, 7> series = {blue, vermillion, green, purple, sky, orange, black};
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
