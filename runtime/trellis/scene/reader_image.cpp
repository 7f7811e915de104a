// SPDX-License-Identifier: GPL-3.0-or-later
// The only source that includes libpng.
#include <png.h>

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/reader_formats.hpp>

namespace trellis {

namespace {

constexpr double pixel = 0.05;  // metres
constexpr unsigned dark = 128;  // grey values below are obstacle
constexpr unsigned most_side = 4096;

/// An image's pixels as grey values, row by row from the top.
struct Image {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<unsigned char> grey;
  [[nodiscard]] bool obstacle(std::size_t column, std::size_t row) const { return grey[row * width + column] < dark; }
};

Image load(const std::string& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  const auto fault = [&] {
    const std::string why = static_cast<const char*>(header.message);
    png_image_free(&header);
    return Error(fmt::format("{}: the image cannot be read: {}", path, why));
  };
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0) throw fault();
  if (header.width > most_side || header.height > most_side) {
    png_image_free(&header);
    throw Error(fmt::format("{}: the image has {} x {} pixels; at most {} x {} are read as a world", path, header.width,
                            header.height, most_side, most_side));
  }
  header.format = PNG_FORMAT_GRAY;
  Image image{header.width, header.height, std::vector<unsigned char>(PNG_IMAGE_SIZE(header))};
  constexpr unsigned char light = 255;
  const png_color white{light, light, light};
  if (png_image_finish_read(&header, &white, image.grey.data(), 0, nullptr) == 0) throw fault();
  return image;
}

/// Consecutive rows with an equal run of obstacle pixels form one box.
std::vector<Obstacle> boxes_of(const Image& image) {
  struct Run {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t top = 0;
  };
  std::vector<Obstacle> boxes;
  const auto close = [&](const Run& run, std::size_t bottom) {
    const auto metres = [](std::size_t pixels) { return pixel * static_cast<double>(pixels); };
    boxes.push_back({fmt::format("box {}", boxes.size() + 1), Box2{{metres(run.begin), metres(image.height - bottom)},
                                                                   {metres(run.end), metres(image.height - run.top)}}});
  };
  std::vector<Run> open;
  for (std::size_t row = 0; row <= image.height; ++row) {
    std::vector<Run> now;
    for (std::size_t column = 0; row < image.height && column < image.width; ++column) {
      if (!image.obstacle(column, row)) continue;
      Run run{column, column, row};
      while (run.end < image.width && image.obstacle(run.end, row)) ++run.end;
      column = run.end;
      now.push_back(run);
    }
    for (const Run& before : open) {
      bool goes_on = false;
      for (Run& run : now) {
        if (run.begin != before.begin || run.end != before.end) continue;
        run.top = before.top;
        goes_on = true;
      }
      if (!goes_on) close(before, row);
    }
    open = std::move(now);
  }
  return boxes;
}

}  // namespace

bool is_image(const std::string& path) {
  constexpr std::array<unsigned char, 8> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  std::array<char, signature.size()> begin{};
  std::ifstream in(path, std::ios::binary);
  if (!in.read(begin.data(), begin.size())) return false;
  for (std::size_t i = 0; i < begin.size(); ++i) {
    if (static_cast<unsigned char>(begin[i]) != signature[i]) return false;
  }
  return true;
}

std::vector<Problem> read_image(const std::string& path, const ReadOptions& options) {
  const Image image = load(path);
  const double width = pixel * static_cast<double>(image.width);
  const double height = pixel * static_cast<double>(image.height);
  auto scene =
      std::make_shared<const Scene>(Scene{World(Box2{{0, 0}, {width, height}}, boxes_of(image)), Robot::point()});
  const std::filesystem::path file(path);
  const std::string name = file.parent_path().parent_path().filename().string() + "/" +
                           file.parent_path().filename().string() + "/" + file.stem().string();
  // The centres of the corner pixels.
  Problem problem = problem_in(name, std::move(scene), options);
  problem.start = {0.5 * pixel, 0.5 * pixel};
  problem.goal = {width - 0.5 * pixel, height - 0.5 * pixel};
  return {std::move(problem)};
}

}  // namespace trellis
