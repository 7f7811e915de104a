// SPDX-License-Identifier: GPL-3.0-or-later
// The only source that includes libpng.
#include <trellis/reader/raster_image.hpp>

#include <png.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <string_view>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/unread.hpp>

namespace trellis {

namespace {

void require_sides(const std::string& path, std::size_t width, std::size_t height) {
  if (width > most_grid_side || height > most_grid_side) {
    throw Error(fmt::format("{}: the image has {} x {} pixels; at most {} x {} are read as a world", path, width,
                            height, most_grid_side, most_grid_side));
  }
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns a PNG without the chunks that state a gamma or a colour space: libpng would convert the samples.
std::string without_colour_space(const std::string& png) {
  constexpr std::size_t signature = 8;  // bytes
  constexpr std::size_t word = 4;       // bytes of the length, the type and the checksum of a chunk each
  constexpr std::array<std::string_view, 4> dropped = {"gAMA", "cHRM", "sRGB", "iCCP"};
  const std::string_view bytes(png);
  std::string kept(bytes.substr(0, signature));
  std::size_t at = signature;
  while (bytes.size() - at >= 3 * word) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < word; ++i) length = length << 8U | static_cast<unsigned char>(bytes[at + i]);
    if (length > bytes.size() - at - 3 * word) break;
    const std::string_view type = bytes.substr(at + word, word);
    if (std::find(dropped.begin(), dropped.end(), type) == dropped.end()) {
      kept += bytes.substr(at, length + 3 * word);
    }
    at += length + 3 * word;
  }
  return kept += bytes.substr(at);  // an unfinished chunk, which libpng reports
}

RasterImage load_png(const std::string& path) {
  const std::string bytes = without_colour_space(bytes_of(path));
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  const auto fault = [&] {
    const std::string why = static_cast<const char*>(header.message);
    png_image_free(&header);
    return Error(fmt::format("{}: the image cannot be read: {}", path, why));
  };
  if (png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()) == 0) throw fault();
  try {
    require_sides(path, header.width, header.height);
  } catch (const Error&) {
    png_image_free(&header);
    throw;
  }
  RasterImage image{header.width, header.height, (header.format & PNG_FORMAT_FLAG_ALPHA) != 0, {}};
  header.format = PNG_FORMAT_RGBA;
  header.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // libpng would take samples of 16 bits as linear
  image.pixels.resize(image.width * image.height);
  if (png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr) == 0) throw fault();
  return image;
}

/// The bytes of a PGM, read number by number; comments go from '#' to the end of the line.
class Pgm {
 public:
  explicit Pgm(const std::string& path) : path_(path), bytes_(bytes_of(path)) {}

  RasterImage image() {
    constexpr std::size_t magic = 2;
    const bool text = bytes_.compare(0, magic, "P2") == 0;
    at_ = magic;
    const std::size_t width = number("the width");
    const std::size_t height = number("the height");
    if (width == 0 || height == 0) throw error("it has no pixels");
    require_sides(path_, width, height);
    const std::size_t most = number("the largest grey value");
    if (most == 0 || most > byte) throw error(fmt::format("its largest grey value is {}, expected 1 to 255", most));
    if (!text) ++at_;  // the one blank before the pixels
    const std::size_t count = width * height;
    if (!text && bytes_.size() < at_ + count) {
      throw error(fmt::format("it ends after {} of {} pixels", bytes_.size() - std::min(bytes_.size(), at_), count));
    }
    RasterImage image{width, height, false, std::vector<Pixel>(count)};
    for (Pixel& pixel : image.pixels) {
      const std::size_t value = text ? number("a grey value") : static_cast<unsigned char>(bytes_[at_++]);
      if (value > most) throw error(fmt::format("a grey value is {}, expected at most {}", value, most));
      const auto grey = static_cast<unsigned char>(value * byte / most);
      pixel = {grey, grey, grey, byte};
    }
    return image;
  }

 private:
  static constexpr std::size_t byte = 255;

  [[nodiscard]] Error error(const std::string& why) const {
    const auto line = 1 + std::count(bytes_.begin(),
                                     bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, bytes_.size())), '\n');
    return Error(fmt::format("{}:{}: the image cannot be read: {}", path_, line, why));
  }

  std::size_t number(const char* what) {
    while (at_ < bytes_.size() && (is_blank(bytes_[at_]) || bytes_[at_] == '#')) {
      if (bytes_[at_] == '#') at_ = std::min(bytes_.find('\n', at_), bytes_.size());
      if (at_ < bytes_.size()) ++at_;
    }
    constexpr std::size_t enough = 1'000'000;
    constexpr std::size_t ten = 10;
    std::size_t value = 0;
    const std::size_t begin = at_;
    for (; at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_) {
      value = std::min(enough, value * ten + static_cast<std::size_t>(bytes_[at_] - '0'));
    }
    if (at_ == begin) throw error(fmt::format("{} is missing, expected a whole number", what));
    return value;
  }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  const std::string& path_;
  std::string bytes_;
  std::size_t at_ = 0;
};

enum class Kind : unsigned char { none, png, pgm };

Kind kind_of(const std::string& path) {
  constexpr std::array<unsigned char, 8> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  std::array<char, signature.size()> begin{};
  std::ifstream in(path, std::ios::binary);
  in.read(begin.data(), begin.size());
  const auto same = [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; };
  if (in && std::equal(begin.begin(), begin.end(), signature.begin(), same)) return Kind::png;
  const bool pgm = begin[0] == 'P' && (begin[1] == '2' || begin[1] == '5') &&
                   (begin[2] == ' ' || begin[2] == '\n' || begin[2] == '\r' || begin[2] == '\t' || begin[2] == '#');
  return pgm ? Kind::pgm : Kind::none;
}

}  // namespace

bool is_raster_image(const std::string& path) { return kind_of(path) != Kind::none; }

RasterImage load_raster_image(const std::string& path) {
  require_readable(path);
  switch (kind_of(path)) {
    case Kind::png: return load_png(path);
    case Kind::pgm: return Pgm(path).image();
    default: {
      const std::string known = unread_bytes(first_bytes(path));
      throw Error(fmt::format("{}:1: no image that can be read, expected a PNG or a PGM{}{}", path,
                              known.empty() ? "" : ": ", known));
    }
  }
}

}  // namespace trellis
