// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/mesh_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

#include <trellis/base/input_file.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/unread.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

struct Format {
  std::string_view ending;
  void (*read)(const MeshSource&, Polygons&);
};

constexpr std::array<Format, 6> formats{
    {{"stl", read_stl}, {"obj", read_obj}, {"ply", read_ply}, {"off", read_off}, {"g", read_byu}, {"dae", read_dae}}};

std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return ending.empty() ? ending : ending.substr(1);
}

const Format* format_of(const std::string& path) {
  const std::string ending = ending_of(path);
  const auto* const format =
      std::find_if(formats.begin(), formats.end(), [&](const Format& f) { return f.ending == ending; });
  return format == formats.end() ? nullptr : format;
}

/// What a file is that is no mesh by its ending, and what to do: "; it is ...".
std::string hint_for(const std::string& path) {
  const std::string known = unread_ending(path);
  return known.empty() ? known : "; " + known;
}

std::string load(const std::string& path) {
  constexpr std::uintmax_t largest = std::uintmax_t{64} << 20U;
  InputFile file(path, largest);
  std::string text = file.rest();
  if (!file.fault().empty()) throw Error(fmt::format("{}: the file cannot be read: {}", path, file.fault()));
  return text;
}

/// Warns where the extents suggest another unit.
void check_extent(const std::string& unit, const std::string& path, MeshFile& file) {
  constexpr double huge = 500.0, tiny = 0.005;  // m
  const Vec3 size = file.mesh->bounds().hi - file.mesh->bounds().lo;
  const double extent = std::max({size.x, size.y, size.z});
  const std::string sizes = fmt::format("{:.4g} x {:.4g} x {:.4g} m", size.x, size.y, size.z);
  if (file.up != '\0') {
    if (extent > huge || extent < tiny) {
      file.warnings.push_back(fmt::format("{}: it extends {}{}; 1 unit is {:g} m by its <unit>", path,
                                          extent < tiny ? "only " : "", sizes, file.metres_in_unit));
    }
    return;
  }
  if (extent > huge && unit == "m") {
    file.warnings.push_back(
        fmt::format(R"({}: it extends {}; if its numbers are millimetres, give unit = "mm")", path, sizes));
  }
  if (extent < tiny) {
    file.warnings.push_back(
        fmt::format("{}: it extends only {}; its unit was given as \"{}\", {}", path, sizes, unit,
                    unit == "m" ? "but its numbers may be a larger one" : "but they may be metres"));
  }
}

/// Returns the warning of a file in which another axis than z is up, "" of others.
std::string up_warning(const std::string& path, char up) {
  if (up != 'x' && up != 'y') return "";
  return fmt::format(
      "{}: in this file {} is up ({}_UP), and its axes are kept; worlds have z up: pose {{ x, y, z, axis = {}, angle = "
      "math.pi / 2 }} turns it",
      path, up, up == 'x' ? 'X' : 'Y', up == 'x' ? "{0, -1, 0}" : "{1, 0, 0}");
}

}  // namespace

const std::vector<std::string>& mesh_endings() {
  static const std::vector<std::string> endings = [] {
    std::vector<std::string> all;
    all.reserve(formats.size());
    for (const Format& format : formats) all.emplace_back(format.ending);
    return all;
  }();
  return endings;
}

bool has_mesh_ending(const std::string& path) { return format_of(path) != nullptr; }

double metres_in(const std::string& unit) {
  static const std::vector<std::pair<std::string, double>> units{
      {"m", 1.0}, {"mm", 1e-3}, {"cm", 1e-2}, {"inch", 0.0254}};
  std::vector<std::string> names;
  names.reserve(units.size());
  for (const auto& [name, metres] : units) {
    if (name == unit) return metres;
    names.push_back(name);
  }
  const auto value = number_in(unit);
  if (value && *value > 0.0 && std::isfinite(*value)) return *value;
  throw Error(fmt::format(R"(unit must be "m", "mm", "cm", "inch" or a number of metres greater than 0, got "{}"{})",
                          unit, did_you_mean(unit, names)));
}

MeshFile read_mesh(const std::string& path, const MeshOptions& options) {
  const Format* format = format_of(path);
  if (format == nullptr) {
    throw Error(fmt::format("{}: files of meshes end with .stl, .obj, .ply, .off, .g or .dae{}", path, hint_for(path)));
  }
  MeshSource source{path, load(path), metres_in(options.unit), options.y_up};
  // STL has formats whose first bytes are a free text.
  if (format->read != read_stl && source.text.starts_with(byte_order_mark)) {
    source.text.erase(0, byte_order_mark.size());
  }
  Polygons polygons(source);
  format->read(source, polygons);
  MeshFile file;
  file.metres_in_unit = source.unit;
  if (format->read == read_dae) {
    const ColladaAsset asset = collada_asset(source.text);
    file.up = asset.up;
    file.metres_in_unit = asset.metres_in_unit;
    file.unit_name = asset.unit_name;
  }
  for (const std::string& warning : polygons.warnings) file.warnings.push_back(fmt::format("{}: {}", path, warning));
  const Vec3& scale = options.scale;
  if (scale.x == 0.0 || scale.y == 0.0 || scale.z == 0.0) {
    throw Error(
        fmt::format("{}: the factors of its scale must not be 0, got {:g} {:g} {:g}", path, scale.x, scale.y, scale.z));
  }
  if (scale != Vec3{1.0, 1.0, 1.0}) {
    for (Vec3& v : polygons.vertices) v = {scale.x * v.x, scale.y * v.y, scale.z * v.z};
  }
  std::vector<Triangle> triangles = polygons.triangles(file.without_area);
  if (scale.x * scale.y * scale.z < 0.0) {
    for (Triangle& triangle : triangles) std::swap(triangle[1], triangle[2]);
  }
  file.format = polygons.format;
  file.polygons = polygons.count();
  if (triangles.empty()) {
    throw source.error(0, polygons.count() == 0 ? "it has no triangles"
                                                : fmt::format("none of its {} polygons has an area", polygons.count()));
  }
  const auto count = static_cast<double>(polygons.vertices.size());
  for (const Vec3& v : polygons.vertices) file.vertex_mean = file.vertex_mean + v;
  file.vertex_mean = 1.0 / count * file.vertex_mean;
  file.mesh = std::make_shared<const Mesh>(std::move(polygons.vertices), std::move(triangles), path);
  if (file.without_area > 0) {
    file.warnings.push_back(fmt::format("{}: {} triangles without area were left out", path, file.without_area));
  }
  check_extent(options.unit, path, file);
  if (!options.y_up) file.up_warning = up_warning(path, file.up);
  return file;
}

}  // namespace trellis
