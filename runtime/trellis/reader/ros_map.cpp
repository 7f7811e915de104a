// SPDX-License-Identifier: GPL-3.0-or-later
// Occupancy maps of ROS: a YAML file and its image.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/raster_image.hpp>
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
  double yaw = 0.0;  ///< of the image about its lower left corner, radians
  bool negate = false;
  bool scale = false;  ///< the mode is scale, not trinary
  double occupied = 0.0;
  double free = 0.0;
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool is_known(const std::string& key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); }

/// Returns the value of a key that each map has.
YamlEntry needed(const YamlEntry& file, const char* key) {
  if (file.has(key)) return file.at(key);
  std::vector<std::string> others = file.keys();
  std::erase_if(others, is_known);
  throw file.error(fmt::format("'{}' is missing{}", key, did_you_mean(key, others)));
}

double share_at(const YamlEntry& file, const char* key) {
  const YamlEntry entry = needed(file, key);
  const double share = entry.number();
  if (share < 0.0 || share > 1.0) throw entry.error(fmt::format("'{}' is {}, expected 0 to 1", key, share));
  return share;
}

MapFile map_of(const YamlEntry& file) {
  ErrorList errors;
  MapFile map;
  errors.attempt([&] {
    const YamlEntry entry = needed(file, "image");
    map.image = entry.word();
    // A script may read files of its folder; a map does not lead out of it.
    const std::filesystem::path path(map.image);
    if (path.empty() || path.is_absolute() || *path.lexically_normal().begin() == "..") {
      throw entry.error(
          fmt::format("the image is '{}', expected a file beside the map or in a folder below", map.image));
    }
  });
  errors.attempt([&] {
    const YamlEntry entry = needed(file, "resolution");
    map.resolution = entry.number();
    constexpr double least = 1e-6;
    constexpr double most = 1e3;
    if (map.resolution < least || map.resolution > most) {
      throw entry.error(fmt::format("'resolution' is {}, expected {} to {} metres", map.resolution, least, most));
    }
  });
  errors.attempt([&] {
    const YamlEntry entry = needed(file, "origin");
    const auto origin = entry.numbers(3, "x, y, yaw");
    map.origin = {origin[0], origin[1]};
    if (!in_range(map.origin)) throw entry.error(fmt::format("'origin' is farther than {:g} m", most_distant));
    map.yaw = origin[2];
  });
  errors.attempt([&] {
    const YamlEntry entry = needed(file, "negate");
    const std::string word = lower(entry.word());
    constexpr std::array<std::string_view, 5> yes = {"1", "true", "yes", "on", "y"};
    constexpr std::array<std::string_view, 5> no = {"0", "false", "no", "off", "n"};
    map.negate = std::find(yes.begin(), yes.end(), word) != yes.end();
    if (!map.negate && std::find(no.begin(), no.end(), word) == no.end()) {
      throw entry.error(fmt::format("'negate' is '{}', expected 0 or 1", entry.word()));
    }
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
    const std::string mode = lower(file.at("mode").word());
    if (mode != "trinary" && mode != "scale") {
      throw file.at("mode").error(fmt::format("the mode is '{}', expected trinary or scale", mode));
    }
    map.scale = mode == "scale";
  });
  errors.raise();
  return map;
}

enum class Cell : unsigned char { free, occupied, unknown };

/// Decides a pixel of a map as one of the map servers does.
class Rule {
 public:
  Rule(const MapFile& map, const RasterImage& image, MapServer server)
      : map_(map), server_(server), alpha_(image.has_alpha && !map.scale) {}

  [[nodiscard]] Cell operator()(const Pixel& pixel) const {
    if (server_ == MapServer::nav2) {
      const double occupancy = occupancy_of(pixel.luma());
      if (!pixel.opaque()) return Cell::unknown;
      if (occupancy <= map_.free) return Cell::free;
      return occupancy >= map_.occupied ? Cell::occupied : Cell::unknown;
    }
    const double occupancy = occupancy_of(alpha_ ? 0.25 * (3.0 * pixel.mean() + pixel.alpha) : pixel.mean());
    if (occupancy > map_.occupied) return Cell::occupied;
    return occupancy < map_.free ? Cell::free : Cell::unknown;
  }
  [[nodiscard]] std::string text() const {
    if (server_ == MapServer::nav2) {
      return "pixels are read as by the map server of Nav2: their luma, and transparent ones are unknown; scenes.load "
             "reads them as that of ROS 1 with map_server = \"ros1\"";
    }
    return fmt::format("pixels are read as by the map server of ROS 1: the mean of the channels{}",
                       alpha_ ? ", alpha included" : "");
  }

 private:
  /// The probability that a pixel of this brightness, 0 to 255, is occupied.
  [[nodiscard]] double occupancy_of(double brightness) const {
    constexpr double most = 255.0;
    return (map_.negate ? brightness : most - brightness) / most;
  }

  const MapFile& map_;
  MapServer server_;
  bool alpha_;  // is one of the channels whose mean counts for ROS 1
};

