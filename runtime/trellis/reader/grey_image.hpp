// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace trellis {

/// An image's pixels as grey values, row by row from the top.
struct GreyImage {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<unsigned char> grey;
  [[nodiscard]] unsigned at(std::size_t column, std::size_t row) const { return grey[row * width + column]; }
};

/// Whether the file begins as a PNG or a PGM does.
bool is_grey_image(const std::string& path);

/// Reads a PNG or a PGM (P2 or P5, at most 255 grey values).
/// \throws Error that says what is wrong with it
GreyImage load_grey_image(const std::string& path);

}  // namespace trellis
