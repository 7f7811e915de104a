// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/raster_image.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

constexpr double pixel = 0.05;  // metres
constexpr double dark = 128.0;  // below it the mean of the channels is an obstacle

}  // namespace

SceneFile read_image(const std::string& path, const ReadOptions& options) {
  const RasterImage image = load_raster_image(path);
  const double width = pixel * static_cast<double>(image.width);
  const double height = pixel * static_cast<double>(image.height);
  auto boxes = boxes_of(
      path, image.width, image.height,
      [&](std::size_t column, std::size_t row) {
        const Pixel& at = image.at(column, row);
        return !at.opaque() || at.mean() < dark;
      },
      {}, pixel);
  auto scene = std::make_shared<const PlanarScene>(World(Box2{{0, 0}, {width, height}}, std::move(boxes)),
                                                   options.robot.value_or(Robot::point()));
  const std::filesystem::path file(path);
  const std::string name = file.parent_path().parent_path().filename().string() + "/" +
                           file.parent_path().filename().string() + "/" + file.stem().string();
  // The centres of the corner pixels.
  Problem problem = problem_in(name, std::move(scene), options);
  if (!options.robot) {
    problem.start = {0.5 * pixel, 0.5 * pixel};
    problem.goals = {{width - 0.5 * pixel, height - 0.5 * pixel}};
  }
  SceneFile scene_file{"image, dark pixels are obstacles",
                       "1 pixel = 0.05 m",
                       "the origin is the lower left corner, y up",
                       {std::move(problem)}};
  const auto clear =
      std::count_if(image.pixels.begin(), image.pixels.end(), [](const Pixel& one) { return !one.opaque(); });
  if (clear > 0) {
    scene_file.warnings.push_back(
        fmt::format("{} of {} pixels are transparent, so unknown; they are obstacles", clear, image.pixels.size()));
  }
  return scene_file;
}

}  // namespace trellis
