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
