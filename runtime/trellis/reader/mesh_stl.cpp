// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>

namespace trellis {

namespace {

static_assert(std::endian::native == std::endian::little, "numbers of binary STL files are little-endian");

constexpr std::size_t head = 80;    // bytes before the number of triangles
constexpr std::size_t record = 50;  // bytes of a triangle

template <class T>
T value_at(const std::string& text, std::size_t byte) {
  T value{};
  std::memcpy(&value, text.data() + byte, sizeof(T));
  return value;
}

/// The number of triangles that a binary file declares.
std::uint32_t declared(const std::string& text) { return value_at<std::uint32_t>(text, head); }

std::size_t size_for(std::size_t triangles) { return head + sizeof(std::uint32_t) + record * triangles; }

/// The text of an ASCII file without a byte order mark.
std::string_view without_mark(std::string_view text) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  return text;
}

std::string lower(std::string_view word) {
  std::string result(word);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

/// Whether the first word is `solid`, in any case, after a byte order mark and blank lines. The headers of some binary
/// files begin so too.
bool starts_as_text(const std::string& text) {
  Lines lines(without_mark(text));
  while (lines.next()) {
    const std::string_view word = take_word(lines.here);
    if (!word.empty()) return lower(word) == "solid";
  }
  return false;
}

/// Whether the file is binary: it does not start as text, its size is that of its triangles, or it has a NUL before the
/// first facet of an ASCII file.
bool is_binary(const std::string& text) {
  if (text.size() < size_for(0)) return false;
  if (!starts_as_text(text) || text.size() == size_for(declared(text))) return true;
  constexpr std::size_t longest = 1024;  // bytes of a name
  const std::size_t nul = text.find('\0');
  return nul != std::string::npos &&
         lower(std::string_view(text).substr(0, std::min(nul, longest))).find("facet") == std::string::npos;
}

void read_binary(const MeshSource& source, Polygons& polygons) {
  polygons.format = "STL, binary";
  const std::string& text = source.text;
  const std::size_t count = declared(text);
  if (count > Mesh::most_triangles) {
    throw source.error_at_byte(
        head, fmt::format("it declares {} triangles; a mesh has at most {}", count, Mesh::most_triangles));
  }
  if (text.size() < size_for(count)) {
    throw source.error_at_byte(head, fmt::format("it declares {} triangles, which take {} bytes, but the file has {}",
                                                 count, size_for(count), text.size()));
  }
  if (const std::size_t more = text.size() - size_for(count); more > 0) {
    polygons.warnings.push_back(fmt::format("{} bytes after its {} triangles were left out", more, count));
  }
  polygons.vertices.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    // The normal comes first.
    constexpr std::size_t skipped = 3 * sizeof(float);
    std::size_t at = size_for(i) + skipped;
    std::array<std::uint32_t, 3> corners{};
    for (std::uint32_t& corner : corners) {
      std::array<double, 3> v{};
      for (double& x : v) {
        x = double{value_at<float>(text, at)};
        at += sizeof(float);
      }
      corner = static_cast<std::uint32_t>(polygons.vertices.size());
      polygons.add_vertex({v[0], v[1], v[2]}, 0);
    }
    polygons.add(corners, 0);
  }
}

/// The statements of an ASCII file, each of which must stand at its place.
class Statements {
 public:
  Statements(const MeshSource& source, Polygons& polygons)
      : source_(source), lines_(without_mark(source.text)), polygons_(polygons) {}

  void read() {
    while (filled()) {
      if (polygons_.count() > 0 && is_padding(lines_.here)) {
        const auto begin = static_cast<std::size_t>(lines_.here.data() - source_.text.data());
        polygons_.warnings.push_back(
            fmt::format("{} bytes after 'endsolid' were left out", source_.text.size() - begin));
        return;
      }
      expect("solid");
      solid();
    }
  }

 private:
  /// Whether a line after 'endsolid' begins with a NUL or the end of a text of CP/M (Ctrl-Z), with which some programs
  /// fill up the last block of a file.
  static bool is_padding(std::string_view line) {
    constexpr char ctrl_z = 0x1A;
    const std::string_view word = take_word(line);
    return word.front() == '\0' || word.front() == ctrl_z;
  }
  bool filled() {
    while (lines_.next()) {
      std::string_view rest = lines_.here;
      if (!take_word(rest).empty()) return true;
    }
    return false;
  }
  [[noreturn]] void fail(const std::string& expected, std::string_view got) const {
    throw source_.error(lines_.number(), fmt::format("expected {}, got {}", expected,
                                                     got.empty() ? "the end of the line" : in_quotes(got)));
  }
  void expect(std::string_view wanted) {
    const std::string_view word = take_word(lines_.here);
    if (lower(word) != wanted) fail(fmt::format("'{}'", wanted), word);
  }
  void line_of(std::string_view wanted) {
    if (!filled()) throw source_.error(lines_.number(), fmt::format("the file ends before '{}'", wanted));
    expect(wanted);
  }
  void solid() {
    while (true) {
      if (!filled()) throw source_.error(lines_.number(), "the file ends before 'endsolid'");
      const std::string_view word = take_word(lines_.here);
      const std::string statement = lower(word);
      if (statement == "endsolid") return;
      if (statement != "facet") fail("'facet' or 'endsolid'", word);
      facet();
    }
  }
  void facet() {
    const std::size_t line = lines_.number();
    line_of("outer");
    std::array<std::uint32_t, 3> corners{};
    for (std::uint32_t& corner : corners) {
      line_of("vertex");
      corner = static_cast<std::uint32_t>(polygons_.vertices.size());
      polygons_.add_vertex(lines_);
    }
    line_of("endloop");
    line_of("endfacet");
    polygons_.add(corners, line);
  }

  const MeshSource& source_;
  Lines lines_;
  Polygons& polygons_;
};

}  // namespace

void read_stl(const MeshSource& source, Polygons& polygons) {
  if (is_binary(source.text)) {
    read_binary(source, polygons);
    return;
  }
  polygons.format = "STL, ASCII";
  if (!starts_as_text(source.text)) {
    throw source.error(1, "it is no STL file: an ASCII one begins with 'solid', a binary one has at least 84 bytes");
  }
  Statements(source, polygons).read();
}

}  // namespace trellis