/// The pose of a map's image, whose lower left corner is the origin. Quarter turns are exact.
Pose2 pose_of(const MapFile& map) {
  constexpr double nothing = 1e-9;
  Pose2 pose{map.origin.x, map.origin.y, std::cos(map.yaw), std::sin(map.yaw)};
  if (std::abs(pose.s) < nothing) pose = {pose.x, pose.y, std::copysign(1.0, pose.c), 0.0};
  if (std::abs(pose.c) < nothing) pose = {pose.x, pose.y, 0.0, std::copysign(1.0, pose.s)};
  return pose;
}

std::vector<Vec2> moved(const Pose2& pose, const Box2& box) {
  std::vector<Vec2> corners = rectangle_vertices(box);
  for (Vec2& corner : corners) corner = pose(corner);
  return corners;
}

/// Moves the boxes of an image to its pose. Those that a quarter turn moves stay boxes. Others become rectangles, grown
/// by the rounding of their corners so that neighbours leave no gap; triangles fill the corners of the bounds that the
/// image does not cover.
World placed(const Pose2& pose, Vec2 size, std::vector<Obstacle> obstacles) {
  const std::vector<Vec2> corners = moved(pose, {{0.0, 0.0}, size});
  const Box2 bounds = bounding_box(corners);
  const bool quarter = pose.c == 0.0 || pose.s == 0.0;
  const double rounding =
      4.0 * std::numeric_limits<double>::epsilon() * (std::abs(pose.x) + std::abs(pose.y) + size.x + size.y);
  for (Obstacle& obstacle : obstacles) {
    auto box = std::get<Box2>(obstacle.shape);
    if (quarter) {
      obstacle.shape = bounding_box(moved(pose, box));
      continue;
    }
    const Vec2 more{rounding, rounding};
    box = {box.lo - more, box.hi + more};
    obstacle.shape = Polygon{moved(pose, box)};
  }
  if (quarter) return {bounds, std::move(obstacles)};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // The sides run counter-clockwise: to the right below the image, to the left above it.
    const Vec2 from = corners[i];
    const Vec2 to = corners[(i + 1) % corners.size()];
    const Vec2 along = to - from;
    const Vec2 corner{along.y > 0.0 ? bounds.hi.x : bounds.lo.x, along.x > 0.0 ? bounds.lo.y : bounds.hi.y};
    obstacles.push_back({fmt::format("outside of the map {}", i + 1), Polygon{{from, corner, to}}});
  }
  return {bounds, std::move(obstacles)};
}

}  // namespace

bool is_ros_map(const SourceText& text) {
  if (!has_key(text, "image") || !(has_key(text, "resolution") || has_key(text, "occupied_thresh"))) return false;
  try {
    return YamlEntry::root(text, "").has("image");
  } catch (const Error&) {
    return true;  // its reader says why it is no YAML
  }
}

SceneFile read_ros_map(const SourceText& text, const ReadOptions& options) {
  const YamlEntry root = YamlEntry::root(text, "a map of ROS as a YAML map");
  const MapFile map = map_of(root);
  const auto path = std::filesystem::path(text.path).parent_path() / map.image;
  RasterImage image;
  try {
    image = load_raster_image(path.string());
  } catch (const Error& fault) {
    throw root.at("image").error(fmt::format("its image: {}", fault.what()));
  }
  const Rule rule(map, image, options.map_server);
  std::size_t unknown = 0;
  std::size_t clear = 0;
  for (const Pixel& pixel : image.pixels) {
    if (rule(pixel) != Cell::unknown) continue;
    ++unknown;
    clear += pixel.opaque() ? 0U : 1U;
  }
  const Pose2 pose = pose_of(map);
  const Vec2 size{map.resolution * static_cast<double>(image.width),
                  map.resolution * static_cast<double>(image.height)};
  const bool turned = pose.c != 1.0 || pose.s != 0.0;
  // Without a turn the boxes are computed at their place: what adding the origin rounds is then the same for all.
  auto boxes = boxes_of(
      path.string(), image.width, image.height,
      [&](std::size_t column, std::size_t row) { return rule(image.at(column, row)) != Cell::free; },
      turned ? Vec2{} : map.origin, map.resolution);
  const auto make_world = [&]() -> World {
    if (turned) return placed(pose, size, std::move(boxes));
    return {{map.origin, map.origin + size}, std::move(boxes)};
  };
  World world = make_world();
  auto scene = std::make_shared<const PlanarScene>(std::move(world), options.robot.value_or(Robot::point()));
  SceneFile file{"map of ROS",
                 fmt::format("1 pixel = {:g} m", map.resolution),
                 fmt::format("the lower left corner is ({:g}, {:g}){}, y up", map.origin.x, map.origin.y,
                             turned ? fmt::format(", turned by {:g} rad", map.yaw) : ""),
                 {problem_in(stem_of(text.path), std::move(scene), options)}};
  file.notes.push_back(rule.text());
  file.warnings = unused_warnings(text, root.unused());
  if (std::abs(map.yaw) > 2.0 * std::numbers::pi) {
    file.warnings.push_back(
        fmt::format("line {}: the yaw of the origin is {:g}, more than a full turn; it is in radians",
                    root.at("origin").line(), map.yaw));
  }
  if (unknown > 0) {
    file.warnings.push_back(fmt::format("{} of {} pixels are neither free nor occupied{}; they are obstacles", unknown,
                                        image.pixels.size(), clear > 0 ? fmt::format(" ({} transparent)", clear) : ""));
  }
  return file;
}

}  // namespace trellis
