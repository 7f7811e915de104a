// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include <trellis/reader/mesh_formats.hpp>

namespace trellis {

namespace {

// Statements without influence on where triangles are.
constexpr std::array<std::string_view, 21> ignored = {
    "vt",    "vn",       "vp",       "g",          "o",         "s",   "mg", "usemtl", "mtllib", "usemap", "maplib",
    "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "lod", "l",  "p",      "vc",     "csh"};
// Statements of curves and free-form surfaces.
constexpr std::array<std::string_view, 14> curved = {"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                                     "parm",   "trim", "hole", "scrv", "sp",   "con",   "end"};

template <std::size_t N>
bool among(const std::array<std::string_view, N>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Joins a line that ends with a backslash with the next one.
void join_continued(Lines& lines, std::string& joined) {
  const auto ends_open = [](std::string_view line) {
    const std::size_t last = line.find_last_not_of(" \t\r");
    return last != std::string_view::npos && line[last] == '\\';
  };
  if (!ends_open(lines.here)) return;
  joined.clear();
  while (true) {
    const bool open = ends_open(lines.here);
    joined += open ? lines.here.substr(0, lines.here.rfind('\\')) : lines.here;
    joined += ' ';
    if (!open || !lines.next()) break;
  }
  lines.here = joined;
}

/// Adds the polygon of an `f` statement: indices count from 1, or back from -1, the last vertex so far.
void add_face(const MeshSource& source, Lines& lines, std::vector<std::uint32_t>& corners, Polygons& polygons) {
  corners.clear();
  for (std::string_view word = take_word(lines.here); !word.empty(); word = take_word(lines.here)) {
    if (word.starts_with('#')) break;
    // vertex, vertex/texture, vertex//normal, or vertex/texture/normal
    const auto given = integer_in(word.substr(0, word.find('/')));
    if (!given) {
      throw source.error(lines.number(), fmt::format("polygon {}: expected the index of a vertex, got {}",
                                                     polygons.count() + 1, in_quotes(word)));
    }
    const auto known = static_cast<std::int64_t>(polygons.vertices.size());
    if (*given < -known) {
      throw source.error(lines.number(), fmt::format("polygon {} names vertex {}, but there are {} before it",
                                                     polygons.count() + 1, *given, known));
    }
    corners.push_back(polygons.vertex(*given < 0 ? known + *given + 1 : *given, 1, lines.number()));
    if (corners.size() > most_corners) break;
  }
  polygons.add(corners, lines.number());
}

}  // namespace

void read_obj(const MeshSource& source, Polygons& polygons) {
  polygons.format = "OBJ";
  Lines lines(source.text);
  std::string joined;
  std::vector<std::uint32_t> corners;
  while (lines.next()) {
    join_continued(lines, joined);
    std::string_view line = lines.here;
    const std::string_view word = take_word(line);
    if (word.empty() || word.starts_with('#')) continue;
    if (word == "v") {
      lines.here = line;
      polygons.add_vertex(lines);
    } else if (word == "f" || word == "fo") {
      lines.here = line;
      add_face(source, lines, corners, polygons);
    } else if (const auto vertices = number_in(word); vertices && lines.number() == 1) {
      // Some programs write the numbers of vertices and triangles first.
      polygons.expect(*vertices, number_in(take_word(line)).value_or(0.0), lines.number());
    } else if (among(curved, word)) {
      throw source.error(lines.number(),
                         fmt::format("'{}': curves and free-form surfaces are not read; export triangles", word));
    } else if (!among(ignored, word)) {
      throw source.error(lines.number(), fmt::format("{} is no statement of an OBJ file", in_quotes(word)));
    }
  }
}

}  // namespace trellis
