// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/scene/spatial/mesh.hpp>

namespace trellis {

// What the readers of the formats of meshes share; callers use read_mesh.

inline constexpr std::size_t most_corners = 1000;  ///< of a polygon

/// A file in memory, and the unit of its coordinates.
struct MeshSource {
  std::string path;
  std::string text;
  double unit = 1.0;  ///< in metres
  bool y_up = false;  ///< see MeshOptions

  /// Returns an Error at a line (counted from 1); line 0 is the whole file.
  [[nodiscard]] Error error(std::size_t line, const std::string& fault) const;
  /// Returns an Error at a byte (counted from 0).
  [[nodiscard]] Error error_at_byte(std::size_t byte, const std::string& fault) const;
};

/// The lines of a text without their ends, which are LF or CR LF.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  /// Goes to the next line; false at the end of the text.
  bool next();
  /// The words of this line that are left.
  std::string_view here;
  /// The number of this line, counted from 1.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// The text after this line.
  [[nodiscard]] std::string_view rest() const { return rest_; }
  /// Goes to the next line that is not blank or a comment from `#` on, which is cut off.
  bool next_filled();

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Takes the first word of a line off it; "" where there is none.
std::string_view take_word(std::string_view& line);
/// Returns the number that a whole word is, which may be infinite or not a number.
std::optional<double> number_in(std::string_view word);
std::optional<std::int64_t> integer_in(std::string_view word);
/// Returns a word in quotes, as messages show it: cut off where it is long, without control characters.
std::string in_quotes(std::string_view word);

/// The polygons of a file.
class Polygons {
 public:
  explicit Polygons(const MeshSource& source) : source_(source) {}

  std::string format;
  std::vector<Vec3> vertices;
  std::vector<std::string> warnings;  ///< what the file contains and the mesh does not, without the file's name

  /// Adds a vertex from its coordinates in the file's unit. \param line  of the vertex, 0 in a binary file
  void add_vertex(const Vec3& given, std::size_t line);
  /// Adds a vertex from the first three words of the line.
  void add_vertex(Lines& lines);
  /// Adds a polygon of vertices counted from 0, which may follow later. \param line  of the polygon, 0 in a binary file
  void add(std::span<const std::uint32_t> corners, std::size_t line);
  /// Returns the vertex of an index that is counted from `first`.
  [[nodiscard]] std::uint32_t vertex(std::int64_t index, std::int64_t first, std::size_t line) const;
  /// \throws Error where a file declares more vertices or polygons than a mesh may have
  void check_limits(double vertex_count, double polygon_count, std::size_t line) const;
  /// \throws Error also where a text declares more vertices and polygons than it has bytes for
  void expect(double vertex_count, double polygon_count, std::size_t line) const;
  [[nodiscard]] std::size_t count() const { return begin_.size(); }
  /// Cuts the polygons into triangles and leaves those without area out.
  /// \throws Error where a polygon names a vertex that the file does not have, or its sides cross
  std::vector<Triangle> triangles(std::size_t& without_area) const;

 private:
  [[nodiscard]] Error fault(std::size_t polygon, const std::string& what) const;

  const MeshSource& source_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> begin_;  // of each polygon in corners_
  std::vector<std::uint32_t> lines_;  // of each polygon
  std::size_t triangles_ = 0;         // that the polygons make at most
};

/// Cuts a polygon into triangles, by diagonals inside it as seen along its normal. Returns false where its sides cross.
bool triangulate(const std::vector<Vec3>& vertices, std::span<const std::uint32_t> corners,
                 std::vector<Triangle>& triangles);

void read_stl(const MeshSource& source, Polygons& polygons);
void read_obj(const MeshSource& source, Polygons& polygons);
void read_ply(const MeshSource& source, Polygons& polygons);
void read_off(const MeshSource& source, Polygons& polygons);
void read_byu(const MeshSource& source, Polygons& polygons);
/// Reads COLLADA through the program trellis-mesh, in metres.
void read_dae(const MeshSource& source, Polygons& polygons);

/// What a file of COLLADA states of its coordinates.
struct ColladaAsset {
  char up = 'y';                ///< the axis that points up: 'x', 'y' or 'z'
  double metres_in_unit = 1.0;  ///< as assimp uses it
  std::string unit_name = {};   ///< "inch"; "" without
};
/// Returns the `<up_axis>` and the `<unit>` of a file, or what COLLADA defines where it has none: Y_UP and metres.
ColladaAsset collada_asset(std::string_view text);

}  // namespace trellis
