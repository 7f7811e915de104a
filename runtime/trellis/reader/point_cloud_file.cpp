// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/point_cloud_file.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

/// Splits a row of a text at semicolons, else at commas, else at blanks. Rows that separate by several of them are
/// split at all.
void split_row(std::string_view line, std::vector<std::string_view>& cells) {
  constexpr std::string_view space = " \t";
  const auto trimmed = [&](std::string_view cell) {
    const std::size_t begin = cell.find_first_not_of(space);
    return begin == std::string_view::npos ? std::string_view()
                                           : cell.substr(begin, cell.find_last_not_of(space) + 1 - begin);
  };
  cells.clear();
  const char mark = line.find(';') != std::string_view::npos   ? ';'
                    : line.find(',') != std::string_view::npos ? ','
                                                               : ' ';
  bool several = mark == ' ';
  std::string_view rest = trimmed(line);
  while (!several) {
    const std::size_t end = rest.find(mark);
    cells.push_back(trimmed(rest.substr(0, end)));
    several = cells.back().find_first_of(" \t,") != std::string_view::npos;
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  if (!several) return;
  cells.clear();
  rest = line;
  while (true) {
    rest.remove_prefix(std::min(rest.size(), rest.find_first_not_of(" \t,;")));
    if (rest.empty()) return;
    const std::size_t end = std::min(rest.size(), rest.find_first_of(" \t,;"));
    cells.push_back(rest.substr(0, end));
    rest.remove_prefix(end);
  }
}

/// Returns the columns of x, y and z that a header names.
/// \param warnings  receives the names of the other columns
std::array<std::size_t, 3> named_columns(const MeshSource& source, std::size_t line,
                                         const std::vector<std::string_view>& cells,
                                         std::vector<std::string>& warnings) {
  std::array<std::size_t, 3> columns{};
  std::array<bool, 3> found{};
  std::vector<std::string> names;
  std::vector<std::string> others;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string name(cells[i]);
    if (i == 0 && name.starts_with("//")) name.erase(0, 2);  // as CloudCompare writes it
    if (name.size() > 1 && name.front() == name.back() && (name.front() == '"' || name.front() == '\'')) {
      name = name.substr(1, name.size() - 2);
    }
    if (name.empty()) continue;
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    constexpr std::array<std::array<std::string_view, 2>, 3> axes = {
        {{"x", "points:0"}, {"y", "points:1"}, {"z", "points:2"}}};  // those of ParaView
    bool axis = false;
    for (std::size_t k = 0; k < axes.size(); ++k) {
      if (lower != axes.at(k)[0] && lower != axes.at(k)[1]) continue;
      axis = true;
      if (found.at(k)) throw source.error(line, fmt::format("two columns are called {}", in_quotes(name)));
      found.at(k) = true;
      columns.at(k) = i;
    }
    names.push_back(in_quotes(name));
    if (!axis) others.push_back(in_quotes(name));
  }
  if (!found[0] || !found[1] || !found[2]) {
    throw source.error(line,
                       fmt::format("the first line names the columns {}: a cloud has columns x, y and z, in metres",
                                   fmt::join(names, ", ")));
  }
  if (!others.empty()) {
    warnings.push_back(fmt::format("{}:{}: column{} {} {} not read", source.path, line, others.size() == 1 ? "" : "s",
                                   fmt::join(others, ", "), others.size() == 1 ? "is" : "are"));
  }
  return columns;
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
  std::array<std::size_t, 3> columns = {0, 1, 2};
  bool first = true;
  bool headed = false;
  bool more = false;
  std::vector<std::string_view> cells;
  while (lines.next_filled()) {
    split_row(lines.here, cells);
    const bool begins = std::exchange(first, false);
    // The first line may name the columns, or be the number of points.
    if (begins && cells.size() == 1 && number_in(cells.front())) continue;
    if (begins && !number_in(cells.front())) {
      columns = named_columns(source, lines.number(), cells, sink.warnings);
      headed = true;
      continue;
    }
    if (!headed && cells.size() > 3 && !std::exchange(more, true)) {
      sink.warnings.push_back(
          fmt::format("{}:{}: the line has {} columns and none has a name: the first three are x, y "
                      "and z; a first line as `id,x,y,z` would name them",
                      source.path, lines.number(), cells.size()));
    }
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < p.size(); ++k) {
      const std::string_view cell = columns.at(k) < cells.size() ? cells[columns.at(k)] : std::string_view();
      const auto value = number_in(cell);
      if (!value) {
        throw source.error(lines.number(), fmt::format("a point needs three numbers, got {}",
                                                       cell.empty() ? std::string("fewer") : in_quotes(cell)));
      }
      p.at(k) = *value;
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
  PointCloudFile read{std::move(sink.points()), sink.format, sink.skipped(), std::move(sink.warnings)};
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
