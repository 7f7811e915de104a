// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds drawn as images.
#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "scene_brute.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/image.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr double pixel = 0.05;

}  // namespace

TEST_CASE("an image's dark pixels are obstacles, and nothing else is", "[reader][image]") {
  const test::Folder folder;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Stream stream(seed, "", "image");
    const std::size_t width = 5 + stream.below(30);
    const std::size_t height = 5 + stream.below(30);
    std::vector<char> dark(width * height, 0);
    // Blocks and single pixels; the corners that a point goes from and to are light.
    for (int block = 0; block < 12; ++block) {
      const std::size_t x = stream.below(width);
      const std::size_t y = stream.below(height);
      for (std::size_t i = x; i < std::min(width, x + 1 + stream.below(6)); ++i) {
        for (std::size_t j = y; j < std::min(height, y + 1 + stream.below(6)); ++j) dark[j * width + i] = 1;
      }
    }
    test::write_image(folder.file("world.png"), width, height,
                      [&](std::size_t column, std::size_t row) { return dark[row * width + column] != 0; });
    const auto problems = read_problems(folder.file("world.png"), {});
    REQUIRE(problems.size() == 1);
    const Problem& problem = problems.front();
    const World& world = planar(*problem.scene).world;
    CHECK(problem.scene->is_point());
    CHECK(world.bounds().hi.x == Approx(pixel * static_cast<double>(width)));
    CHECK(world.bounds().hi.y == Approx(pixel * static_cast<double>(height)));
    CHECK(problem.start[0] == Approx(0.5 * pixel));
    CHECK(problem.goal()[1] == Approx(world.bounds().hi.y - 0.5 * pixel));
    std::size_t pixels = 0;
    double area = 0.0;
    for (const auto& obstacle : world.obstacles()) {
      const auto& box = std::get<Box2>(obstacle.shape);
      area += (box.hi.x - box.lo.x) * (box.hi.y - box.lo.y);
    }
    CAPTURE(seed, width, height);
    for (std::size_t row = 0; row < height; ++row) {
      for (std::size_t column = 0; column < width; ++column) {
        const Vec2 middle{pixel * (static_cast<double>(column) + 0.5),
                          pixel * (static_cast<double>(height - row) - 0.5)};
        const bool is_dark = dark[row * width + column] != 0;
        pixels += is_dark ? 1 : 0;
        REQUIRE(brute::is_free(world, middle) == !is_dark);
      }
    }
    CHECK(area == Approx(pixel * pixel * static_cast<double>(pixels)));
    CHECK(world.obstacles().size() <= pixels);
  }
}

TEST_CASE("rows that are alike make one box", "[reader][image]") {
  const test::Folder folder;
  test::write_image(folder.file("wall.png"), 40, 40,
                    [](std::size_t column, std::size_t row) { return column >= 18 && column < 22 && row != 30; });
  const auto problems = read_problems(folder.file("wall.png"), {});
  CHECK(problems.front().scene->obstacle_count() == 2);
}

TEST_CASE("an unreadable image is an error, wherever it is truncated", "[reader][image]") {
  const test::Folder folder;
  const std::string image = test::image(20, 20, [](std::size_t column, std::size_t) { return column == 3; });
  for (std::size_t length = 8; length < image.size(); length += 7) {
    std::ofstream(folder.file("cut.png"), std::ios::binary) << image.substr(0, length);
    // The last chunk says only that it is the last.
    if (length > image.size() - 16) continue;
    CAPTURE(length);
    CHECK_THROWS_WITH(read_problems(folder.file("cut.png"), {}), Contains("cut.png: the image cannot be read"));
  }
}

TEST_CASE("the mean of an image's channels as sampled decides, whatever gamma it states", "[reader][image]") {
  const test::Folder folder;
  // Pure green has the mean 85; as light it would be bright. A grey of 127 is dark, one of 128 is not.
  const std::vector<std::string> colours = {{'\0', '\xFF', '\0'}, "\x7F\x7F\x7F", "\x80\x80\x80", "\xFF\xFF\x0F"};
  const std::string dark = "##..";
  std::string gamma, space;
  test::png::chunk(gamma, "gAMA", std::string("\0\0\x27\x10", 4));  // 0.1
  test::png::chunk(space, "sRGB", std::string(1, '\0'));
  for (const std::string& chunks : {std::string(), gamma, space}) {
    const std::string path = folder.write(
        "colours.png",
        test::image_of(
            4, 1, test::Channels::rgb, [&](std::size_t column, std::size_t) { return colours[column]; }, chunks));
    const SceneFile file = read_scene(path, {});
    CHECK(file.warnings.empty());
    for (std::size_t i = 0; i < dark.size(); ++i) {
      CAPTURE(i, chunks.size());
      CHECK(brute::is_free(planar(*file.problems[0].scene).world,
                           {pixel * (static_cast<double>(i) + 0.5), 0.5 * pixel}) == (dark[i] == '.'));
    }
  }
}

TEST_CASE("samples of 16 bits, palettes and grey with alpha have the same values", "[reader][image]") {
  const test::Folder folder;
  const auto obstacles = [&](const std::string& png) {
    return read_scene(folder.write("a.png", png), {}).problems[0].scene->obstacle_count();
  };
  // 0x7F00 is dark, 0x8100 is not: as linear light both would be bright.
  CHECK(obstacles(test::image_of(
            4, 1, test::Channels::grey,
            [](std::size_t column, std::size_t) { return std::string(column == 0 ? "\x7F" : "\x81") + '\0'; }, "",
            16)) == 1);
  std::string palette;
  test::png::chunk(palette, "PLTE", std::string("\x40\x40\x40\xC0\xC0\xC0", 6));
  CHECK(obstacles(test::image_of(
            4, 1, test::Channels::palette,
            [](std::size_t column, std::size_t) { return std::string(1, column == 2 ? '\0' : '\1'); }, palette)) == 1);
  CHECK(obstacles(test::image_of(4, 1, test::Channels::grey_alpha, [](std::size_t column, std::size_t) {
          return std::string(column == 3 ? "\x10" : "\xF0") + "\xFF";
        })) == 1);
}

TEST_CASE("pixels that are not opaque are unknown, so obstacles, and counted", "[reader][image]") {
  const test::Folder folder;
  const std::string path =
      folder.write("clear.png", test::image_of(4, 1, test::Channels::rgba, [](std::size_t column, std::size_t) {
                     return std::string("\xFF\xFF\xFF") + (column == 0 ? '\0' : column == 1 ? '\x80' : '\xFF');
                   }));
  const SceneFile file = read_scene(path, {});
  REQUIRE(file.warnings.size() == 1);
  CHECK(file.warnings[0] == "2 of 4 pixels are transparent, so unknown; they are obstacles");
  const World& world = planar(*file.problems[0].scene).world;
  CHECK_FALSE(brute::is_free(world, {0.5 * pixel, 0.5 * pixel}));
  CHECK_FALSE(brute::is_free(world, {1.5 * pixel, 0.5 * pixel}));
  CHECK(brute::is_free(world, {2.5 * pixel, 0.5 * pixel}));
}
