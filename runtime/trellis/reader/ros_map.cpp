// SPDX-License-Identifier: GPL-3.0-or-later
// Occupancy maps of ROS: a YAML file and its image.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/grey_image.hpp>
#include <trellis/reader/yaml_entry.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

constexpr std::array<const char*, 7> keys = {"image",           "resolution",  "origin", "negate",
                                             "occupied_thresh", "free_thresh", "mode"};

struct MapFile {
  std::string image;
  double resolution = 0.0;
  Vec2 origin;
  bool negate = false;
  double occupied = 0.0;
  double free = 0.0;
};

double share_at(const YamlEntry& file, const char* key) {
  const YamlEntry entry = file.at(key);
  const double share = entry.number();
  if (share < 0.0 || share > 1.0) throw entry.error(fmt::format("'{}' is {}, expected 0 to 1", key, share));
  return share;
}

MapFile map_of(const YamlEntry& file) {
  ErrorList errors;
  MapFile map;
  for (const std::string& key : file.keys()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    errors.attempt([&] {
      throw file.at(key).error(fmt::format("'{}' is not known{}, expected {}", key,
                                           did_you_mean(key, std::vector<std::string>(keys.begin(), keys.end())),
                                           fmt::join(keys, ", ")));
    });
  }
  errors.attempt([&] {
    const YamlEntry entry = file.at("image");
    map.image = entry.word();
    // A script may read files of its folder; a map does not lead out of it.
    const std::filesystem::path path(map.image);
    if (path.empty() || path.is_absolute() || *path.lexically_normal().begin() == "..") {
      throw entry.error(
          fmt::format("the image is '{}', expected a file beside the map or in a folder below", map.image));
    }
  });
  errors.attempt([&] {
    const YamlEntry entry = file.at("resolution");
    map.resolution = entry.number();
    constexpr double least = 1e-6;
    constexpr double most = 1e3;
    if (map.resolution < least || map.resolution > most) {
      throw entry.error(fmt::format("'resolution' is {}, expected {} to {} metres", map.resolution, least, most));
    }
  });
  errors.attempt([&] {
    const YamlEntry entry = file.at("origin");
    const auto origin = entry.numbers(3, "x, y, yaw");
    map.origin = {origin[0], origin[1]};
    if (!in_range(map.origin)) throw entry.error(fmt::format("'origin' is farther than {:g} m", most_distant));
    if (origin[2] != 0.0) {
      throw entry.error(fmt::format("the map's yaw is {}, expected 0: turned maps are not read", origin[2]));
    }
  });
  errors.attempt([&] {
    const YamlEntry entry = file.at("negate");
    const std::string word = entry.word();
    if (word != "0" && word != "1" && word != "false" && word != "true") {
      throw entry.error(fmt::format("'negate' is '{}', expected 0 or 1", word));
    }
    map.negate = word == "1" || word == "true";
  });
  errors.attempt([&] { map.occupied = share_at(file, "occupied_thresh"); });
  errors.attempt([&] {
    map.free = share_at(file, "free_thresh");
    if (map.free > map.occupied && map.occupied > 0.0) {
      throw file.at("free_thresh")
          .error(fmt::format("'free_thresh' is {}, expected at most 'occupied_thresh', {}", map.free, map.occupied));
    }
  });
  errors.attempt([&] {
    if (!file.has("mode")) return;
    const std::string mode = file.at("mode").word();
    if (mode != "trinary" && mode != "scale") {
      throw file.at("mode").error(fmt::format("the mode is '{}', expected trinary or scale", mode));
    }
  });
  errors.raise();
  return map;
}

/// The probability that a pixel is occupied, as map_server computes it.
double occupancy(const MapFile& map, unsigned grey) {
  constexpr double most = 255.0;
  return (map.negate ? static_cast<double>(grey) : most - static_cast<double>(grey)) / most;
}

}  // namespace

bool is_ros_map(const SourceText& text) {
  const auto begins = [&](std::string_view word) {
    return std::any_of(text.lines.begin(), text.lines.end(),
                       [&](const std::string& line) { return line.starts_with(word); });
  };
  return begins("image:") && (begins("resolution:") || begins("occupied_thresh:"));
}

SceneFile read_ros_map(const SourceText& text, const ReadOptions& options) {
  const YamlEntry root = YamlEntry::root(text, "a map of ROS as a YAML map");
  const MapFile map = map_of(root);
  const auto path = std::filesystem::path(text.path).parent_path() / map.image;
  GreyImage image;
  try {
    image = load_grey_image(path.string());
  } catch (const Error& fault) {
    throw root.at("image").error(fmt::format("its image: {}", fault.what()));
  }
  std::size_t unknown = 0;
  for (const unsigned char pixel : image.grey) {
    const double share = occupancy(map, pixel);
    unknown += share >= map.free && share <= map.occupied ? 1U : 0U;
  }
  auto boxes = boxes_of(
      path.string(), image.width, image.height,
      [&](std::size_t column, std::size_t row) { return occupancy(map, image.at(column, row)) >= map.free; },
      map.origin, map.resolution);
  const Vec2 size{map.resolution * static_cast<double>(image.width),
                  map.resolution * static_cast<double>(image.height)};
  auto scene = std::make_shared<const PlanarScene>(World({map.origin, map.origin + size}, std::move(boxes)),
                                                   options.robot.value_or(Robot::point()));
  SceneFile file{"map of ROS",
                 fmt::format("1 pixel = {:g} m", map.resolution),
                 fmt::format("the lower left corner is ({:g}, {:g}), y up", map.origin.x, map.origin.y),
                 {problem_in(stem_of(text.path), std::move(scene), options)}};
  if (unknown > 0) {
    file.warnings.push_back(
        fmt::format("{} of {} pixels are neither free nor occupied; they are obstacles", unknown, image.grey.size()));
  }
  return file;
}

}  // namespace trellis
