// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace trellis {

/// A pixel as its file samples it, 0 to 255; alpha 255 is opaque.
struct Pixel {
  unsigned char red = 0;
  unsigned char green = 0;
  unsigned char blue = 0;
  unsigned char alpha = 0;

  [[nodiscard]] bool opaque() const { return alpha == 255; }
  /// The mean of red, green and blue, 0 to 255.
  [[nodiscard]] double mean() const { return (red + green + blue) / 3.0; }
  /// The luma of ITU-R BT.601, rounded: 0.299 red + 0.587 green + 0.114 blue.
  [[nodiscard]] unsigned luma() const { return (299U * red + 587U * green + 114U * blue + 500U) / 1000U; }
};
static_assert(sizeof(Pixel) == 4);

/// An image's pixels row by row from the top.
struct RasterImage {
  std::size_t width = 0;
  std::size_t height = 0;
  bool has_alpha = false;  ///< the file has an alpha channel, or a transparent colour
  std::vector<Pixel> pixels;
  [[nodiscard]] const Pixel& at(std::size_t column, std::size_t row) const { return pixels[row * width + column]; }
};

/// Whether the file begins as a PNG or a PGM does.
bool is_raster_image(const std::string& path);

/// Reads a PNG or a PGM (P2 or P5, at most 255 grey values). Values are those that the file samples: chunks of a PNG
/// that state a gamma or a colour space change nothing. Samples of 16 bits are rounded to 8.
/// \throws Error that says what is wrong with it
RasterImage load_raster_image(const std::string& path);

}  // namespace trellis
