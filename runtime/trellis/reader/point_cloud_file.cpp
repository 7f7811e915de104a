// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/point_cloud_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

#include <trellis/base/input_file.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/point_cloud_formats.hpp>
#include <trellis/reader/unread.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

struct Format {
  std::string_view ending;
  void (*read)(const MeshSource&, PointSink&);
};

constexpr std::array<Format, 6> formats{{{"ply", read_ply_points},
                                         {"pcd", read_pcd},
                                         {"xyz", read_xyz},
                                         {"pts", read_xyz},
                                         {"txt", read_xyz},
                                         {"csv", read_xyz}}};

const Format* format_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto* const format = std::find_if(formats.begin(), formats.end(), [&](const Format& f) {
    return !ending.empty() && f.ending == std::string_view(ending).substr(1);
  });
  return format == formats.end() ? nullptr : format;
}

}  // namespace

void PointSink::check_limit(double count, std::size_t line) const {
  if (!(count > static_cast<double>(PointCloud::most_points))) return;
  throw source_.error(line,
                      fmt::format("it declares {:.0f} points; a cloud has at most {}", count, PointCloud::most_points));
}

void PointSink::add(const Vec3& given, std::size_t line) {
  ++seen_;
  const bool numbers = std::isfinite(given.x) && std::isfinite(given.y) && std::isfinite(given.z);
  if (!numbers && skip_nan_) {
    ++skipped_;
    return;
  }
  if (!numbers) {
    throw source_.error(line, fmt::format("point {} is ({}, {}, {}); `skip_nan = true` leaves such points out, which a "
                                          "sensor writes where it measured nothing",
                                          seen_, given.x, given.y, given.z));
  }
  if (points_.size() == PointCloud::most_points) {
    throw source_.error(line, fmt::format("more than {} points", PointCloud::most_points));
  }
  const Vec3 p = source_.unit * given;
  if (!in_range(p)) {
    throw source_.error(line, fmt::format("point {} must lie within {:g} m of 0 in x, y and z, got ({}, {}, {})", seen_,
                                          most_distant, p.x, p.y, p.z));
  }
  points_.push_back(p);
}

void read_xyz(const MeshSource& source, PointSink& sink) {
  sink.format = "points as text";
  Lines lines(source.text);
  std::string line;
  bool first = true;
  while (lines.next_filled()) {
    line.assign(lines.here);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    std::string_view rest = line;
    std::array<double, 3> p{};
    std::size_t count = 0;
    std::string_view word;
    while (count < p.size()) {
      word = take_word(rest);
      const auto value = number_in(word);
      if (!value) break;
      p[count++] = *value;
    }
    // The first line may name the columns, or be the number of points.
    const bool heading = first && (count == 0 || (count == 1 && word.empty()));
    first = false;
    if (heading) continue;
    if (count < p.size()) {
      throw source.error(lines.number(),
                         fmt::format("a point needs three numbers, got {}", word.empty() ? "fewer" : in_quotes(word)));
    }
    sink.add({p[0], p[1], p[2]}, lines.number());
  }
}

const std::vector<std::string>& point_cloud_endings() {
  static const std::vector<std::string> endings = [] {
    std::vector<std::string> all;
    all.reserve(formats.size());
    for (const Format& format : formats) all.emplace_back(format.ending);
    return all;
  }();
  return endings;
}

PointCloudFile read_point_cloud(const std::string& path, const PointCloudOptions& options) {
  const Format* format = format_of(path);
  if (format == nullptr) {
    const std::string known = unread_ending(path);
    throw Error(fmt::format("{}: files of points end with .{}{}{}", path, fmt::join(point_cloud_endings(), ", ."),
                            known.empty() ? "" : "; it is ", known));
  }
  constexpr std::uintmax_t largest = std::uintmax_t{256} << 20U;
  InputFile file(path, largest);
  MeshSource source{path, file.rest(), metres_in(options.unit), false};
  if (!file.fault().empty()) throw Error(fmt::format("{}: the file cannot be read: {}", path, file.fault()));
  if (source.text.starts_with(byte_order_mark)) source.text.erase(0, byte_order_mark.size());
  PointSink sink(source, options.skip_nan);
  format->read(source, sink);
  PointCloudFile read{std::move(sink.points()), sink.format, sink.skipped(), {}};
  if (read.points.empty()) {
    throw source.error(0, read.skipped == 0
                              ? "it has no points"
                              : fmt::format("none of its {} points has numbers as coordinates", read.skipped));
  }
  const Box3 box = bounds_of(read.points);
  const Vec3 size = box.hi - box.lo;
  const double extent = std::max({size.x, size.y, size.z});
  constexpr double huge = 500.0;  // m
  if (extent > huge && options.unit == "m") {
    read.warnings.push_back(
        fmt::format(R"({}: it extends {:.4g} x {:.4g} x {:.4g} m; if its numbers are millimetres, give unit = "mm")",
                    path, size.x, size.y, size.z));
  }
  return read;
}

}  // namespace trellis
