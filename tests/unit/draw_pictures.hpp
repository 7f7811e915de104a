// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include <trellis/draw/canvas.hpp>

#include "support/catch.hpp"

namespace trellis::draw {

inline std::pair<unsigned, unsigned> png_size(const std::string& png) {
  const auto word = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = (value << 8U) | static_cast<unsigned char>(png.at(i));
    return value;
  };
  return {word(16), word(20)};
}

/// Every format has its signature and the canvas's size, no number that is none, and the same bytes twice.
inline void check_formats(const Canvas& canvas) {
  const std::string svg = canvas.render(Format::svg);
  CHECK(svg.starts_with("<?xml"));
  CHECK(svg.find("</svg>") != std::string::npos);
  std::istringstream box(svg.substr(svg.find("viewBox=\"0 0 ") + 13));
  double width = 0.0;
  double height = 0.0;
  REQUIRE(box >> width >> height);
  CHECK(width == Approx(canvas.width()));
  CHECK(height == Approx(canvas.height()));
  // All text is drawn as outlines, so these letters could only be a number's.
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(svg.find("inf") == std::string::npos);
  CHECK(canvas.render(Format::svg) == svg);

  const std::string png = canvas.render(Format::png, 1.0);
  CHECK(png.starts_with("\x89PNG\r\n\x1a\n"));
  CHECK(png_size(png).first == static_cast<unsigned>(std::ceil(canvas.width() - 1e-6)));
  CHECK(png_size(png).second == static_cast<unsigned>(std::ceil(canvas.height() - 1e-6)));
  CHECK(canvas.render(Format::png, 1.0) == png);

  const std::string pdf = canvas.render(Format::pdf);
  CHECK(pdf.starts_with("%PDF-"));
  CHECK(pdf.find("%%EOF") != std::string::npos);
  CHECK(pdf.find("CreationDate") == std::string::npos);
  CHECK(canvas.render(Format::pdf) == pdf);
}

}  // namespace trellis::draw
