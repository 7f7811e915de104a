// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>

#include <trellis/reader/mesh_formats.hpp>

namespace trellis {

namespace {

/// Reads numbers that are not negative from a line.
template <std::size_t N>
std::array<double, N> counts_in(const MeshSource& source, Lines& lines, const std::string& expected) {
  std::array<double, N> counts{};
  for (double& count : counts) {
    const std::string_view word = take_word(lines.here);
    const auto value = integer_in(word);
    if (!value || *value < 0) {
      throw source.error(lines.number(), fmt::format("expected {}, got {}", expected,
                                                     word.empty() ? "the end of the line" : in_quotes(word)));
    }
    count = static_cast<double>(*value);
  }
  return counts;
}

[[noreturn]] void fail_end(const MeshSource& source, const Lines& lines, const char* what, double done, double all) {
  throw source.error(lines.number(), fmt::format("the file ends after {:.0f} of {:.0f} {}", done, all, what));
}

/// Goes to the line of the counts, which may be the rest of the first one.
void read_heading(const MeshSource& source, Lines& lines) {
  if (!lines.next_filled()) throw source.error(1, "the file is empty");
  const std::string_view word = take_word(lines.here);
  if (word != "OFF" && word != "COFF" && word != "NOFF" && word != "CNOFF" && word != "STOFF") {
    throw source.error(lines.number(),
                       fmt::format("expected 'OFF' (or COFF, NOFF, CNOFF, STOFF), got {}", in_quotes(word)));
  }
  std::string_view rest = lines.here;
  const std::string_view next = take_word(rest);
  if (next == "BINARY") throw source.error(lines.number(), "binary OFF files are not read; export an ASCII one");
  if (next.empty() && !lines.next_filled()) {
    throw source.error(lines.number(), "the file ends before the numbers of vertices and polygons");
  }
}

}  // namespace

void read_off(const MeshSource& source, Polygons& polygons) {
  polygons.format = "OFF";
  Lines lines(source.text);
  read_heading(source, lines);
  const auto [vertices, faces] = counts_in<2>(source, lines, "the numbers of vertices, polygons and edges");
  polygons.expect(vertices, faces, lines.number());
  for (double i = 0; i < vertices; ++i) {
    if (!lines.next_filled()) fail_end(source, lines, "vertices", i, vertices);
    // Normals, colours and coordinates of textures may follow.
    polygons.add_vertex(lines);
  }
  std::vector<std::uint32_t> corners;
  for (double i = 0; i < faces; ++i) {
    if (!lines.next_filled()) fail_end(source, lines, "polygons", i, faces);
    const auto [size] = counts_in<1>(source, lines, "a polygon's number of vertices");
    corners.clear();
    for (double k = 0; k < size && corners.size() <= most_corners; ++k) {
      const std::string_view word = take_word(lines.here);
      const auto index = integer_in(word);
      if (!index) {
        throw source.error(lines.number(),
                           fmt::format("polygon {} needs {:.0f} indices of vertices, got {}", polygons.count() + 1,
                                       size, word.empty() ? "fewer" : in_quotes(word)));
      }
      corners.push_back(polygons.vertex(*index, 0, lines.number()));
    }
    polygons.add(corners, lines.number());
  }
}

// The format of Movie.BYU: the numbers of parts, vertices, polygons and edges; the first and last polygon of each part;
// coordinates; indices from 1, of which the last of a polygon is negative.
void read_byu(const MeshSource& source, Polygons& polygons) {
  polygons.format = "BYU";
  Lines lines(source.text);
  if (!lines.next_filled()) throw source.error(1, "the file is empty");
  const auto [parts, vertices, faces] =
      counts_in<3>(source, lines, "the numbers of parts, vertices, polygons and edges");
  polygons.expect(vertices, faces, lines.number());
  // Numbers may stand on any line.
  const auto next = [&](const char* what, double done, double all) {
    std::string_view word = take_word(lines.here);
    while (word.empty()) {
      if (!lines.next_filled()) fail_end(source, lines, what, done, all);
      word = take_word(lines.here);
    }
    return word;
  };
  const auto integer = [&](const char* what, double done, double all) {
    const std::string_view word = next(what, done, all);
    const auto value = integer_in(word);
    if (!value) throw source.error(lines.number(), fmt::format("expected an integer, got {}", in_quotes(word)));
    return *value;
  };
  lines.here = {};
  for (double i = 0; i < 2 * parts; ++i) static_cast<void>(integer("parts", i / 2, parts));
  for (double i = 0; i < vertices; ++i) {
    std::array<double, 3> v{};
    for (double& x : v) {
      const std::string_view word = next("vertices", i, vertices);
      const auto value = number_in(word);
      if (!value) {
        throw source.error(lines.number(),
                           fmt::format("vertex {:.0f} needs three numbers, got {}", i + 1, in_quotes(word)));
      }
      x = *value;
    }
    polygons.add_vertex({v[0], v[1], v[2]}, lines.number());
  }
  std::vector<std::uint32_t> corners;
  for (double i = 0; i < faces; ++i) {
    corners.clear();
    std::int64_t index = 1;
    while (index >= 0 && corners.size() <= most_corners) {
      index = integer("polygons", i, faces);
      // -index would overflow for the least integer, which vertex() refuses as it is.
      const bool last = index < 0 && index >= -std::int64_t{0xffffffff};
      corners.push_back(polygons.vertex(last ? -index : index, 1, lines.number()));
    }
    polygons.add(corners, lines.number());
  }
}

}  // namespace trellis
