// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds drawn as images, for the readers of images.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

namespace trellis::test {

namespace png {

inline void put(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((value >> shift) & 0xFFU);
}

inline void chunk(std::string& image, std::string_view type, const std::string& data) {
  put(image, static_cast<std::uint32_t>(data.size()));
  const std::string body = std::string(type) + data;
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : body) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  image += body;
  put(image, ~crc);
}

}  // namespace png

/// The colour types of PNG.
enum class Channels : char { grey = 0, rgb = 2, palette = 3, grey_alpha = 4, rgba = 6 };

/// Returns a PNG of samples of 8 bits, without compression. `samples` returns those of a column and row, from the top.
/// \param chunks  written before the pixels, as `chunk` makes them
inline std::string image_of(std::size_t width, std::size_t height, Channels channels,
                            const std::function<std::string(std::size_t, std::size_t)>& samples,
                            const std::string& chunks = "", char depth = 8) {
  std::string bytes = "\x89PNG\r\n\x1a\n";
  std::string header;
  png::put(header, static_cast<std::uint32_t>(width));
  png::put(header, static_cast<std::uint32_t>(height));
  header += std::string{depth, static_cast<char>(channels), 0, 0, 0};
  png::chunk(bytes, "IHDR", header);
  bytes += chunks;
  // One stored block of deflate a row: a filter byte and the pixels.
  std::string data = "\x78\x01";
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (std::size_t row = 0; row < height; ++row) {
    std::string line(1, '\0');
    for (std::size_t column = 0; column < width; ++column) line += samples(column, row);
    const auto length = static_cast<std::uint16_t>(line.size());
    data += row + 1 == height ? '\1' : '\0';
    for (const unsigned value : {static_cast<unsigned>(length), static_cast<unsigned>(~length)}) {
      data += static_cast<char>(value & 0xFFU);
      data += static_cast<char>((value >> 8U) & 0xFFU);
    }
    data += line;
    for (const char c : line) {
      a = (a + static_cast<unsigned char>(c)) % 65521;
      b = (b + a) % 65521;
    }
  }
  png::put(data, (b << 16U) | a);
  png::chunk(bytes, "IDAT", data);
  png::chunk(bytes, "IEND", "");
  return bytes;
}

/// Returns a PNG of grey values. `obstacle` returns for each column and row, from the top, whether it is dark.
inline std::string image(std::size_t width, std::size_t height,
                         const std::function<bool(std::size_t, std::size_t)>& obstacle) {
  return image_of(width, height, Channels::grey, [&](std::size_t column, std::size_t row) {
    return std::string(1, obstacle(column, row) ? '\0' : '\xFF');
  });
}

inline void write_image(const std::string& path, std::size_t width, std::size_t height,
                        const std::function<bool(std::size_t, std::size_t)>& obstacle) {
  std::ofstream(path, std::ios::binary) << image(width, height, obstacle);
}

}  // namespace trellis::test
