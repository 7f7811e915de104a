// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/mesh_formats.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <system_error>

#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

constexpr std::string_view blanks = " \t\v\f\r";

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7f; }

}  // namespace

Error MeshSource::error(std::size_t line, const std::string& fault) const {
  if (line == 0) return Error(fmt::format("{}: {}", path, fault));
  return Error(fmt::format("{}:{}: {}", path, line, fault));
}

Error MeshSource::error_at_byte(std::size_t byte, const std::string& fault) const {
  return Error(fmt::format("{}: byte {}: {}", path, byte, fault));
}

bool Lines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  here = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  ++number_;
  return true;
}

bool Lines::next_filled() {
  while (next()) {
    here = here.substr(0, here.find('#'));
    if (here.find_first_not_of(blanks) != std::string_view::npos) return true;
  }
  return false;
}

std::string_view take_word(std::string_view& line) {
  const std::size_t begin = line.find_first_not_of(blanks);
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  line.remove_prefix(begin);
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  // Too large, or too small: strtod gives infinity or a number near 0.
  if (fault == std::errc::result_out_of_range) return std::strtod(std::string(word).c_str(), nullptr);
  return value;
}

std::optional<std::int64_t> integer_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t most = 40;
  std::string text(word.substr(0, most));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return is_control(c) || static_cast<unsigned char>(c) > 0x7eU; }, '?');
  return fmt::format("'{}{}'", text, word.size() > most ? "..." : "");
}

void Polygons::add_vertex(const Vec3& given, std::size_t line) {
  constexpr std::size_t most = 3 * Mesh::most_triangles;
  if (vertices.size() == most) throw source_.error(line, fmt::format("more than {} vertices", most));
  const Vec3 v = source_.unit * given;
  if (!in_range(v)) {
    throw source_.error(line, fmt::format("vertex {} must lie within {:g} m of 0 in x, y and z, got ({}, {}, {})",
                                          vertices.size() + 1, most_distant, v.x, v.y, v.z));
  }
  vertices.push_back(v);
}

void Polygons::add_vertex(Lines& lines) {
  std::array<double, 3> v{};
  for (double& x : v) {
    const std::string_view word = take_word(lines.here);
    const auto value = number_in(word);
    if (!value) {
      throw source_.error(lines.number(), fmt::format("vertex {} needs three numbers, got {}", vertices.size() + 1,
                                                      word.empty() ? "fewer" : in_quotes(word)));
    }
    x = *value;
  }
  add_vertex({v[0], v[1], v[2]}, lines.number());
}

void Polygons::add(std::span<const std::uint32_t> corners, std::size_t line) {
  if (corners.size() < 3 || corners.size() > most_corners) {
    throw source_.error(
        line, fmt::format("polygon {} needs 3 to {} vertices, got {}", count() + 1, most_corners, corners.size()));
  }
  triangles_ += corners.size() - 2;
  if (triangles_ > Mesh::most_triangles) {
    throw source_.error(line, fmt::format("more than {} triangles", Mesh::most_triangles));
  }
  begin_.push_back(static_cast<std::uint32_t>(corners_.size()));
  lines_.push_back(static_cast<std::uint32_t>(line));
  corners_.insert(corners_.end(), corners.begin(), corners.end());
}

std::uint32_t Polygons::vertex(std::int64_t index, std::int64_t first, std::size_t line) const {
  constexpr std::int64_t most = 3 * static_cast<std::int64_t>(Mesh::most_triangles);
  if (index < first || index - first >= most) {
    throw source_.error(
        line, fmt::format("polygon {} names vertex {}; vertices are counted from {}", count() + 1, index, first));
  }
  return static_cast<std::uint32_t>(index - first);
}

void Polygons::check_limits(double vertex_count, double polygon_count, std::size_t line) const {
  constexpr std::size_t most_vertices = 3 * Mesh::most_triangles;
  if (polygon_count > static_cast<double>(Mesh::most_triangles)) {
    throw source_.error(line, fmt::format("it declares {:.0f} polygons; a mesh has at most {} triangles", polygon_count,
                                          Mesh::most_triangles));
  }
  if (vertex_count > static_cast<double>(most_vertices)) {
    throw source_.error(
        line, fmt::format("it declares {:.0f} vertices; a file of a mesh has at most {}", vertex_count, most_vertices));
  }
}

void Polygons::expect(double vertex_count, double polygon_count, std::size_t line) const {
  check_limits(vertex_count, polygon_count, line);
  // Three digits and a blank after each at least.
  if (6.0 * (vertex_count + polygon_count) > static_cast<double>(source_.text.size()) + 6.0) {
    throw source_.error(line,
                        fmt::format("it declares {:.0f} vertices and {:.0f} polygons, for which its {} bytes are too "
                                    "few",
                                    vertex_count, polygon_count, source_.text.size()));
  }
}

Error Polygons::fault(std::size_t polygon, const std::string& what) const {
  return source_.error(lines_[polygon], fmt::format("polygon {} {}", polygon + 1, what));
}

std::vector<Triangle> Polygons::triangles(std::size_t& without_area) const {
  const auto corners_of = [&](std::size_t i) {
    const std::size_t end = i + 1 < begin_.size() ? begin_[i + 1] : corners_.size();
    return std::span(corners_).subspan(begin_[i], end - begin_[i]);
  };
  // All before any work.
  for (std::size_t i = 0; i < count(); ++i) {
    for (const std::uint32_t v : corners_of(i)) {
      if (v < vertices.size()) continue;
      throw fault(i, fmt::format("names vertex {} (counted from 1), but the file has {}", std::uint64_t{v} + 1U,
                                 vertices.size()));
    }
  }
  std::vector<Triangle> all;
  all.reserve(triangles_);
  for (std::size_t i = 0; i < count(); ++i) {
    if (!triangulate(vertices, corners_of(i), all)) throw fault(i, "cannot be cut into triangles: its sides cross");
  }
  const std::size_t made = all.size();
  std::erase_if(all, [&](const Triangle& t) {
    const Vec3& a = vertices[t[0]];
    return cross(vertices[t[1]] - a, vertices[t[2]] - a) == Vec3{};
  });
  without_area = made - all.size();
  return all;
}

}  // namespace trellis
